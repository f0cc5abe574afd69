"""How much of a signal's power sits in sharp lines."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.spectrum import hann

LOBE = 2
"""Half width of a line in bins under the Hann window."""
NEIGHBOURHOOD = 65
"""Bins of the running median that stands for the floor."""
PROMINENCE = 25.0
"""A line stands this much above the floor: of 10,000 bins of white noise the largest reaches 13 medians."""


def tonal_share(series: Array) -> tuple[float, float, float]:
    """Share of the variance in lines that stand out of the local floor of the periodogram.

    The spectrum has to be taken where lines are sharp: for a gearbox that is over mesh phase, not over time.

    Args:
        series: (samples,), equally spaced.

    Returns:
        tau = sum of (power - floor) over the bins within LOBE of a line / total power; the strongest line's frequency
        in cycles per sample; and its amplitude in the unit of the series. Zeros for a constant or too short series.
    """
    if series.size < 2 * NEIGHBOURHOOD:
        return 0.0, 0.0, 0.0
    window = hann(series.size)
    spectrum = np.fft.rfft((series - series.mean()) * window)[1:]
    power = np.abs(spectrum) ** 2
    total = float(power.sum())
    if total == 0.0:
        return 0.0, 0.0, 0.0
    floor = median_filter(power, NEIGHBOURHOOD, mode="nearest")
    peaks = np.flatnonzero(power > PROMINENCE * floor)
    if peaks.size == 0:
        return 0.0, 0.0, 0.0
    lobes = np.unique(np.clip(peaks[:, None] + np.arange(-LOBE, LOBE + 1), 0, power.size - 1))
    strongest = int(peaks[np.argmax(power[peaks])])
    share = float(np.sum(np.maximum(power[lobes] - floor[lobes], 0.0)) / total)
    return share, _peak(power, strongest) / series.size, 2.0 * float(np.sqrt(power[strongest])) / float(window.sum())


def _peak(power: Array, at: int) -> float:
    """Bin number of a line (1 = first bin after the mean), refined by its larger neighbour (Hann window)."""
    if not 0 < at < power.size - 1:
        return at + 1.0
    left, middle, right = np.sqrt(power[at - 1 : at + 2])
    side = right if right > left else left
    shift = (2.0 * side - middle) / (side + middle)
    return float(at + 1.0 + (shift if right > left else -shift))
