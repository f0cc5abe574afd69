"""The study itself: a search over what the paper leaves open, then a closer look at two parameter sets.

All that is computed goes into one store, piece by piece. The search draws parameter sets evenly from their ranges and
labels their motions at the thirteen frequencies of the labels. Around the best draws more are made (these are fitted to
the labels, and said to be). Statements are judged on the best of the even draws, and on the base configuration.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim import config
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.params import Configuration
from nw_gear_sim.studies.section4 import space, waveforms
from nw_gear_sim.studies.section4.evaluate import PLAN, Labelled, label
from nw_gear_sim.studies.section4.scoring import held, motions
from nw_gear_sim.studies.section4.statements import frequencies, read_labels
from nw_gear_sim.studies.store import Store

FIGURES = (0.170, 0.205, 0.245)
"""omega_e of Figs 13, 14, 15."""
GRID = tuple(np.round(np.linspace(0.161, 0.267, 3 * LANES), 5).tolist())
"""Where intervals of Figs 19-21 are looked at closely."""
GRID_PARTS = tuple(f"grid-{k:02d}" for k in range(0, len(GRID), LANES))
"""Names of its blocks."""
MINUTE = 60.0
PARENTS = 4
"""Of how many draws the neighbourhood is searched."""
MOST_DRAWS = 4096
SETS = ("best", "base")
"""Parameter sets that are looked at closely: the best even draw, and the base configuration as it is."""

Run = Callable[[Mapping[str, Any]], None]


@dataclass(frozen=True)
class Question:
    """What is asked for.

    Attributes:
        draws: even ones; around: draws near each of the PARENTS best, 0 for none; seed: of all of them.
    """

    draws: int = 48
    around: int = 4
    seed: int = 0

    def __post_init__(self) -> None:
        for place, value, least, most in (
            ("--draws", self.draws, 1, MOST_DRAWS),
            ("--around", self.around, 0, MOST_DRAWS),
            ("--seed", self.seed, 0, 2**31 - 1),
        ):
            if not least <= value <= most:
                raise InputError(place, f"{least} to {most}", str(value))


@dataclass(frozen=True, eq=False)
class Draw:
    """A parameter set of the search: key of its piece, shares of the ranges, share of the labels that it holds."""

    key: str
    shares: Array
    score: float


def work(piece: Labelled | waveforms.Spectra | waveforms.Integrated) -> dict[str, Array]:
    """Compute a piece of the study."""
    if isinstance(piece, Labelled):
        return label(piece)
    return waveforms.spectra(piece) if isinstance(piece, waveforms.Spectra) else waveforms.integrated(piece)


def describe(base: Configuration, question: Question) -> dict[str, Any]:
    """Return what a store has to know; the number of draws isn't part of it, so that more may be added."""
    return {
        "study": "claims of Sec. 4",
        "configuration": config.to_yaml(base),
        "seed": question.seed,
        "plan": asdict(PLAN),
        "frequencies": list(frequencies(read_labels())),
        "space": [[u.name, u.low, u.high, u.logarithmic] for u in space.SPACE],
    }


def search(base: Configuration, question: Question, store: Store, run: Run) -> tuple[list[Draw], list[Draw]]:
    """Return the even draws, then those around the best of them; compute what is missing.

    Args:
        base: what the draws are laid over; question: how many; store: of the study.
        run: computes the pieces (key -> piece) that the store hasn't, and puts them there.
    """
    points = space.shares(question.draws, question.seed)
    even = {f"draw-{k:06d}": points[k] for k in range(len(points))}
    run(_pieces(base, even))
    found = [Draw(key, shares, score(store, key)) for key, shares in even.items()]
    parents = sorted(found, key=lambda draw: -draw.score)[: PARENTS if question.around else 0]
    near: dict[str, Array] = {}
    for parent in parents:
        number = int(parent.key.split("-")[1])
        children = space.around(parent.shares, question.around, question.seed + 1 + number)
        near |= {f"near-{number:06d}-{k:03d}": child for k, child in enumerate(children)}
    run(_pieces(base, near))
    return found, [Draw(key, shares, score(store, key)) for key, shares in near.items()]


def score(store: Store, key: str, reading: str = "section") -> float:
    """Return the share of the labels that a computed draw holds."""
    return float(np.mean(held(read_labels(), motions(store.get(key), reading))))


def best(draws: Sequence[Draw]) -> Draw:
    """Return the draw with the highest score, the first of them."""
    return max(draws, key=lambda draw: draw.score)


def closely(base: Configuration, draw: Draw) -> dict[str, Any]:
    """Return the pieces that look closely at a draw, and at the motions of the base configuration."""
    names = set_names(draw)
    chosen = space.configured(space.named(draw.shares), base)
    fixed = config.with_values({"operation.drive": "fixed"}, base)
    return {
        **_motions(names["best"], chosen),
        **_beyond_motions(names["best"], chosen),
        **_motions(names["base"], fixed),
    }


def set_names(draw: Draw) -> dict[str, str]:
    """Return the beginning of the keys of each of SETS."""
    return dict(zip(SETS, (f"best-{draw.key}", "base"), strict=True))


def _pieces(base: Configuration, shares: Mapping[str, Array]) -> dict[str, Labelled]:
    places = frequencies(read_labels())
    return {key: Labelled(PLAN, space.configured(space.named(s), base), places) for key, s in shares.items()}


def _motions(name: str, configuration: Configuration) -> dict[str, Any]:
    parts = [GRID[k : k + LANES] for k in range(0, len(GRID), LANES)]
    return {
        f"{name}-labels": Labelled(PLAN, configuration, frequencies(read_labels())),
        **{f"{name}-{p}": Labelled(PLAN, configuration, g) for p, g in zip(GRID_PARTS, parts, strict=True)},
    }


def _beyond_motions(name: str, configuration: Configuration) -> dict[str, Any]:
    places = frequencies(read_labels())
    rigid = config.with_values({"numerics.ring": "rigid"}, configuration)
    return {
        f"{name}-kinematic": Labelled(replace(PLAN, excitation="kinematic"), configuration, places),
        f"{name}-rigid": Labelled(replace(PLAN, ring="rigid"), rigid, places),
        f"{name}-minute": Labelled(PLAN, configuration, places, MINUTE),
        **{f"{name}-lines-{e}": waveforms.Spectra(configuration, e, FIGURES) for e in ("tied", "kinematic")},
        **{f"{name}-rk4-{1e3 * w:.0f}": waveforms.Integrated(configuration, w) for w in FIGURES},
    }
