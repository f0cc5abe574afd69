"""What the live page keeps: the newest rows, exact extremes, nothing that grows."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.dashboard.buffers import Bins, Ring, zigzag
from nw_gear_monitor.dashboard.feed import NODES, Feed
from nw_gear_monitor.dashboard.presence import LIVE, STALE, WAITING, Register
from nw_gear_monitor.dashboard.states import MOST_SPANS
from nw_gear_monitor.dashboard.waves import BINS
from test.monitor.gear_signal import blocks, waveform


@given(st.lists(st.integers(0, 12), max_size=20), st.integers(1, 9), st.integers(0, 60))
def test_a_ring_keeps_the_newest_rows_and_gives_each_reader_what_it_has_not_seen(sizes, capacity, seen):
    ring, everything = Ring(2, capacity), np.empty((0, 2))
    for size in sizes:
        rows = np.column_stack([np.arange(len(everything), len(everything) + size)] * 2).astype(float)
        ring.add(rows)
        everything = np.vstack([everything, rows])
    assert ring.count == len(everything)
    assert np.array_equal(ring.everything(), everything[-capacity:])
    unseen = everything[max(seen, len(everything) - capacity) :] if seen < len(everything) else everything[:0]
    assert np.array_equal(ring.since(seen), unseen)


@settings(max_examples=60)
@given(st.lists(st.integers(1, 40), min_size=1, max_size=30), st.floats(0.01, 0.9), st.integers(0, 2**31))
def test_extremes_of_a_bin_are_those_of_its_samples_however_they_came_in_blocks(sizes, width, seed):
    random = np.random.default_rng(seed)
    n = sum(sizes)
    time = 5.0 + np.cumsum(random.uniform(0.001, 0.2, n))
    values = random.normal(size=(n, 2))
    bins, found, at = Bins(2, width, 5.0), [], 0
    for size in sizes:
        found.append(bins.add(time[at : at + size], values[at : at + size]))
        at += size
    rows = np.vstack(found)
    index = np.floor((time - 5.0) / width).astype(int)
    over = np.unique(index)[:-1]  # the last one may still grow
    assert np.allclose(rows[:, 0], 5.0 + (over + 0.5) * width)
    for row, k in zip(rows, over, strict=True):
        mine = values[index == k]
        assert np.array_equal(row[1:3], mine.min(axis=0))
        assert np.array_equal(row[3:5], mine.max(axis=0))
        assert np.allclose(row[5:7], mine.mean(axis=0))


def test_a_line_goes_through_both_extremes_and_is_broken_at_a_gap():
    bins = np.array([[0.5, -1.0, 2.0, 0.0], [1.5, -3.0, 4.0, 0.0], [5.5, 0.0, 1.0, 0.5]])
    points = zigzag(bins, 1, 1.0, 1.5)
    assert points[:4].tolist() == [[0.25, -1.0], [0.75, 2.0], [1.25, -3.0], [1.75, 4.0]]
    assert np.isnan(points[4, 1])
    assert 1.75 < points[4, 0] < 5.25
    assert np.isnan(zigzag(bins[2:], 1, 1.0, 1.5, before=1.5)[0, 1])
    assert not np.isnan(zigzag(bins[1:2], 1, 1.0, 1.5, before=0.5)).any()


def fed(table, history=4.0, rows=999):
    feed = Feed(history, 3.0)
    for block in blocks(table, rows):
        feed.add_waveform(block, 0.0)
    return feed


def test_thirteen_channels_show_the_extremes_of_the_last_seconds_and_no_more():
    table = waveform(9.0)
    feed = fed(table)
    assert len(feed.waves.channels) == 13
    lines = feed.waves.lines.everything()
    assert len(lines) <= 2 * BINS
    assert lines[-1, 0] - lines[0, 0] == pytest.approx(4.0, abs=0.02)
    inside = (table.column("time") > lines[0, 0] + 0.01) & (table.column("time") < lines[-1, 0] - 0.01)
    for k, channel in enumerate(feed.waves.channels, start=1):
        if channel in names.MESHES:
            values = table.column(f"x_{channel}")[inside]
        else:
            values = np.hypot(table.column(f"fx_{channel}"), table.column(f"fy_{channel}"))[inside]
        assert lines[:, k].max() >= values.max()
        assert lines[:, k].min() <= values.min()


def test_memory_is_that_of_the_first_seconds_for_ever():
    feed, table = fed(waveform(5.0)), waveform(5.0)
    sizes = []
    for k in range(1, 4):
        moved = table.data.copy()
        moved[:, 0] += 5.0 * k
        for block in blocks(Table(table.row, table.columns, moved)):
            feed.add_waveform(block, 0.0)
        tail = feed.waves.reduced().tail.data
        sizes.append((len(feed.waves.lines), len(feed.waves.reduced().displacement.time), len(tail)))
    assert sizes[0] == sizes[1] == sizes[2]
    for k in range(3 * MOST_SPANS):
        state = names.CHAOTIC if k % 2 else names.PERIODS[0]
        feed.add_status("gear_monitor_node: stage I", 0, f"{state}: why", {"state": state}, 0.0)
        feed.add_status(f"node{k}: task", 0, "", {}, 0.0)
        feed.answer("this", True, "yes")
    assert len(feed.states.spans["stage I"]) == MOST_SPANS
    assert len(feed.states.latest) <= 128
    assert len(feed.answers) <= 10
    assert len(feed.nodes.everyone(0.0)) <= 64


def test_a_run_that_begins_anew_replaces_the_one_before():
    feed = fed(waveform(3.0))
    feed.add_operation(2.9, 1.3, 2e6)
    feed.add_wind(3.5, 11.0)
    epoch = feed.epoch
    for block in blocks(waveform(1.0)):
        feed.add_waveform(block, 0.0)
    assert feed.epoch == epoch + 1
    assert feed.waves.lines.everything()[:, 0].max() < 1.0
    assert feed.last < 1.0
    feed.add_wind(0.1, 9.0)
    assert feed.wind.last.tolist() == [0.1, 9.0]


def test_a_block_that_came_twice_is_shown_once_and_other_machines_are_named():
    table = waveform(2.0)
    feed = fed(table)
    count = feed.waves.lines.count
    feed.add_waveform(blocks(table)[-1], 0.0)
    assert feed.waves.lines.count == count
    foreign = Table("sample", ("time", "x_1"), np.array([[0.0, 1.0], [0.1, 1.0]]))
    feed.add_waveform(foreign, 0.0)
    assert feed.waves.foreign == "phase_I"


def test_who_goes_quiet_is_stale_until_heard_again():
    register = Register(NODES, stale_after=3.0)
    assert {part.state for part in register.everyone(0.0)} == {WAITING}
    register.heard("gear_sim_node", 10.0)
    assert register.look("gear_sim_node", 12.9).state == LIVE
    quiet = register.look("gear_sim_node", 14.0)
    assert (quiet.state, quiet.silent) == (STALE, 4.0)
    register.heard("gear_sim_node", 15.0)
    assert register.look("gear_sim_node", 15.1).state == LIVE
