"""`nw_gear study superharmonic --basin`: which start ends in which motion."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from nw_gear_common.errors import InputError
from nw_gear_sim.commands import axes
from nw_gear_sim.commands.superharmonic_files import write
from nw_gear_sim.commands.tables import show
from nw_gear_sim.drawings.superharmonic_basin_page import page
from nw_gear_sim.superharmonic import family
from nw_gear_sim.superharmonic.basins import HISTORIES, MOST_PERIODS, Basins
from nw_gear_sim.superharmonic.basins import basins as compute
from nw_gear_sim.superharmonic.exact import orbits_at

if TYPE_CHECKING:
    from nw_gear_common.tables import Array
    from nw_gear_sim.superharmonic.question import Question

BEYOND = 0.02
"""Part of a frequency by which the branch is followed beyond it at least."""


def basins(
    question: Question,
    texts: list[str],
    frequencies: Array | None,
    *,
    history: str,
    periods: int | None,
    workers: int | None,
    files: list[Path],
    as_json: bool,
) -> None:
    """Compute, write and print a map of basins.

    Args:
        question: what is asked; texts: the axes x and v as the user wrote them; frequencies: the one of the map.
        history: of `basins.HISTORIES`; periods: at most; workers: threads.
        files: to write; as_json: whether to print JSON.

    Raises:
        InputError: other axes, not one frequency, or a file that can't be written.
    """
    named = dict(axes.axis("--basin", text) for text in texts)
    if {*named} != {"x", "v"} or len(texts) != 2:
        raise InputError("--basin", "x=START:STOP:COUNT and v=START:STOP:COUNT", " and ".join(texts))
    if frequencies is None or len(frequencies) != 1:
        raise InputError(
            "--omega", "one frequency with --basin", "none" if frequencies is None else str(len(frequencies))
        )
    if history not in HISTORIES:
        raise InputError("--history", " or ".join(HISTORIES), history)
    omega = float(frequencies[0])
    usual = family.usual(question.pair, question.mode, question.slope)
    low, high = min(usual[0], omega * (1.0 - BEYOND)), max(usual[-1], omega * (1.0 + BEYOND))
    found = compute(
        question.pair,
        omega,
        named["x"],
        named["v"],
        orbits_at(question.pair, omega, float(low), float(high), question.slope),
        slope=question.slope,
        history=history,
        periods=MOST_PERIODS if periods is None else periods,
        workers=workers,
        say=_say,
    )
    shown = {**question.as_object(), **found.as_object()}
    if files:
        shown["files"] = write(files, question, "superharmonic basins", lambda: page(found, question), found.table)
    if as_json:
        print(json.dumps(shown))
    else:
        _print(found, question)


def _print(found: Basins, question: Question) -> None:
    if question.fit is not None:
        print(question.in_words())
    rows = [
        [f"{orbit.amplitude(3):.5g}", "stable" if stable else "unstable", f"{100.0 * share:.2f} %"]
        for (orbit, stable), share in zip(found.orbits, found.shares, strict=True)
    ]
    rows.append(["elsewhere", "", f"{100.0 * found.elsewhere:.2f} %"])
    title = f"Stage {question.pair.stage} with the {question.law} at omega = {found.omega:g}: {found.ends.size} starts"
    show(title, ["alpha of the orbit", "", "starts that end there"], rows)
    print(
        f"{found.periods.mean():.0f} periods until it is clear, on average; history before the start: {found.history}"
    )


def _say(done: int, total: int) -> None:
    if done % 1280 == 0 or done == total:
        print(f"{done} of {total} starts", file=sys.stderr, flush=True)
