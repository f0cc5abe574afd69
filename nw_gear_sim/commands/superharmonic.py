"""`nw_gear study superharmonic`: amplitudes of the third superharmonic of a gear pair under delayed feedback."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nw_gear_common.errors import InputError
from nw_gear_sim.commands import axes
from nw_gear_sim.commands.point import JsonOption

if TYPE_CHECKING:
    from nw_gear_sim.superharmonic.family import Curve

Given = Annotated[float | None, typer.Option(help="In the place of the paper's value.")]


def superharmonic(
    stage: Annotated[str, typer.Option("--stage", help="Gear pair: I, II or III.")] = "II",
    mode: Annotated[
        str, typer.Option("--mode", help="corrected, or paper_eq75: the printed sign and stability condition.")
    ] = "corrected",
    omega: Annotated[
        list[str] | None,
        typer.Option("--omega", help="Excitation frequency: a number (repeatable) or START:STOP:COUNT."),
    ] = None,
    over: Annotated[
        str, typer.Option("--over", help="Curves over a parameter at each --omega: zeta=0:0.12:2401; also g_d, g_v.")
    ] = "",
    family: Annotated[str, typer.Option("--family", help="One curve for each value: zeta=0.02,0.06,0.1.")] = "",
    exact: Annotated[
        bool, typer.Option("--exact", help="Add the branch of the delay equation itself, by harmonic balance.")
    ] = False,
    zeta: Given = None,
    g_d: Given = None,
    g_v: Given = None,
    tau_d: Given = None,
    tau_v: Given = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="File: .html draws, .csv lists.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Find amplitudes, stability, folds and jumps near the superharmonic resonance 3 omega = w0."""
    from nw_gear_sim.superharmonic import family as families  # noqa: PLC0415 - numba and scipy only where needed
    from nw_gear_sim.superharmonic.pair import gear_pair  # noqa: PLC0415

    if output is not None and output.suffix not in (".html", ".csv"):
        raise InputError(f"-o {output}", "a name that ends in .html or .csv", output.suffix or "no suffix")
    given = {"zeta": zeta, "g_d": g_d, "g_v": g_v, "tau_d": tau_d, "tau_v": tau_v}
    pair = gear_pair(stage).having(**{name: value for name, value in given.items() if value is not None})
    frequencies = _frequencies(omega)
    curves = families.curves(
        pair,
        mode,
        frequencies,
        over=axes.axis("--over", over) if over else None,
        family=axes.axis("--family", family) if family else None,
        exact=exact,
    )
    shown = _as_object(curves, stage, mode)
    if output is not None:
        shown["files"] = [_write(output, curves, mode)]
    if as_json:
        print(json.dumps(shown))
    else:
        _print(curves, shown)


def _frequencies(texts: list[str] | None) -> Any:
    """Return the frequencies asked for, in ascending order; None where none is."""
    import numpy as np  # noqa: PLC0415 - see superharmonic

    if not texts:
        return None
    return np.unique(np.concatenate([axes.values("--omega", text) for text in texts]))


def _as_object(curves: list[Curve], stage: str, mode: str) -> dict[str, Any]:
    listed = [curve.as_object() for curve in curves]
    first = listed[0]
    return {
        "stage": stage,
        "mode": mode,
        "trust": max(curve["trust"] for curve in listed),
        "points": first["points"],
        "folds": first["folds"],
        "curves": listed,
    }


def _write(path: Path, curves: list[Curve], mode: str) -> str:
    from nw_gear_sim.superharmonic.family import as_csv  # noqa: PLC0415 - see superharmonic

    if path.suffix == ".csv":
        text = as_csv(curves)
    else:
        from nw_gear_sim.drawings.superharmonic_page import page  # noqa: PLC0415

        text = page(curves, mode)
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"-o {path}", "a file that can be written", error.strerror or str(error)) from None
    return str(path)


def _print(curves: list[Curve], shown: dict[str, Any]) -> None:
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415 - rich only where it is needed

    rows = []
    for curve in curves:
        best, at = curve.highest()
        folds = ", ".join(f"{fold:.6g}" for fold in curve.branches.folds) or "none"
        least = "" if curve.exact is None else f"{max(point.alpha for point in curve.exact):.4g}"
        trust = curve.as_object()["trust"]
        rows.append([curve.name, f"{best:.5g}", f"{at:.6g}", least, folds, f"{trust:.3g}"])
    columns = ["curve", "largest alpha", "at", "of the delay equation", "folds at", "trust"]
    show(f"Superharmonic resonance of stage {shown['stage']}, {shown['mode']}", columns, rows)
    if shown["trust"] > 1.0:
        print(
            "\nTrust above 1: the first order is off by more than about 5 % here; --exact gives the delay equation's."
        )
