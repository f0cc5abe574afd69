"""Orders of bearings against published figures and the simulator's kinematics."""

import math

import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.bearing_orders import from_cage, from_geometry, of_gearbox
from nw_gear_sim import config
from nw_gear_sim.kinematics import SHAFT_OF_BEARING, derive

INCH = 0.0254


@pytest.mark.parametrize(
    ("roller", "pitch", "inner", "outer", "cage", "knocks"),
    [
        (0.3126, 1.537, 5.4152, 3.5848, 0.39828, 4.7135),  # SKF 6205-2RS JEM, 9 balls
        (0.2656, 1.122, 4.9469, 3.0530, 0.3817, 3.9874),  # SKF 6203-2RS JEM, 8 balls
    ],
)
def test_published_orders(roller, pitch, inner, outer, cage, knocks):
    """Case Western Reserve University Bearing Data Center, bearing information (rolling element: two knocks)."""
    found = from_geometry(9 if pitch > 1.5 else 8, roller * INCH, pitch * INCH)
    assert found.inner == pytest.approx(inner, abs=1e-3)
    assert found.outer == pytest.approx(outer, abs=1e-3)
    assert found.cage == pytest.approx(cage, abs=1e-3)
    assert found.lines()["roller"] == pytest.approx(knocks, rel=2e-3)


def test_identities():
    found = from_geometry(17, 0.012, 0.071, math.radians(15))
    assert found.outer + found.inner == pytest.approx(17)
    assert found.outer == pytest.approx(17 * found.cage)
    # A roller rolls on the outer race without slip, seen from the cage.
    g = 0.012 / 0.071 * math.cos(math.radians(15))
    assert found.roller == pytest.approx(found.cage * 0.071 * (1 + g) / 0.012)


def test_cage_alone():
    known, cage = from_geometry(9, 0.3126, 1.537), from_cage(9, 0.5 * (1 - 0.3126 / 1.537))
    assert (cage.outer, cage.inner, cage.roller) == (known.outer, known.inner, None)
    assert "roller" not in cage.lines()


def test_the_simulator_passes_its_rollers_at_the_outer_order():
    configuration = config.load(None)
    derived = derive(configuration)
    orders = of_gearbox(configuration)
    assert set(orders) == set(SHAFT_OF_BEARING)
    for kind, shaft in SHAFT_OF_BEARING.items():
        speed = derived.shaft_ratio[shaft]
        assert orders[kind].outer * speed == pytest.approx(derived.roller_pass_ratio[kind])
        assert orders[kind].cage * speed == pytest.approx(derived.cage_ratio[kind])
        assert orders[kind].inner > orders[kind].outer


@pytest.mark.parametrize(
    ("call", "place"),
    [
        (lambda: from_cage(2, 0.4), "rollers"),
        (lambda: from_cage(9.5, 0.4), "rollers"),
        (lambda: from_cage(9, 1.0), "cage_factor"),
        (lambda: from_cage(9, math.nan), "cage_factor"),
        (lambda: from_geometry(9, 0.0, 1.0), "roller_diameter"),
        (lambda: from_geometry(9, 1.0, 1.0), "roller_diameter"),
        (lambda: from_geometry(9, 0.1, math.inf), "pitch_diameter"),
        (lambda: from_geometry(9, 0.1, 1.0, 1.6), "contact_angle"),
        (lambda: from_geometry(9, 0.1, 1.0, math.nan), "contact_angle"),
    ],
)
def test_bad_input_is_refused(call, place):
    with pytest.raises(InputError) as caught:
        call()
    assert caught.value.place == place
