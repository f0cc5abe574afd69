"""The reductions keep extremes, means and gaps, whatever the blocks they come in."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nw_gear_monitor.review.decimate import Envelope, Tail, Waterfall, pool


def brute_force(time, values, band):
    """Extremes and means by sorting every sample into the band's bins, one after the other."""
    index = np.floor((time - time[0]) / band.width).astype(int)
    used = sorted(set(index.tolist()))
    groups = [values[index == i] for i in used]
    return (np.array([f(g, axis=0) for g in groups]) for f in (np.min, np.max, np.mean))


@settings(max_examples=30, deadline=None)
@given(
    st.integers(1, 3000),
    st.floats(1e-4, 0.3),
    st.lists(st.integers(1, 700), min_size=1, max_size=20),
    st.integers(0, 2**32 - 1),
)
def test_envelope_is_exact_for_any_blocks_and_any_length(size, step, blocks, seed):
    values = np.random.default_rng(seed).normal(size=(size, 2))
    time = 1.7e9 + step * np.arange(size)
    envelope = Envelope(("a", "b"), bins=64)
    begin, turn = 0, 0
    while begin < size:
        end = begin + blocks[turn % len(blocks)]
        envelope.add(time[begin:end], values[begin:end])
        begin, turn = end, turn + 1
    band = envelope.result()
    assert len(band.time) <= 64
    low, high, mean = brute_force(time, values, band)
    assert np.array_equal(band.low, low)
    assert np.array_equal(band.high, high)
    assert np.allclose(band.mean, mean, rtol=0, atol=1e-12)
    assert np.all(np.diff(band.time) > 0)


def test_one_sample_in_a_million_is_still_seen():
    envelope = Envelope(("x",))
    for block in range(1000):
        values = np.zeros((1000, 1))
        if block == 617:
            values[333] = 42.0
        envelope.add(block + np.arange(1000) / 1000.0, values)
    band = envelope.result()
    assert band.high.max() == 42.0
    assert abs(band.time[band.high[:, 0].argmax()] - 617.333) <= band.width


def test_a_gap_is_broken_and_nothing_else():
    envelope = Envelope(("x",))
    time = np.concatenate([np.arange(0.0, 10.0, 0.01), np.arange(12.0, 20.0, 0.01)])
    envelope.add(time, np.ones((len(time), 1)))
    broken = envelope.result().with_breaks(0.1)
    holes = np.flatnonzero(np.isnan(broken.low[:, 0]))
    assert len(holes) == 1
    assert 10.0 < broken.time[holes[0]] < 12.0


def test_nothing_gives_nothing():
    assert Envelope(("x",)).result() is None
    assert Tail(1.0).result() is None
    assert Waterfall().result() is None
    envelope = Envelope(("x",))
    envelope.add(np.array([1.0]), np.array([[np.nan]]))
    assert envelope.result() is None


def test_tail_keeps_exactly_the_last_seconds():
    tail = Tail(2.0)
    for block in range(100):
        time = 0.05 * block + np.arange(10) * 0.005
        tail.add(np.column_stack([time, time**2]))
    rows = tail.result()
    assert rows[-1, 0] == pytest.approx(4.995)
    assert rows[0, 0] == pytest.approx(2.995)
    assert np.allclose(np.diff(rows[:, 0]), 0.005)


def test_waterfall_keeps_maxima_when_rows_are_merged():
    waterfall = Waterfall(rows=8)
    for second in range(100):
        spectrum = np.zeros(5)
        spectrum[2] = float(second == 37)
        waterfall.add(float(second), spectrum)
    times, rows = waterfall.result()
    assert len(times) <= 9
    assert rows[:, 2].max() == 1.0
    at = int(rows[:, 2].argmax())
    assert times[at] <= 37 < (times[at + 1] if at + 1 < len(times) else 100)


def test_pool_takes_the_maximum_of_neighbours():
    assert pool(np.array([1.0, 5.0, 2.0, 3.0, 4.0]), 2).tolist() == [5.0, 3.0, 4.0]
    assert pool(np.array([1.0, 2.0]), 1).tolist() == [1.0, 2.0]
