"""What bad input on the stream gets: it is named in the status `stream`, and none of it becomes a number."""

import copy

import numpy as np
import pytest

from nw_gear_common import names, share
from nw_gear_common.tables import Table
from nw_gear_monitor import health
from nw_gear_monitor.machinefile.read import load
from nw_gear_monitor.pipeline import Pipeline, Windows
from nw_gear_monitor.signals.stream import Continuity
from test.monitor import foreign

RATE, SECONDS, ROWS = 640, 9, 32
BAD = 45
"""Number of the block that is spoilt, in the third second; windows are 2 s long."""
SHOWN = ("mean", "rms", "peak_to_peak", "kurtosis", "harmonic_1")


@pytest.fixture(scope="module")
def machine():
    return load(share.find("config/machine_example.yaml"))


def made(seconds=SECONDS, rate=RATE):
    """A regular mesh with noise, and noise on the bearing."""
    time = np.arange(seconds * rate) / rate
    angle = 2.0 * np.pi * 5.0 * time
    noise = np.random.default_rng(5).standard_normal((2, time.size))
    return np.column_stack([time, angle, 1e-4 + 1e-5 * np.cos(20.0 * angle) + 1e-7 * noise[0], noise[1]])


def blocks(data, rows=ROWS):
    return [foreign.table(data[i : i + rows]) for i in range(0, len(data), rows)]


def run(machine, tables):
    """Hops, and the status `stream` after the last."""
    pipeline = Pipeline(machine, Windows(spectrum_seconds=2, label_seconds=8))
    hops = [hop for table in tables for hop in pipeline.feed(table)]
    return hops, pipeline.continuity, health.stream_status(pipeline.continuity, Continuity())


def numbers(hop):
    """Everything of a hop that must be the same wherever its window was whole."""
    rows = hop.indicators["mesh"]
    found = {name: float(rows.column(name)[0]) for name in SHOWN}
    found["bearing"] = float(hop.bearing_indicators["front"].column("rms")[0])
    found["line"] = float("nan") if hop.spectrum is None else float(hop.spectrum.column("mesh")[200])
    return found


@pytest.fixture(scope="module")
def clean(machine):
    hops, continuity, status = run(machine, blocks(made()))
    assert (len(hops), status.level, status.message) == (SECONDS, health.OK, "contiguous")
    assert continuity.constant == ()
    return {hop.time: numbers(hop) for hop in hops}


def put(column, value, rows=slice(3, 4)):
    """Spoil some samples of a column."""

    def spoil(tables):
        data = tables[BAD].data.copy()
        data[rows, column] = value
        tables[BAD] = foreign.table(data)

    return spoil


def replace(make):
    """Put another table in the place of the block."""

    def spoil(tables):
        tables[BAD] = make(tables[BAD])

    return spoil


def swap(tables):
    tables[BAD], tables[BAD + 1] = tables[BAD + 1], tables[BAD]


def twice(tables):
    tables.insert(BAD + 1, tables[BAD])


def again_later(tables):
    tables.insert(BAD + 3, tables[BAD])


def back_inside(tables):
    data = tables[BAD].data.copy()
    data[16:, 0] -= 0.03
    tables[BAD] = foreign.table(data)


def from_file(**changes):
    return replace(lambda t: Table(changes.get("row", t.row), changes.get("columns", t.columns), t.data))


@pytest.mark.parametrize(
    ("spoil", "counter", "said"),
    [
        (put(2, np.nan), "malformed", "expected finite numbers, got others in column x_mesh"),
        (put(3, np.inf), "malformed", "column a_front"),
        (put(3, -np.inf), "malformed", "column a_front"),
        (put(1, np.nan), "malformed", "column phase_pinion"),
        (put(0, np.nan), "malformed", "column time"),
        (put(2, 1e200), "malformed", "column x_mesh"),
        (replace(lambda t: foreign.table(t.data[:1])), "malformed", "expected at least 2, got 1"),
        (replace(lambda t: foreign.table(t.data[::-1])), "malformed", "stamps that ascend"),
        (put(0, 2.3, slice(None)), "malformed", "stamps that ascend"),
        (from_file(columns=("time", "phase_pinion", "x", "a_front")), "malformed", "none named x_mesh"),
        (from_file(columns=("time", "phase_pinion", "x_mesh", "x_mesh")), "malformed", "none named a_front"),
        (from_file(row="bin"), "malformed", "row meaning: expected sample, got bin"),
        (replace(lambda t: foreign.table(t.data[::16])), "malformed", "sample rate: expected at least 64 Hz, got 40"),
        (back_inside, "restarts", "time jumped back by 0.03 s"),
        (put(1, 3.0, slice(10, None)), "restarts", "the mesh phase jumped"),
        (lambda tables: tables.pop(BAD), "gaps", "0.05 s missing before 2.3"),
        (swap, "disordered", "a block came after later ones: 2.250 to 2.298 s"),
        (twice, "repeated", "a block came twice: 2.250 to 2.298 s"),
        (again_later, "repeated", "a block came twice: 2.250 to 2.298 s"),
    ],
)
def test_it_is_named_and_no_number_comes_from_it(machine, clean, spoil, counter, said):
    tables = blocks(made())
    spoil(tables)
    hops, continuity, status = run(machine, tables)
    assert getattr(continuity, counter) >= 1
    assert status.level == health.WARN
    assert said in status.message
    for hop in hops:
        for name, value in numbers(hop).items():
            assert np.isnan(value) or value == pytest.approx(clean[hop.time][name], rel=1e-9), (hop.time, name)
    assert len(hops) >= SECONDS - 2
    assert np.isfinite(list(numbers(hops[-1]).values())).all()


