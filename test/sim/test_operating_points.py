"""The presets behave as an independent implementation of the same equations did. Slow."""

import numpy as np
import pytest

from nw_gear_common.tables import Array
from nw_gear_sim.config import load
from nw_gear_sim.kinematics import derive
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.readings import Block
from nw_gear_sim.simulation import Simulation
from test.sim.gearboxes import RATED_TORQUE

pytestmark = pytest.mark.slow

UNIT = 45e-6


class Run:
    """A preset, run for `settle` s and then recorded for `seconds` s."""

    def __init__(self, preset: str, settle: float, seconds: float) -> None:
        configuration = load(preset)
        self.kinematics = derive(configuration)
        speed, torque = self.kinematics.ring_speed, self.kinematics.input_torque
        drive = Drive(speed, speed, torque, torque)
        simulation = Simulation(configuration, drive)
        for _ in range(round(20 * settle)):
            simulation.advance(256, drive)
        self.blocks: list[Block] = [simulation.advance(256, drive) for _ in range(round(20 * seconds))]

    def all(self, name: str) -> Array:
        """One field of all blocks."""
        return np.concatenate([getattr(block, name) for block in self.blocks])

    def mean(self, name: str) -> Array:
        """The mean of a fraction."""
        return np.mean([getattr(block, name) for block in self.blocks], axis=0)


@pytest.fixture(scope="module")
def rated() -> Run:
    return Run("rated", 2.0, 8.0)


def test_rated_elongations(rated: Run) -> None:
    x = rated.all("x")
    assert x.mean(axis=0) / UNIT == pytest.approx([3.73, 3.69, 3.57, 2.35, 2.33, 2.27, 3.27], abs=0.015)
    deviation = x.std(axis=0) * 1e6
    assert np.all((deviation[:3] > 20.5) & (deviation[:3] < 22.5))
    assert np.all((deviation[3:6] > 2.0) & (deviation[3:6] < 4.2))
    assert deviation[6] == pytest.approx(0.5, abs=0.1)
    width = np.ptp(x, axis=0) / UNIT
    assert np.all((width[:3] > 1.35) & (width[:3] < 1.6))
    assert np.all((width[3:6] > 0.15) & (width[3:6] < 0.35))
    assert width[6] == pytest.approx(0.06, abs=0.02)


def test_rated_keeps_contact_and_doesnt_drift(rated: Run) -> None:
    assert np.all(rated.mean("open_fraction") == 0.0)
    force = rated.all("force")
    assert np.all(force.min(axis=0) / force.mean(axis=0) > [0.93] * 3 + [0.85] * 3 + [0.97])
    seconds = force.reshape(8, -1, 7).mean(axis=1)
    assert np.max(np.abs(seconds / seconds.mean(axis=0) - 1)) < 1e-3


def test_rated_lines(rated: Run) -> None:
    x = rated.all("x")[:, [0, 3, 6]]
    amplitude = np.abs(np.fft.rfft((x - x.mean(axis=0)) * np.hanning(len(x))[:, None], axis=0))
    frequency = np.fft.rfftfreq(len(x), 1 / 5120)
    strongest = frequency[np.argmax(amplitude, axis=0)]
    assert strongest[0] == pytest.approx(26.24, abs=0.15)
    assert strongest[1] in (pytest.approx(98.99, abs=0.15), pytest.approx(26.24, abs=0.15))
    for line, column in ((52.48, 0), (98.99, 1), (26.24, 1), (324.19, 2), (98.99, 2), (26.24, 2)):
        near = amplitude[np.abs(frequency - line) < 0.3, column].max()
        around = np.median(amplitude[np.abs(frequency - line) < 5, column])
        assert near > 10 * around


def test_efficiency(rated: Run) -> None:
    """Friction takes 0.1 to 1.5 % in each stage; the rest arrives at the generator."""
    power = (rated.all("shaft_torque") * rated.all("shaft_speed")).mean(axis=0)
    power_in = RATED_TORQUE * rated.all("shaft_speed")[:, 0].mean()
    assert 0.985**2 < power[2] / power_in < 0.999**2
    assert 0.985 < power[3] / power[2] < 0.999


def test_rattling() -> None:
    run = Run("rattling", 2.0, 10.0)
    opened = run.mean("open_fraction")
    assert opened[3:6].mean() == pytest.approx(0.42, abs=0.03)
    assert np.all(opened[:3] < opened[3:6].min())


def test_period_two() -> None:
    """Stage II strikes its back flanks and repeats after two periods."""
    run = Run("period2", 16.0, 16.0)
    assert np.all(run.mean("back_fraction")[3:6] > 0.1)
    x = run.all("x")[:, 3]
    amplitude = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(len(x))))
    frequency = np.fft.rfftfreq(len(x), 1 / 5120)
    mesh = run.kinematics.mesh_frequency_hz("II", run.kinematics.ring_speed)

    def line(f: float) -> float:
        return float(amplitude[np.abs(frequency - f) < 0.2].max())

    assert line(mesh / 2) > 0.05 * line(mesh)
    assert line(mesh / 2) > 30 * float(np.median(amplitude[np.abs(frequency - mesh / 2) < 3]))
