"""Judges every statement of Sec. 4 on what was computed for one parameter set."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.studies.section4.scoring import STAGES, Motions, motions, regimes
from nw_gear_sim.studies.section4.statements import (
    DOMINANT,
    INTEGRATOR,
    MINUTE,
    MOTION,
    MULTI,
    ONLY,
    REGIMES,
    RING,
    Statement,
    agrees,
    read_statements,
    seen,
)
from nw_gear_sim.studies.section4.waveforms import MULTIPLES

NEAR = 0.02
"""A line is at a multiple of the mesh frequency where it is closer to it than this share of the mesh frequency."""
ALONE = 0.1
"""A line is the only one where no other one has more than this share of its amplitude."""
SAME = 0.1
"""Standard deviations that differ by less than this share are the same."""
CONTRADICTS = "contradicts"


@dataclass(frozen=True, eq=False)
class Evidence:
    """What was computed for one parameter set, as arrays of the pieces.

    Attributes:
        labels: the frequencies of the labels; grid: many along the axis, in blocks; kinematic, rigid, minute: the
            labels' frequencies with stages at their own frequencies, with a rigid ring, after a minute.
        tied_lines, kinematic_lines: spectra; rk4: motions by Runge-Kutta, by omega_e.
    """

    labels: Mapping[str, Array]
    grid: tuple[Mapping[str, Array], ...]
    kinematic: Mapping[str, Array]
    rigid: Mapping[str, Array]
    minute: Mapping[str, Array]
    tied_lines: Mapping[str, Array]
    kinematic_lines: Mapping[str, Array]
    rk4: Mapping[float, Mapping[str, Array]]


@dataclass(frozen=True)
class Verdict:
    """Whether a statement holds: True, False or CONTRADICTS, which comes first; and what was found, in words.

    Attributes:
        agrees: whether what was found agrees with it, contradiction or not.
        kinematic: what was found with every stage at its own mesh frequency, "" where that wasn't computed.
    """

    statement: Statement
    holds: bool | str
    value: str
    agrees: bool
    kinematic: str = ""


def judge(evidence: Evidence) -> tuple[Verdict, ...]:
    """Judge all statements."""
    found = gathered(evidence.labels, *evidence.grid)
    own = motions(evidence.kinematic)
    return tuple(_verdict(statement, evidence, found, own) for statement in read_statements())


def judge_motions(found: Motions) -> dict[str, tuple[bool, str]]:
    """Judge the statements about motions alone: id -> whether what was found agrees, and what it is."""
    chosen = (s for s in read_statements() if s.kind in (MOTION, REGIMES))
    return {s.id: of_regimes(found) if s.kind == REGIMES else of_motion(s, found) for s in chosen}


def gathered(*pieces: Mapping[str, Array]) -> Motions:
    """Return the motions of several pieces."""
    return {place: motion for piece in pieces for place, motion in motions(piece).items()}


def holding(verdicts: tuple[Verdict, ...]) -> int:
    """Return how many statements hold; those that contradict others don't."""
    return sum(verdict.holds is True for verdict in verdicts)


def _verdict(statement: Statement, evidence: Evidence, found: Motions, own: Motions) -> Verdict:
    kinematic = ""
    if statement.kind == MOTION:
        fits, value = of_motion(statement, found)
        kinematic = of_motion(statement, own)[1]
    elif statement.kind == REGIMES:
        fits, value = of_regimes(found)
        kinematic = of_regimes(own)[1]
    elif statement.kind in (DOMINANT, ONLY):
        fits, value = of_line(statement, evidence.tied_lines)
        kinematic = of_line(statement, evidence.kinematic_lines)[1]
    else:
        test = {MINUTE: _of_minute, INTEGRATOR: _of_integrator, RING: _of_ring}[statement.kind]
        fits, value = test(evidence)
    if statement.contradicts:
        return Verdict(statement, CONTRADICTS, f"{value}; not together with {', '.join(statement.contradicts)}", fits,
                       kinematic)  # fmt: skip
    return Verdict(statement, fits, value, fits, kinematic)


