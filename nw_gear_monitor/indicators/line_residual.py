"""The residual of the line fit in the phase domain, strobed at a stage's own mesh period: input of tau and K."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.hermite import crossings, interpolate
from nw_gear_monitor.signals.linefit import LineFit
from nw_gear_monitor.signals.normal import relative_time


def line_residual(
    done: LineFit,
    starts: Array,
    time: Array,
    phase: Array,
    own: Array,
    x: Array,
    v: Array,
    channel: int,
    per_cycle: int,
) -> Array:
    """What the fitted lines and the slow trend leave of one mesh, at equal steps of mesh phase.

    Args:
        done: the fit of this window.
        starts: (seconds,) beginnings of its seconds, s.
        time: (samples,) s; phase: (samples, phases) rad of what the lines follow; x, v: (samples,) m, m/s of the mesh.
        own: (samples,) mesh phase to strobe on, rad.
        channel: number of the mesh.
        per_cycle: points per cycle of `own`.

    Returns:
        (points,) m.
    """
    step = 2.0 * np.pi / per_cycle
    targets = np.arange(np.ceil(own[0] / step), np.floor(own[-1] / step) + 1.0) * step
    position = crossings(own, targets)
    position = position[(position >= 0) & (position <= own.size - 1)]
    value, _ = interpolate(position, x[:, None], v[:, None], (time[-1] - time[0]) / (time.size - 1))
    samples = np.arange(time.size)
    moments = np.interp(position, samples, time)
    phases = np.column_stack([np.interp(position, samples, phase[:, stage]) for stage in range(phase.shape[1])])
    which = np.clip(np.searchsorted(starts, moments, side="right") - 1, 0, starts.size - 1)
    pieces = []
    for second, start in enumerate(starts):
        rows = which == second
        tau = relative_time(moments[rows], start)
        pieces.append(value[rows, 0] - done.predict(second, phases[rows], tau, channel))
    return np.concatenate(pieces)


def strobes(rest: Array, per_cycle: int) -> Array:
    """One point per mesh cycle of a residual, at the phase where it varies most.

    Args:
        rest: (points,) residual at equal steps of mesh phase, m.
        per_cycle: points per cycle.

    Returns:
        (cycles,) m.
    """
    cycles = rest[: rest.size // per_cycle * per_cycle].reshape(-1, per_cycle)
    strobed: Array = cycles[:, int(np.argmax(cycles.var(axis=0)))]
    return strobed
