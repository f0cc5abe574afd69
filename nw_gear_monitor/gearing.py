"""The built-in gearbox as a machine to watch: everything follows from its configuration."""

from __future__ import annotations

from nw_gear_common import names
from nw_gear_monitor.indicators.bearing_orders import of_gearbox
from nw_gear_monitor.machine import Bearing, Channel, Machine, Shaft, Stage
from nw_gear_sim.kinematics import SHAFT_OF_BEARING, Kinematics, bearing_kind, derive
from nw_gear_sim.params import Configuration

NAME = "NW gearbox"


def gearing(configuration: Configuration) -> Machine:
    """Describe the gearbox of a configuration.

    Raises:
        InputError: the gearbox can't be assembled.
    """
    derived = derive(configuration)
    return Machine(
        NAME, _stages(derived, configuration), _channels(derived), _shafts(configuration), _bearings(configuration)
    )


def _stages(derived: Kinematics, configuration: Configuration) -> tuple[Stage, ...]:
    speed = configuration.turbine.rated_speed
    stages = []
    for name in names.STAGES:
        stage = derived.stage(name)
        teeth = (stage.pair.driver.teeth, stage.pair.driven.teeth)
        frequency = derived.mesh_frequency_hz(name, speed)
        stages.append(Stage(name, f"phase_{name}", 1.0, frequency, teeth, stage.mesh.backlash))
    return tuple(stages)


def _channels(derived: Kinematics) -> tuple[Channel, ...]:
    channels = []
    for stage in names.STAGES:
        for j, mesh in enumerate(names.MESHES_OF_STAGE[stage]):
            phase = derived.stage(stage).planet_phases[j]
            channels.append(Channel(mesh, stage, f"x_{mesh}", f"v_{mesh}", "m", j + 1, phase))
    return tuple(channels)


def _shafts(configuration: Configuration) -> tuple[Shaft, ...]:
    gears = configuration.gears
    return (
        Shaft("ring", "I", gears.ring.teeth),
        Shaft("planet", "I", gears.planet_1.teeth),
        Shaft("sun", "II", gears.sun.teeth),
        Shaft("output", "III", gears.herringbone_2.teeth),
    )


def _bearings(configuration: Configuration) -> tuple[Bearing, ...]:
    orders = of_gearbox(configuration)
    bearings = []
    for name in names.BEARINGS:
        kind = bearing_kind(name)
        rollers = getattr(configuration.bearings, kind).rollers
        columns = (f"fx_{name}", f"fy_{name}")
        bearings.append(Bearing(name, SHAFT_OF_BEARING[kind], columns, "N", rollers, orders[kind], optional=True))
    return tuple(bearings)
