"""What the monitor looks at to judge a bearing: its force, the turns of its shaft, where its rollers pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.bearing_orders import BearingOrders
from nw_gear_monitor.indicators.window import Column


@dataclass(frozen=True, eq=False)
class BearingWindow:
    """The last seconds of one bearing.

    Attributes:
        rate: samples per second, Hz.
        size: (samples,) magnitude of the radial force, N.
        components: (samples, 2) the force in two directions, N.
        phase: (samples,) unwrapped phase of the shaft in the bearing, rad; None where nothing turns.
        long_size, long_phase: the same over the window of the envelope; None while it isn't filled.
        orders: of the bearing, in turns of its shaft; None where they aren't known.
        band: of the envelope, Hz; None where the samples don't carry it.
    """

    rate: float
    size: Array
    components: Array
    phase: Array | None
    long_size: Array | None
    long_phase: Array | None
    orders: BearingOrders | None
    band: tuple[float, float] | None


@dataclass(frozen=True)
class BearingIndicator:
    """One indicator: the columns it fills and the function that does it (one number per column)."""

    columns: tuple[Column, ...]
    compute: Callable[[BearingWindow], tuple[float, ...]]
