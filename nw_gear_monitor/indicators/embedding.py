"""Points in a phase space: what the chaos indicators work on, from samples or from a strobed section."""

from __future__ import annotations

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked


def embed(x: Array, dimension: int, lag: int = 1) -> Array:
    """Delay vectors (x(i), x(i + lag), .., x(i + (dimension - 1) lag)) of a scalar signal.

    Source: Takens, Lecture Notes in Mathematics 898 (1981) 366-381. A driven system is better strobed: see `strobed`.

    Args:
        x: (samples,) any unit, at equal steps.
        dimension: coordinates of a point, 1 or more.
        lag: samples between coordinates, 1 or more.

    Returns:
        (samples - (dimension - 1) lag, dimension), the unit of x.

    Raises:
        InputError: a value that isn't finite, a constant, fewer samples than two points take, no whole numbers.
    """
    dimension = checked.whole("dimension", dimension, 1)
    span = (dimension - 1) * checked.whole("lag", lag, 1)
    values = checked.signal("x", x, span + 2)
    size = values.size - span
    return np.column_stack([values[k * lag : k * lag + size] for k in range(dimension)])


def strobed(x: Array, v: Array) -> Array:
    """Points (x, v) of a section, each coordinate in units of its own standard deviation, so that they can be compared.

    Args:
        x, v: (strobes,) displacement and velocity, one pair a period, m and m/s or any other unit.

    Raises:
        InputError: different lengths, a value that isn't finite, a constant.
    """
    columns = [checked.signal("x", x), checked.signal("v", v)]
    if columns[0].size != columns[1].size:
        raise InputError("v", f"one value for each of {columns[0].size} x", str(columns[1].size))
    scaled = [column / float(np.max(np.abs(column))) for column in columns]
    return np.column_stack([column / float(np.std(column)) for column in scaled])


def points(place: str, given: Array, least: int) -> Array:
    """Return points as float64 after checking them.

    Args:
        place: name of the argument, for the error.
        given: (points, coordinates), of `embed` or `strobed`.
        least: smallest number of points.

    Raises:
        InputError: another shape, too few points, a value that isn't finite, or the same point again and again.
    """
    array = np.asarray(given)
    if array.ndim != 2 or array.shape[1] < 1:
        raise InputError(place, "an array of shape (points, coordinates)", f"shape {array.shape}")
    if len(array) < least:
        raise InputError(place, f"at least {least} points", str(len(array)))
    columns = [checked.finite(f"{place}, coordinate {k}", column) for k, column in enumerate(array.T)]
    values = np.ascontiguousarray(np.column_stack(columns))
    scale = float(np.max(np.abs(values)))
    if not float(np.max(np.std(values / scale if scale else values, axis=0))) > checked.LEAST_SPREAD:
        raise InputError(place, "points that differ", "the same point again and again")
    return values


def of_order_one(values: Array) -> tuple[Array, int]:
    """Points divided by the power of two next to their spread, and that power: no rounding, equal distances stay equal.

    Args:
        values: (points, coordinates) not all the same.
    """
    first = int(np.frexp(np.max(np.abs(values)))[1])
    scaled = np.ldexp(values, -first)
    second = int(np.frexp(np.max(np.std(scaled, axis=0)))[1])
    return np.ldexp(scaled, -second), first + second


def mean_period(x: Array) -> int:
    """One over the mean frequency of a signal, in samples, rounded up: the least Theiler window of Rosenstein's method.

    The mean frequency is sum f |X(f)|^2 / sum |X(f)|^2 over the spectrum of x - mean x. Source: Rosenstein, Collins and
    De Luca, Physica D 65 (1993) 117-134, section 2. Noise makes it shorter, slow trends longer.

    Raises:
        InputError: fewer than 16 samples, a value that isn't finite, a constant.
    """
    values = checked.signal("x", x, 16)
    length = next_fast_len(2 * values.size - 1, real=True)
    scaled = values / float(np.max(np.abs(values)))
    power = np.abs(rfft(scaled - scaled.mean(), length)) ** 2
    frequency = np.arange(power.size) / length
    return min(int(np.ceil(power.sum() / (frequency @ power))), values.size)


def correlation_lag(x: Array) -> int:
    """First lag at which the autocorrelation of x - mean x is below 1 - 1/e of its value at 0, in samples.

    Source: Rosenstein, Collins and De Luca (1993, see `mean_period`).

    Raises:
        InputError: fewer than 16 samples, a value that isn't finite, a constant, no such lag (a trend).
    """
    values = checked.signal("x", x, 16)
    scaled = values / float(np.max(np.abs(values)))
    spectrum = rfft(scaled - scaled.mean(), next_fast_len(2 * values.size, real=True))
    correlation = irfft(np.abs(spectrum) ** 2)[: values.size]
    below = np.flatnonzero(correlation < (1.0 - 1.0 / np.e) * correlation[0])
    if not below.size:
        raise InputError("x", "a signal whose autocorrelation decays", "one that doesn't")
    return int(below[0])
