"""Lines of a damaged bearing in the envelope of its force, every second."""

from __future__ import annotations

import math

import numpy as np

from nw_gear_monitor.indicators.bearing_lines import NEIGHBOURS, SLIP, bearing_lines
from nw_gear_monitor.indicators.bearing_orders import BearingOrders
from nw_gear_monitor.indicators.bearing_window import BearingIndicator, BearingWindow
from nw_gear_monitor.indicators.window import Column
from nw_gear_monitor.signals.band_envelope import edge, low_order_spectrum

WANTED_CAGE_TURNS = 8
LEAST_CAGE_TURNS = 4
"""Turns of the cage in the window: wanted, and needed. Lines of the bearing and of its shaft come apart with them."""
SHARE_OF_RATE = 0.45
"""The band of the envelope ends below this share of the sample rate."""
NARROWEST = 0.25
"""A band cut to less than this share of its wanted width is given up."""
PARTS = (("bpfo", "outer"), ("bpfi", "inner"), ("bsf", "roller"), ("ftf", "cage"))
"""Name of a column and part of the bearing (see `BearingOrders`)."""


def wanted_seconds(frequency: float, cage: float, least: int, most: int) -> int | None:
    """Length of the window of the envelope in whole seconds.

    Args:
        frequency: turns of the shaft per second, Hz.
        cage: turns of the cage per turn of the shaft.
        least, most: seconds that the window has at least, and that are kept.

    Returns:
        Enough for WANTED_CAGE_TURNS within the limits; None where even `most` don't hold LEAST_CAGE_TURNS.
    """
    turn = 1.0 / (frequency * cage)
    if LEAST_CAGE_TURNS * turn > most:
        return None
    return min(max(math.ceil(WANTED_CAGE_TURNS * turn), least), most)


def usable_band(band: tuple[float, float], rate: float) -> tuple[float, float] | None:
    """The band (Hz) as far as a sample rate (Hz) carries it; None where too little is left."""
    low, high = band[0], min(band[1], SHARE_OF_RATE * rate)
    return (low, high) if high - low >= NARROWEST * (band[1] - band[0]) else None


def _highest(orders: BearingOrders, turns: float) -> float:
    """Highest order of the spectrum that its lines and the floor around them need."""
    return max(orders.lines().values()) * (1.0 + SLIP) + (NEIGHBOURS + 4.0) / turns


def _compute(window: BearingWindow) -> tuple[float, ...]:
    nothing = (math.nan,) * len(INDICATOR.columns)
    orders, band, phase, size = window.orders, window.band, window.long_phase, window.long_size
    if orders is None or band is None or phase is None or size is None:
        return nothing
    turned = float(phase[-1] - phase[0]) / (2.0 * np.pi) * (1.0 - 2.0 * edge(band) * window.rate / size.size)
    spectrum = low_order_spectrum(size, window.rate, phase, band, _highest(orders, max(math.floor(turned) - 1, 1)))
    found = {line.part: line for line in bearing_lines(spectrum, orders, harmonics=1)}
    values: list[float] = []
    for _, part in PARTS:
        line = found.get(part)
        values += [math.nan, math.nan] if line is None else [line.amplitude, line.prominence]
    return tuple(values)


def _pair(name: str, text: str) -> tuple[Column, Column]:
    return (
        Column(name, "N", f"envelope line {text}"),
        Column(f"{name}_prominence", "", "that line over the median of the envelope spectrum around it"),
    )


INDICATOR = BearingIndicator(
    (
        *_pair("bpfo", "of the outer race: rollers passing a spot of it"),
        *_pair("bpfi", "of the inner race"),
        *_pair("bsf", "of a roller, two knocks a turn; not known from roller counts alone"),
        *_pair("ftf", "of the cage"),
    ),
    _compute,
)
