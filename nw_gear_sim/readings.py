"""What a simulation gives out: samples of an interval with phases, shafts and contact shares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.assembly import start_phases
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.model import Interval
from nw_gear_sim.params import Configuration
from nw_gear_sim.stepping import Course

_SHARES = ("open_fraction", "back_fraction")


@dataclass(frozen=True, eq=False)
class Block:
    """Samples of one interval, C-contiguous arrays of n rows in SI units.

    Attributes:
        time: seconds since the start, (n,).
        phase: unwrapped mesh phase of planet 1 in stages I, II, III, 0 at tooth entry, rad, (n, 3).
        x, v, force: elongation x_n (m), its rate (m/s) and mesh force (N) in the order of names.MESHES, (n, 7).
        bearing_force: x, y, z of the force on the housings in the order of names.BEARINGS, N, (n, 10, 3).
        shaft_angle, shaft_speed, shaft_torque: unwrapped rotation (rad), rad/s and torque carried (N m) of ring
            (mean), planet 1, sun, output shaft, each positive in its own sense of rotation and power flow, (n, 4).
        open_fraction: share of the steps in which a mesh carried nothing, (7,).
        back_fraction: share of the steps in which it carried on its back flanks, (7,).
    """

    time: Array
    phase: Array
    x: Array
    v: Array
    force: Array
    bearing_force: Array
    shaft_angle: Array
    shaft_speed: Array
    shaft_torque: Array
    open_fraction: Array
    back_fraction: Array


def joined(blocks: Sequence[Block]) -> Block:
    """Return blocks that follow each other as one, with the mean of their shares by length."""
    if len(blocks) == 1:
        return blocks[0]
    samples = [len(block.time) for block in blocks]
    columns = {field.name: [getattr(block, field.name) for block in blocks] for field in fields(Block)}
    shares = {name: np.average(columns.pop(name), axis=0, weights=samples) for name in _SHARES}
    return Block(**{name: np.concatenate(parts) for name, parts in columns.items()}, **shares)


def thinned(block: Block, every: int) -> Block:
    """Return a block with the first of every so many samples; the shares stay."""
    if every == 1:
        return block
    kept = {f.name: getattr(block, f.name) for f in fields(Block)}
    thin = {name: np.ascontiguousarray(x[::every]) for name, x in kept.items() if name not in _SHARES}
    return Block(**{**kept, **thin})


class Readings:
    """Makes blocks of what was recorded.

    Shaft angles, speeds and torques follow from the recorded rotations: of the ring's mean, then of model.Laws.probes.

    Args:
        configuration: torsion springs and generator; gearbox: the whole model.
        sample_rate: of the blocks, Hz.
    """

    def __init__(self, configuration: Configuration, gearbox: Gearbox, sample_rate: float) -> None:
        self._sample_rate = sample_rate
        self._start_phase = np.array(start_phases(gearbox.kinematics))
        self._phase_ratio = gearbox.laws.phase_ratio
        bodies, torsion, generator = gearbox.kinematics.bodies, configuration.torsion, configuration.generator
        gears = (bodies.planet_1, bodies.planet_2, bodies.sun, bodies.herringbone_1, bodies.herringbone_2)
        self._ratio = np.array([gearbox.kinematics.shaft_ratio[shaft] for shaft in names.SHAFTS])
        self._input = np.array([1.0, 0.0, 0.0, 1.0 / self._ratio[3]])
        turned = np.diag([1.0, *(1.0 / gear.base_radius for gear in gears)])
        self._shown = turned[:, [0, 1, 3, 5]]
        bent = np.stack([turned[:, 1] - turned[:, 2], turned[:, 3] - turned[:, 4], turned[:, 5]], axis=1)
        stiffness = np.array([torsion.planet, torsion.sun, generator.stiffness])
        time = np.array([torsion.damping_time, torsion.damping_time, generator.damping_time])
        self._by_twist, self._by_rate = np.zeros((6, 4)), np.zeros((6, 4))
        self._by_twist[:, 1:], self._by_rate[:, 1:] = stiffness * bent, stiffness * time * bent

    def block(self, before: int, interval: Interval, course: Course, steps_per_sample: int) -> Block:
        """Return the block of an interval that comes after `before` samples."""
        samples = len(course.x)
        index = np.arange(samples)
        share, elapsed = index / samples, index / self._sample_rate
        change = interval.speed_end - interval.speed_start
        angle = interval.angle + (interval.speed_start + 0.5 * change * share) * elapsed
        speed = interval.speed_start + change * share
        torque = interval.torque_start + (interval.torque_end - interval.torque_start) * share
        shaft_angle, shaft_speed, shaft_torque = self._shafts(angle, speed, torque, course)
        steps = samples * steps_per_sample
        return Block(
            time=(before + index) / self._sample_rate,
            phase=angle[:, None] * self._phase_ratio + self._start_phase,
            x=course.x,
            v=course.rate,
            force=course.force,
            bearing_force=course.housing,
            shaft_angle=shaft_angle,
            shaft_speed=shaft_speed,
            shaft_torque=shaft_torque,
            open_fraction=course.open / steps,
            back_fraction=course.back / steps,
        )

    def _shafts(self, angle: Array, speed: Array, torque: Array, course: Course) -> tuple[Array, Array, Array]:
        """Return angle (rad), speed (rad/s) and torque (N m) of the shafts from those of the ring, each (n, 4)."""
        twist, rate = course.twist, course.twist_rate
        carried = torque[:, None] * self._input + twist @ self._by_twist + rate @ self._by_rate
        return (
            angle[:, None] * self._ratio + twist @ self._shown,
            speed[:, None] * self._ratio + rate @ self._shown,
            carried,
        )
