"""`nw_gear study superharmonic`: curves over the frequency or a parameter."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nw_gear_sim.commands import axes
from nw_gear_sim.commands.superharmonic_files import write
from nw_gear_sim.commands.tables import show
from nw_gear_sim.drawings.superharmonic_page import page
from nw_gear_sim.superharmonic import family as families

if TYPE_CHECKING:
    from nw_gear_common.tables import Array
    from nw_gear_sim.superharmonic.family import Curve
    from nw_gear_sim.superharmonic.question import Question


def curves(
    question: Question,
    frequencies: Array | None,
    *,
    over: str,
    family: str,
    exact: bool,
    files: list[Path],
    as_json: bool,
) -> None:
    """Compute, write and print a family of curves.

    Args:
        question: what is asked; frequencies: (n,) or None for those of the resonance.
        over, family: axes as the user wrote them; exact: with the delay equation's branch, as always with a backlash.
        files: to write; as_json: whether to print JSON.

    Raises:
        InputError: axes that make no curve, or a file that can't be written.
    """
    made = families.curves(
        question.pair,
        question.mode,
        frequencies,
        over=axes.axis("--over", over) if over else None,
        family=axes.axis("--family", family) if family else None,
        exact=exact or question.slope is not None,
        slope=question.slope,
    )
    shown = _as_object(made, question)
    if files:
        shown["files"] = write(
            files, question, "superharmonic", lambda: page(made, question), lambda: families.table(made)
        )
    if as_json:
        print(json.dumps(shown))
    else:
        _print(made, question)


def _as_object(made: list[Curve], question: Question) -> dict[str, Any]:
    listed = [curve.as_object() for curve in made]
    first = listed[0]
    return {
        **question.as_object(),
        "trust": max(curve["trust"] for curve in listed),
        "points": first["points"],
        "folds": first["folds"],
        "curves": listed,
    }


def _print(made: list[Curve], question: Question) -> None:
    if question.fit is not None:
        print(question.in_words())
    rows = []
    for curve in made:
        best, at = curve.highest()
        folds = ", ".join(f"{fold:.6g}" for fold in curve.branches.folds) or "none"
        least = "" if curve.exact is None else f"{max(point.alpha for point in curve.exact.points):.4g}"
        rows.append([curve.name, f"{best:.5g}", f"{at:.6g}", least, folds, f"{curve.trust:.3g}"])
    columns = ["curve", "largest alpha", "at", "of the delay equation", "folds at", "trust"]
    show(f"Superharmonic resonance of stage {question.pair.stage}, {question.mode}", columns, rows)
    for curve in made:
        for jump in curve.jumps:
            print(f"{curve.name}, first order: jumps {jump.in_words(curve.over)}")
        for jump in () if curve.exact is None else curve.exact.jumps:
            print(f"{curve.name}, delay equation with the {question.law}: jumps {jump.in_words(curve.over)}")
        if curve.exact is not None and not curve.exact.whole:
            print(f"{curve.name}: the branch was lost at omega = {curve.exact.points[-1].omega:.6g}")
    if max(curve.trust for curve in made) > 1.0:
        print(
            "\nTrust above 1: the first order is off by more than about 5 % here; --exact gives the delay equation's."
        )
