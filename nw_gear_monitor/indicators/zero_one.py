"""The 0-1 test for chaos (Gottwald and Melbourne, SIAM J. Appl. Dyn. Syst. 8 (2009) 129-145)."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked

FREQUENCIES = 100
LEAST = 100
GOLDEN = 0.6180339887498949


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _growth(series: Array, frequencies: Array, lags: int) -> Array:
    size = series.size
    mean = series.mean()
    pairs = size - lags
    correlations = np.empty(frequencies.size)
    p = np.empty(size)
    q = np.empty(size)
    for index in range(frequencies.size):
        c = frequencies[index]
        sum_p, sum_q = 0.0, 0.0
        step_re, step_im = np.cos(c), np.sin(c)
        re, im = 1.0, 0.0
        for j in range(size):
            re, im = re * step_re - im * step_im, re * step_im + im * step_re  # cos and sin of (j + 1) c
            sum_p += series[j] * re
            sum_q += series[j] * im
            p[j] = sum_p
            q[j] = sum_q
        scale = mean * mean / (1.0 - np.cos(c))
        sum_d, sum_dd, sum_nd = 0.0, 0.0, 0.0
        for lag in range(1, lags + 1):
            total = 0.0
            for j in range(pairs):
                dp = p[j + lag] - p[j]
                dq = q[j + lag] - q[j]
                total += dp * dp + dq * dq
            d = total / pairs - scale * (1.0 - np.cos(lag * c))
            sum_d += d
            sum_dd += d * d
            sum_nd += lag * d
        middle = (lags + 1) / 2.0
        spread_n = (lags * lags - 1.0) / 12.0
        spread_d = sum_dd / lags - (sum_d / lags) ** 2
        product = np.sqrt(spread_n * spread_d)
        correlations[index] = (sum_nd / lags - middle * sum_d / lags) / product if product > 0.0 else 0.0
    return correlations


def _correlations(series: Array) -> Array:
    """K_c for each of the frequencies c."""
    fractions = np.mod(GOLDEN * np.arange(1, FREQUENCIES + 1), 1.0)
    frequencies = np.pi / 5.0 + 3.0 * np.pi / 5.0 * fractions
    scaled = np.ascontiguousarray(series / np.std(series))
    found: Array = _growth(scaled, frequencies, series.size // 10)
    return found


def zero_one(series: Array) -> float:
    """Asymptotic growth rate K of the 0-1 test: near 0 for regular, near 1 for chaotic motion (and for noise).

    For each c the walks p(n) = sum phi(j) cos(j c), q(n) = sum phi(j) sin(j c) are formed; D_c(n) is their mean square
    displacement over n steps less its oscillating part (E phi)^2 (1 - cos n c) / (1 - cos c); K_c is the correlation of
    D_c(n) with n for n up to a tenth of the series; K is the median over c. The paper draws c at random from
    (pi/5, 4 pi/5); here 100 values are spread over it by the golden ratio, so that the result is repeatable.

    Args:
        series: (samples,), one value per period of the motion; oversampled series read as regular. 1000 values are
            wanted, fewer blur K.

    Returns:
        K in [-1, 1]; NaN for fewer than 100 values or a constant series.
    """
    if series.size < LEAST or float(np.std(series)) == 0.0:
        return float("nan")
    return float(np.median(_correlations(series)))


@dataclass(frozen=True)
class ZeroOne:
    """Outcome of the 0-1 test.

    Attributes:
        k: median of K_c over the frequencies c.
        lower, upper: quartiles of K_c; far apart where the series is too short or some c meets a line of the spectrum.
    """

    k: float
    lower: float
    upper: float


def zero_one_test(series: Array) -> ZeroOne:
    """The 0-1 test of a finished record, with a measure of its spread and no number for what can't be tested.

    As `zero_one`, but the mean is taken out first: the oscillating part is then zero, and a mean far above the standard
    deviation doesn't drown the walks in its products with the series (noise of 1e-6 about 1 reads K = 0.3 otherwise).

    Args:
        series: (samples,) one value per period of the motion, any unit. 1000 are wanted: see `zero_one`. A periodic
            motion with a little noise reads as chaotic, so decide first that it isn't periodic.

    Raises:
        InputError: fewer than 100 values, one that isn't finite, a constant.
    """
    values = checked.signal("series", series, LEAST)
    scaled = values / float(np.max(np.abs(values)))
    lower, middle, upper = np.percentile(_correlations(scaled - scaled.mean()), [25.0, 50.0, 75.0])
    return ZeroOne(k=float(middle), lower=float(lower), upper=float(upper))
