"""Size and shape of a bearing's radial force, its lines at shaft speed and roller passage, its impulsiveness."""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.bearing_window import BearingIndicator, BearingWindow
from nw_gear_monitor.indicators.crest_factor import crest_factor
from nw_gear_monitor.indicators.kurtosis import kurtosis
from nw_gear_monitor.indicators.mesh_harmonics import LEAST_CYCLES, line_amplitude
from nw_gear_monitor.indicators.peak_to_peak import peak_to_peak
from nw_gear_monitor.indicators.rms import rms
from nw_gear_monitor.indicators.window import Column
from nw_gear_monitor.signals.kurtogram import spectral_kurtosis

SEGMENTS = (32, 128)
"""Samples in a segment of the spectral kurtosis: 6 and 25 ms at 5120 Hz."""
LEAST_SHAFT_TURNS = 4.0
"""Turns in the window from which the shaft's own line is read: a Hann window then keeps the mean out."""


def impulsive_band(x: Array, rate: float) -> tuple[float, float, float]:
    """Largest spectral kurtosis over all frequencies and SEGMENTS, and the band where it was found.

    The largest of several hundred values: about 0.3 (shorter segments) to 0.6 for stationary noise of 4 s.

    Args:
        x: (samples,) any unit.
        rate: samples per second, Hz.

    Returns:
        Kurtosis; low and high limit of its band (half the window's resolution on either side), Hz.

    Raises:
        InputError: see `spectral_kurtosis`.
    """
    best = (-math.inf, math.nan, math.nan)
    for segment in SEGMENTS:
        frequency, value = spectral_kurtosis(x, rate, segment)
        at = int(np.argmax(value))
        half = rate / segment
        best = max(best, (float(value[at]), max(float(frequency[at]) - half, 0.0), float(frequency[at]) + half))
    return best


def _shape(window: BearingWindow) -> tuple[float, ...]:
    x = window.size
    return float(np.mean(x)), rms(x), peak_to_peak(x), crest_factor(x), kurtosis(x)


def _lines(window: BearingWindow) -> tuple[float, float]:
    if window.phase is None:
        return math.nan, math.nan
    turned = float(window.phase[-1] - window.phase[0]) / (2.0 * np.pi)
    shaft = math.nan
    if turned >= LEAST_SHAFT_TURNS:
        both = [line_amplitude(window.phase, np.ascontiguousarray(c), 1.0) for c in window.components.T]
        shaft = math.hypot(*both)
    order = window.orders.outer if window.orders is not None else math.nan
    passage = line_amplitude(window.phase, window.size, order) if order * turned >= LEAST_CYCLES else math.nan
    return shaft, passage


SHAPE = BearingIndicator(
    (
        Column("mean", "N", "mean radial force; follows the load"),
        Column("rms", "N", "root mean square about the mean"),
        Column("peak_to_peak", "N", "largest less smallest value"),
        Column("crest_factor", "", "largest deviation over rms"),
        Column("kurtosis", "", "fourth moment over squared variance"),
    ),
    _shape,
)
LINES = BearingIndicator(
    (
        Column("shaft_rate", "N", "amplitude at the shaft's speed, both directions together"),
        Column("roller_pass", "N", "amplitude of the force itself where rollers pass the outer race"),
    ),
    _lines,
)
IMPULSES = BearingIndicator(
    (
        Column("spectral_kurtosis", "", "largest spectral kurtosis over frequency; above 0 for bursts"),
        Column("spectral_kurtosis_low", "Hz", "lower limit of the band where it was found"),
        Column("spectral_kurtosis_high", "Hz", "upper limit of that band"),
    ),
    lambda window: impulsive_band(window.size, window.rate),
)
