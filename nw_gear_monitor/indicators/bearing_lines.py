"""How far the lines of a damaged bearing stand out of an envelope spectrum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.bearing_orders import BearingOrders
from nw_gear_monitor.signals import checked
from nw_gear_monitor.signals.envelope import OrderSpectrum

HARMONICS = 3
SLIP = 0.02
"""A line is looked for within this share of its order on either side."""
NEIGHBOURS = 64
"""Bins on either side of the searched ones whose median is the floor."""


@dataclass(frozen=True)
class BearingLine:
    """One line of one bearing.

    Attributes:
        part: outer, inner, cage or roller.
        harmonic: multiple of the part's order.
        expected: order without slip.
        order: where the largest amplitude within the slip was found.
        amplitude: there, in the unit of the signal.
        prominence: amplitude over the median amplitude of the bins around; the largest of n bins of noise has about
            1.2 sqrt(ln n).
    """

    part: str
    harmonic: int
    expected: float
    order: float
    amplitude: float
    prominence: float


def bearing_lines(
    spectrum: OrderSpectrum, orders: BearingOrders, *, harmonics: int = HARMONICS, slip: float = SLIP
) -> tuple[BearingLine, ...]:
    """Read the bearing's lines and their harmonics from an envelope spectrum.

    Args:
        spectrum: of the envelope, over orders of the bearing's shaft.
        orders: of the bearing.
        harmonics: multiples of each order that are read, as far as the spectrum goes.
        slip: share of an order within which its line may lie, 0 to 0.1.

    Raises:
        InputError: a spectrum with values that aren't finite or with nothing but zeros around a line, settings out of
            range, a record in which the cage turns less than twice.
    """
    harmonics = checked.whole("harmonics", harmonics, 1)
    if not 0.0 <= slip <= 0.1:
        raise InputError("slip", "0 to 0.1", repr(slip))
    amplitude = checked.signal("spectrum", spectrum.amplitude, 2 * NEIGHBOURS)
    if spectrum.turns * orders.cage < 2.0:
        raise InputError("spectrum", f"at least {2.0 / orders.cage:.3g} turns of the shaft", str(spectrum.turns))
    wanted = [(part, k, k * order) for part, order in orders.lines().items() for k in range(1, harmonics + 1)]
    last = float(spectrum.order[-1])
    return tuple(
        _line(spectrum, amplitude, part, k, order, slip)
        for part, k, order in wanted
        if order * (1.0 + slip) + NEIGHBOURS / spectrum.turns <= last
    )


def _line(
    spectrum: OrderSpectrum, amplitude: Array, part: str, harmonic: int, expected: float, slip: float
) -> BearingLine:
    # The window spreads a line over two bins on either side of its own; bins 0 and 1 hold what is left of the mean.
    low = max(int(np.floor(expected * (1.0 - slip) * spectrum.turns)), 2)
    high = max(int(np.ceil(expected * (1.0 + slip) * spectrum.turns)), low) + 1
    at = low + int(np.argmax(amplitude[low:high]))
    around = np.concatenate(
        [amplitude[max(low - NEIGHBOURS, 2) : max(low - 2, 2)], amplitude[high + 2 : high + NEIGHBOURS]]
    )
    floor = float(np.median(around))
    if not floor > 0.0:
        raise InputError("spectrum", f"noise around order {expected:.6g}", "zeros")
    value = float(amplitude[at])
    return BearingLine(part, harmonic, expected, float(spectrum.order[at]), value, value / floor)
