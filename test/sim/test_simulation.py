"""The simulation as others use it: blocks, phases, starts, tied excitation, errors."""

import math

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.readings import Block
from nw_gear_sim.simulation import INTEGRATORS, Divergence, Simulation, steps_per_sample
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE

RATED = Drive(RATED_SPEED, RATED_SPEED, RATED_TORQUE, RATED_TORQUE)
REST = Drive(0.0, 0.0, 0.0, 0.0)
CONFIGURATION = load()
MESH_RATIO = [stage.mesh_ratio for stage in derive(CONFIGURATION).stages]


def simulation(drive: Drive = RATED, *, configuration: Configuration = CONFIGURATION, **options: object) -> Simulation:
    return Simulation(configuration, drive, **options)  # type: ignore[arg-type]


def test_block() -> None:
    run = simulation()
    block = run.advance(32, RATED)
    shapes = {
        "time": (32,),
        "phase": (32, 3),
        "x": (32, 7),
        "v": (32, 7),
        "force": (32, 7),
        "bearing_force": (32, 10, 3),
        "shaft_angle": (32, 4),
        "shaft_speed": (32, 4),
        "shaft_torque": (32, 4),
        "open_fraction": (7,),
        "back_fraction": (7,),
    }
    for name, shape in shapes.items():
        array: Array = getattr(block, name)
        assert array.shape == shape
        assert array.flags.c_contiguous
        assert array.dtype == np.float64
        assert np.all(np.isfinite(array))
    assert block.time == pytest.approx(np.arange(32) / 5120, rel=1e-15)
    assert run.time == 32 / 5120
    assert run.advance(1, RATED).time[0] == 32 / 5120


def test_starts_in_equilibrium() -> None:
    """The elongations are those of the static equilibrium, and hardly move within a quarter of a millisecond."""
    block = simulation(sample_rate=20480.0).advance(5, RATED)
    assert block.x[0] / 45e-6 == pytest.approx([3.12, 3.95, 3.86, 2.36, 2.33, 2.27, 3.25], abs=6e-3)
    assert np.max(np.abs(block.x[-1] - block.x[0])) < 3e-6
    ratio = derive(CONFIGURATION).shaft_ratio.values()
    assert block.shaft_speed[0] == pytest.approx([RATED_SPEED * r for r in ratio], rel=1e-9)
    assert block.shaft_torque[0] == pytest.approx([4.3e6, 3.46e5, 5.01e5, 7.65e4], rel=0.05)


def test_starts_from_zero() -> None:
    """As in the paper: nothing is displaced but by the transmission errors, then the load closes all gaps."""
    run = simulation(start="zero")
    block = run.advance(256, RATED)
    assert np.max(np.abs(block.x[0])) < 14e-6
    assert np.max(block.x) > 55e-6
    for _ in range(3):
        block = run.advance(512, RATED)
    assert np.all(block.x[-1] > 0)


@pytest.mark.parametrize("start", ["equilibrium", "zero"])
def test_standstill(start: str) -> None:
    """No speed, no torque: nothing but the weights, no rotation."""
    run = simulation(REST, start=start)
    block = run.advance(1024, REST)
    for array in (block.x, block.v, block.force, block.bearing_force, block.shaft_torque):
        assert np.all(np.isfinite(array))
    assert np.max(np.abs(block.shaft_angle)) < 1e-3
    assert np.all(block.phase == block.phase[0])
    if start == "equilibrium":
        assert np.max(np.abs(block.x - block.x[0])) < 1e-8


def ramp(run: Simulation, blocks: int, samples: int) -> tuple[Array, Array]:
    """Speed up from rest to rated with the torque; returns times and phases."""
    parts: list[Block] = []
    for k in range(blocks):
        a, b = k / blocks, (k + 1) / blocks
        drive = Drive(a * RATED_SPEED, b * RATED_SPEED, a * RATED_TORQUE, b * RATED_TORQUE)
        parts.append(run.advance(samples, drive))
    return np.concatenate([p.time for p in parts]), np.concatenate([p.phase for p in parts])


def test_phase_is_the_integral_of_speed() -> None:
    """Uniform acceleration: phase = ratio * (speed / duration) t^2 / 2, exactly, across blocks."""
    run = simulation(REST)
    time, phase = ramp(run, 4, 128)
    duration = 4 * 128 / 5120
    turned = np.outer(RATED_SPEED / duration * time**2 / 2, MESH_RATIO)
    assert phase - phase[0] == pytest.approx(turned, rel=1e-12, abs=1e-12)


def test_mesh_frequency_in_the_phase() -> None:
    block = simulation().advance(2, RATED)
    frequency = (block.phase[1] - block.phase[0]) * 5120 / (2 * math.pi)
    assert frequency == pytest.approx([26.2383, 98.9901, 324.192], rel=3e-6)


