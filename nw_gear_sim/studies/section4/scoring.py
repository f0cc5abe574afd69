"""How many labels a parameter set holds, and what guesses without any model would."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.studies.bifurcation import label as by_exponent
from nw_gear_sim.studies.section4.statements import MULTI, Label, agrees, seen

STAGES = names.STAGES
READINGS = ("section", "exponent")
"""`section`: a section of few dots counts as periodic even if the exponent is above 0; `exponent`: it doesn't."""
SHUFFLES = 2000
Motions = dict[tuple[str, float], str]
"""(stage, omega_e) -> motion."""


def motions(arrays: Mapping[str, Array], reading: str = "section") -> Motions:
    """Return what was found in a computed piece (`evaluate.label`)."""
    found: Motions = {}
    for k, omega_e in enumerate(arrays["omega_e"]):
        rate, error, diverged = (float(arrays[name][k]) for name in ("rate", "error", "diverged"))
        for s, stage in enumerate(STAGES):
            motion = by_exponent(int(arrays["period"][k, s]), rate, error, diverged)
            if reading == "section":
                motion = seen(arrays["x"][k, s], float(arrays["deviation"][k, s]), motion)
            found[stage, float(omega_e)] = motion
    return found


def held(labels: Sequence[Label], found: Motions) -> list[bool]:
    """Return label by label whether it is what was found."""
    return [agrees(label.expected, found[label.stage, label.omega_e]) for label in labels]


def guesses(labels: Sequence[Label]) -> dict[str, float]:
    """Return the share of labels that guesses hold which know nothing of the gearbox.

    The last two know how often each label occurs, in all and in each stage.
    """
    count = len(labels)

    def share(motion: str, stage: str = "") -> float:
        return sum(agrees(label.expected, motion) for label in labels if stage in ("", label.stage)) / count

    candidates = [*names.PERIODS[:4], names.CHAOTIC]
    constant = {f"always {motion}": share(motion) for motion in candidates}
    return {
        **constant,
        "the best constant guess": max(constant.values()),
        "the best constant guess for each stage": sum(max(share(m, s) for m in candidates) for s in STAGES),
    }


@dataclass(frozen=True)
class Chance:
    """What the best of as many draws would score if its motions had nothing to do with the labels.

    Attributes:
        mean, upper: mean and 95 % quantile of the best score; probability: of the score that was reached, or more.
        shuffles: how many assignments were tried.
    """

    mean: float
    upper: float
    probability: float
    shuffles: int


def chance(labels: Sequence[Label], draws: Sequence[Motions], seed: int = 0) -> Chance:
    """Shuffle the expected labels over the places that were tested, and look how well the best draw does then.

    A permutation test: what the draws found stays as it is, with all that draws and neighbouring frequencies have in
    common, and each shuffle has as many labels of a kind as the paper has.
    """
    kinds = sorted({label.expected for label in labels})
    expected = np.array([kinds.index(label.expected) for label in labels])
    fits = np.array(
        [[[agrees(k, found[label.stage, label.omega_e]) for k in kinds] for label in labels] for found in draws]
    )
    places = np.arange(len(labels))
    reached = fits[:, places, expected].mean(axis=1).max()
    rng = np.random.default_rng(seed)
    best = np.array([fits[:, places, rng.permutation(expected)].mean(axis=1).max() for _ in range(SHUFFLES)])
    exceeding = int(np.sum(best >= reached - 1e-12))
    probability = (1 + exceeding) / (1 + SHUFFLES)
    return Chance(float(best.mean()), float(np.quantile(best, 0.95)), probability, SHUFFLES)


def occurrences(labels: Sequence[Label]) -> dict[str, int]:
    """Return how often each label is expected, the most frequent one first; `multi` is any period from 2 up."""
    return dict(Counter(label.expected for label in labels).most_common())


def regimes(found: Motions) -> dict[str, int]:
    """Return how often motions are periodic, multi-periodic, chaotic, or none of these."""
    counts = {names.PERIODS[0]: 0, MULTI: 0, names.CHAOTIC: 0, "other": 0}
    for motion in found.values():
        kind = MULTI if agrees(MULTI, motion) else motion
        counts[kind if kind in counts else "other"] += 1
    return counts
