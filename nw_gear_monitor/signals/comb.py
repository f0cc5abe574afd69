"""The lines a gearbox is expected to show: combinations of the three mesh frequencies, and fractions of them.

A line is three whole numbers: its phase is (a phi_I + b phi_II + c phi_III) / 12 with the mesh phases of planet 1. The
twelfths make room for f/2, f/3 and f/4.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from nw_gear_common import names
from nw_gear_common.tables import Array

PARTS = 12
HIGHEST_COMBINATION = 4
"""Largest |k| + |l| + |m| of a line k f_I + l f_II + m f_III."""
OWN_HARMONICS = 24
FREE_HARMONICS = (2, 2, 1)
"""Own harmonics of I, II, III up to these have an amplitude that is free in every second."""
MODULATED_COMBINATION = 2
MODULATED_HARMONICS = (8, 4, 4)
"""Lines up to this combination order, and own harmonics of I, II, III up to these, may change their amplitude."""
LOWEST_FREQUENCY = 5.0
HIGHEST_FREQUENCY = 2500.0
"""Lines below are part of the slow trend, lines above are left out (Hz)."""
DIVISORS = (2, 3, 4)
CANDIDATE_HARMONICS = 4
"""Subharmonic lines p f_s / n are looked for up to this multiple of f_s."""

Twelfths = tuple[int, int, int]
Subharmonic = tuple[int, int]
"""Number of the stage (0, 1, 2) and divisor n."""


@dataclass(frozen=True)
class Comb:
    """A list of lines in groups.

    Attributes:
        free: the strongest lines; their amplitude is free in every second and not among the columns of the fit.
        modulated: lines whose amplitude may follow speed and load.
        steady: the other expected lines.
        candidates: (stage, divisor) -> lines p f_s / n with p / n not whole in lower terms.
    """

    free: tuple[Twelfths, ...]
    modulated: tuple[Twelfths, ...]
    steady: tuple[Twelfths, ...]
    candidates: tuple[tuple[Subharmonic, tuple[Twelfths, ...]], ...]

    @property
    def lines(self) -> tuple[Twelfths, ...]:
        """Every line of the fit once, modulated first, then steady, then candidates."""
        return (*self.modulated, *self.steady, *self.candidate_lines)

    @property
    def candidate_lines(self) -> tuple[Twelfths, ...]:
        """The lines of all candidates, each once."""
        return tuple(dict.fromkeys(line for _, lines in self.candidates for line in lines))


def base(ratios: Array) -> Comb:
    """The comb of a regular gearbox, with the candidates for period doubling, tripling and quadrupling.

    Args:
        ratios: (3,) mesh frequencies of the stages over that of stage I.
    """
    free = tuple(_own(stage, PARTS * k) for stage in range(3) for k in range(1, FREE_HARMONICS[stage] + 1))
    modulated: list[Twelfths] = []
    steady: list[Twelfths] = []
    span = range(-HIGHEST_COMBINATION, HIGHEST_COMBINATION + 1)
    for k, l, m in itertools.product(span, span, span):  # noqa: E741  (the usual letters of the three multiples)
        size = abs(k) + abs(l) + abs(m)
        line = _scaled((k, l, m))
        if 0 < size <= HIGHEST_COMBINATION and _positive(line, ratios) and line not in free:
            own = size == max(abs(k), abs(l), abs(m))
            group = modulated if own or size <= MODULATED_COMBINATION else steady
            group.append(line)
    for stage, harmonic in itertools.product(range(3), range(HIGHEST_COMBINATION + 1, OWN_HARMONICS + 1)):
        group = modulated if harmonic <= MODULATED_HARMONICS[stage] else steady
        group.append(_own(stage, PARTS * harmonic))
    candidates = tuple(((stage, n), _fractions(stage, n)) for stage in range(3) for n in DIVISORS)
    return Comb(free, tuple(sorted(modulated)), tuple(sorted(steady)), candidates)


def refined(comb: Comb, ratios: Array, found: Subharmonic) -> Comb:
    """The comb of a gearbox in which one stage repeats only after n mesh periods: its f_s / n mixes with the others.

    Adds p f_s / n + q f_a + r f_b with ceil(|p| / n) + |q| + |r| up to HIGHEST_COMBINATION, and own multiples of
    f_s / n up to OWN_HARMONICS * n of them; drops the candidates.
    """
    stage, divisor = found
    others = [i for i in range(3) if i != stage]
    known = {*comb.free, *comb.modulated, *comb.steady}
    added: dict[Twelfths, None] = {}
    span = range(-HIGHEST_COMBINATION, HIGHEST_COMBINATION + 1)
    reach = HIGHEST_COMBINATION * divisor
    for p, q, r in itertools.product(range(1, reach + 1), span, span):
        if p % divisor == 0 or -(-p // divisor) + abs(q) + abs(r) > HIGHEST_COMBINATION:
            continue
        line = [0, 0, 0]
        line[stage], line[others[0]], line[others[1]] = p * PARTS // divisor, q * PARTS, r * PARTS
        added[_scaled_positive((line[0], line[1], line[2]), ratios)] = None
    for p in range(1, OWN_HARMONICS + 1):
        added[_own(stage, p * PARTS // divisor)] = None
    return Comb(comb.free, comb.modulated, (*comb.steady, *sorted(line for line in added if line not in known)), ())


def multiples(lines: tuple[Twelfths, ...]) -> Array:
    """The lines as an array (lines, 3) of multiples of the mesh frequencies."""
    return np.array(lines, dtype=np.float64).reshape(-1, 3) / PARTS


def spaced(frequency: Array, apart: float, highest: float, taken: Array | None = None) -> npt.NDArray[np.bool_]:
    """Choose lines that a window can tell apart.

    Args:
        frequency: (lines,) Hz, the important ones first.
        apart: smallest distance, Hz (one over the length of the window).
        highest: lines at or above are left out, Hz.
        taken: frequencies that are there already, Hz.

    Returns:
        (lines,) bool: a line is kept if it lies between LOWEST_FREQUENCY and `highest` and no kept line is closer.
    """
    keep = np.zeros(frequency.size, dtype=bool)
    before = 0 if taken is None else len(taken)
    there = np.empty(before + frequency.size)
    there[:before] = [] if taken is None else taken
    count = before
    for i, f in enumerate(frequency):
        keep[i] = LOWEST_FREQUENCY < f < highest and not np.any(np.abs(there[:count] - f) < apart)
        if keep[i]:
            there[count] = f
            count += 1
    return keep


def describe(line: Twelfths) -> str:
    """Name a line, for instance `f_II/2 + f_I` (the largest fraction first)."""
    words = []
    for stage, parts in sorted(
        zip(names.STAGES, line, strict=True), key=lambda item: Fraction(item[1], PARTS).denominator, reverse=True
    ):
        multiple = Fraction(abs(parts), PARTS)
        if multiple:
            text = ("" if multiple.numerator == 1 else f"{multiple.numerator} ") + f"f_{stage}"
            text += "" if multiple.denominator == 1 else f"/{multiple.denominator}"
            words.append(("- " if parts < 0 else "+ ") + text)
    return " ".join(words).removeprefix("+ ")


def _positive(multiple: Twelfths, ratios: Array) -> bool:
    return bool(np.dot(multiple, ratios) > 0)


def _scaled(multiple: Twelfths) -> Twelfths:
    return multiple[0] * PARTS, multiple[1] * PARTS, multiple[2] * PARTS


def _scaled_positive(line: Twelfths, ratios: Array) -> Twelfths:
    return line if _positive(line, ratios) else (-line[0], -line[1], -line[2])


def _own(stage: int, parts: int) -> Twelfths:
    line = [0, 0, 0]
    line[stage] = parts
    return line[0], line[1], line[2]


def _fractions(stage: int, divisor: int) -> tuple[Twelfths, ...]:
    """Lines p f_s / n; for n = 4 only odd p, since 4 is tried on top of 2."""
    parts = range(1, CANDIDATE_HARMONICS * divisor)
    return tuple(_own(stage, p * PARTS // divisor) for p in parts if p % divisor and (divisor != 4 or p % 2))
