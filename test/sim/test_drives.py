"""Sources of the drive: files that change within a tick, load cases beside the configured operating point."""

import math
from dataclasses import replace

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.drivefile import DriveSeries
from nw_gear_sim.drives import FixedPoint, Recorded, Source
from nw_gear_sim.loadcase import LoadCase
from nw_gear_sim.nodes.session import Session
from nw_gear_sim.readings import Block, joined
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE

CONFIGURATION = load("rated")


def run(source: Source, ticks: int) -> tuple[Session, list[Block]]:
    session = Session(CONFIGURATION, source, "kinematic", "equilibrium", 5120.0)
    session.begin({})
    return session, [session.advance({}) for _ in range(ticks)]


def test_a_file_that_changes_faster_than_the_ticks() -> None:
    """Speed and torque swing once a tick: whoever looks at its ends alone sees their largest values all the time."""
    times = np.arange(0.0, 1.0, 1.0 / 1280.0)
    swing = 1.0 + 0.1 * np.cos(2.0 * math.pi * 80.0 * times)
    series = DriveSeries(times, RATED_SPEED * swing, RATED_TORQUE * swing, "a file")
    session, blocks = run(Recorded(series, hold=True), 40)
    assert session.tick == pytest.approx(1.0 / 80.0)
    assert {len(block.time) for block in blocks} == {64}
    time, phase = (np.concatenate([getattr(block, name) for block in blocks]) for name in ("time", "phase"))
    assert np.diff(time) == pytest.approx(1.0 / 5120.0, rel=1e-9)
    turned = phase[64 * 32, 0] - phase[0, 0]
    assert turned == pytest.approx(91 * RATED_SPEED * time[64 * 32], rel=1e-3)
    torque = np.mean([block.shaft_torque[:, 0] for block in blocks])
    assert torque == pytest.approx(RATED_TORQUE, rel=1e-3)


class Parted(FixedPoint):
    """A fixed point that asks for a seventh of a tick at a time."""

    longest = 0.0125 / 7


def test_a_parted_tick_gives_what_a_whole_one_gives() -> None:
    (_, whole), (_, parted) = run(FixedPoint(CONFIGURATION), 4), run(Parted(CONFIGURATION), 4)
    for one, other in zip(whole, parted, strict=True):
        for name in ("time", "phase", "x", "force", "bearing_force", "shaft_torque"):
            expected: Array = getattr(one, name)
            assert getattr(other, name) == pytest.approx(expected, abs=1e-9 * float(np.max(np.abs(expected))))
        assert np.array_equal(one.open_fraction, other.open_fraction)


def test_shares_of_joined_blocks_go_by_their_length() -> None:
    _, (block, *_) = run(FixedPoint(CONFIGURATION), 1)
    short = replace(
        block,
        **{
            name: getattr(block, name)[:16]
            for name in (
                "time",
                "phase",
                "x",
                "v",
                "force",
                "bearing_force",
                "shaft_angle",
                "shaft_speed",
                "shaft_torque",
            )
        },
        open_fraction=np.ones(7),
        back_fraction=np.full(7, 0.5),
    )
    both = joined([replace(block, open_fraction=np.zeros(7), back_fraction=np.zeros(7)), short])
    assert len(both.time) == len(both.bearing_force) == 80
    assert both.open_fraction == pytest.approx(np.full(7, 0.2))
    assert both.back_fraction == pytest.approx(np.full(7, 0.1))


def test_a_load_case_says_where_it_begins_unless_that_is_the_configured_point() -> None:
    assert LoadCase(CONFIGURATION, "grid_loss", 1.0, windy=False).remarks == ()
    slower = with_values({"operation.load": 0.25}, CONFIGURATION)
    (remark,) = LoadCase(slower, "grid_loss", 1.0, windy=False).remarks
    assert "8.65 r/min and 1.075 MN m instead of the configured 17.30 r/min and 1.075 MN m" in remark
    assert LoadCase(slower, "grid_loss", 1.0, windy=True).remarks == ()


def test_a_load_case_needs_a_turbine_that_turns() -> None:
    idle = with_values({"operation.load": 0.05}, CONFIGURATION)
    with pytest.raises(InputError, match=r"operation\.load: expected at least 0\.0681 for a load case.*got 0\.05"):
        LoadCase(idle, "grid_loss", 1.0, windy=False)
    assert LoadCase(idle, "grid_loss", 1.0, windy=True).phase() == "running"