def of_motion(statement: Statement, found: Motions) -> tuple[bool, str]:
    """Judge a motion at one frequency, or at all that were computed inside an interval."""
    there = [m for (stage, omega_e), m in found.items() if stage == statement.stage and statement.covers(omega_e)]
    if not there:
        return False, "not computed"
    fits = sum(agrees(statement.expected, motion) for motion in there)
    if len(there) == 1:
        return fits == 1, there[0]
    listed = ", ".join(f"{motion} {count}" for motion, count in Counter(there).most_common())
    return fits == len(there), f"at {fits} of {len(there)} frequencies ({listed})"


def of_regimes(found: Motions) -> tuple[bool, str]:
    """Judge whether periodic, multi-periodic and chaotic motions all occur."""
    counts = regimes(found)
    fits = all(counts[kind] for kind in (names.PERIODS[0], MULTI, names.CHAOTIC))
    words = {MULTI: "multi-period"}
    return fits, ", ".join(f"{words.get(kind, kind)} {count}" for kind, count in counts.items())


def of_line(statement: Statement, spectra: Mapping[str, Array]) -> tuple[bool, str]:
    """Judge where the strongest line of a stage is, or whether it is the only one."""
    k = int(np.argmin(np.abs(spectra["omega_e"] - statement.low)))
    s = STAGES.index(statement.stage)
    dominant, others = float(spectra["dominant"][k, s]), float(spectra["others"][k, s])
    lines = spectra["lines"][k, s]
    wanted = float(statement.expected)
    fits = abs(dominant - wanted) < NEAR
    if statement.kind == ONLY:
        return bool(
            fits and others < ALONE
        ), f"strongest line at {dominant:.3f} f_m, next {100 * others:.0f} % of f_m's"
    if abs(wanted - 1.0) < NEAR:
        return bool(fits), f"strongest line at {dominant:.3f} f_m"
    third, stage_two = (100 * lines[k] / lines[MULTIPLES.index(1.0)] for k in (0, 1))
    shares = f"of f_m's amplitude {third:.1f} % at f_m/3, {stage_two:.1f} % at 40/131 f_m"
    return bool(fits), f"strongest line at {dominant:.3f} f_m; {shares}"


def _of_minute(evidence: Evidence) -> tuple[bool, str]:
    before, after = motions(evidence.labels), motions(evidence.minute)
    same = sum(before[place] == after[place] for place in before)
    return same == len(before), f"{same} of {len(before)} motions are the same"


def _of_integrator(evidence: Evidence) -> tuple[bool, str]:
    """As many dots, or many in both, and about the same standard deviation."""
    same, total, worst = 0, 0, 0.0
    for omega_e, run in evidence.rk4.items():
        k = int(np.argmin(np.abs(evidence.labels["omega_e"] - omega_e)))
        for s in range(len(STAGES)):
            here, there = float(evidence.labels["deviation"][k, s]), float(run["deviation"][s])
            change = abs(there / here - 1.0) if here > 0.0 else float("inf")
            dots = seen(evidence.labels["x"][k, s], here, names.UNKNOWN), seen(run["x"][s], there, names.UNKNOWN)
            same += dots[0] == dots[1] and change < SAME
            total += 1
            worst = max(worst, change)
    return same == total, f"{same} of {total} motions; standard deviations differ by up to {100 * worst:.1f} %"


def _of_ring(evidence: Evidence) -> tuple[bool, str]:
    flexible, rigid = motions(evidence.labels), motions(evidence.rigid)
    changed = sum(flexible[place] != rigid[place] for place in flexible)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = evidence.rigid["deviation"] / evidence.labels["deviation"]
    change = np.nanmax(np.abs(ratio - 1.0), axis=0)
    listed = ", ".join(f"{100 * c:.0f} % in {stage}" for stage, c in zip(STAGES, change, strict=True))
    value = f"a rigid ring changes {changed} of {len(flexible)} motions, standard deviations by up to {listed}"
    return bool(changed > 0 or np.any(change > SAME)), value
