"""A machine that isn't the built-in gearbox: from a logger's file to states and bearing lines."""

import json

import numpy as np
import pytest

from nw_gear_common import cli, names, share
from nw_gear_common.errors import InputError
from nw_gear_monitor.datafiles.read import read as read_file
from nw_gear_monitor.foreign.phases import pulses, unwrapped
from nw_gear_monitor.foreign.waveform import Options, waveform
from nw_gear_monitor.machinefile.read import load
from nw_gear_monitor.pipeline import Pipeline
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.review.read import read
from nw_gear_monitor.signals.differences import derivative
from test.monitor import foreign

SECONDS = 12.0
WAVEFORM = f"{names.NAMESPACE}/{names.WAVEFORM}"


@pytest.fixture(scope="module")
def machine():
    return load(share.find("config/machine_example.yaml"))


def imported(tmp_path, columns, *options):
    """What `nw_gear import` says about a file, and the tables that it recorded."""
    file, folder = tmp_path / "bench.csv", tmp_path / "recording"
    foreign.write_csv(file, columns)
    description = share.find("config/machine_example.yaml")
    code = cli.main(["import", str(file), "--machine", str(description), "-o", str(folder), *options])
    assert code == 0
    with Recording.open(folder) as recording:
        return folder, [table for _, _, table in recording.read([WAVEFORM])]


def last_hop(machine, tables):
    pipeline = Pipeline(machine)
    hops = [hop for table in tables for hop in pipeline.feed(table)]
    assert (pipeline.continuity.malformed, pipeline.continuity.gaps, pipeline.continuity.restarts) == (0, 0, 0)
    return hops[-1]


CASES = [
    pytest.param(label, omega, marks=[] if label == names.CHAOTIC else pytest.mark.slow)
    for label, omega in foreign.OMEGA.items()
]
"""The quick run takes period 2 through the nodes (test/system/test_foreign.py)."""


@pytest.mark.parametrize(("label", "omega"), CASES)
def test_a_gear_pair_by_kahraman_and_singh_gets_its_label(tmp_path, machine, label, omega):
    period = 2.0 * np.pi / omega
    strobes = foreign.integrate(foreign.settled(omega), np.arange(100) * period, omega)
    returns = {n: np.abs(strobes[n:] - strobes[:-n]).max() for n in (1, 2, 4, 8, 16)}
    if label == names.CHAOTIC:
        assert foreign.largest_exponent(omega) > 0.1
        assert min(returns.values()) > 0.1
    else:
        true = int(label.partition("-")[2])
        assert foreign.largest_exponent(omega) < -0.1
        assert next(n for n, apart in returns.items() if apart < 1e-4) == true
    time, x, angle = foreign.pair(omega, SECONDS)
    columns = {"a_front": foreign.bearing(time, angle), "disp": x, "t [ms]": 1e3 * time, "pulse": foreign.tacho(angle)}
    _, tables = imported(tmp_path, columns, "--column", "x_mesh=disp", "--tacho", "pulse")
    hop = last_hop(machine, tables)
    assert hop.stages["pair"].state.label == label
    bearing = hop.bearing_indicators["front"]
    assert bearing.column("bpfo_prominence")[0] > 5.0
    for other in ("bpfi", "ftf", "bsf"):
        assert bearing.column(f"{other}_prominence")[0] < 4.0


def test_a_bearing_without_damage_shows_no_line(machine):
    time, x, angle = foreign.pair(foreign.OMEGA["period-1"], SECONDS)
    data = np.column_stack([time, angle, x, foreign.bearing(time, angle, knock=0.0)])
    hop = last_hop(machine, [foreign.table(data)])
    assert max(hop.bearing_indicators["front"].column(f"{n}_prominence")[0] for n in ("bpfo", "bpfi", "ftf")) < 4.0


def test_sidebands_of_a_shaft_are_expected_lines(machine):
    """An eccentric wheel modulates its mesh once a turn: regular, and no quasi-periodic motion."""
    time = np.arange(round(SECONDS * foreign.RATE)) / foreign.RATE
    angle = 2.0 * np.pi * 5.0 * time
    x = 1e-4 + 5e-6 * np.cos(20.0 * angle) * (1.0 + 0.5 * np.cos(angle / 3.0)) + 2e-6 * np.cos(angle + 1.0)
    x += 1e-7 * np.random.default_rng(1).standard_normal(x.size)
    noise = np.random.default_rng(2).standard_normal(x.size)
    hop = last_hop(machine, [foreign.table(np.column_stack([time, angle, x, noise]))])
    assert hop.stages["pair"].state.label == "period-1"
    assert hop.stages["pair"].evidence.rho < 0.01


def test_the_tacho_gives_the_phase_that_the_file_had(tmp_path):
    time, x, angle = foreign.pair(foreign.OMEGA["period-1"], 4.0)
    columns = {"time": time, "x_mesh": x, "a_front": x, "pulse": foreign.tacho(angle)}
    folder, tables = imported(tmp_path, columns, "--tacho", "pulse")
    data = np.vstack([table.data for table in tables])
    names_in = tables[0].columns
    phase = data[:, names_in.index("phase_pinion")]
    true = np.interp(data[:, 0], time, angle)
    assert np.ptp(phase - true) < 2e-3  # rad: a twentieth of a sample at 5 turns a second is 3e-4
    assert data[:, names_in.index("x_mesh")] == pytest.approx(np.interp(data[:, 0], time, x), abs=1e-12)
    run = read(folder, lambda _words: None)
    assert "another machine" in run.remarks[0]


