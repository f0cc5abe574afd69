"""At which orders of its shaft a damaged rolling bearing knocks."""

from __future__ import annotations

import math
from dataclasses import dataclass

from nw_gear_common.errors import InputError
from nw_gear_monitor.signals import checked
from nw_gear_sim.kinematics import SHAFT_OF_BEARING
from nw_gear_sim.params import Configuration


@dataclass(frozen=True)
class BearingOrders:
    """Knocks per turn of the shaft; outer ring at rest, inner ring turning with the shaft, no slip.

    Attributes:
        outer: rollers that pass a spot of the outer race (BPFO).
        inner: rollers that pass a spot of the inner race (BPFI).
        cage: turns of the cage (FTF).
        roller: turns of a roller about its own axis (BSF); a damaged roller knocks twice in each of them, at the two
            races. None where the bearing's geometry isn't known.
    """

    outer: float
    inner: float
    cage: float
    roller: float | None

    def lines(self) -> dict[str, float]:
        """Name and order of the lines that are known; `roller` at the two knocks per turn of a roller."""
        known = {"outer": self.outer, "inner": self.inner, "cage": self.cage}
        return known if self.roller is None else {**known, "roller": 2.0 * self.roller}


def from_geometry(
    rollers: int, roller_diameter: float, pitch_diameter: float, contact_angle: float = 0.0
) -> BearingOrders:
    """Orders of a bearing whose geometry is known.

    With g = d cos(a) / D: cage (1 - g)/2, outer Z (1 - g)/2, inner Z (1 + g)/2, roller (D / 2d)(1 - g^2). Source: for
    instance Randall and Antoni (2011, see `envelope_spectrum`), from memory. Real bearings slip by one or two per cent.

    Args:
        rollers: their number Z in one row.
        roller_diameter, pitch_diameter: d and D, m.
        contact_angle: a, rad.

    Raises:
        InputError: fewer than 3 rollers, a diameter that isn't above zero, d not below D, an angle outside 0 to pi/2.
    """
    rollers = checked.whole("rollers", rollers, 3)
    d, big = checked.positive("roller_diameter", roller_diameter), checked.positive("pitch_diameter", pitch_diameter)
    if d >= big:
        raise InputError("roller_diameter", f"less than the pitch diameter {big:.6g} m", f"{d:.6g} m")
    if not 0.0 <= contact_angle < 0.5 * math.pi:
        raise InputError("contact_angle", "0 to pi/2 rad", repr(contact_angle))
    g = d / big * math.cos(contact_angle)
    known = from_cage(rollers, 0.5 * (1.0 - g))
    return BearingOrders(known.outer, known.inner, known.cage, big / (2.0 * d) * (1.0 - g * g))


def from_cage(rollers: int, cage_factor: float) -> BearingOrders:
    """Orders of a bearing of which only the number of rollers and the speed of the cage are known.

    Outer Z c, inner Z (1 - c), cage c: rollers pass a spot of the outer race as often as the cage brings them, and one
    of the inner race as often as it overtakes them. The roller's own turns can't be known.

    Args:
        rollers: their number Z.
        cage_factor: c, speed of the cage over that of the shaft.

    Raises:
        InputError: fewer than 3 rollers, a cage factor that isn't between 0 and 1.
    """
    rollers = checked.whole("rollers", rollers, 3)
    if not 0.0 < cage_factor < 1.0:
        raise InputError("cage_factor", "a number between 0 and 1", repr(cage_factor))
    return BearingOrders(rollers * cage_factor, rollers * (1.0 - cage_factor), cage_factor, None)


def of_gearbox(configuration: Configuration) -> dict[str, BearingOrders]:
    """Orders of every kind of bearing of the gearbox (`pb1` ..), in turns of the shaft that turns in it.

    The cage factor is that of the configuration, which the simulator's roller passage follows as well:
    `Kinematics.roller_pass_ratio` is `outer` times the speed of the shaft over that of the ring. Planets turn on axes
    that stand still, so that there, too, the inner ring is the one that turns.
    """
    kinds = {kind: getattr(configuration.bearings, kind) for kind in SHAFT_OF_BEARING}
    return {kind: from_cage(bearing.rollers, bearing.cage_factor) for kind, bearing in kinds.items()}
