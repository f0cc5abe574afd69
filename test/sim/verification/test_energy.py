"""Energy over time: conserved where nothing takes it, balanced to the last loss where everything does.

Energies and powers are computed from recorded displacements and velocities by the independent equations. Slow.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
import scipy.integrate

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Simulation
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE, WITHOUT_LOSSES
from test.sim.verification.independent import Independent

pytestmark = pytest.mark.slow

RK4 = {"numerics.integrator": "rk4"}


def test_conserved_without_losses(figure: Callable[[str, float], float]) -> None:
    """At rest, undamped, frictionless: a step of the torque sets it swinging, and for a second nothing is lost.

    Kinetic energy, springs, rollers and meshes, less the work of torque and weight. The drift is given over the
    energy of the vibration and has to stay under a millionth at a step of 2 us.
    """
    configuration = with_values({**dict(WITHOUT_LOSSES), **RK4, "numerics.step": 2e-6}, load())
    other, torque = Independent(configuration), RATED_TORQUE
    simulation = Simulation(configuration, Drive(0.0, 0.0, 0.9 * torque, 0.9 * torque), sample_rate=5000.0)
    drive = Drive(0.0, 0.0, torque, torque)
    ring, output = other.torque_row()
    load_row = torque * ring - torque / other.kinematics.total_ratio * output + other.weight(0.0)

    def energy() -> tuple[float, float]:
        kinetic = 0.5 * float(other.mass @ simulation.v**2)
        return other.energy(simulation.q, simulation.v) - float(load_row @ simulation.q), kinetic

    whole, kinetic = zip(*_while(simulation, drive, 100, 50, energy), strict=True)
    vibration = max(kinetic)
    drift = float(np.max(np.abs(np.array(whole) - whole[0]))) / vibration
    assert vibration > 10  # J
    assert figure("energy drift over a second, over the vibration's", drift) < 1e-6


def _while(
    simulation: Simulation, drive: Drive, intervals: int, samples: int, look: Callable[[], tuple[float, float]]
) -> list[tuple[float, float]]:
    out = [look()]
    for _ in range(intervals):
        simulation.advance(samples, drive)
        out.append(look())
    return out


class Powers(NamedTuple):
    """At an instant: power in and out, of what is prescribed, of weight, friction and dampers (W); stored (J)."""

    given: float
    taken: float
    prescribed: float
    weight: float
    friction: float
    damping: float
    stored: float


def powers(other: Independent, q: Array, v: Array, angle: float, speed: float, torque: float) -> Powers:
    """Powers of all elements on the whole motion: shafts turning at their speeds, and the vibration.

    Prescribed are the transmission errors, the stiffness over the phase, the segments and rollers that pass: each of
    them moves the end of a spring and does work on it.
    """
    turning = speed * other.turning
    mesh, (rollers, rollers_slope) = other.meshes(q, v, angle, speed), other.bearings(q, angle)
    rows, stiffness, damping = other.springs
    ring, output = other.torque_row()
    generator = other.configuration.generator
    twist, twist_rate = output @ q, output @ v
    held = generator.stiffness * (twist + generator.damping_time * twist_rate)
    released = torque / other.kinematics.total_ratio
    elastic = mesh.stiffness * np.abs(mesh.deflection)
    rub = sum(
        (elastic[k] * other.friction(name, angle, speed) for k, name in enumerate(names.MESHES)), np.zeros(len(q))
    )
    mesh_damping = np.array([other.kinematics.stage(name).stiffness.damping for name in names.MESHES])
    stored = 0.5 * stiffness @ (rows @ q) ** 2 + rollers + 0.5 * mesh.stiffness @ mesh.deflection**2
    return Powers(
        given=torque * float(ring @ (v + turning)),
        taken=float(released * (output @ (v + turning)) + held * (output @ turning)),
        prescribed=float(
            mesh.force @ (mesh.error_rate + mesh.h_rate @ q)
            + 0.5 * mesh.stiffness_rate @ mesh.deflection**2
            + rollers_slope * speed
        ),
        weight=float(other.weight(angle) @ (v + turning)),
        friction=float(-rub @ (v + turning)),
        damping=float(damping @ (rows @ v) ** 2 + mesh_damping @ mesh.rate**2),
        stored=float(stored + 0.5 * other.mass @ v**2 + turning @ (other.mass * v)),
    )


def balance(other: Independent, simulation: Simulation, samples: int, torques: tuple[float, float]) -> dict[str, float]:
    """Works (J) over an interval in which the torque runs linearly, one step a sample; `off` is what doesn't add up."""
    rate = simulation.sample_rate
    times = np.arange(samples + 1) / rate
    course = torques[0] + (torques[1] - torques[0]) * times / times[-1]
    start = simulation.time
    found = []
    for k in range(samples + 1):
        angle = RATED_SPEED * (start + times[k])
        found.append(powers(other, simulation.q, simulation.v, angle, RATED_SPEED, course[k]))
        if k < samples:
            simulation.advance(1, Drive(RATED_SPEED, RATED_SPEED, course[k], course[k + 1]))
    columns = np.array(found).T
    work = {
        name: float(scipy.integrate.simpson(column, x=times))
        for name, column in zip(Powers._fields[:-1], columns, strict=False)
    }
    work["stored"] = float(columns[-1, -1] - columns[-1, 0])
    gained = work["given"] + work["prescribed"] + work["weight"]
    spent = work["taken"] + work["friction"] + work["damping"] + work["stored"]
    return work | {"off": gained - spent}


