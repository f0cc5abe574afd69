"""Inner loops of the accelerometers: sample by sample in a fixed order, so that nothing depends on how blocks are cut.

They needn't be among `compiled.SOURCES`: none calls a kernel of another file, and numba itself notices a change of this
one.
"""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim import compiled
from nw_gear_sim.sensors.path import Path


@compiled.kernel
def shake(path: Path, force: Array, before: Array, state: Array, parts: int, out: Array) -> None:
    """Let forces act on housings and give their accelerations.

    Args:
        path: steps of 1/parts of the interval between forces.
        force: (samples, channels), N.
        before: (channels,) the force before them, N; replaced by the last one.
        state: (channels, 2) displacement (m) and velocity (m/s); changed in place.
        parts: steps from one force to the next, in which it runs linearly.
        out: (samples * parts, channels), m/s^2; set here.
    """
    for channel in range(force.shape[1]):
        step, now, then = path.step[channel], path.now[channel], path.then[channel]
        stiff, viscous, inertance = path.out[channel, 0], path.out[channel, 1], path.inertance[channel]
        x, v, last = state[channel, 0], state[channel, 1], before[channel]
        for n in range(force.shape[0]):
            target = force[n, channel]
            begin = last
            for part in range(1, parts + 1):
                current = target if part == parts else begin + (target - begin) * part / parts
                new_x = step[0, 0] * x + step[0, 1] * v + now[0] * last + then[0] * current
                v = step[1, 0] * x + step[1, 1] * v + now[1] * last + then[1] * current
                x, last = new_x, current
                out[n * parts + part - 1, channel] = stiff * x + viscous * v + inertance * current
        state[channel, 0], state[channel, 1], before[channel] = x, v, last


@compiled.kernel
def limit(values: Array, most: float, clipped: Array) -> None:
    """Hold values (samples, channels) within +-most in place, and count in `clipped` (channels,) how often it acted."""
    for n in range(values.shape[0]):
        for channel in range(values.shape[1]):
            if abs(values[n, channel]) > most:
                values[n, channel] = most if values[n, channel] > 0.0 else -most
                clipped[channel] += 1.0


@compiled.kernel
def thin(values: Array, taps: Array, every: int, out: Array) -> None:
    """Filter and keep every so many samples.

    Args:
        values: (samples, channels), any unit.
        taps: (n,) symmetric weights; every: samples from one window to the next.
        out: (windows, channels), window k begins at sample k * every; set here.
    """
    for window in range(out.shape[0]):
        out[window, :] = 0.0
        for tap in range(taps.size):
            weight = taps[tap]
            for channel in range(values.shape[1]):
                out[window, channel] += weight * values[window * every + tap, channel]


def compile_kernels(path: Path) -> None:
    """Compile all, or load them from numba's cache, so that the first block doesn't wait."""
    channels = len(path.inertance)
    samples = np.zeros((1, channels))
    shake(path, samples, np.zeros(channels), np.zeros((channels, 2)), 1, samples)
    limit(samples, 1.0, np.zeros(channels))
    thin(samples, np.ones(1), 1, np.zeros((1, channels)))
