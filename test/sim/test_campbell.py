"""The Campbell diagram: orders by hand, crossings found again, lines that don't move where nothing changes."""

import math

import numpy as np
import pytest

from nw_gear_sim.campbell import Campbell, as_object, find_campbell, wind_torque
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.excitations import orders
from nw_gear_sim.linear import linearise, lowest_modes
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE, WITHOUT_FRICTION, make


@pytest.fixture(scope="module")
def diagram() -> Campbell:
    course = wind_torque(RATED_TORQUE, RATED_SPEED)
    speeds = np.linspace(0.9, 1.3, 9) * RATED_SPEED
    return find_campbell(make(*WITHOUT_FRICTION), course, rated=RATED_SPEED, speeds=speeds, count=32)


def test_orders_by_hand() -> None:
    """At 17.3 r/min: mesh frequencies from the teeth, 26.2383, 98.9901, 324.192 Hz; shafts; 100 segments."""
    found = {order.name: order.ratio * 17.3 / 60 for order in orders(make().kinematics)}
    assert found["mesh I"] == pytest.approx(91 * 17.3 / 60)
    assert [found[f"mesh {s}"] for s in ("I", "II", "III")] == pytest.approx([26.2383, 98.9901, 324.192], rel=1e-5)
    assert found["mesh II, 2nd"] == 2 * found["mesh II"]
    assert found["mesh III, 3rd"] == pytest.approx(3 * 324.192, rel=1e-5)
    shafts = [found[f"shaft {s}"] * 60 for s in ("ring", "planet", "sun", "output")]
    assert shafts == pytest.approx([17.3, 71.559, 148.485, 972.58], rel=1e-4)
    assert found["planets pass the ring"] == pytest.approx(3 * 17.3 / 60)
    assert found["ring segments (numerical)"] == pytest.approx(28.833, rel=1e-4)
    assert found["rollers of pb1, pb2"] == pytest.approx(28 * 0.44 * 71.559 / 60, rel=1e-4)
    assert found["rollers of b21, b22"] == pytest.approx(20 * 0.42 * 972.58 / 60, rel=1e-4)


def test_wind_torque() -> None:
    """Paper Eq 2: half of the speed, a quarter of the torque; rated above."""
    course = wind_torque(RATED_TORQUE, RATED_SPEED)
    factors = [course(f * RATED_SPEED) / RATED_TORQUE for f in (0.0, 0.5, 1.0, 1.3)]
    assert factors == pytest.approx([0.0, 0.25, 1.0, 1.0])


def test_lines_are_level_where_nothing_changes(diagram: Campbell) -> None:
    """Without friction and under the same torque the speed does nothing to a gearbox without gyroscopic terms."""
    above = diagram.speed >= RATED_SPEED * (1 - 1e-9)
    assert above.sum() >= 6
    flat = diagram.frequencies_hz[above]
    assert np.max(np.abs(flat / flat[0] - 1)) < 1e-6
    below = diagram.frequencies_hz[0] / flat[0] - 1
    assert np.all(below < 1e-3)  # less load, softer bearings
    assert below.min() < -0.005
    assert np.all(np.diff(flat[0]) >= 0)


def test_crossings_are_resonances(diagram: Campbell) -> None:
    """Solved anew at the speed of a crossing, a mode has the frequency of the order."""
    gearbox = make(*WITHOUT_FRICTION)
    ratio = {order.name: order.ratio for order in diagram.orders}
    assert len(diagram.crossings) > 5
    for crossing in diagram.crossings[::6]:
        torque = wind_torque(RATED_TORQUE, RATED_SPEED)(crossing.speed)
        q = find_equilibrium(gearbox, torque, speed=crossing.speed).q
        frequencies = lowest_modes(linearise(gearbox, q), 32).frequencies_hz
        assert crossing.frequency_hz == pytest.approx(ratio[crossing.order] * crossing.speed / (2 * math.pi))
        assert np.min(np.abs(frequencies / crossing.frequency_hz - 1)) < 1e-3


def test_every_crossing_is_found(diagram: Campbell) -> None:
    """A line that is below an order at one end and above at the other crosses it an odd number of times."""
    for order in diagram.orders:
        side = diagram.frequencies_hz > (order.ratio * diagram.speed / (2 * math.pi))[:, None]
        for m in range(side.shape[1]):
            count = sum(c.mode == m + 1 and c.order == order.name for c in diagram.crossings)
            assert count % 2 == int(side[0, m] != side[-1, m])


def test_margins_by_hand(diagram: Campbell) -> None:
    """Mode 8 at 100.2 Hz is 1.2 % above the mesh frequency of stage II, 98.99 Hz."""
    (row,) = [row for row in diagram.margins if row.mode == 8 and row.order == "mesh II"]
    assert row.excitation_hz == pytest.approx(98.9901, rel=1e-5)
    assert row.margin == pytest.approx(row.frequency_hz / 98.9901 - 1, rel=1e-4)
    assert 0.01 < row.margin < 0.014
    assert all(abs(row.margin) <= diagram.separation for row in diagram.margins)
    expected = sum(
        abs(f / (o.ratio * RATED_SPEED / (2 * math.pi)) - 1) <= 0.1
        for o in diagram.orders for f in diagram.frequencies_hz[np.searchsorted(diagram.speed, RATED_SPEED)]
    )  # fmt: skip
    assert len(diagram.margins) == expected


def test_shares_say_who_can_excite(diagram: Campbell) -> None:
    """A share of strain energy for mesh orders, none for the others; the three stages are at most the whole."""
    assert np.all(diagram.strain >= 0)
    assert np.all(diagram.strain.sum(axis=1) <= 1)
    for crossing in diagram.crossings:
        assert math.isfinite(crossing.share) == crossing.order.startswith("mesh")


def test_the_object_is_plain_json(diagram: Campbell) -> None:
    import json

    read = json.loads(json.dumps(as_object(diagram), allow_nan=False))
    assert len(read["modes"]) == 32
    assert len(read["modes"][0]["frequencies_hz"]) == len(read["speed"])
