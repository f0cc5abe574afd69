"""A measured wind speed, followed from sample to sample."""

from __future__ import annotations

from bisect import bisect_right

from nw_gear_common.tables import Array


class SeriesWind:
    """Linear interpolation in a time series; across a gap that is a straight line between the good rows.

    Args:
        times: shape (n,), s, ascending, the first one 0.
        speeds: shape (n,), m/s.
        loop: begin again at the end, one `interval` after the last row; otherwise the last value holds.
        interval: usual time between rows, s.
    """

    def __init__(self, times: Array, speeds: Array, loop: bool, interval: float) -> None:
        self._times = [float(t) for t in times]
        self._speeds = [float(v) for v in speeds]
        self._period = 0.0
        if loop:
            self._period = self._times[-1] + interval
            self._times.append(self._period)
            self._speeds.append(self._speeds[0])

    def at(self, time: float) -> float:
        """Wind speed (m/s) at a time (s) after the first row."""
        if self._period:
            time %= self._period
        if time <= 0.0:
            return self._speeds[0]
        if time >= self._times[-1]:
            return self._speeds[-1]
        i = bisect_right(self._times, time) - 1
        share = (time - self._times[i]) / (self._times[i + 1] - self._times[i])
        return self._speeds[i] + share * (self._speeds[i + 1] - self._speeds[i])
