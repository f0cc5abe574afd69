"""Integrators on the gearbox: agreement with the classical method at a small step, bounds, checkpoints."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.linear import find_modes
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import INTEGRATORS, Divergence, Simulation
from test.sim.gearboxes import RATED_SPEED as W
from test.sim.gearboxes import RATED_TORQUE as T

BASE = load()
STEADY = (Drive(W, W, T, T),)
TENTH = (Drive(W, W, 0.1 * T, 0.1 * T),)
WIND = (Drive(0.8 * W, 0.84 * W, 0.6 * T, 0.7 * T), Drive(0.84 * W, 0.8 * W, 0.7 * T, 0.62 * T))
JUMP = (Drive(W, W, 0.5 * T, 0.5 * T), Drive(W, W, T, T))


def simulate(drives: tuple[Drive, ...], **numerics: Any) -> Array:
    """Return x_n (um) from 2 ms on, of 80 samples for each drive."""
    configuration = with_values({f"numerics.{name}": value for name, value in numerics.items()}, BASE)
    run = Simulation(configuration, drives[0])
    return np.concatenate([run.advance(80, drive).x for drive in drives])[10:] * 1e6


@cache
def exact(drives: tuple[Drive, ...]) -> Array:
    return simulate(drives, integrator="rk4", step=1 / 409600)


@pytest.mark.parametrize(
    ("drives", "integrator", "step", "bound"),
    [
        (STEADY, "gautschi", 1 / 40960, 0.05),
        (STEADY, "gautschi", 1 / 20480, 0.05),
        (STEADY, "gautschi", 1 / 15360, 0.05),
        (STEADY, "etdrk4", 1 / 20480, 0.005),
        (TENTH, "gautschi", 1 / 20480, 0.04),
        (WIND, "gautschi", 1 / 20480, 0.04),
        (WIND, "etdrk4", 1 / 20480, 0.005),
        (JUMP, "gautschi", 1 / 40960, 0.6),
        (JUMP, "etdrk4", 1 / 20480, 0.03),
    ],
)
def test_agrees_with_the_classical_method(
    drives: tuple[Drive, ...], integrator: str, step: float, bound: float
) -> None:
    """Within `bound` um of all seven elongations, from 2 ms on."""
    assert np.max(np.abs(simulate(drives, integrator=integrator, step=step) - exact(drives))) < bound


def test_a_jump_of_the_torque_costs_no_order() -> None:
    errors = [np.max(np.abs(simulate(JUMP, step=1 / rate) - exact(JUMP))) for rate in (20480, 40960)]
    assert errors[0] / errors[1] > 3.0


def test_the_bound_of_the_classical_method_is_that_of_all_eigenvalues() -> None:
    """The bound found from the fastest eigenvalues against that from the dense eigenproblem, at the softer meshes."""
    gearbox = Gearbox(BASE)
    q = find_equilibrium(gearbox, T, speed=W).q
    bound = find_modes(gearbox, q).largest_stable_step
    assert bound == pytest.approx(2.79e-5, rel=0.01)
    numbers = [refused(integrator="rk4", step=step) for step in (0.99 * bound, 1.02 * bound)]
    assert numbers[0] is None
    assert numbers[1] == pytest.approx(bound, rel=0.01)


def refused(**numerics: Any) -> float | None:
    """Return the bound named when the step is refused, None when it is accepted."""
    configuration = with_values({f"numerics.{name}": value for name, value in numerics.items()}, BASE)
    try:
        Simulation(configuration, STEADY[0], sample_rate=1 / (2 * numerics["step"]))
    except InputError as error:
        if error.place != "numerics.step":
            raise
        return float(error.expected.split()[2])
    return None


@pytest.mark.parametrize(("integrator", "beyond"), [("gautschi", 1.3), ("etdrk4", 1.5)])
def test_the_bound_divides_steps_that_stay_from_steps_that_grow(
    integrator: str, beyond: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    bound = refused(integrator=integrator, step=4e-4)
    assert bound is not None
    monkeypatch.setattr("nw_gear_sim.simulation.check_step", lambda *arguments: None)
    for share, grows in (
        (0.97, False),
        (beyond, True),
    ):  # meshes are at their stiffest one after the other, not at once
        step = share * bound
        configuration = with_values({"numerics.integrator": integrator, "numerics.step": step}, BASE)
        run = Simulation(configuration, STEADY[0], sample_rate=1 / step)
        try:
            x = run.advance(round(0.2 / step), STEADY[0]).x
            swing = float(np.max(np.abs(x[-100:, 6] - x[-100:, 6].mean())))
        except Divergence:
            swing = math.inf
        assert (swing > 20e-6) == grows


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_resumes_bit_for_bit(integrator: str) -> None:
    configuration = with_values({"numerics.integrator": integrator, "numerics.step": 1 / 40960}, BASE)
    whole = Simulation(configuration, WIND[0])
    first = whole.advance(40, WIND[0])
    saved = {
        name: np.copy(value) if isinstance(value, np.ndarray) else value for name, value in whole.checkpoint().items()
    }
    expected = whole.advance(40, WIND[1])
    later = Simulation.resume(configuration, saved)
    assert later.time == 40 / 5120
    found = later.advance(40, WIND[1])
    for name in ("time", "phase", "x", "v", "force", "bearing_force", "shaft_angle", "shaft_speed", "shaft_torque"):
        assert np.array_equal(getattr(found, name), getattr(expected, name)), name
    assert not np.array_equal(first.x, found.x)


def test_a_checkpoint_of_something_else_is_refused() -> None:
    run = Simulation(BASE, STEADY[0])
    with pytest.raises(InputError, match="checkpoint: integrator"):
        Simulation.resume(with_values({"numerics.integrator": "etdrk4"}, BASE), run.checkpoint())
    with pytest.raises(InputError, match="checkpoint: step"):
        Simulation.resume(with_values({"numerics.step": 1 / 40960}, BASE), run.checkpoint())


def test_a_ring_that_moves_as_one_runs() -> None:
    """The rigid ring's elongations are near those of the flexible one, but not the same."""
    rigid = simulate(STEADY, ring="rigid")
    flexible = exact(STEADY)
    assert np.max(np.abs(rigid.mean(axis=0) / flexible.mean(axis=0) - 1)) < 0.15
    assert np.max(np.abs(rigid - flexible)) > 1.0