@pytest.mark.parametrize("spoil", [twice, again_later])
def test_a_block_that_comes_twice_interrupts_nothing(machine, spoil):
    tables = blocks(made(4))
    spoil(tables)
    hops, continuity, _ = run(machine, tables)
    assert [hop.time for hop in hops] == [1.0, 2.0, 3.0, 4.0]
    assert (continuity.restarts, continuity.gaps, continuity.repeated) == (0, 0, 1)


def test_a_stream_that_begins_anew_a_little_earlier_is_a_restart(machine):
    tables = blocks(made(4))
    hops, continuity, _ = run(machine, [*tables[:32], *tables[22:]])
    assert (continuity.restarts, continuity.gaps) == (1, 0)
    assert "time jumped back to 1.100 s" in continuity.last_break
    assert [hop.time for hop in hops] == [1.0, 3.0, 4.0]
    assert hops[1].restarted


def test_the_order_of_columns_does_not_matter_and_others_are_not_looked_at(machine, clean):
    tables = blocks(made())
    for i, table in enumerate(tables):
        order = np.random.default_rng(i).permutation(4)
        mixed = np.column_stack([table.data[:, order], np.full(len(table), np.nan)])
        tables[i] = Table(table.row, (*(table.columns[k] for k in order), "spare"), mixed)
    hops, _, status = run(machine, tables)
    assert (status.level, status.message) == (health.OK, "contiguous")
    assert all(numbers(hop) == pytest.approx(clean[hop.time], nan_ok=True) for hop in hops)


@pytest.mark.parametrize(("column", "source"), [(2, "x_mesh"), (3, "a_front")])
def test_a_channel_that_does_not_move_is_named_and_gives_no_number(machine, column, source):
    data = made(10)
    data[:, column] = 0.7
    hops, _, status = run(machine, blocks(data))
    assert status.level == health.WARN
    assert status.message == f"constant: {source}"
    assert status.values["constant columns"] == source
    of_mesh, of_bearing = (
        hops[-1].indicators["mesh"].data[0, 1:],
        hops[-1].bearing_indicators["front"].data[0, 1:],
    )
    assert np.isnan(of_mesh).all() == (source == "x_mesh")
    assert np.isnan(of_bearing).all() == (source == "a_front")
    if source == "x_mesh":
        assert hops[-1].stages["pair"].state.label == names.UNKNOWN
        assert "no vibration" in hops[-1].stages["pair"].state.reason


def test_a_changed_rate_is_a_restart_that_tells_both(machine):
    first, second = made(3), made(6, 1280)
    hops, continuity, status = run(machine, [*blocks(first), *blocks(second[3 * 1280 :], 64)])
    assert continuity.restarts == 1
    assert "the sample rate changed from 640 Hz to 1280 Hz" in status.message
    assert [(hop.time, hop.rate) for hop in hops] == [(t, 640.0 if t <= 3.0 else 1280.0) for t in range(1, 7)]
    assert hops[3].restarted


def test_too_short_gives_no_number(machine):
    hops, _, _ = run(machine, blocks(made(1)))
    assert np.isnan(list(numbers(hops[0]).values())).all()
    assert hops[0].stages["pair"].state.label == names.UNKNOWN
    assert "1 of at least 8 s" in hops[0].stages["pair"].state.reason


def test_samples_too_slow_for_a_mesh_give_no_state(machine):
    data = made(9, 160)  # 100 Hz would show at 60 Hz
    hops, _, _ = run(machine, blocks(data, 8))
    assert hops[-1].stages["pair"].state.label == names.UNKNOWN
    assert "160 samples a second are too few" in hops[-1].stages["pair"].state.reason


def test_what_was_told_is_not_told_again(machine):
    tables = blocks(made(3))
    twice(tables)
    _, continuity, _ = run(machine, tables)
    status = health.stream_status(continuity, copy.copy(continuity))
    assert (status.level, status.message) == (health.OK, "contiguous")
    assert status.values["last late"].startswith("a block came twice")


def odd():
    """Displacements that are numbers, but no vibration of a gear."""
    generator = np.random.default_rng(0)
    size = 10 * RATE
    time = np.arange(size) / RATE
    return {
        "a spike": np.where(np.arange(size) == 3000, 1.0, 0.0),
        "rounding": 1e-320 * generator.standard_normal(size),
        "huge": 1e59 * generator.standard_normal(size),
        "a step": np.where(time > 5.0, 1e3, 0.0),
        "drift": time,
        "two values": generator.integers(0, 2, size) * 1.0,
        "an offset that leaves no digits": 1e15 + np.cos(2.0 * np.pi * 100.0 * time),
    }


@pytest.mark.parametrize("name", odd())
def test_what_is_no_vibration_gets_no_state_and_no_infinity(machine, name):
    data = made(10)
    data[:, 2] = odd()[name]
    hops, continuity, _ = run(machine, blocks(data, 160))
    assert (len(hops), continuity.malformed) == (10, 0)
    assert {hop.stages["pair"].state.label for hop in hops} == {names.UNKNOWN}
    for hop in hops:
        tables = [hop.spectrum, hop.orders, *hop.sections.values(), *hop.indicators.values()]
        assert not any(np.isinf(table.data).any() for table in tables if table is not None)
