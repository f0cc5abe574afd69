"""`nw_gear study superharmonic`: what it is asked, and which of its studies answers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from nw_gear_common.errors import InputError
from nw_gear_sim.commands import axes
from nw_gear_sim.commands.point import JsonOption

Given = Annotated[float | None, typer.Option(help="In the place of the paper's value.")]
SUFFIXES = (".html", ".csv", ".parquet")


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
    sweep: Annotated[
        bool, typer.Option("--sweep", help="Integrate in time, frequency stepped up and down: hysteresis, jumps.")
    ] = False,
    map_: Annotated[
        list[str] | None,
        typer.Option("--map", help="Twice: gains, delays (tau: both) or zeta as axes of a chart of mu and folds."),
    ] = None,
    basin: Annotated[
        list[str] | None,
        typer.Option("--basin", help="Twice, x=... and v=...: which motion each start ends in, at one --omega."),
    ] = None,
    restoring: Annotated[
        str, typer.Option("--restoring", help="cubic, or backlash: the gap itself in the delay equation.")
    ] = "cubic",
    slope: Annotated[
        float | None, typer.Option("--slope", help="c k_m beside the gap (default: the one whose fit the cubic is).")
    ] = None,
    fit: Annotated[
        float | None, typer.Option("--fit", help="Half width of the interval of a new cubic fit of the backlash.")
    ] = None,
    history: Annotated[
        str, typer.Option("--history", help="Before a --basin's start: constant (at rest) or free (swinging at w0).")
    ] = "constant",
    periods: Annotated[
        int | None, typer.Option("--periods", help="Periods at most for a step of --sweep or a start of --basin.")
    ] = None,
    workers: Annotated[int | None, typer.Option("--workers", help="Threads of --basin (default: cores).")] = None,
    zeta: Given = None,
    g_d: Given = None,
    g_v: Given = None,
    tau_d: Given = None,
    tau_v: Given = None,
    output: Annotated[
        list[Path] | None,
        typer.Option("-o", "--output", help="File, repeatable: .html draws, .csv and .parquet list."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Find amplitudes, stability, folds and jumps near the superharmonic resonance 3 omega = w0.

    \b
    nw_gear study superharmonic --stage I --family zeta=0.02,0.06,0.1 --exact -o curves.html
    nw_gear study superharmonic --stage I --zeta 0.04 --sweep -o sweep.html
    nw_gear study superharmonic --map g_d=-0.4:0.4:161 --map g_v=-0.4:0.4:161 -o gains.html
    nw_gear study superharmonic --stage I --zeta 0.04 --omega 0.1593 --basin x=-8:8:81 --basin v=-3:3:81 -o basin.html
    nw_gear study superharmonic --restoring backlash -o gap.html
    nw_gear study superharmonic --fit 15 -o fit.html
    """  # noqa: D301 - click's mark for lines that stay as they are
    from nw_gear_sim.superharmonic.question import ask  # noqa: PLC0415 - numba and scipy only where needed

    files = _outputs(output)
    kinds = {"--over": bool(over), "--sweep": sweep, "--map": bool(map_), "--basin": bool(basin)}
    asked = [name for name, wanted in kinds.items() if wanted]
    if len(asked) > 1:
        raise InputError(asked[1], f"one of {', '.join(kinds)} at a time", " and ".join(asked))
    given = {"zeta": zeta, "g_d": g_d, "g_v": g_v, "tau_d": tau_d, "tau_v": tau_v}
    question = ask(stage, mode, given, restoring=restoring, slope=slope, fit=fit)
    frequencies = _frequencies(omega)
    if map_:
        _refuse("--map", family=family, restoring=restoring == "backlash", periods=periods, workers=workers)
        from nw_gear_sim.commands.superharmonic_map import chart  # noqa: PLC0415 - as above

        chart(question, map_, frequencies, exact=exact, files=files, as_json=as_json)
    elif basin:
        _refuse("--basin", family=family, exact=exact)
        from nw_gear_sim.commands.superharmonic_basin import basins  # noqa: PLC0415 - as above

        basins(
            question, basin, frequencies, history=history, periods=periods, workers=workers, files=files,
            as_json=as_json,
        )  # fmt: skip
    elif sweep:
        _refuse("--sweep", family=family, workers=workers)
        from nw_gear_sim.commands.superharmonic_sweep import sweeps  # noqa: PLC0415 - as above

        sweeps(question, frequencies, periods=periods, files=files, as_json=as_json)
    else:
        _refuse("curves", periods=periods, workers=workers)
        _refuse("--over", restoring=bool(over) and restoring == "backlash")
        from nw_gear_sim.commands.superharmonic_curves import curves  # noqa: PLC0415 - as above

        curves(question, frequencies, over=over, family=family, exact=exact, files=files, as_json=as_json)


def _refuse(study: str, **options: Any) -> None:
    """Refuse options that have no meaning in a study."""
    for name, value in options.items():
        if value:
            raise InputError(f"--{name}", f"nothing with {study}: it has no meaning there", str(value))


def _outputs(paths: list[Path] | None) -> list[Path]:
    for path in paths or []:
        if path.suffix not in SUFFIXES:
            raise InputError(f"-o {path}", "a name that ends in " + ", ".join(SUFFIXES), path.suffix or "no suffix")
    return paths or []


def _frequencies(texts: list[str] | None) -> Any:
    """Return the frequencies asked for, in ascending order; None where none is."""
    import numpy as np  # noqa: PLC0415 - see superharmonic

    if not texts:
        return None
    return np.unique(np.concatenate([axes.values("--omega", text) for text in texts]))
