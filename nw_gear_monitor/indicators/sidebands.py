"""Sidebands of the mesh lines at the shaft orders of both gears, and how much of them there is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked
from nw_gear_monitor.signals.resample import DEGREE, whole_turns
from nw_gear_monitor.signals.spectrum import hann

HARMONICS = 3
SIDEBANDS = 6
"""Sidebands on either side of a mesh line."""
LEAST_TURNS = 3
"""Turns of the slower gear in a record: a Hann window then parts its sidebands from the mesh line and each other."""
LEAST_LINE = 1e-9
"""A mesh line weaker than this share of the signal's rms is rounding."""


@dataclass(frozen=True, eq=False)
class Sidebands:
    """Mesh lines and what stands beside them, amplitudes in the unit of the signal.

    Attributes:
        mesh: (harmonics,) amplitude at k mesh orders.
        driver, driven: (harmonics, sidebands, 2) amplitudes at k - s/z (last index 0) and k + s/z (1) mesh orders,
            s = 1..sidebands, z the teeth of that gear.
        driver_alone, driven_alone: (sidebands,) False where the other gear has a sideband within two cycles over the
            record, so that each of the two reads both.
    """

    mesh: Array
    driver: Array
    driven: Array
    driver_alone: npt.NDArray[np.bool_]
    driven_alone: npt.NDArray[np.bool_]


def sidebands(
    mesh_phase: Array,
    x: Array,
    teeth: tuple[int, int],
    *,
    harmonics: int = HARMONICS,
    count: int = SIDEBANDS,
    degree: int = DEGREE,
) -> Sidebands:
    """Measure the lines k f_m and k f_m +- s f_shaft of both gears over mesh phase.

    A(q) = |2 sum_n w_n x_n exp(-i q phi_n)| / sum_n w_n on equal steps of mesh phase phi, w a Hann window over the
    whole tooth pitches of the record. One turn of a gear is z mesh cycles, so f_shaft = f_m / z. Where a sideband of
    one gear and one of the other are closer than two cycles over the record they can't be told apart, and each reads
    both (`driver_alone`, `driven_alone`).

    Args:
        mesh_phase: (samples,) unwrapped phase of the mesh, rad: it grows by 2 pi a tooth.
        x: (samples,) any unit, sampled at equal steps of time.
        teeth: of driver and driven gear.
        harmonics: mesh lines, k = 1..harmonics.
        count: sidebands on either side of each.
        degree: of the spline that resamples.

    Raises:
        InputError: see `whole_turns`; a record shorter than LEAST_TURNS of the gear with more teeth; fewer than 2.5
            samples in a cycle of the highest line; more sidebands than half the teeth of the smaller gear; no mesh
            line.
    """
    harmonics, count = _settings(teeth, harmonics, count)
    turns = whole_turns(mesh_phase, x, degree=degree, least=LEAST_TURNS * max(teeth))
    highest = harmonics + count / min(teeth)
    sampled = x.size * 2.0 * np.pi / float(mesh_phase[-1] - mesh_phase[0])
    if sampled < 2.5 * highest:
        raise InputError("x", f"at least {2.5 * highest:.3g} samples a mesh cycle", f"{sampled:.3g}")
    return sidebands_of_cycles(turns.values, teeth, harmonics=harmonics, count=count)