def test_tied_runs_at_the_frequency_of_stage_two() -> None:
    block = simulation(excitation="tied").advance(2, RATED)
    frequency = (block.phase[1] - block.phase[0]) * 5120 / (2 * math.pi)
    assert frequency == pytest.approx([98.9901] * 3, rel=3e-6)
    assert block.shaft_speed[0, 3] == pytest.approx(972.58 * math.pi / 30, rel=1e-4)


def spectrum_peaks(run: Simulation, seconds: float, stage: int) -> float:
    """Frequency (Hz) of the strongest line of a mesh, after as long a settling."""
    run.advance(int(seconds * 5120), RATED)
    x = run.advance(int(seconds * 5120), RATED).x[:, stage]
    amplitude = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(len(x))))
    return float(np.argmax(amplitude) / seconds)


@pytest.mark.parametrize(("excitation", "frequency"), [("kinematic", 26.24), ("tied", 98.99)])
def test_strongest_line_of_stage_one(excitation: str, frequency: float) -> None:
    assert spectrum_peaks(simulation(excitation=excitation), 1.0, 0) == pytest.approx(frequency, abs=1.1)


def test_blocks_join_without_a_seam() -> None:
    """One long block and many short ones are the same motion, but for the rounding of their times."""
    whole = simulation().advance(96, RATED)
    run = simulation()
    parts = [run.advance(n, RATED) for n in (1, 31, 64)]
    assert np.concatenate([p.x for p in parts]) == pytest.approx(whole.x, rel=1e-9)


def test_same_again_bit_for_bit() -> None:
    first, second = (simulation().advance(64, RATED) for _ in range(2))
    assert np.array_equal(first.x, second.x)
    assert np.array_equal(first.bearing_force, second.bearing_force)


def test_sample_rate_only_picks_samples() -> None:
    fine = simulation(sample_rate=20480.0).advance(32, RATED)
    coarse = simulation(sample_rate=5120.0).advance(8, RATED)
    assert np.array_equal(fine.x[::4], coarse.x)


def test_fractions_count_steps() -> None:
    """Idling in the gaps is open all the time; rated load never is; a negative torque rides on the back flanks."""
    slack = with_values({f"mesh.{stage}.backlash": 5e-3 for stage in ("I", "II", "III")}, CONFIGURATION)
    assert np.all(simulation(REST, configuration=slack).advance(8, REST).open_fraction == 1.0)
    loaded = simulation().advance(8, RATED)
    assert np.all(loaded.open_fraction == 0.0)
    assert np.all(loaded.back_fraction == 0.0)
    backwards = Drive(RATED_SPEED, RATED_SPEED, -RATED_TORQUE, -RATED_TORQUE)
    assert np.all(simulation(backwards).advance(8, backwards).back_fraction == 1.0)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_divergence_names_time_state_and_step(integrator: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Far beyond the bound, which isn't checked here: the fastest modes grow until a displacement is no longer one."""
    monkeypatch.setattr("nw_gear_sim.simulation.check_step", lambda *arguments: None)
    unstable = with_values({"numerics.integrator": integrator, "numerics.step": 1 / 5120}, CONFIGURATION)
    run = simulation(configuration=unstable)
    with pytest.raises(Divergence, match=r"^integration diverged at 0\.0") as caught:
        run.advance(5120, RATED)
    error = caught.value
    assert error.step == round(error.time * 5120)
    assert error.state in str(error)
    assert not abs(error.value) <= 0.1


@pytest.mark.parametrize(
    ("options", "place"),
    [
        ({"start": "middle"}, "start"),
        ({"excitation": "free"}, "excitation"),
        ({"sample_rate": 5000.0}, "sample_rate"),
        ({"sample_rate": 30720.0}, "sample_rate"),
        ({"sample_rate": 0.0}, "sample_rate"),
    ],
)
def test_wrong_options(options: dict[str, object], place: str) -> None:
    with pytest.raises(InputError, match=place):
        simulation(**options)


def test_no_samples() -> None:
    with pytest.raises(InputError, match="at least 1"):
        simulation(start="zero").advance(0, RATED)


def test_steps_per_sample() -> None:
    def steps(rate: float, **numerics: object) -> int:
        changed = with_values({f"numerics.{name}": value for name, value in numerics.items()}, CONFIGURATION)
        return steps_per_sample(changed.numerics, rate)

    assert steps(5120.0) == 4
    assert steps(20480.0) == 1
    assert steps(40960.0) == 1
    assert steps(5120.0, integrator="rk4") == 8
    assert steps(5120.0, step=1 / 15360) == 3
    with pytest.raises(InputError, match="sample_rate"):
        steps(40960.0, step=1 / 20480)
