"""Blocks to whole seconds: gaps, restarts, bad blocks."""

import numpy as np
import pytest

from nw_gear_common.tables import Table
from nw_gear_monitor.signals.stream import Stream
from test.monitor.gear_signal import blocks, paper, waveform

LAYOUT = paper().layout

WALL = 1.7632e9 + 0.3
"""A stamp near the wall clock, at a fraction of a second; doubles there are 2.4e-7 s apart."""


@pytest.fixture(scope="module")
def four_seconds():
    return waveform(4.0)


def feed(stream, tables):
    return [second for table in tables for second in stream.feed(table)]


def shifted(table, seconds):
    data = table.data.copy()
    data[:, 0] += seconds
    return Table(table.row, table.columns, data)


def test_every_sample_comes_out_once_and_in_whole_seconds(four_seconds):
    stream = Stream(LAYOUT)
    seconds = feed(stream, blocks(four_seconds, 256))
    assert [s.start for s in seconds] == [0, 1, 2, 3]
    assert np.array_equal(np.vstack([s.data for s in seconds]), four_seconds.data)
    assert seconds[0].rate == 5120.0
    assert stream.continuity.gaps == stream.continuity.restarts == stream.continuity.malformed == 0


@pytest.mark.parametrize("rows", [7, 256, 5119, 20480])
def test_the_cut_into_messages_does_not_matter(four_seconds, rows):
    reference = feed(Stream(LAYOUT), blocks(four_seconds, 512))
    seconds = feed(Stream(LAYOUT), blocks(four_seconds, rows))
    assert [s.start for s in seconds] == [s.start for s in reference]
    assert all(np.array_equal(a.data, b.data) for a, b in zip(seconds, reference, strict=True))


def test_stamps_near_the_wall_clock_make_no_gaps(four_seconds):
    stream = Stream(LAYOUT)
    seconds = feed(stream, blocks(shifted(four_seconds, WALL)))
    assert [s.start - int(WALL) for s in seconds] == [1, 2, 3]
    assert stream.continuity.gaps == stream.continuity.restarts == 0
    assert {len(s.data) for s in seconds} <= {5119, 5120, 5121}
    assert seconds[0].rate == 5120.0


def test_fast_samples_near_the_wall_clock_make_no_gaps():
    stream = Stream(LAYOUT)
    table = shifted(waveform(1.8, rate=40960), WALL)
    assert len(feed(stream, blocks(table, 2048))) == 1
    assert stream.continuity.gaps == stream.continuity.restarts == 0
    assert stream.rate == 40960.0


def test_a_lost_block_is_counted_and_not_bridged(four_seconds):
    pieces = blocks(four_seconds)
    del pieces[30]
    stream = Stream(LAYOUT)
    seconds = feed(stream, pieces)
    assert stream.continuity.gaps == 1
    assert stream.continuity.lost_seconds == pytest.approx(0.05, abs=1e-9)
    assert "0.05 s missing" in stream.continuity.last_break
    assert [s.start for s in seconds] == [0, 2, 3]
    assert seconds[0].epoch != seconds[1].epoch == seconds[2].epoch


def test_a_single_lost_sample_inside_a_block_is_a_gap(four_seconds):
    stream = Stream(LAYOUT)
    feed(stream, [Table("sample", four_seconds.columns, np.delete(four_seconds.data, 700, axis=0))])
    assert stream.continuity.gaps == 1
    assert stream.continuity.lost_seconds == pytest.approx(1 / 5120, rel=1e-6)


def test_a_jump_back_in_time_is_a_restart(four_seconds):
    stream = Stream(LAYOUT)
    first = feed(stream, blocks(four_seconds)[:50])
    second = feed(stream, blocks(four_seconds))
    assert stream.continuity.restarts == 1
    assert stream.continuity.gaps == 0
    assert "back" in stream.continuity.last_break
    assert first[-1].epoch < second[0].epoch
    assert [s.start for s in second] == [0, 1, 2, 3]


def test_a_jump_of_the_mesh_phase_is_a_restart(four_seconds):
    data = four_seconds.data.copy()
    data[7000:, 1:4] += 1.0
    stream = Stream(LAYOUT)
    seconds = feed(stream, blocks(Table("sample", four_seconds.columns, data)))
    assert stream.continuity.restarts == 1
    assert "phase" in stream.continuity.last_break
    assert [s.start for s in seconds] == [0, 2, 3]


def test_changed_columns_and_changed_rate_are_restarts(four_seconds):
    stream = Stream(LAYOUT)
    feed(stream, blocks(four_seconds)[:25])
    narrower = Table("sample", four_seconds.columns[:-1], four_seconds.data[25 * 256 :, :-1])
    feed(stream, blocks(narrower))
    assert (stream.continuity.restarts, stream.continuity.gaps) == (1, 0)
    feed(stream, [Table("sample", narrower.columns, shifted(four_seconds, 4.0).data[::2, :-1])])
    assert stream.continuity.restarts == 2
    assert stream.rate == 2560.0


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda t: Table("bin", t.columns, t.data), "row meaning"),
        (lambda t: Table(t.row, (*t.columns[:-1], "x_I_1"), t.data), "a name twice"),
        (lambda t: Table(t.row, ("zeit", *t.columns[1:]), t.data), "none named time"),
        (lambda t: Table(t.row, t.columns, t.data[:1]), "at least 2"),
        (lambda t: Table(t.row, t.columns, np.where(np.arange(t.data.shape[1]) == 5, np.nan, t.data)), "x_I_2"),
    ],
)
def test_a_malformed_block_is_named_and_dropped(four_seconds, spoil, said):
    pieces = blocks(four_seconds)
    stream = Stream(LAYOUT)
    seconds = feed(stream, [*pieces[:10], spoil(pieces[10]), *pieces[10:]])
    assert stream.continuity.malformed == 1
    assert said in stream.continuity.last_malformed
    assert [s.start for s in seconds] == [0, 1, 2, 3]
