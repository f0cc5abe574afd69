"""Rolling bearings against the sum over rollers, roller by roller."""

import math

import numpy as np
import pytest

from nw_gear_common.tables import Array
from nw_gear_sim.physics.bearing import Bearing, add_bearings, bearing_forces, bearing_law, power, quick_power

INNER = Bearing(0, 1, 2, 28, 4.82e9, math.radians(12), 50e-6, 1e5, 0.44)
PLAIN = Bearing(3, 4, -1, 20, 3.51e9, 0.0, 30e-6, 5e4, 0.42)


def run(bearings: list[Bearing], q: Array, cage: float, exponent: float = 10 / 9) -> Array:
    law = bearing_law(bearings, exponent)
    housing = np.zeros((len(bearings), 3))
    turn = np.tile([math.cos(cage), math.sin(cage)], (len(bearings), 1))
    bearing_forces(law, False, turn, q, *np.zeros((2, law.start[-1])), housing)
    return housing


def roller_by_roller(bearing: Bearing, x: float, y: float, z: float, cage: float, exponent: float) -> Array:
    total = np.zeros(3)
    for i in range(bearing.rollers):
        angle = cage + 2 * math.pi * i / bearing.rollers
        direction = np.array([
            math.cos(angle) * math.cos(bearing.contact_angle),
            math.sin(angle) * math.cos(bearing.contact_angle),
            math.sin(bearing.contact_angle),
        ])  # fmt: skip
        compression = direction @ [x, y, z] - bearing.clearance
        if compression > 0:
            total += bearing.stiffness * compression**exponent * direction
    return total


@pytest.mark.parametrize("exponent", [1.0, 10 / 9, 1.5, 2.0])
def test_power(exponent: float) -> None:
    values = 10 ** np.random.default_rng(1).uniform(-12, 1, 20_000)
    raised = values.copy()
    law = bearing_law([INNER], exponent)
    power(law.scale, law.polynomial, raised)
    assert raised == pytest.approx(values**exponent, rel=1e-10)
    quick = values.copy()
    quick_power(law.scale, law.quick, quick)
    assert quick == pytest.approx(values**exponent, rel=1e-7)


def test_power_of_nothing_is_nothing() -> None:
    law = bearing_law([INNER], 10 / 9)
    values = np.array([0.0, 5e-324, 1e-30])
    power(law.scale, law.polynomial, values)
    assert values.tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("rollers", [28, 29])
@pytest.mark.parametrize("axial", [30e-6, 600e-6])
@pytest.mark.parametrize("exponent", [10 / 9, 1.5])
@pytest.mark.parametrize("cage", [0.0, 0.37, -12.9])
def test_forces_roller_by_roller(cage: float, exponent: float, axial: float, rollers: int) -> None:
    """In pairs and odd numbers, and pressed together so much that all rollers carry."""
    inner = INNER._replace(rollers=rollers)
    q = np.array([120e-6, -80e-6, axial, -45e-6, 60e-6])
    housing = run([inner, PLAIN], q, cage, exponent)
    assert housing[0] == pytest.approx(roller_by_roller(inner, *q[:3], cage, exponent), rel=1e-9)
    assert housing[1] == pytest.approx(roller_by_roller(PLAIN, q[3], q[4], 0.0, cage, exponent), rel=1e-9, abs=1e-6)
    assert housing[1, 2] == 0.0


def test_nothing_inside_the_clearance() -> None:
    assert np.all(run([INNER, PLAIN], np.array([20e-6, 20e-6, 0.0, 20e-6, 0.0]), 0.1) == 0.0)


def test_stiffness_varies_while_the_cage_turns() -> None:
    """The force repeats after one roller's pitch, and differs in between."""
    q = np.array([0.0, -100e-6, 0.0, 0.0, 0.0])
    pitch = 2 * math.pi / INNER.rollers
    start, middle, end = (run([INNER, PLAIN], q, k * pitch)[0, 1] for k in (0.0, 0.5, 1.0))
    assert end == pytest.approx(start, rel=1e-9)
    assert abs(middle / start - 1) > 1e-4


def test_opposed_bearings_hold_the_shaft_axially() -> None:
    """At contact angles of +g and -g a shift in z raises one load and lowers the other."""
    other = INNER._replace(x=3, y=4, z=5, contact_angle=-INNER.contact_angle)
    centred = run([INNER, other], np.array([0.0, -150e-6, 0.0] * 2), 0.0)
    shifted = run([INNER, other], np.array([0.0, -150e-6, 40e-6] * 2), 0.0)
    assert centred[:, 2].sum() == pytest.approx(0, abs=1e-6 * abs(centred[0, 2]))
    assert shifted[:, 2].sum() > 0.1 * centred[0, 2]


def test_reactions_on_the_moving_rings() -> None:
    law = bearing_law([INNER, PLAIN], 10 / 9)
    force = np.zeros(5)
    housing = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    add_bearings(law, housing, np.array([1e-3, 0.0, 0.0, 0.0, 2e-3]), force)
    assert force == pytest.approx([-101.0, -2.0, -3.0, -4.0, -105.0])
