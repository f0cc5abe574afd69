"""The monitor's states against the truth of the simulated gearbox, without ROS.

Truth comes from the model: the rate at which two neighbouring trajectories part (negative: regular), and for periods
2 and 4 the motion itself, compared with itself one, two and four mesh periods before.
"""

import copy
import itertools
import math

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.gearing import gearing
from nw_gear_monitor.pipeline import Pipeline
from nw_gear_sim import config, kinematics
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.drivetrain import DriveTrain
from nw_gear_sim.physics.rotor import Rotor
from nw_gear_sim.physics.wind_weibull import WeibullWind
from nw_gear_sim.simulation import Simulation

pytestmark = pytest.mark.slow

TICK = 512
"""Samples between two changes of the drive: 0.1 s."""
UNDECIDED = {names.UNKNOWN, names.TRANSIENT}


def table(block):
    columns = names.waveform_columns(())
    return Table("sample", columns, np.column_stack([block.time, block.phase, block.x, block.v]))


def fixed(preset):
    configuration = config.load(preset)
    derived = kinematics.derive(configuration)
    drive = Drive(derived.ring_speed, derived.ring_speed, derived.input_torque, derived.input_torque)
    return configuration, drive, Simulation(configuration, drive)


def watch(configuration, simulation, drives):
    """Every hop of the monitor while the simulation follows the drives, and the last block."""
    pipeline = Pipeline(gearing(configuration))
    hops, block = [], None
    for drive in drives:
        block = simulation.advance(TICK, drive)
        hops += pipeline.feed(table(block))
    assert pipeline.continuity.gaps == pipeline.continuity.restarts == pipeline.continuity.malformed == 0
    return hops


def shown(hops, stage):
    return {hop.stages[stage].state.label for hop in hops}


def growth(simulation, drive, seconds):
    """Mean rate (1/s) at which a trajectory that got a billionth more torque for 0.1 s parts from this one.

    Distances are those of the seven displacements, as rms over 0.1 s each.
    """
    other = copy.deepcopy(simulation)
    simulation.advance(TICK, drive)
    more = drive.torque_start * (1 + 1e-9)
    other.advance(TICK, Drive(drive.speed_start, drive.speed_end, more, more))
    distances = [
        np.sqrt(np.mean((other.advance(TICK, drive).x - simulation.advance(TICK, drive).x) ** 2))
        for _ in range(round(10 * seconds) + 1)
    ]
    return math.log(distances[-1] / distances[0]) / seconds


def change_over_periods(block, numbers):
    """Standard deviation of the change of x_II_1 over so many mesh periods of stage II, for each number."""
    phase, x = block.phase[:, 1], block.x[:, names.MESHES.index("II_1")]
    grid = phase[0] + 2 * np.pi * np.arange(4.0, 60.0, 0.01)
    return [np.std(np.interp(grid, phase, x) - np.interp(grid - 2 * np.pi * n, phase, x)) for n in numbers]


def test_rated_is_regular_in_every_stage():
    configuration, drive, simulation = fixed("rated")
    hops = watch(configuration, simulation, [drive] * 400)
    assert all(shown(hops[9:], stage) == {"period-1"} for stage in names.STAGES)
    assert growth(simulation, drive, 2.0) < 0


def test_rattling_is_chaotic():
    configuration, drive, simulation = fixed("rattling")
    hops = watch(configuration, simulation, [drive] * 400)
    assert shown(hops[9:], "II") == {names.CHAOTIC}
    assert not any(shown(hops, stage) & {"period-1", names.QUASI_PERIODIC} for stage in names.STAGES)
    assert growth(simulation, drive, 0.6) > 5


def test_period_two_is_found_in_stage_two_and_named_elsewhere():
    configuration, drive, simulation = fixed("period2")
    hops = watch(configuration, simulation, [drive] * 400)
    assert shown(hops[9:], "II") == {"period-2"}
    assert shown(hops[9:], "I") == shown(hops[9:], "III") == {"period-1"}
    assert growth(simulation, drive, 2.0) < 0
    differences = change_over_periods(simulation.advance(5120, drive), (1, 2))
    assert differences[1] < 0.5 * differences[0]


