"""Drive files: what is read from OpenFAST's and SCADA systems' files, in which units, what is refused and how."""

import json
import math
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nw_gear_common import cli
from nw_gear_common.errors import InputError
from nw_gear_sim.drivefile import DriveColumns, DriveSeries, parse_columns, read_drive_file, recognised, summary
from test.sim.openfast_files import binary

RPM = math.pi / 30.0
TIMES = np.arange(9) * 0.0125
SPEEDS = 12.1 + 0.3 * np.sin(np.arange(9.0))
TORQUES = 4180.0 + 55.0 * np.cos(np.arange(9.0))


def write(folder: Path, text: str, name: str = "drive.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def table() -> np.ndarray:
    return np.column_stack([np.full(9, 11.4), SPEEDS, TORQUES])


def openfast_text(folder: Path, *, rows: list[str] | None = None, units: str = "(s)\t(m/s)\t(rpm)\t(kN-m)") -> Path:
    """A file as OpenFAST writes it: six lines of remarks, names, units, rows in ES10.3E2 or wider."""
    head = "\nPredictions were generated on 12-Mar-2024 at 14:03:11 using OpenFAST, compiled as a 64-bit application\n"
    head += "linked with NWTC Subroutine Library; ElastoDyn\n\nDescription from the FAST input file: 5 MW\n\n"
    lines = [f"{t:10.4f}\t{w:10.3E}\t{s:14.7E}\t{q:14.7E}" for t, (w, s, q) in zip(TIMES, table(), strict=True)]
    names = "Time\tWind1VelX\tRotSpeed\tRotTorq"
    return write(folder, head + "\n".join([names, units, *(rows or lines)]) + "\n", "run.out")


def is_the_series(series: DriveSeries, rtol: float = 1e-7) -> None:
    np.testing.assert_allclose(series.times, TIMES, rtol=0, atol=1e-9)
    np.testing.assert_allclose(series.speed, SPEEDS * 2.0 * math.pi / 60.0, rtol=rtol)
    np.testing.assert_allclose(series.torque, TORQUES * 1000.0, rtol=rtol)
    assert (series.gaps, series.empty_rows) == ((), 0)
    assert series.rate_hz == pytest.approx(80.0)
    assert series.duration == pytest.approx(0.1)


def test_text_of_openfast(tmp_path: Path) -> None:
    series = read_drive_file(openfast_text(tmp_path))
    is_the_series(series)
    assert series.source.endswith("run.out: speed RotSpeed (r/min) and torque RotTorq (kN m)")


@pytest.mark.parametrize("identifier", [1, 2, 3, 4])
def test_binary_of_openfast(tmp_path: Path, identifier: int) -> None:
    path = tmp_path / "run.outb"
    path.write_bytes(binary(identifier, TIMES, table(), width=20 if identifier == 4 else 10))
    series = read_drive_file(path)
    packed = identifier != 3
    # int16 over the range of a channel: half a step of 1/65535 of it, and float32 scales
    np.testing.assert_allclose(series.speed, SPEEDS * RPM, rtol=0, atol=(0.6 / 65000 * RPM) if packed else 1e-12)
    np.testing.assert_allclose(series.torque, TORQUES * 1e3, rtol=0, atol=(110e3 / 65000) if packed else 1e-7)
    np.testing.assert_allclose(series.times, TIMES, rtol=0, atol=1e-9)
    assert series.rate_hz == pytest.approx(80.0)


def test_a_packed_value_by_hand(tmp_path: Path) -> None:
    """Value = (stored - offset) / scale: 12 r/min from 6000 with scale 1000 and offset -6000."""
    head = struct.pack("<hhiidd", 4, 12, 2, 2, 5.0, 0.5) + struct.pack("<2f2f", 1000.0, 2.0, -6000.0, 500.0)
    head += struct.pack("<i", 3) + b"abc"
    head += b"".join(text.ljust(12).encode() for text in ("Time", "RotSpeed", "LSShftTq", "(s)", "(rpm)", "(kN-m)"))
    path = tmp_path / "hand.bin"  # known by its first bytes
    path.write_bytes(head + struct.pack("<4h", 6000, 8500, 0, -500))
    series = read_drive_file(path)
    np.testing.assert_allclose(series.times, [0.0, 0.5])
    np.testing.assert_allclose(series.speed, np.array([12.0, 6.0]) * RPM)
    np.testing.assert_allclose(series.torque, [4.0e6, -0.5e6])
    assert series.origin == "1970-01-01T00:00:05"


def test_other_channels_and_power(tmp_path: Path) -> None:
    path = tmp_path / "run.outb"
    data = np.column_stack([SPEEDS, SPEEDS * 97.0, SPEEDS * RPM * TORQUES])
    path.write_bytes(binary(3, TIMES, data, ("Time", "RotSpeed", "GenSpeed", "RotPwr"), ("s", "rpm", "rpm", "kW")))
    is_the_series(read_drive_file(path))
    fast = read_drive_file(path, columns=DriveColumns(speed="GenSpeed", power="RotPwr"))
    np.testing.assert_allclose(fast.speed, SPEEDS * 97.0 * RPM)
    np.testing.assert_allclose(fast.torque * fast.speed, SPEEDS * RPM * TORQUES * 1000.0)


def test_a_packed_shaft_at_rest_does_not_turn_backwards(tmp_path: Path) -> None:
    """Packing rounds: a zero may come out below zero by less than a step, but not by more."""
    path = tmp_path / "run.outb"
    for lowest, fine in ((-1e-5, True), (-1e-2, False)):
        speeds = np.linspace(lowest, 12.0, 9)
        path.write_bytes(binary(4, TIMES, np.column_stack([SPEEDS, speeds, TORQUES])))
        if fine:
            assert read_drive_file(path).speed[0] == 0.0
        else:
            with pytest.raises(InputError, match=r"byte \d+, row 1, column RotSpeed: expected a speed of at least 0"):
                read_drive_file(path)


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        ("time,speed,torque\n0,1.25,3e6\n0.5,1.5,4e6\n2,2,-1e6\n", ""),
        ("time (s),speed (rad/s),torque (kN m)\n7,1.25,3e3\n7.5,1.5,4e3\n9,2,-1e3\n", ""),
        ("Timestamp;Rotor speed [rad/s];Rotor torque [MNm]\n0;1,25;3\n0,5;1,5;4\n2;2;-1\n", ""),
        ("time\tspeed\ttorque\n0\t1,25\t3,0\n0,5\t1,5\t4\n2\t2\t-1\n", "torque=torque MN m"),
        ("time,speed,power (kW)\n0,1.25,3750\n0.5,1.5,6000\n2,2,-2000\n", ""),
        ("zeit,n,x,M\n0,1.25,a,3e3\n500,1.5,b,4e3\n2000,2,c,-1e3\n", "time=zeit ms, speed=n, torque=M kN-m"),
        ("time,speed (mean),speed (max),torque\n0,1.25,9,3e6\n.5,1.5,9,4e6\n2,2,9,-1e6\n", "speed=speed (mean) rad/s"),
        (
            "time,speed,torque\n2024-03-01T00:00:00Z,1.25,3e6\n2024-03-01T00:00:00.500Z,1.5,4e6\n"
            "2024-03-01T01:00:02+01:00,2,-1e6\n",
            "",
        ),
    ],
)
def test_forms_of_a_scada_file(tmp_path: Path, text: str, columns: str) -> None:
    chosen = parse_columns(columns) if columns else None
    series = read_drive_file(write(tmp_path, text), columns=chosen, longest_gap=2.0)
    np.testing.assert_allclose(series.times, [0.0, 0.5, 2.0], rtol=1e-12)
    np.testing.assert_allclose(series.speed, [1.25, 1.5, 2.0], rtol=1e-12)
    np.testing.assert_allclose(series.torque, [3e6, 4e6, -1e6], rtol=1e-12)
    assert series.rate_hz is None


