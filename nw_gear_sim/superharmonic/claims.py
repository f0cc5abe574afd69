"""What the paper says about Figs 22-30 in words, statement by statement, and whether the equations bear it out.

`claims.csv` has one row per statement that can be checked. Rules: a statement about a family over the frequency (figure
`..a`) is tested at nu = w0/3; one about a curve over a parameter (`..b`) along 2401 values of zeta in [0, 0.12], or of
g_d or g_v in [-0.4, 0.4]. Everything else is at the base values of Sec. 5.2 (`pair.gear_pair`).
"""

from __future__ import annotations

import csv
import functools
from dataclasses import dataclass
from importlib.resources import files

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_sim.superharmonic.firstorder import MODES, Branches, branches, coefficients, critical_damping, peak
from nw_gear_sim.superharmonic.pair import gear_pair

POINTS = 2401
RANGES = {"zeta": (0.0, 0.12), "g_d": (-0.4, 0.4), "g_v": (-0.4, 0.4)}
CONTRADICTIONS = {"30a.0": ("29a.0.2", "30a.0.2")}
"""Statement -> others that it can't be true together with.

Fig. 29 has no unstable branch at g_d = 0.2, which is the base point; Fig. 30 has one at g_v = 0 and at 0.2, hence at
the base point g_v = 0.1 between them, since mu is linear in g_v.
"""

WORDS = {
    "unstable_branch": "an unstable branch exists at {over} = {values}",
    "no_unstable_branch": "there is no unstable branch at {over} = {values}",
    "peak_falls": "the peak amplitude falls as {over} grows through {values}",
    "peak_rises": "the peak amplitude rises as {over} grows through {values}",
    "single_valued": "the amplitude has one value all along {over} at omega = {omega}",
    "multivalued": "the amplitude has several values somewhere along {over} at omega = {omega}",
    "falls": "the amplitude falls all along {over} at omega = {omega}",
    "rises": "the amplitude rises all along {over} at omega = {omega}",
    "jump": "the amplitude jumps both ways within the range of {over} at omega = {omega}",
}


@dataclass(frozen=True)
class Claim:
    """One statement.

    Attributes:
        id, figure, stage: which it is.
        over: parameter of the family or of the curve.
        kind: key of WORDS.
        omega: excitation frequency of a curve over a parameter, None for a family.
        values: values of the parameter that a statement about a family names.
    """

    id: str
    figure: str
    stage: str
    over: str
    kind: str
    omega: float | None
    values: tuple[float, ...]

    @property
    def text(self) -> str:
        """The statement in words."""
        listed = ", ".join(f"{value:g}" for value in self.values)
        return WORDS[self.kind].format(over=self.over, values=listed, omega=self.omega)


@dataclass(frozen=True)
class Outcome:
    """Whether a statement holds: True, False, or `contradicts` where it also contradicts other statements; and why.

    Attributes:
        claim: the statement; holds: the outcome; value: what was found, in words.
    """

    claim: Claim
    holds: bool | str
    value: str


def read_claims() -> tuple[Claim, ...]:
    """Return all statements of the paper's Sec. 5.2 that can be checked."""
    text = files(__package__).joinpath("claims.csv").read_text(encoding="utf-8")
    return tuple(
        Claim(
            id=row["id"],
            figure=row["figure"],
            stage=row["stage"],
            over=row["over"],
            kind=row["kind"],
            omega=float(row["omega"]) if row["omega"] else None,
            values=tuple(float(value) for value in row["values"].split()),
        )
        for row in csv.DictReader(text.splitlines())
    )


def judge(mode: str = "corrected") -> tuple[Outcome, ...]:
    """Test every statement.

    Raises:
        InputError: unknown mode.
    """
    if mode not in MODES:
        raise InputError("mode", " or ".join(MODES), mode)
    return tuple(_outcome(claim, mode) for claim in read_claims())


def held(outcomes: tuple[Outcome, ...]) -> int:
    """Return how many statements hold; those that contradict others don't."""
    return sum(outcome.holds is True for outcome in outcomes)


def _outcome(claim: Claim, mode: str) -> Outcome:
    holds, value = _of_family(claim, mode) if claim.omega is None else _of_curve(claim, mode)
    if not holds and claim.id in CONTRADICTIONS:
        return Outcome(claim, "contradicts", f"{value}; contradicts {' with '.join(CONTRADICTIONS[claim.id])}")
    return Outcome(claim, holds, value)


def _of_family(claim: Claim, mode: str) -> tuple[bool, str]:
    pair = gear_pair(claim.stage)
    c = coefficients(pair, pair.w0 / 3.0, mode, **{claim.over: np.array(claim.values)})
    if claim.kind.startswith("peak"):
        peaks = peak(c)
        steps = np.diff(peaks)
        holds = bool(np.all(steps < 0.0) if claim.kind == "peak_falls" else np.all(steps > 0.0))
        signs = "" if np.all(c.mu > 0.0) or np.all(c.mu < 0.0) else "; mu changes sign"
        return holds, "peaks " + ", ".join(f"{p:.4g}" for p in peaks) + signs
    mu, limit = float(c.mu[0]), float(np.atleast_1d(critical_damping(c))[0])
    folded = abs(mu) < limit
    return folded == (claim.kind == "unstable_branch"), f"|mu| = {abs(mu):.4g}, mu_c = {limit:.4g}"


@functools.lru_cache(maxsize=64)
def _curve(stage: str, over: str, omega: float, mode: str) -> Branches:
    return branches(gear_pair(stage), over, np.linspace(*RANGES[over], POINTS), omega=omega, mode=mode)


def _of_curve(claim: Claim, mode: str) -> tuple[bool, str]:
    assert claim.omega is not None
    curve = _curve(claim.stage, claim.over, claim.omega, mode)
    several = curve.multivalued
    where = "folds at " + ", ".join(f"{fold:.4g}" for fold in curve.folds) if curve.folds else "no fold"
    if claim.kind == "multivalued":
        return bool(several.any()), where
    if claim.kind == "single_valued":
        return not several.any(), where
    if claim.kind == "jump":
        return bool(several.any() and not several[0] and not several[-1]), where
    if several.any():
        return False, where
    steps = np.diff(curve.alpha[:, 0])
    share = float(np.mean(steps < 0.0))
    holds = bool(np.all(steps < 0.0) if claim.kind == "falls" else np.all(steps > 0.0))
    return holds, f"falls along {100 * share:.1f} % of the range"
