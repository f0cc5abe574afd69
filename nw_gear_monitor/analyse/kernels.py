"""Compiles what `analyse` needs, once, after an installation."""

from __future__ import annotations

import numpy as np

from nw_gear_monitor.analyse.measure import measure
from nw_gear_monitor.analyse.options import Options
from nw_gear_monitor.analyse.select import Signal

SAMPLES = 2000


def compile_kernels() -> None:
    """Measure a chaotic map, and a driven signal with its derivative, both short."""
    x, v, x_now, v_now = np.empty(SAMPLES), np.empty(SAMPLES), 0.1, 0.1
    for k in range(SAMPLES):
        x_now, v_now = 1.0 - 1.4 * x_now * x_now + v_now, 0.3 * x_now
        x[k], v[k] = x_now, v_now
    measure(Signal("x", x, None, None, None), Options(map=True))
    measure(Signal("x", x, v, None, None), Options(map=True))
    phase = np.asarray(0.2 * np.pi * np.arange(SAMPLES), dtype=np.float64)
    measure(Signal("x", np.cos(phase) + 0.5 * np.interp(phase, phase[::10], x[:200]), None, 10.0, phase), Options())