def test_ten_minute_means_far_from_the_epoch(tmp_path: Path) -> None:
    rows = "".join(
        f"2023-07-{1 + i // 144:02d} {i // 6 % 24:02d}:{i % 6}0:00;{10 + i % 3};{1500 + i}\n" for i in range(600)
    )
    series = read_drive_file(write(tmp_path, "Timestamp;Rotor speed (RPM);Power (kW)\n" + rows))
    assert series.rate_hz == pytest.approx(1 / 600)
    assert (series.duration, series.origin) == (599 * 600.0, "2023-07-01T00:00:00")
    np.testing.assert_allclose(series.torque[:2], [1500e3 / (10 * RPM), 1501e3 / (11 * RPM)])


def test_rows_at_ten_kilohertz(tmp_path: Path) -> None:
    rows = "".join(f"{1.7e9 + i * 1e-4:.4f},1.2,{i}\n" for i in range(2000))
    series = read_drive_file(write(tmp_path, "time,speed,torque\n" + rows))
    assert series.rate_hz == pytest.approx(1e4, rel=1e-6)
    assert series.duration == pytest.approx(0.1999, rel=1e-6)


GAPPY = "time,speed,torque\n0,1,10\n1,,20\n2,3,nan\n3,4,40\n4,4,40\n5,5,50\n9,9,90\n10,10,100\n"


