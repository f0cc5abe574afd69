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
    harmonics, count = checked.whole("harmonics", harmonics, 1), checked.whole("count", count, 1)
    for number in teeth:
        if checked.whole("teeth", number, 3) < 2 * count:
            raise InputError("count", f"at most half of {number} teeth", str(count))
    turns = whole_turns(mesh_phase, x, degree=degree, least=LEAST_TURNS * max(teeth))
    highest = harmonics + count / min(teeth)
    sampled = x.size * 2.0 * np.pi / float(mesh_phase[-1] - mesh_phase[0])
    if sampled < 2.5 * highest:
        raise InputError("x", f"at least {2.5 * highest:.3g} samples a mesh cycle", f"{sampled:.3g}")
    s = np.arange(1, count + 1)[:, None] * np.array([-1.0, 1.0])
    multiples = np.arange(1, harmonics + 1)
    orders = [multiples.astype(np.float64), *(multiples[:, None, None] + s / z for z in teeth)]
    deviation = turns.values - turns.values.mean()
    mesh, driver, driven = (_amplitudes(deviation, order) for order in orders)
    weakest, rms = float(mesh.min()), float(np.std(deviation))
    if weakest <= LEAST_LINE * rms:
        raise InputError("x", f"lines at 1..{harmonics} mesh orders", f"{weakest:.3g} of {rms:.3g} rms at one of them")
    apart = 2.0 / turns.turns
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


def _alone(teeth: tuple[int, int], count: int, apart: float) -> npt.NDArray[np.bool_]:
    """Sidebands of the first gear that keep a distance from all of the second.

    Since s is at most half of z, those of the next mesh line are never nearer than those of the same one.
    """
    s = np.arange(1, count + 1)
    distance = np.abs(s[:, None] / teeth[0] - s / teeth[1])
    return np.asarray(distance.min(axis=1) >= apart)


def _amplitudes(deviation: Array, orders: Array) -> Array:
    """Amplitudes at the orders; `deviation` is (cycles, points in a cycle).

    With phi = 2 pi (c + m / points) the sum over all points is one over cycles, a product of matrices, and then one
    over the points of a cycle.
    """
    window = hann(deviation.size)
    weighted = deviation * window.reshape(deviation.shape)
    angle = -2.0 * np.pi * orders.reshape(-1, 1)
    cycles, points = (np.arange(size) for size in deviation.shape)
    over_cycles = np.cos(angle * cycles) @ weighted + 1j * (np.sin(angle * cycles) @ weighted)
    sums = np.sum(over_cycles * np.exp(1j * angle * points / points.size), axis=1)
    amplitudes: Array = 2.0 * np.abs(sums).reshape(orders.shape) / float(window.sum())
    return amplitudes
