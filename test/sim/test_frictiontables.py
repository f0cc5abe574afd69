"""Friction tables between the speeds of the grid."""

import numpy as np
import pytest

from nw_gear_sim.config import load
from nw_gear_sim.frictiontables import FrictionTables
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.physics.friction import empty_table, fill_table

LAW = Gearbox(load()).laws.friction


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0, 1.0 + 1e-12, 1.01, 2.4, 57.3, 200.0, 431.7])
def test_as_exact_as_stated(share):
    tables, table, exact = FrictionTables(LAW), empty_table(), empty_table()
    tables.fill(share * LAW.fade_speed, table)
    fill_table(LAW, share * LAW.fade_speed, exact)
    largest = np.max(np.abs(exact), axis=(0, 2), keepdims=True)
    assert np.all(np.abs(table - exact) <= 3e-5 * largest)


def test_depends_on_the_speed_alone():
    """So that a simulation that is resumed goes on bit for bit."""
    travelled, fresh = FrictionTables(LAW), FrictionTables(LAW)
    first, second = empty_table(), empty_table()
    for speed in (1.0, 1.7, 0.2, 1.3579):
        travelled.fill(speed, first)
    fresh.fill(1.3579, second)
    assert np.array_equal(first, second)