def test_gaps_are_bridged_linearly_and_told(tmp_path: Path) -> None:
    series = read_drive_file(write(tmp_path, GAPPY), gaps="bridge")
    assert [(g.start, g.seconds) for g in series.gaps] == [(0.0, 3.0), (5.0, 4.0)]
    assert series.gaps[1].label == "1970-01-01T00:00:05"
    assert series.empty_rows == 2
    for time, speed, torque in ((0.0, 1.0, 10.0), (1.5, 2.5, 25.0), (7.0, 7.0, 70.0), (9.25, 9.25, 92.5)):
        assert series.at(time) == pytest.approx((speed, torque))


def test_beyond_both_ends_the_last_values_hold(tmp_path: Path) -> None:
    series = read_drive_file(write(tmp_path, GAPPY), gaps="bridge")
    assert series.at(-1.0) == (1.0, 10.0)
    assert series.at(10.0) == series.at(1e9) == (10.0, 100.0)


def test_empty_rows_at_both_ends_are_told(tmp_path: Path) -> None:
    path = write(tmp_path, "time,speed,torque\n0,,1\n1,2,1\n2,2,1\n3,2,1\n4,2,\n5,2,\n")
    series = read_drive_file(path, gaps="bridge")
    assert [(g.start, g.seconds) for g in series.gaps] == [(-1.0, 1.0), (2.0, 2.0)]
    assert (series.duration, series.empty_rows) == (2.0, 3)


def test_uneven_times_are_no_gap_up_to_the_longest_one(tmp_path: Path) -> None:
    path = write(tmp_path, "time,speed,torque\n0,1,1\n1,1,1\n1.25,1,1\n3,1,1\n4,1,1\n")
    assert read_drive_file(path, longest_gap=1.75).gaps == ()
    with pytest.raises(
        InputError, match=r"row 5: expected at most 1.5 s after the row before .*, got 1.75 s, the first"
    ):
        read_drive_file(path)


@given(st.lists(st.floats(1e-3, 1e3), min_size=2, max_size=30), st.floats(-0.2, 1.2))
def test_interpolation_is_that_of_numpy(steps: list[float], share: float) -> None:
    times = np.cumsum(steps) - steps[0]
    values = np.cos(np.arange(len(steps)))
    time = share * float(times[-1])
    speed, torque = DriveSeries(times, values, 3.0 * values, "made").at(time)
    expected = np.interp(time, times, values)
    assert (speed, torque) == pytest.approx((expected, 3.0 * expected), rel=1e-9, abs=1e-12)


