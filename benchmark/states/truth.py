"""The true state of a system, from the noise-free orbit: exact recurrence, largest exponent, rules of exclusion.

Rules, stated before any classifier saw a case:
  period n        P(k + n) = P(k) within 1e-8 of the orbit's size over 128 strobes, n at most 16, exponent below -0.001
  chaotic         exponent above 0.02 nats a strobe and above five standard errors over 4000 strobes, above 0.02 in the
                  window as well, and not yet settled 1000 strobes after it
  quasi-periodic  autonomous: no recurrence up to 64 strobes and exponent within 0.001 of zero; driven at two
                  incommensurate frequencies: exponent below -0.02 and an orbit that depends smoothly on the second
                  drive's phase (Pikovsky and Feudel, Chaos 5 (1995) 253-260): no strange nonchaotic attractors
  excluded        what meets none of these; a splitting (rms distance from the best divisor's orbit) under 2 % of the
                  channel's standard deviation; an aperiodic part (rms after the means of any n up to 16) under 10 % of
                  it; a torus whose strongest line f has abs(q f - p) N < 2 for some q up to 16, in a window of N
                  strobes; a map at rest
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from states.systems import FLOWS, run, seen

WINDOW = 1000
LONGEST = 16
SETTLE = 1000
ROUNDS, ROUND = 6, 400
LOOKED_AT = 64
EXACT = 1e-8
EXPONENT_STROBES = 4000
LEAST_CHAOS = 0.02
LEAST_STABLE = 0.001
LEAST_DRIVEN = 0.02
LEAST_SPLITTING = 0.02
LEAST_APERIODIC = 0.10
LEAST_BEATS = 2.0
MOST_SENSITIVE = 50.0
LARGEST = 1e4
SELF_EXCITED = ("vdp", "coupled", "circle", "delayed")


@dataclass(frozen=True, eq=False)
class Truth:
    """What a system does.

    Attributes:
        label: its state, or empty where it is excluded.
        why: the reason of the exclusion, or empty.
        exponent: largest Lyapunov exponent, nats a strobe.
        state, first: where the window begins.
    """

    label: str
    why: str
    exponent: float
    state: Array
    first: int


def truth(system: str, p: Array, start: Array) -> Truth:  # noqa: PLR0911  one return a rule
    """Find the true state of a system from a start.

    Args:
        system: one of systems.FLOWS or systems.MAPS.
        p: (8,) its parameters; p[5] is not 0 where a second drive acts (flows), `driven` always has one.
        start: (8,) state and tangent.
    """
    s, first = start.copy(), SETTLE
    run(system, p, s, 0, SETTLE, keep=False)
    twice_driven = system == "driven" or (system in FLOWS and p[5] != 0.0)
    if not twice_driven:
        for _ in range(ROUNDS):
            _, growth = run(system, p, s, first, ROUND, keep=False)
            first += ROUND
            if not _bounded(s):
                return Truth("", "diverges", 0.0, s, first)
            period = recurs(system, p, s, first)
            if period:
                return _periodic(system, p, s, first, period, float(np.mean(growth)))
    _, growth = run(system, p, s, first, EXPONENT_STROBES, keep=False)
    first += EXPONENT_STROBES
    if not _bounded(s):
        return Truth("", "diverges", 0.0, s, first)
    blocks = growth.reshape(8, -1).mean(axis=1)
    exponent, error = float(blocks.mean()), float(blocks.std(ddof=1) / np.sqrt(8))
    if exponent > max(LEAST_CHAOS, 5.0 * error):
        return _chaotic(system, p, s, first, exponent)
    if twice_driven and exponent < -LEAST_DRIVEN:
        if _sensitive(system, p, s, first):
            return Truth("", "strange nonchaotic or nearly", exponent, s, first)
        return _torus(system, p, s, first, exponent)
    if system in SELF_EXCITED and not twice_driven and abs(exponent) < LEAST_STABLE:
        return _torus(system, p, s, first, exponent)
    return Truth("", "exponent near zero", exponent, s, first)


def recurs(system: str, p: Array, s: Array, first: int) -> int:
    """Exact recurrence period up to LOOKED_AT from here on; 0 where there is none."""
    wave, _ = run(system, p, s.copy(), first, 2 * LOOKED_AT, keep=True)
    points = wave[:, 0, :2]
    size = float(np.max(np.abs(wave[..., 0]))) + 1e-12
    for n in range(1, LOOKED_AT + 1):
        if float(np.max(np.abs(points[n:] - points[:-n]))) < EXACT * size:
            return n
    return 0


def _bounded(s: Array) -> bool:
    return bool(np.all(np.isfinite(s)) and np.max(np.abs(s[:4])) < LARGEST)


def _channel(system: str, p: Array, s: Array, first: int) -> Array:
    """The clean channel over the window, (cycles, values), in units of its standard deviation."""
    wave, _ = run(system, p, s.copy(), first, WINDOW, keep=True)
    x = seen(system, wave)[..., 0]
    return np.asarray((x - x.mean()) / (x.std() or 1.0))


def aperiodic(rows: Array, n: int) -> float:
    """Rms of what the means of the groups k mod n leave."""
    left = rows.copy()
    for g in range(n):
        left[g::n] -= left[g::n].mean(axis=0)
    return float(np.sqrt(np.mean(left**2)))


def _periodic(system: str, p: Array, s: Array, first: int, period: int, exponent: float) -> Truth:
    if period > LONGEST:
        return Truth("", f"period above {LONGEST}", exponent, s, first)
    if exponent > -LEAST_STABLE:
        return Truth("", "hardly stable", exponent, s, first)
    if system not in FLOWS and period == 1:
        return Truth("", "a map at rest", exponent, s, first)
    rows = _channel(system, p, s, first)
    splitting = min((aperiodic(rows, n) for n in range(1, period) if period % n == 0), default=1.0)
    if splitting < LEAST_SPLITTING:
        return Truth("", "splitting too small", exponent, s, first)
    return Truth(names.PERIODS[period - 1], "", exponent, s, first)


def _chaotic(system: str, p: Array, s: Array, first: int, exponent: float) -> Truth:
    later = s.copy()
    _, growth = run(system, p, later, first, WINDOW, keep=False)
    if float(np.mean(growth)) < LEAST_CHAOS:
        return Truth("", "laminar in the window", exponent, s, first)
    run(system, p, later, first + WINDOW, WINDOW, keep=False)
    if recurs(system, p, later, first + 2 * WINDOW):
        return Truth("", "transient chaos", exponent, s, first)
    if _least_aperiodic(_channel(system, p, s, first)) < LEAST_APERIODIC:
        return Truth("", "aperiodic part too small", exponent, s, first)
    return Truth(names.CHAOTIC, "", exponent, s, first)


def _torus(system: str, p: Array, s: Array, first: int, exponent: float) -> Truth:
    if recurs(system, p, s, first):
        return Truth("", "locked", exponent, s, first)
    rows = _channel(system, p, s, first)
    if _least_aperiodic(rows) < LEAST_APERIODIC:
        return Truth("", "aperiodic part too small", exponent, s, first)
    if _beats(rows[:, 0]) < LEAST_BEATS:
        return Truth("", "nearly locked", exponent, s, first)
    return Truth(names.QUASI_PERIODIC, "", exponent, s, first)


def _least_aperiodic(rows: Array) -> float:
    return min(aperiodic(rows, n) for n in range(1, LONGEST + 1))


def _beats(points: Array) -> float:
    """Turns within the window of the slowest beat between the section's strongest line and a period up to LONGEST."""
    padded = 16 * points.size
    power = np.abs(np.fft.rfft((points - points.mean()) * np.hanning(points.size), padded)) ** 2
    line = float(np.argmax(power)) / padded
    return min(abs(q * line - round(q * line)) for q in range(1, LONGEST + 1)) * points.size


def _sensitive(system: str, p: Array, s: Array, first: int) -> bool:
    """Whether the orbit depends on the second drive's phase by more than MOST_SENSITIVE of its size a radian."""
    shift = 1e-7
    moved = p.copy()
    moved[7] += shift
    one, _ = run(system, p, s.copy(), first, 3000, keep=True)
    two, _ = run(system, moved, s.copy(), first, 3000, keep=True)
    distance = np.max(np.abs(one[..., 0] - two[..., 0])) / shift
    return bool(distance > MOST_SENSITIVE * float(np.std(one[..., 0])))
