"""What every analysis of a finished record asks of its input: numbers, enough of them, a phase that grows."""

from __future__ import annotations

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

LEAST_SPREAD = 1e-12
"""A standard deviation below this share of the largest value is rounding: the signal counts as constant."""


def signal(place: str, x: Array, least: int = 2) -> Array:
    """Return x as float64 after checking it.

    Args:
        place: name of the argument, for the error.
        x: (samples,) any unit.
        least: smallest number of samples.

    Raises:
        InputError: not one-dimensional, too short, a value that isn't finite, or a constant.
    """
    values = finite(place, x, least)
    scale = float(np.max(np.abs(values)))
    if not float(np.std(values / scale if scale else values)) > LEAST_SPREAD:
        raise InputError(place, "a signal that varies", f"a constant ({values[0]:.6g})")
    return values


def finite(place: str, x: Array, least: int = 1) -> Array:
    """Return x as float64; raises InputError where it isn't real, one-dimensional, long enough and finite."""
    given = np.asarray(x)
    if given.dtype.kind not in "iuf":
        raise InputError(place, "real numbers", f"values of type {given.dtype}")
    values = given.astype(np.float64)
    if values.ndim != 1:
        raise InputError(place, "an array of one dimension", f"shape {values.shape}")
    if values.size < least:
        raise InputError(place, f"at least {least} samples", str(values.size))
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise InputError(place, "finite numbers", f"{values[bad[0]]} at sample {bad[0]} ({bad.size} such)")
    return values


def phase(place: str, angle: Array, samples: int) -> Array:
    """Return an unwrapped phase as float64 after checking it.

    Args:
        place: name of the argument, for the error.
        angle: (samples,) rad.
        samples: length of the signal it belongs to.

    Raises:
        InputError: another length, a value that isn't finite, or one that isn't larger than the one before.
    """
    values = finite(place, angle, 2)
    if values.size != samples:
        raise InputError(place, f"one value for each of {samples} samples", str(values.size))
    fall = np.flatnonzero(np.diff(values) <= 0.0)
    if fall.size:
        i = int(fall[0])
        raise InputError(
            place,
            "an unwrapped phase that always grows",
            f"{values[i]:.6g}, then {values[i + 1]:.6g} at sample {i + 1}",
        )
    return values


def whole(place: str, number: int, least: int) -> int:
    """Return a whole number; raises InputError below `least` or where it has a fraction."""
    if isinstance(number, bool) or not isinstance(number, (int, np.integer)) or number < least:
        raise InputError(place, f"a whole number, {least} or more", repr(number))
    return int(number)


def positive(place: str, number: float) -> float:
    """Return a number; raises InputError unless it is finite and above zero."""
    if not (np.isfinite(number) and number > 0.0):
        raise InputError(place, "a finite number above zero", repr(number))
    return float(number)


def band(place: str, limits: tuple[float, float], rate: float) -> tuple[float, float]:
    """Return a band (Hz); raises InputError unless 0 <= low < high <= rate / 2."""
    low, high = limits
    if not (np.isfinite(low) and np.isfinite(high) and 0.0 <= low < high <= 0.5 * rate):
        raise InputError(place, f"0 <= low < high <= {0.5 * rate:.6g} Hz", f"{low} to {high}")
    return float(low), float(high)
