"""`nw_gear study superharmonic --sweep`: the delay equation in time, its frequency stepped up and down."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nw_gear_sim.commands.superharmonic_files import write
from nw_gear_sim.commands.tables import show
from nw_gear_sim.drawings.superharmonic_sweep_page import page
from nw_gear_sim.superharmonic import family
from nw_gear_sim.superharmonic.firstorder import TRUSTED, coefficients, trust
from nw_gear_sim.superharmonic.sweeping import MOST_PERIODS, Step, Sweep, sweep

if TYPE_CHECKING:
    from nw_gear_common.tables import Array
    from nw_gear_sim.superharmonic.question import Question

POINTS = 101
"""Frequencies of a sweep where none are given."""


def sweeps(
    question: Question, frequencies: Array | None, *, periods: int | None, files: list[Path], as_json: bool
) -> None:
    """Compute, write and print a sweep up and down.

    Args:
        question: what is asked; frequencies: (n,) ascending, or None for those of the resonance.
        periods: at most at each frequency; files: to write; as_json: whether to print JSON.

    Raises:
        InputError: too few frequencies or periods, or a file that can't be written.
    """
    if frequencies is None:
        usual = family.usual(question.pair, question.mode, question.slope)
        frequencies = np.linspace(usual[0], usual[-1], POINTS)
    found = sweep(
        question.pair,
        frequencies,
        slope=question.slope,
        periods=MOST_PERIODS if periods is None else periods,
        say=_say,
    )
    measure = trust(question.pair, coefficients(question.pair, frequencies, question.mode))
    shown = {**question.as_object(), "trust": float(np.max(measure)) / TRUSTED, **found.as_object()}
    if files:
        shown["files"] = write(
            files, question, "superharmonic sweep", lambda: _page(found, question, frequencies), found.table
        )
    if as_json:
        print(json.dumps(shown))
    else:
        _print(found, question)
        print(
            f"trust of the first order at these frequencies: {shown['trust']:.3g} (above 1: off by more than about 5 %)"
        )


def _page(found: Sweep, question: Question, frequencies: Array) -> str:
    dense = np.linspace(frequencies[0], frequencies[-1], family.POINTS)
    (curve,) = family.curves(question.pair, question.mode, dense, exact=True, slope=question.slope)
    return page(found, curve, question)


def _print(found: Sweep, question: Question) -> None:
    if question.fit is not None:
        print(question.in_words())
    up = {step.omega: step for step in found.steps if step.direction == "up"}
    rows = []
    for step in reversed(found.steps):
        if step.direction == "down":
            both = (up[step.omega], step)
            rows.append([f"{step.omega:.6g}", *(f"{s.alpha:.5g}{_mark(s)}" for s in both)])
    title = f"Stage {question.pair.stage} with the {question.law}, in time"
    show(title, ["omega", "alpha, sweep up", "alpha, sweep down"], rows)
    for jump in found.jumps:
        print(f"jumps {jump.in_words('omega')}")
    if not all(step.settled for step in found.steps):
        print("* doesn't repeat itself within the periods allowed (--periods); (3): repeats after 3 periods")


def _mark(step: Step) -> str:
    return "" if step.settled else f" ({step.repeats})" if step.repeats else " *"


def _say(done: int, total: int) -> None:
    if done % 20 == 0 or done == total:
        print(f"{done} of {total} steps", file=sys.stderr, flush=True)