def test_a_wrapped_angle_in_degrees_becomes_a_phase():
    angle = np.linspace(0.0, 50.0, 400)
    found = unwrapped("angle", np.mod(np.degrees(angle), 360.0), "deg")
    assert found == pytest.approx(angle, abs=1e-9)
    with pytest.raises(InputError, match="angle"):
        unwrapped("angle", angle[::-1], "rad")


def test_pulses_are_met_between_samples():
    time = np.arange(20000) / 1000.0
    found = pulses("tacho", time, np.cos(2.0 * np.pi * 3.7 * time), 1)
    expected = (np.arange(found.times.size) + 0.75) / 3.7
    assert found.times == pytest.approx(expected, abs=1e-6)
    assert found.times.size == 74


def test_differences_have_the_error_of_their_order():
    rate, frequency = 1000.0, 100.0
    time = np.arange(200) / rate
    w = 2.0 * np.pi * frequency
    found = derivative(np.sin(w * time)[:, None], rate)[:, 0]
    error = np.abs(found - w * np.cos(w * time)) / w
    assert error[4:-4].max() == pytest.approx((w / rate) ** 8 / 630.0, rel=0.2)
    ends = np.abs(np.cos(w * time[1:4])) * (w / rate) ** 2 / 6.0
    assert error[1:4] == pytest.approx(ends, rel=0.05)


def test_an_array_without_names_is_imported_by_the_numbers_of_its_channels(tmp_path, machine):
    time, x, angle = foreign.pair(foreign.OMEGA["period-1"], 2.0)
    np.save(tmp_path / "bench.npy", np.column_stack([np.degrees(angle) % 360.0, x, -x]).astype(np.float32))
    columns = {"phase_pinion": "ch1", "x_mesh": "ch2", "a_front": "ch3"}
    found = waveform(read_file(tmp_path / "bench.npy"), machine, Options(columns, rate=foreign.RATE, angle="deg"))
    assert found.table.columns == ("time", "phase_pinion", "x_mesh", "a_front")
    assert found.table.column("time") == pytest.approx(time)
    assert found.table.column("phase_pinion") == pytest.approx(angle, abs=1e-6)  # single precision
    assert found.table.column("a_front") == pytest.approx(-x, rel=1e-6)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--column", "x_mesh=disp", "--tacho", "nothing"], "--tacho nothing"),
        (["--column", "x_pinion=disp"], "--column x_pinion"),
        (["--column", "x_mesh"], "NAME=COLUMN"),
        (["--column", "x_mesh=disp", "--rate", "48000"], "5120"),
        ([], "x_mesh"),
    ],
)
def test_what_does_not_fit_ends_with_one_line(tmp_path, capsys, options, said):
    time, x, angle = np.arange(2000) / 5120, np.sin(np.arange(2000.0)), 0.01 * np.arange(2000)
    file = tmp_path / "bench.csv"
    foreign.write_csv(file, {"time": time, "disp": x, "phase_pinion": angle, "a_front": x})
    description = share.find("config/machine_example.yaml")
    code = cli.main(["import", str(file), "--machine", str(description), "-o", str(tmp_path / "new"), *options])
    lines = [line for line in capsys.readouterr().err.splitlines() if line]
    assert (code, len(lines)) == (2, 1)
    assert said in lines[0]
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda c: c["x_mesh"].__setitem__(77, np.nan), "column x_mesh"),
        (lambda c: c["a_front"].__setitem__(5, np.inf), "column a_front"),
        (lambda c: c["phase_pinion"].__setitem__(9, 0.0), "column phase_pinion"),
        (lambda c: c["time"].__setitem__(slice(1000, None), c["time"][1000:] + 0.5), "time"),
        (lambda c: c["time"].__setitem__(slice(0, 2000), c["time"][::-1].copy()), "time"),
    ],
    ids=["NaN", "infinity", "phase falls", "gap", "time runs back"],
)
def test_bad_samples_are_named_and_nothing_is_written(tmp_path, capsys, spoil, said):
    columns = {"time": np.arange(2000) / 5120, "phase_pinion": 0.01 * np.arange(2000)}
    columns |= {"x_mesh": np.sin(np.arange(2000.0)), "a_front": np.cos(np.arange(2000.0))}
    spoil(columns)
    file = tmp_path / "bench.csv"
    foreign.write_csv(file, columns)
    description = share.find("config/machine_example.yaml")
    code = cli.main(["import", str(file), "--machine", str(description), "-o", str(tmp_path / "new")])
    assert code == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_it_tells_what_it_did_as_json(tmp_path, capsys):
    columns = {"time": np.arange(1024) / 512.0, "phase_pinion": 0.01 * np.arange(1024), "x_mesh": np.ones(1024)}
    imported(tmp_path, {**columns, "a_front": np.ones(1024)}, "--json")
    told = json.loads(capsys.readouterr().out)
    assert (told["samples"], told["rate"], told["duration"], told["blocks"]) == (1024, 512.0, 2.0, 40)
