"""Parameter points: configurations with all that is derived from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.assembly import assemble, masses
from nw_gear_sim.batch.pairs import Key, Pair, Residual, ring_pairs
from nw_gear_sim.kinematics import Kinematics, derive
from nw_gear_sim.layout import Layout
from nw_gear_sim.model import Laws
from nw_gear_sim.params import Configuration


@dataclass(frozen=True, eq=False)
class Point:
    """One parameter point before it is put into a lane.

    Attributes:
        laws, layout, kinematics, mass: as `Gearbox` has them.
        pairs, residual: of the ring.
        speed, torque: of the ring, rad/s and N m.
    """

    configuration: Configuration
    laws: Laws
    layout: Layout
    kinematics: Kinematics
    mass: Array
    pairs: dict[Key, Pair]
    residual: Residual
    speed: float
    torque: float

    @property
    def first(self) -> int:
        """The first motion that isn't the ring's."""
        return 4 * self.layout.segments


def make_points(configurations: Sequence[Configuration], excitation: str, ring: str) -> list[Point]:
    """Prepare the points.

    Raises:
        InputError: a value differs that has to be the same in all points.
    """
    first = configurations[0]
    for configuration in configurations[1:]:
        _refuse_different(first, configuration)
    known: dict[bytes, tuple[dict[Key, Pair], Residual]] = {}
    points = []
    for configuration in configurations:
        kinematics = derive(configuration)
        laws, layout = assemble(configuration, excitation)
        mass = masses(configuration, kinematics, layout)
        bandwidth = None if ring == "rigid" else configuration.numerics.ring_bandwidth
        key = _fingerprint(laws, mass[: 4 * layout.segments], bandwidth)
        if key not in known:
            known[key] = ring_pairs(laws, mass, bandwidth)
        speed, torque = kinematics.ring_speed, kinematics.input_torque
        points.append(Point(configuration, laws, layout, kinematics, mass, *known[key], speed, torque))
    return points


def _refuse_different(first: Configuration, other: Configuration) -> None:
    same: dict[str, tuple[float, float]] = {
        "ring.segments": (first.ring.segments, other.ring.segments),
        "bearings.exponent": (first.bearings.exponent, other.bearings.exponent),
    }
    for kind in ("pb1", "pb2", "sb", "b1", "b21", "b22"):
        counts = getattr(first.bearings, kind).rollers, getattr(other.bearings, kind).rollers
        same[f"bearings.{kind}.rollers"] = counts
    for place, (expected, got) in same.items():
        if expected != got:
            raise InputError(place, f"the same value in all points of a batch ({expected:g})", f"{got:g}")


def _fingerprint(laws: Laws, mass: Array, bandwidth: float | None) -> bytes:
    parts = [np.asarray(value, dtype=np.float64).tobytes() for value in (*laws.ring, *laws.engagement, mass)]
    return b"".join(parts) + repr(bandwidth).encode()


def ring_keys(points: Sequence[Point]) -> tuple[Key, ...]:
    """Return the keys of the ring's pairs that occur in the points, sorted."""
    return tuple(sorted(set().union(*(point.pairs for point in points))))
