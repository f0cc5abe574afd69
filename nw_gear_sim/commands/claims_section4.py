"""Sec. 4 in `nw_gear study claims`: the store it goes on from, and its table."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

WORDS = {True: "holds", False: "fails"}
SHORT = 78
"""Characters of a finding in a table."""


@dataclass(frozen=True)
class Choices:
    """What the options of the command say about Sec. 4: see there."""

    output: Path
    config: str
    draws: int
    around: int
    seed: int
    workers: int | None
    dask: str


def section_4(choices: Choices) -> dict[str, Any]:
    """Go on with the study in its folder to its end, and return what it found.

    Raises:
        InputError: a wrong option, a folder of another study, no such cluster.
    """
    from nw_gear_sim import config as configurations  # noqa: PLC0415 - numba and scipy only where they are needed
    from nw_gear_sim.commands.telling import Teller  # noqa: PLC0415
    from nw_gear_sim.studies.runner import run  # noqa: PLC0415
    from nw_gear_sim.studies.section4 import result, study  # noqa: PLC0415
    from nw_gear_sim.studies.store import Store  # noqa: PLC0415

    question = study.Question(choices.draws, choices.around, choices.seed)
    base = configurations.load(choices.config)
    store = Store(choices.output, study.describe(base, question))

    def compute(pieces: Mapping[str, Any]) -> None:
        missing = {key: piece for key, piece in pieces.items() if key not in store.done()}
        if missing:
            print(f"{len(missing)} of {len(pieces)} parts are missing in {store.folder}", file=sys.stderr, flush=True)
            teller = Teller(len(missing))
            run(missing, study.work, store, workers=choices.workers, dask=choices.dask, say=teller.progress)

    found = result.collect(base, question, store, compute)
    for key in store.damaged:
        print(f"nw_gear: piece {key} was damaged, put aside and computed again", file=sys.stderr)
    return found


def show_section_4(found: Mapping[str, Any]) -> None:
    """Print the statements of Sec. 4, and what the search found."""
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415 - rich only where it is needed

    rows = [
        [
            row["id"],
            WORDS.get(row["holds"], str(row["holds"])),
            f"{row['stage']}: {row['claim']}" if row["stage"] else row["claim"],
            _short(row["value"]),
        ]
        for row in found["rows"]
    ]
    show("Statements of the paper's Sec. 4, on the best even draw", ["id", "outcome", "meaning", "what"], rows)
    search = found["search"]
    print(f"{found['held']} of {found['total']} hold")
    print(f"labels held by the best of {search['draws']} draws: {search['best']['score']:.3f}")
    print(f"by the best of as many at chance: {search['chance']['mean']:.3f}")
    for name, score in search["guesses"].items():
        print(f"by {name}: {score:.3f}")


def _short(text: str) -> str:
    return text if len(text) <= SHORT else text[: SHORT - 3] + "..."
