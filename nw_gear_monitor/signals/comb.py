"""The lines a machine is expected to show: combinations of the mesh frequencies, fractions of them, shaft sidebands.

A line is one whole number per phase: its phase is (a phi_1 + b phi_2 + ..) / 12 with the mesh phases of the stages
(planet 1) first, then the phases of shafts where these are asked for. The twelfths make room for f/2, f/3 and f/4.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array

PARTS = 12
HIGHEST_COMBINATION = 4
"""Largest |k| + |l| + |m| of a line k f_I + l f_II + m f_III."""
HIGHEST_OF_MANY = 3
"""The same with more than three stages, which combine in too many ways."""
OWN_HARMONICS = 24
FREE_HARMONICS = ((200.0, 2), (np.inf, 1))
"""Own harmonics whose amplitude is free in every second, for mesh frequencies below the first number (Hz)."""
MODULATED_COMBINATION = 2
MODULATED_HARMONICS = ((50.0, 8), (np.inf, 4))
"""Own harmonics that may change their amplitude, by mesh frequency; so may lines up to MODULATED_COMBINATION."""
SHAFT_HARMONICS = 4
"""Mesh harmonics beside which sidebands of shafts are looked for."""
LOWEST_FREQUENCY = 5.0
HIGHEST_FREQUENCY = 2500.0
"""Lines below are part of the slow trend, lines above are left out (Hz)."""
DIVISORS = (2, 3, 4)
CANDIDATE_HARMONICS = 4
"""Subharmonic lines p f_s / n are looked for up to this multiple of f_s."""

Twelfths = tuple[int, ...]
Subharmonic = tuple[int, int]
"""Number of the stage (0, 1, ..) and divisor n."""


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


def base(frequency: Array, shafts: Sequence[int] = (), sidebands: int = 0) -> Comb:
    """The comb of a regular machine, with the candidates for period doubling, tripling and quadrupling.

    Args:
        frequency: (stages + shafts,) nominal frequencies of the meshes, then of the shafts, Hz.
        shafts: for each shaft, the number of the stage whose mesh lines it stands beside.
        sidebands: on either side of a mesh line, and harmonics of the shaft itself.
    """
    stages = frequency.size - len(shafts)
    free = tuple(
        _own(stage, PARTS * k, frequency.size)
        for stage in range(stages)
        for k in range(1, _by_frequency(FREE_HARMONICS, frequency[stage]) + 1)
    )
    modulated: list[Twelfths] = []
    steady: list[Twelfths] = []
    highest = _highest(stages)
    for multiple in _combinations(stages, highest):
        line = _scaled(multiple, frequency.size)
        if _positive(line, frequency) and line not in free:
            own = sum(map(abs, multiple)) == max(map(abs, multiple))
            group = modulated if own or sum(map(abs, multiple)) <= MODULATED_COMBINATION else steady
            group.append(line)
    for stage, harmonic in itertools.product(range(stages), range(highest + 1, OWN_HARMONICS + 1)):
        within = harmonic <= _by_frequency(MODULATED_HARMONICS, frequency[stage])
        (modulated if within else steady).append(_own(stage, PARTS * harmonic, frequency.size))
    for number, stage in enumerate(shafts):
        steady += _shaft_lines(stage, stages + number, sidebands, frequency.size)
    candidates = tuple(((stage, n), _fractions(stage, n, frequency.size)) for stage in range(stages) for n in DIVISORS)
    return Comb(free, tuple(sorted(modulated)), tuple(sorted(steady)), candidates)


def refined(comb: Comb, frequency: Array, stages: int, found: Subharmonic) -> Comb:
    """The comb of a machine in which one stage repeats only after n mesh periods: its f_s / n mixes with the others.

    Adds p f_s / n + q f_a + r f_b + .. with ceil(|p| / n) + |q| + |r| + .. up to HIGHEST_COMBINATION, and own multiples
    of f_s / n up to OWN_HARMONICS * n of them; drops the candidates.
    """
    stage, divisor = found
    others = [i for i in range(stages) if i != stage]
    known = {*comb.free, *comb.modulated, *comb.steady}
    added: dict[Twelfths, None] = {}
    highest = _highest(stages)
    for p in range(1, highest * divisor + 1):
        left = highest - -(-p // divisor)
        if p % divisor == 0:
            continue
        for multiple in itertools.chain([(0,) * len(others)], _combinations(len(others), left)):
            line = [0] * frequency.size
            line[stage] = p * PARTS // divisor
            for other, times in zip(others, multiple, strict=True):
                line[other] = times * PARTS
            added[tuple(line) if _positive(line, frequency) else tuple(-part for part in line)] = None
    for p in range(1, OWN_HARMONICS + 1):
        added[_own(stage, p * PARTS // divisor, frequency.size)] = None
    return Comb(comb.free, comb.modulated, (*comb.steady, *sorted(line for line in added if line not in known)), ())


def multiples(lines: tuple[Twelfths, ...], phases: int) -> Array:
    """The lines as an array (lines, phases) of multiples of the phases."""
    return np.array(lines, dtype=np.float64).reshape(-1, phases) / PARTS


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


def describe(line: Twelfths, phases: Sequence[str]) -> str:
    """Name a line, for instance `f_II/2 + f_I` (the largest fraction first).

    Args:
        line: of the comb.
        phases: names of the stages, then of the shafts.
    """
    words = []
    for name, parts in sorted(
        zip(phases, line, strict=True), key=lambda item: Fraction(item[1], PARTS).denominator, reverse=True
    ):
        multiple = Fraction(abs(parts), PARTS)
        if multiple:
            text = ("" if multiple.numerator == 1 else f"{multiple.numerator} ") + f"f_{name}"
            text += "" if multiple.denominator == 1 else f"/{multiple.denominator}"
            words.append(("- " if parts < 0 else "+ ") + text)
    return " ".join(words).removeprefix("+ ")


def _highest(stages: int) -> int:
    return HIGHEST_COMBINATION if stages <= 3 else HIGHEST_OF_MANY


def _by_frequency(choices: tuple[tuple[float, int], ...], frequency: float) -> int:
    return next(number for below, number in choices if frequency < below)


def _combinations(stages: int, highest: int) -> Iterator[tuple[int, ...]]:
    """Every (k, l, ..) with 0 < |k| + |l| + .. <= highest."""
    span = range(-highest, highest + 1)
    for multiple in itertools.product(span, repeat=stages):
        if 0 < sum(map(abs, multiple)) <= highest:
            yield multiple


def _shaft_lines(stage: int, shaft: int, sidebands: int, phases: int) -> list[Twelfths]:
    """Sidebands k f_m +- s f_shaft, and the shaft's own harmonics s f_shaft (k = 0)."""
    lines = []
    for k, s in itertools.product(range(SHAFT_HARMONICS + 1), range(-sidebands, sidebands + 1)):
        if s and (k or s > 0):
            line = [0] * phases
            line[stage], line[shaft] = k * PARTS, s * PARTS
            lines.append(tuple(line))
    return lines


def _positive(line: Sequence[int], frequency: Array) -> bool:
    return bool(np.dot(line, frequency) > 0)


def _scaled(multiple: tuple[int, ...], phases: int) -> Twelfths:
    return tuple(PARTS * k for k in multiple) + (0,) * (phases - len(multiple))


def _own(stage: int, parts: int, phases: int) -> Twelfths:
    return tuple(parts if i == stage else 0 for i in range(phases))


def _fractions(stage: int, divisor: int, phases: int) -> tuple[Twelfths, ...]:
    """Lines p f_s / n; for n = 4 only odd p, since 4 is tried on top of 2."""
    parts = range(1, CANDIDATE_HARMONICS * divisor)
    return tuple(_own(stage, p * PARTS // divisor, phases) for p in parts if p % divisor and (divisor != 4 or p % 2))