HEAD = "time,speed,torque\n0,1,5\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"row 1: expected a time column .*, got an empty file"),
        ("time,n,torque\n0,1,5\n", r"row 1: expected a column of the rotor's speed .*, got columns time, n, torque"),
        ("time,speed\n0,1\n", r"row 1: expected a column of torque or power .*, got columns time, speed"),
        ("time,speed (knots),torque\n", r"row 1, column speed: expected a unit of speed \(rad/s, .*\), got 'knots'"),
        ("time,speed,torque (J)\n", r"row 1, column torque: expected a unit of torque \(N m, kN m, MN m\), got 'J'"),
        ("time,speed,speed,torque\n0,1,1,5\n", r"row 1: expected one column speed, got 2 of them"),
        (HEAD + "1,-0.5,5\n", r"row 3, column speed: expected a speed of at least 0, got -0.5"),
        (HEAD + "1,inf,5\n", r"row 3, column speed: expected a speed that is a finite number, got inf"),
        (HEAD + "1,1,1e999\n", r"row 3, column torque: expected a torque that is a finite number, got inf"),
        (HEAD + "1,fast,5\n", r"row 3, column speed: expected a number or an empty cell, got 'fast'"),
        (HEAD + "0,1,5\n", r"row 3: expected a time after 0 s, got 0 s"),
        (HEAD + "2,1,5\n\n1,1,5\n", r"row 5: expected a time after 2 s, got 1 s"),
        (HEAD + "1e300,1,5\n", r"row 3: expected a time, got 1e\+300 s"),
        (HEAD + ",1,5\n", r"row 3, column time: expected a number, as the times before, got ''"),
        (HEAD + "2020-01-01,1,5\n", r"row 3, column time: expected a number, as the times before, got '2020-01-01'"),
        ("time,speed,torque\n2020-01-01,1,5\n7,1,5\n", r"row 3, column time: .* ISO 8601, as those before, got '7'"),
        ("time,speed,torque\n2020-01-01,1,5\n2020-01-02T00:00Z,1,5\n", r"row 3, column time: .* time zone"),
        ("time,speed,torque\nnoon,1,5\n", r"row 2, column time: expected a date and time .*, got 'noon'"),
        (HEAD + "1,1\n", r"row 3: expected 3 cells as in the header, got 2"),
        (HEAD + "1,,5\n2,1,5\n", r"row 3, column speed: expected a number .*gaps set to bridge.*, got an empty cell"),
        (HEAD + "1,1,NaN\n2,1,5\n", r"row 3, column torque: expected a number .*, got an empty cell or NaN"),
        (HEAD + "1,1,5\n2,1,5\n9,1,5\n", r"row 5: expected at most 1.5 s after .*, got 7 s, the first of 1 gaps"),
        (HEAD, r"expected at least 2 rows with time, speed and torque, got 1"),
        ("time,speed,power\n0,1,5\n1,0,5\n", r"row 3, column speed: expected a speed above 0, as torque is power"),
        ("time;speed;torque\n0;1,5;2.5\n", r"row 2, column torque: expected either decimal points or .* got '2.5'"),
        ("time;speed;torque\n0;1.5;2,5\n", r"row 2, column torque: expected either decimal points or .* got '2,5'"),
        ("time;speed;torque\n0;1;1.234,5\n", r"row 2, column torque: expected either .* got '1.234,5'"),
        ("time;speed;torque\n0;1;1,234\n1;1;2,345\n", r"row 2, column torque: expected numbers with a decimal point"),
    ],
)
def test_what_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(InputError, match=message) as caught:
        read_drive_file(path)
    assert caught.value.place.startswith(str(path))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("rows", "units", "message"),
    [
        (["0.0 11 12"], None, r"run.out: row 9: expected 4 columns, got 3"),
        (["0.0 11 12 4", "0.1 11 12 4", "0.1 11 12 4"], None, r"run.out: row 11: expected a time after 0.1 s"),
        (["0.0 11 12 4", "0.1 11 ******** 4"], None, r"run.out: row 10, column RotSpeed: .* got an empty cell or NaN"),
        (["0.0 11 12 x"], None, r"run.out: row 9, column RotTorq: expected a number, got 'x'"),
        (["0.0 11 12 4"], "(s) (m/s) (rpm)", r"run.out: row 8: expected 4 units in parentheses"),
        (["0.0 11 12 4"], "(s) (m/s) (rpm) (kips)", r"run.out: row 7, column RotTorq: expected a unit of torque"),
    ],
)
def test_what_is_refused_in_text(tmp_path: Path, rows: list[str], units: str | None, message: str) -> None:
    path = openfast_text(tmp_path, rows=rows, **({"units": units} if units else {}))
    with pytest.raises(InputError, match=message):
        read_drive_file(path)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    for name in ("none.csv", "none.out", "none.outb"):
        with pytest.raises(InputError, match=r"expected a readable .*, got No such file"):
            read_drive_file(tmp_path / name)
    write(tmp_path, "nothing\nof the kind\n", "run.out")
    with pytest.raises(InputError, match="expected a line of channel names that begins with Time"):
        read_drive_file(tmp_path / "run.out")
    with pytest.raises(InputError, match="expected refuse or bridge, got 'ignore'"):
        read_drive_file(write(tmp_path, HEAD), gaps="ignore")
    with pytest.raises(InputError, match="longest_gap: expected a time above 0 s, got nan"):
        read_drive_file(write(tmp_path, HEAD), longest_gap=math.nan)


def test_info(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = summary(openfast_text(tmp_path))
    assert (found["rows"], found["gaps"], found["rate_hz"]) == (9, [], pytest.approx(80.0))
    assert found["mean_speed"] == pytest.approx(SPEEDS.mean() * RPM)
    assert found["mean_torque"] == pytest.approx(TORQUES.mean() * 1000.0)
    assert cli.main(["info", str(tmp_path / "run.out"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == found
    assert cli.main(["info", str(write(tmp_path, GAPPY))]) == 0
    assert "after 1970-01-01T00:00:05: 4 s to the next good row" in capsys.readouterr().out


def test_wind_files_are_not_taken_for_drive_files(tmp_path: Path) -> None:
    assert not recognised(Path(__file__).parents[1] / "data" / "mast_wind_10min.csv")
    assert not recognised(tmp_path / "none.csv")
    assert recognised(write(tmp_path, GAPPY))