def sidebands_of_cycles(
    cycles: Array, teeth: tuple[int, int], *, harmonics: int = HARMONICS, count: int = SIDEBANDS
) -> Sidebands:
    """The same from whole mesh cycles that are on equal steps of mesh phase already.

    Args:
        cycles: (cycles, points per cycle) any unit.
        teeth, harmonics, count: see `sidebands`.

    Raises:
        InputError: fewer than LEAST_TURNS turns of the gear with more teeth, fewer than 2.5 points in a cycle of the
            highest line, too many sidebands, no mesh line.
    """
    harmonics, count = _settings(teeth, harmonics, count)
    if len(cycles) < LEAST_TURNS * max(teeth):
        raise InputError("cycles", f"at least {LEAST_TURNS * max(teeth)}", str(len(cycles)))
    highest = harmonics + count / min(teeth)
    if cycles.shape[1] < 2.5 * highest:
        raise InputError("cycles", f"at least {2.5 * highest:.3g} points each", str(cycles.shape[1]))
    s = np.arange(1, count + 1)[:, None] * np.array([-1.0, 1.0])
    multiples = np.arange(1, harmonics + 1)
    orders = [multiples.astype(np.float64), *(multiples[:, None, None] + s / z for z in teeth)]
    deviation = cycles - cycles.mean()
    read = _amplitudes(deviation, np.concatenate([order.ravel() for order in orders]))
    parts = np.split(read, np.cumsum([order.size for order in orders])[:-1])
    mesh, driver, driven = (part.reshape(order.shape) for part, order in zip(parts, orders, strict=True))
    weakest, rms = float(mesh.min()), float(np.std(deviation))
    if weakest <= LEAST_LINE * rms:
        raise InputError("x", f"lines at 1..{harmonics} mesh orders", f"{weakest:.3g} of {rms:.3g} rms at one of them")
    apart = 2.0 / len(cycles)
    return Sidebands(mesh, driver, driven, _alone(teeth, count, apart), _alone(teeth[::-1], count, apart))


def sideband_energy_ratio(amplitudes: Array, mesh: Array) -> Array:
    """Sum of a mesh line's sidebands over the mesh line itself.

    SER_k = sum_s (A_{k,-s} + A_{k,+s}) / A_k, of amplitudes, as is usual in spite of the name: m for a mesh line that
    is amplitude modulated by 1 + m cos. Source: Hanna, Hatch, Kalb, Weiss and Luo, "Detection of wind turbine gear
    tooth defects using sideband energy ratio" (China Wind Power, 2011), six sidebands on either side; from memory.

    Args:
        amplitudes: (harmonics, sidebands, 2) of one gear.
        mesh: (harmonics,) amplitudes of the mesh lines, above zero.

    Returns:
        (harmonics,).

    Raises:
        InputError: shapes that don't fit, values that aren't finite, a mesh line of zero.
    """
    if amplitudes.ndim != 3 or amplitudes.shape[0] != mesh.size or not np.isfinite(amplitudes).all():
        raise InputError(
            "amplitudes", f"finite numbers, shape ({mesh.size}, sidebands, 2)", f"shape {amplitudes.shape}"
        )
    if not (np.isfinite(mesh).all() and (mesh > 0.0).all()):
        raise InputError("mesh", "finite amplitudes above zero", str(mesh))
    ratio: Array = amplitudes.sum(axis=(1, 2)) / mesh
    return ratio


def _settings(teeth: tuple[int, int], harmonics: int, count: int) -> tuple[int, int]:
    harmonics, count = checked.whole("harmonics", harmonics, 1), checked.whole("count", count, 1)
    for number in teeth:
        if checked.whole("teeth", number, 3) < 2 * count:
            raise InputError("count", f"at most half of {number} teeth", str(count))
    return harmonics, count


def _alone(teeth: tuple[int, int], count: int, apart: float) -> npt.NDArray[np.bool_]:
    """Sidebands of the first gear that keep a distance from all of the second.

    Since s is at most half of z, those of the next mesh line are never nearer than those of the same one.
    """
    s = np.arange(1, count + 1)
    distance = np.abs(s[:, None] / teeth[0] - s / teeth[1])
    return np.asarray(distance.min(axis=1) >= apart)


def _amplitudes(deviation: Array, orders: Array) -> Array:
    """Amplitudes at the orders (orders,); `deviation` is (cycles, points in a cycle).

    With phi = 2 pi (c + m / points) the sum over all points is one over cycles, a product of matrices, and then one
    over the points of a cycle.
    """
    window = hann(deviation.size)
    weighted = deviation * window.reshape(deviation.shape)
    cycles, points = (np.arange(size) for size in deviation.shape)
    # whole orders turn once more in each cycle: only their fraction counts there
    over_cycles = np.exp(-2j * np.pi * np.outer(np.mod(orders, 1.0), cycles))
    sums = np.concatenate([over_cycles.real, over_cycles.imag]) @ weighted
    inside = np.exp(-2j * np.pi * np.outer(orders, points / points.size))
    total = np.sum((sums[: orders.size] + 1j * sums[orders.size :]) * inside, axis=1)
    amplitudes: Array = 2.0 * np.abs(total) / float(window.sum())
    return amplitudes
