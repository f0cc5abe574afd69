"""Sample entropy (Richman and Moorman, Am. J. Physiol. Heart Circ. Physiol. 278 (2000) H2039-H2049)."""

from __future__ import annotations

import numba
import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _pairs(templates: Array, radius: float) -> tuple[int, int]:
    """Pairs of templates closer than a radius in all coordinates but the last, and in all.

    Args:
        templates: (coordinates, templates) in the order of the first coordinate.
        radius: open limit of the largest difference.
    """
    dimension, size = templates.shape
    first = templates[0]
    short, long = 0, 0
    stop = 0
    for i in range(size):
        stop = max(stop, i + 1)
        while stop < size and first[stop] - first[i] < radius:
            stop += 1
        if dimension == 3:
            b, c = templates[1, i + 1 : stop], templates[2, i + 1 : stop]
            at_b, at_c = templates[1, i], templates[2, i]
            for j in range(b.size):
                near = abs(b[j] - at_b) < radius
                short += near
                long += near & (abs(c[j] - at_c) < radius)
        else:
            for j in range(i + 1, stop):
                k = 1
                while k < dimension and abs(templates[k, j] - templates[k, i]) < radius:
                    k += 1
                short += k >= dimension - 1
                long += k == dimension
    return short, long


def sample_entropy(x: Array, dimension: int = 2, tolerance: float = 0.2, lag: int = 1) -> float:
    """How little the past of a signal says about its next value.

    SampEn = -ln(A / B), B the pairs of templates (x(i), .., x(i + (m - 1) lag)) whose largest difference is below
    tolerance * sd, A those which stay so with one value more; i = 0 .. samples - m lag - 1 for both. -ln erf(tolerance
    / 2) for white normal noise, whatever m; small for a sine. It depends on the sample rate: oversampling makes any
    signal predictable. The standard deviation is that of the samples (divided by n).

    Args:
        x: (samples,) any unit; 10^m to 20^m of them are wanted.
        dimension: m, 1 or more.
        tolerance: share of the standard deviation.
        lag: samples between the values of a template.

    Returns:
        Nats.

    Raises:
        InputError: a value that isn't finite, a constant, too few samples, no pair within the tolerance (the entropy is
            undefined or infinite then), a setting that isn't possible.
    """
    dimension, lag = checked.whole("dimension", dimension, 1), checked.whole("lag", lag, 1)
    tolerance = checked.positive("tolerance", tolerance)
    values = checked.signal("x", x, dimension * lag + 2)
    values = np.ldexp(values, -int(np.frexp(np.max(np.abs(values)))[1]))
    size = values.size - dimension * lag
    order = np.argsort(values[:size], kind="stable")
    templates = np.stack([values[k * lag : k * lag + size][order] for k in range(dimension + 1)])
    short, long = _pairs(templates, tolerance * float(np.std(values)))
    if long == 0:
        raise InputError("x", f"pairs alike within {tolerance:g} sd in {dimension + 1} values", f"{long} such pairs")
    return float(np.log(short / long))