def run(torques: tuple[float, float], **values: object) -> dict[str, float]:
    """Balance of 50 ms at rated speed from equilibrium."""
    rate = 40960.0
    changed = {key.replace("__", "."): value for key, value in values.items()}
    configuration = with_values({**RK4, "numerics.step": 1 / rate, **changed}, load())
    first, last = (share * RATED_TORQUE for share in torques)
    simulation = Simulation(configuration, Drive(RATED_SPEED, RATED_SPEED, first, first), sample_rate=rate)
    return balance(Independent(configuration), simulation, 2048, (first, last))


@pytest.mark.parametrize(("integrator", "torques"), [("rk4", (1.0, 1.0)), ("rk4", (0.5, 1.0)), ("etdrk4", (0.5, 1.0))])
def test_balance_with_everything_on(
    integrator: str, torques: tuple[float, float], figure: Callable[[str, float], float]
) -> None:
    """Input = output + friction + damping + stored, with the work of what is prescribed, to 1e-4 of the input.

    At constant torque and while it rises. That nothing hides in the size of the input, what doesn't add up is compared
    with the losses too.
    """
    work = run(torques, numerics__integrator=integrator)
    for name, value in work.items():
        figure(f"{name}, J", value)
    assert work["friction"] > 0
    assert work["damping"] > 0
    assert figure("energy balance, off over the input", abs(work["off"]) / work["given"]) < 1e-6
    lost = work["friction"] + work["damping"]
    assert figure("energy balance, off over the losses", abs(work["off"]) / lost) < 1e-4
    assert 0.97 < figure("output over input", work["taken"] / (work["given"] - work["stored"])) < 0.999


def test_balance_of_the_vibration(figure: Callable[[str, float], float]) -> None:
    """Without friction, which is a thousand times the rest, against what the dampers take.

    What is left (5 mJ) is the quadrature's: the power steps by 480 W where a planet passes from segment to segment.
    """
    work = run((0.5, 1.0), friction__enabled=False)
    assert work["friction"] == 0
    assert figure("energy balance without friction, off over the damping", abs(work["off"]) / work["damping"]) < 5e-3


def test_turning_of_the_shafts_stretches_nothing() -> None:
    """The motion on which the balance rests: no mesh force, no spring but the generator's does work on it."""
    other = Independent(load())
    rows, stiffness, _ = other.springs
    strained = np.abs(stiffness * (rows @ other.turning))
    assert np.count_nonzero(strained > 1e-3) == 1  # the generator's
    mesh = other.meshes(np.zeros(len(other.mass)), other.turning, 0.3, 0.0)
    assert np.max(np.abs(mesh.rate)) < 1e-13 * math.hypot(*other.turning)
