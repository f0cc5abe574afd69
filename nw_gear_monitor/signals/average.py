"""Time-synchronous average of a shaft, and what is left of it without the lines that belong there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked
from nw_gear_monitor.signals.resample import DEGREE, whole_turns

LEAST_TURNS = 2
SHAFT_HARMONICS = 2
"""Low multiples of the shaft's speed that count as regular: unbalance and misalignment."""
SIDEBANDS = 1
"""Sidebands on either side of a mesh harmonic that count as regular."""


@dataclass(frozen=True, eq=False)
class Average:
    """The mean turn of a shaft.

    Attributes:
        values: (per_turn,) in the unit of the signal, without its mean; value m stands at the angle 2 pi m / per_turn.
        turns: how many were averaged.
    """

    values: Array
    turns: int


@dataclass(frozen=True, eq=False)
class Parts:
    """An average taken apart; each (per_turn,), in the unit of the signal.

    Attributes:
        regular: low shaft harmonics, mesh harmonics and their first sidebands.
        difference: the average without the regular lines (for FM4).
        residual: the average without low shaft harmonics and mesh harmonics, sidebands kept (for NA4).
    """

    regular: Array
    difference: Array
    residual: Array


def synchronous_average(
    phase: Array, x: Array, *, per_turn: int | None = None, degree: int = DEGREE, least: int = LEAST_TURNS
) -> Average:
    """Average a signal over the turns of a shaft.

    a(theta) = (1/N) sum_n x(theta + 2 pi n) with x resampled to equal steps of phase. What repeats every turn stays,
    noise falls as 1/sqrt(N), a line at another order q is multiplied by |sin(pi N q) / (N sin(pi q))|. Source:
    McFadden, "A revised model for the extraction of periodic waveforms by time domain averaging", Mech. Syst. Signal
    Process. 1 (1987) 83-95, from memory. On a shaft with an odd number of teeth it takes out half the mesh
    frequency: period doubling can't be seen in it.

    Args:
        phase: (samples,) unwrapped phase of the shaft, rad (mesh phase over number of teeth).
        x: (samples,) any unit, sampled at equal steps of time.
        per_turn, degree: see `whole_turns`.
        least: smallest number of whole turns.

    Raises:
        InputError: see `whole_turns`.
    """
    turns = whole_turns(phase, x, per_turn=per_turn, degree=degree, least=least)
    mean = turns.values.mean(axis=0)
    return Average(mean - mean.mean(), turns.turns)


def separate(
    average: Array, teeth: int, *, shaft_harmonics: int = SHAFT_HARMONICS, sidebands: int = SIDEBANDS
) -> Parts:
    """Take an average apart by orders, which fall on the bins of its Fourier transform.

    Sources: Stewart (1977, see `fm4`) for the difference, Zakrajsek and others (1993, see `na4`) for the residual; both
    taken from memory. How many shaft harmonics count as regular differs between authors: it is an argument.

    Args:
        average: (per_turn,) one turn of the shaft.
        teeth: of the gear on this shaft.
        shaft_harmonics: orders 1 to this are regular; 0: none.
        sidebands: on either side of a mesh harmonic that are regular.

    Returns:
        regular + difference = average less its mean; every multiple of `teeth` below per_turn / 2 is a mesh harmonic.

    Raises:
        InputError: an average that can't be used, fewer than 2 * (teeth + sidebands) + 1 points a turn, more sidebands
            or shaft harmonics than half the number of teeth.
    """
    teeth = checked.whole("teeth", teeth, 3)
    for place, number in (("shaft_harmonics", shaft_harmonics), ("sidebands", sidebands)):
        if checked.whole(place, number, 0) > teeth // 2:
            raise InputError(place, f"at most half of {teeth} teeth", str(number))
    values = checked.signal("average", average, 2 * (teeth + sidebands) + 1)
    spectrum = np.fft.rfft(values - values.mean())
    order = np.arange(spectrum.size)
    low = order <= shaft_harmonics
    from_mesh = np.abs(order - teeth * np.maximum(np.rint(order / teeth), 1.0))
    known, regular = low | (from_mesh == 0), low | (from_mesh <= sidebands)
    return Parts(
        regular=_signal(spectrum, regular, values.size),
        difference=_signal(spectrum, ~regular, values.size),
        residual=_signal(spectrum, ~known, values.size),
    )


def mesh_amplitudes(average: Array, teeth: int, harmonics: int) -> Array:
    """Amplitudes of the first mesh harmonics in an average, shape (harmonics,), in its unit.

    Raises:
        InputError: an average that can't be used or with fewer than 2 * teeth * harmonics + 1 points.
    """
    teeth, harmonics = checked.whole("teeth", teeth, 1), checked.whole("harmonics", harmonics, 1)
    values = checked.signal("average", average, 2 * teeth * harmonics + 1)
    amplitudes: Array = 2.0 * np.abs(np.fft.rfft(values)[teeth : teeth * harmonics + 1 : teeth]) / values.size
    return amplitudes


def _signal(spectrum: npt.NDArray[np.complex128], keep: npt.NDArray[np.bool_], size: int) -> Array:
    return np.asarray(np.fft.irfft(np.where(keep, spectrum, 0.0), n=size), dtype=np.float64)
