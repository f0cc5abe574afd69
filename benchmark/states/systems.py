"""Systems whose states are known by other means than their signals: driven oscillators and maps, with tangents.

Flows (theta = phase of the drive, omega t; second drive at ratio omega, off where its amplitude is 0):
  duffing    x'' + d x' + a x + b x^3 = g cos theta + g2 cos theta2
  pendulum   x'' + q x' + sin x = A cos theta + A2 cos theta2; seen as sin x, with cos x x' as second channel
  gear       x'' + 2 z x' + (1 + k cos theta) g(x) = F + (A omega^2) cos theta + (A2 (ratio omega)^2) cos theta2,
             g the dead zone of half width 1 (Kahraman and Blankenship, J. Appl. Mech. 64 (1997) 217-226)
  vdp        x'' - m (1 - x^2) x' + x = F cos theta
  coupled    two of them, x'' - m (1 - x^2) x' + x + c (x - y) = F cos theta, y'' - m (1 - y^2) y' + s y + c (y - x) = 0
Maps: logistic, sine, cubic, gauss, henon, circle, delayed logistic, logistic with a drive at the golden ratio.
"""

from __future__ import annotations

import numba
import numpy as np

from nw_gear_common.tables import Array

FLOWS = ("duffing", "pendulum", "gear", "vdp", "coupled")
MAPS = ("logistic", "sine", "cubic", "gauss", "henon", "circle", "delayed", "driven")
FIRST_MAP = 10
STEPS = 160
"""Runge-Kutta steps to a period of the drive."""
WAVE = 32
"""Values recorded in a period of the drive, at equal phases."""
TAU = 2.0 * np.pi
GOLDEN = 0.6180339887498949


def kind_of(system: str) -> int:
    """Number of a system in the kernels."""
    return FLOWS.index(system) if system in FLOWS else FIRST_MAP + MAPS.index(system)


def is_map(system: str) -> bool:
    """Whether a system gives one point a period."""
    return system in MAPS


