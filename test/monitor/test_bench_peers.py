"""The benchmark of the chaos indicators: the same tasks as the peers, and nothing made up where there is none."""

import numpy as np
import pytest

from nw_gear_common.bench import _merge
from nw_gear_monitor import bench_peers
from test.monitor.chaotic import peer


def test_the_signal_is_lorenz():
    """Mean of x 0 by symmetry; <x^2> = <x y> = 8/3 <z> with <z> = 23.55, so that the standard deviation is 7.92."""
    x = bench_peers.lorenz(16384)
    assert abs(np.mean(x)) < 1.5
    assert np.std(x) == pytest.approx(7.92, rel=0.02)
    assert np.max(np.abs(np.diff(x, 4))) < 0.05  # smooth: a flow, not a map


def test_same_task_as_nolds():
    peer()  # its import warns
    task = bench_peers.tasks(1200, 1200)[0]
    entry = bench_peers._entry(task, 1)
    assert entry["peers"]["nolds"]["difference"] < 1e-9
    assert entry["peers"]["nolds"]["ratio"] > 1.0
    assert entry["peer"] in ("neurokit2", "nolds")
    assert entry["ratio"] == entry["peers"][entry["peer"]]["ratio"]


def test_a_peer_that_is_missing_leaves_null():
    task = bench_peers.Task("rms", lambda x: float(np.std(x)), 100, {"a_package_nobody_has": lambda p, x: 1.0})
    entry = bench_peers._entry(task, 1)
    assert entry["peers"] == {}
    assert entry["peer"] is None
    assert entry["ratio"] is None
    assert entry["milliseconds"] > 0.0


def test_a_peer_that_needs_more_memory_than_there_is_is_left_out():
    x = np.broadcast_to(0.0, 10**8)
    assert bench_peers._peer("nolds", lambda p, x: 1.0, x, 1) is None


def test_parts_share_tables():
    values = {"indicators": {"rms": 1}, "machine": "here"}
    _merge(values, {"indicators": {"exponent": 2}, "step": 3})
    assert values == {"indicators": {"rms": 1, "exponent": 2}, "machine": "here", "step": 3}