def test_period_four_is_found_in_stage_two():
    configuration, drive, simulation = fixed("period4")
    simulation.advance(4 * 5120, drive)
    hops = watch(configuration, simulation, [drive] * 300)
    assert shown(hops[-5:], "II") == {"period-4"}
    assert names.QUASI_PERIODIC not in shown(hops, "II")  # while it settles
    assert growth(simulation, drive, 2.0) < 0
    differences = change_over_periods(simulation.advance(5120, drive), (1, 2, 4))
    assert differences[2] < 0.5 * differences[1]


@pytest.mark.parametrize("seed", [0, 1])
def test_under_weibull_wind_stages_two_and_three_carry_a_label_for_most_of_a_minute(seed):
    configuration = config.load(None)
    wind = configuration.wind
    process = WeibullWind(wind.weibull_shape, wind.weibull_scale, wind.sampling_interval, wind.correlation_time, seed)
    rotor = Rotor(configuration.turbine, process.at(0.0))
    simulation = Simulation(configuration, Drive(rotor.speed, rotor.speed, rotor.torque, rotor.torque))
    hops = watch(configuration, simulation, (rotor.advance(process.at(0.1 * (i + 1)), 0.1) for i in range(600)))
    for stage in ("II", "III"):
        labels = [hop.stages[stage].state.label for hop in hops]
        assert sum(label not in UNDECIDED for label in labels) >= 30
        assert set(labels) - UNDECIDED == {"period-1"}  # nothing rattles at these loads


def test_rattling_stays_chaotic_while_speed_and_load_change():
    configuration, drive, simulation = fixed("rattling")
    speed, torque = drive.speed_start, drive.torque_start

    def at(time):
        return speed * (1 + 0.05 * math.sin(2 * math.pi * time / 9)), torque * (
            1 + 0.3 * math.sin(2 * math.pi * time / 7)
        )

    ends = [at(0.1 * i) for i in range(201)]
    drives = [Drive(a[0], b[0], a[1], b[1]) for a, b in itertools.pairwise(ends)]
    hops = watch(configuration, simulation, drives)
    assert shown(hops[9:], "II") == {names.CHAOTIC}


@pytest.mark.parametrize("scenario", ["shutdown", "emergency_stop", "grid_loss"])
def test_a_load_that_goes_to_zero_is_transient_and_no_chaos(scenario):
    configuration = config.load()
    train = DriveTrain(configuration.turbine, configuration.drivetrain, scenario, 10.0, 12.0)
    simulation = Simulation(configuration, train.drive)
    hops = watch(configuration, simulation, (train.advance(12.0, 0.1) for _ in range(250)))
    assert not any(names.CHAOTIC in shown(hops, stage) for stage in names.STAGES)
    assert names.TRANSIENT in shown(hops, "II")
    assert shown([hop for hop in hops if 10.0 <= hop.time <= 11.0], "II") == {names.PERIODS[0]}


@pytest.mark.parametrize("scenario", ["shutdown", "emergency_stop", "grid_loss"])
def test_a_stopped_gearbox_is_unknown_and_no_chaos(scenario):
    """A light rotor under a strong brake: it stands within seconds."""
    values = {"rotor_inertia": 1e7, "shutdown_time": 1.0, "pitch_time": 0.5, "brake_torque": 2e7, "brake_time": 0.2}
    light = {f"drivetrain.{name}": value for name, value in {**values, "brake_speed": 1.0}.items()}
    configuration = config.with_values(light, config.load())
    train = DriveTrain(configuration.turbine, configuration.drivetrain, scenario, 11.5, 12.0)
    simulation = Simulation(configuration, train.drive)
    hops = watch(configuration, simulation, (train.advance(12.0, 0.1) for _ in range(240)))
    assert train.phase == "standstill"
    before = [hop for hop in hops if 10.0 <= hop.time <= 11.0]
    assert all(shown(before, stage) == {names.PERIODS[0]} for stage in names.STAGES)
    after = [hop for hop in hops if hop.time > train.events()["standstill"] + 1.0]
    assert len(after) > 3
    assert not any(hop.turning for hop in after)
    assert all(shown(after, stage) == {names.UNKNOWN} for stage in names.STAGES)
    assert not any(names.CHAOTIC in shown(hops, stage) for stage in names.STAGES)