@numba.njit(cache=True, error_model="numpy", inline="always")
def _rates(kind, theta, theta2, s, p, out):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Rates of (x, v, y, w) and of a tangent in s[4:]."""
    x, v, dx, dv = s[0], s[1], s[4], s[5]
    out[0] = v
    out[4] = dv
    drive = p[4] * np.cos(theta) + p[5] * np.cos(theta2)
    if kind == 0:
        out[1] = -p[1] * v - p[2] * x - p[3] * x * x * x + drive
        out[5] = -p[1] * dv - (p[2] + 3.0 * p[3] * x * x) * dx
    elif kind == 1:
        out[1] = -p[1] * v - np.sin(x) + drive
        out[5] = -p[1] * dv - np.cos(x) * dx
    elif kind == 2:
        square = p[0] * p[0]
        stiff = 1.0 + p[2] * np.cos(theta)
        force = square * (p[4] * np.cos(theta) + p[5] * p[6] * p[6] * np.cos(theta2))
        beyond = x - 1.0 if x > 1.0 else (x + 1.0 if x < -1.0 else 0.0)
        out[1] = -2.0 * p[1] * v - stiff * beyond + p[3] + force
        out[5] = -2.0 * p[1] * dv - (stiff * dx if beyond != 0.0 else 0.0)
    else:
        y, w, dy, dw = s[2], s[3], s[6], s[7]
        pull, dpull = (p[2] * (x - y), p[2] * (dx - dy)) if kind == 4 else (0.0, 0.0)
        out[1] = p[1] * (1.0 - x * x) * v - x - pull + drive
        out[5] = p[1] * (1.0 - x * x) * dv - (2.0 * p[1] * x * v + 1.0) * dx - dpull
        if kind == 4:
            out[2] = w
            out[6] = dw
            out[3] = p[1] * (1.0 - y * y) * w - p[3] * y + pull
            out[7] = p[1] * (1.0 - y * y) * dw - (2.0 * p[1] * y * w + p[3]) * dy + dpull


@numba.njit(cache=True, error_model="numpy")
def _flow(kind, p, s, first, cycles, wave, growth):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Integrate over cycles; wave (cycles, WAVE, 3) takes x, v, v' (none kept if empty), growth ln of the tangent."""
    step = TAU / (p[0] * STEPS)
    k1, k2, k3, k4, q = np.zeros(8), np.zeros(8), np.zeros(8), np.zeros(8), np.zeros(8)
    every = STEPS // WAVE
    for cycle in range(cycles):
        for i in range(STEPS):
            a = TAU * i / STEPS
            b = p[6] * TAU * ((first + cycle) + i / STEPS) + p[7]
            h = TAU / STEPS
            _rates(kind, a, b, s, p, k1)
            if wave.shape[0] > 0 and i % every == 0:
                wave[cycle, i // every, 0] = s[0]
                wave[cycle, i // every, 1] = s[1]
                wave[cycle, i // every, 2] = k1[1]
            for j in range(8):
                q[j] = s[j] + 0.5 * step * k1[j]
            _rates(kind, a + 0.5 * h, b + 0.5 * h * p[6], q, p, k2)
            for j in range(8):
                q[j] = s[j] + 0.5 * step * k2[j]
            _rates(kind, a + 0.5 * h, b + 0.5 * h * p[6], q, p, k3)
            for j in range(8):
                q[j] = s[j] + step * k3[j]
            _rates(kind, a + h, b + h * p[6], q, p, k4)
            for j in range(8):
                s[j] += step / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])
        if kind == 1:  # an angle: whole turns change nothing but precision
            s[0] -= TAU * np.round(s[0] / TAU)
        _renormalise(s, cycle, growth)


@numba.njit(cache=True, error_model="numpy")
def _renormalise(s, cycle, growth):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    length = np.sqrt(s[4] ** 2 + s[5] ** 2 + s[6] ** 2 + s[7] ** 2)
    growth[cycle] = np.log(length + 1e-300)
    if length > 1e-250:
        for j in range(4, 8):
            s[j] /= length
    else:  # a superstable point forgets every direction
        s[4], s[5], s[6], s[7] = 1.0, 0.0, 0.0, 0.0


@numba.njit(cache=True, error_model="numpy")
def _map(kind, p, s, first, cycles, wave, growth):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202, C901
    for cycle in range(cycles):
        x, y, dx, dy = s[0], s[1], s[4], s[5]
        if wave.shape[0] > 0:
            wave[cycle, 0, 0] = np.cos(TAU * x) + p[2] * np.sin(2.0 * TAU * x) if kind == 15 else x
            wave[cycle, 0, 1] = y
        if kind == 10:
            s[0], s[4] = p[0] * x * (1.0 - x), p[0] * (1.0 - 2.0 * x) * dx
        elif kind == 11:
            s[0], s[4] = p[0] * np.sin(np.pi * x), p[0] * np.pi * np.cos(np.pi * x) * dx
        elif kind == 12:
            s[0], s[4] = p[0] * x * (1.0 - x * x), p[0] * (1.0 - 3.0 * x * x) * dx
        elif kind == 13:
            bell = np.exp(-p[0] * x * x)
            s[0], s[4] = bell + p[1], -2.0 * p[0] * x * bell * dx
        elif kind == 14:
            s[0], s[4] = 1.0 - p[0] * x * x + y, -2.0 * p[0] * x * dx + dy
            s[1], s[5] = p[1] * x, p[1] * dx
        elif kind == 15:
            s[0], s[4] = x + p[0] - p[1] / TAU * np.sin(TAU * x), (1.0 - p[1] * np.cos(TAU * x)) * dx
            s[0] -= np.floor(s[0])
        elif kind == 16:
            s[0], s[4] = p[0] * x * (1.0 - y), p[0] * ((1.0 - y) * dx - x * dy)
            s[1], s[5] = x, dx
        else:
            turn = TAU * ((first + cycle) * p[6] + p[7] / TAU)
            s[0], s[4] = p[0] * x * (1.0 - x) + p[1] * np.cos(turn), p[0] * (1.0 - 2.0 * x) * dx
        if kind not in (14, 16):  # one coordinate
            s[5] = 0.0
        _renormalise(s, cycle, growth)


def run(system: str, p: Array, s: Array, first: int, cycles: int, *, keep: bool) -> tuple[Array, Array]:
    """Go on by whole cycles of the drive (steps of a map); `s` is moved on.

    Args:
        system: one of FLOWS or MAPS.
        p: (8,) its parameters.
        s: (8,) state and tangent at the beginning, changed in place.
        first: number of the first cycle, for the second drive.
        cycles: how many.
        keep: whether to return the orbit.

    Returns:
        (cycles, values a cycle, 3) x, v and v' (of maps x, y), empty unless kept; (cycles,) tangent's growth, nats.
    """
    width = 1 if is_map(system) else WAVE
    wave = np.zeros((cycles if keep else 0, width, 3))
    growth = np.zeros(cycles)
    (_map if is_map(system) else _flow)(kind_of(system), p, s, first, cycles, wave, growth)
    return wave, growth


def seen(system: str, wave: Array) -> Array:
    """What a sensor would see of an orbit: (cycles, values, 3) channel, its rate of change, and that one's."""
    if system != "pendulum":
        return wave
    x, v, a = wave[..., 0], wave[..., 1], wave[..., 2]
    return np.stack([np.sin(x), np.cos(x) * v, np.cos(x) * a - np.sin(x) * v * v], axis=-1)
