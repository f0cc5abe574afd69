"""Sums of a signal against cosine and sine at multiples of a phase: what line amplitudes are made from."""

from __future__ import annotations

import numba
import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array

Complex = npt.NDArray[np.complex128]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _sums(phase: Array, weighted: Array, orders: Array) -> Complex:
    out = np.zeros(orders.size, dtype=np.complex128)
    for k in range(orders.size):
        order = orders[k]
        real, imaginary = 0.0, 0.0
        for i in range(phase.size):
            angle = order * phase[i]
            real += weighted[i] * np.cos(angle)
            imaginary -= weighted[i] * np.sin(angle)
        out[k] = complex(real, imaginary)
    return out


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _power_sums(phase: Array, weighted: Array, parts: int, powers: npt.NDArray[np.int64]) -> Complex:
    out = np.zeros(powers.size, dtype=np.complex128)
    for i in range(phase.size):
        angle = phase[i] / parts
        base = complex(np.cos(angle), -np.sin(angle))
        term = complex(1.0, 0.0)
        reached = 0
        for k in range(powers.size):
            step, square = powers[k] - reached, base
            while step > 0:
                if step & 1:
                    term *= square
                square *= square
                step >>= 1
            reached = powers[k]
            out[k] += weighted[i] * term
    return out


def line_sums(phase: Array, weighted: Array, orders: Array) -> Complex:
    """sum_i y_i exp(-i q phi_i) for each order q.

    Args:
        phase: (samples,) rad.
        weighted: (samples,) the signal y, window included.
        orders: (orders,) multiples q of the phase.
    """
    found: Complex = _sums(np.ascontiguousarray(phase), weighted, np.asarray(orders, dtype=np.float64))
    return found


def power_sums(phase: Array, weighted: Array, parts: int, powers: npt.NDArray[np.int64]) -> Complex:
    """The same at the orders powers / parts, with one cosine and sine for all of them.

    Args:
        phase: (samples,) rad, any size: rounding grows with it as 1e-16 of it.
        weighted: (samples,) the signal, window included.
        parts: of the phase that whole powers are taken of.
        powers: (orders,) increasing, above 0.
    """
    found: Complex = _power_sums(np.ascontiguousarray(phase), weighted, parts, powers)
    return found
