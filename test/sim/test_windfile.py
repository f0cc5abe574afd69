"""Wind files: what is read, what is reported, what is refused and in which words."""

import csv
import statistics
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nw_gear_common.errors import InputError
from nw_gear_sim import windfile

MAST = Path(__file__).parents[1] / "data" / "mast_wind_10min.csv"


def write(folder: Path, text: str) -> str:
    path = folder / "wind.csv"
    path.write_text(text)
    return str(path)


def test_the_measured_week() -> None:
    with MAST.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    data = windfile.read(MAST)
    assert len(data.times) == len(rows) == 7 * 144
    assert data.deviations is not None
    np.testing.assert_array_equal(data.speeds, [float(r["wind_speed_mean"]) for r in rows])
    np.testing.assert_array_equal(data.deviations, [float(r["wind_speed_std"]) for r in rows])
    assert (data.interval, data.gaps, data.origin) == (600.0, (), "2016-03-01T00:00:00")
    summary = windfile.summary(MAST)
    assert summary["mean"] == pytest.approx(statistics.mean(float(r["wind_speed_mean"]) for r in rows))
    assert (summary["rows"], summary["gaps"], summary["rate_hz"]) == (1008, [], pytest.approx(1 / 600))


def test_missing_rows_and_empty_cells_are_gaps(tmp_path: Path) -> None:
    lines = MAST.read_text().splitlines()
    kept = lines[:5] + lines[7:20]  # rows 00:40 and 00:50 are missing
    kept[10] = kept[10].split(",")[0] + ",,,"
    data = windfile.read(write(tmp_path, "\n".join(kept)))
    found = [(gap.label, gap.seconds) for gap in data.gaps]
    assert found == [("2016-03-01T00:30:00", 1800.0), ("2016-03-01T01:40:00", 1200.0)]
    assert data.empty_rows == 1
    assert len(data.times) == len(kept) - 2
    summary = windfile.summary(data.path)
    assert summary["gaps"] == [
        {"start": "2016-03-01T00:30:00", "seconds": 1800.0},
        {"start": "2016-03-01T01:40:00", "seconds": 1200.0},
    ]


@given(st.lists(st.booleans(), min_size=4, max_size=40))
def test_gaps_are_exactly_the_empty_cells(good: list[bool]) -> None:
    good = [True, True, *good, True]
    text = "time,wind_speed\n" + "\n".join(f"{10 * i},{7 if ok else ''}" for i, ok in enumerate(good))
    with tempfile.TemporaryDirectory() as folder:
        data = windfile.read(write(Path(folder), text))
    assert len(data.times) + data.empty_rows == len(good)
    covered = [round(gap.seconds / 10) - 1 for gap in data.gaps]
    assert sum(covered) == good.count(False)
    assert all(covered)
    for gap in data.gaps:
        first = round(gap.start / 10)
        assert [good[first], good[first + 1], good[first + round(gap.seconds / 10)]] == [True, False, True]


def test_means_are_bridged_linearly_on_the_grid_of_intervals(tmp_path: Path) -> None:
    text = "time,wind_speed_mean,wind_speed_std\n0,5,1.0\n600,6,1.1\n1200,,\n1800,NaN,1\n2400,9,1.4\n"
    data = windfile.read(write(tmp_path, text))
    means, deviations = data.regular()
    np.testing.assert_allclose(means, [5, 6, 7, 8, 9])
    np.testing.assert_allclose(deviations, [1.0, 1.1, 1.2, 1.3, 1.4])
    assert [(g.start, g.seconds) for g in data.gaps] == [(600.0, 1800.0)]


def test_every_other_cell_empty_is_seen(tmp_path: Path) -> None:
    text = "time,wind_speed\n" + "\n".join(f"{i},{'' if i % 2 else 7}" for i in range(9))
    data = windfile.read(write(tmp_path, text))
    assert [g.seconds for g in data.gaps] == [2.0] * 4
    assert data.interval == 1.0


def test_empty_cells_at_both_ends_are_counted(tmp_path: Path) -> None:
    data = windfile.read(write(tmp_path, "time,wind_speed\n0,\n1,5\n2,6\n3,n/a\n"))
    assert (data.empty_rows, data.gaps, data.origin) == (2, (), "1970-01-01T00:00:01")


def test_means_off_the_grid_are_refused(tmp_path: Path) -> None:
    text = "time,wind_speed_mean,wind_speed_std\n0,5,1\n600,6,1\n1200,6,1\n2100,6,1\n"
    with pytest.raises(InputError, match=r"2100 s after the first row: expected intervals .* multiples of 600 s"):
        windfile.read(write(tmp_path, text)).regular()


@pytest.mark.parametrize(
    "text",
    [
        "time,wind_speed\n2020-01-01T00:00:00Z,5\n2020-01-01T00:00:01Z,6\n2020-01-01T00:00:02Z,7\n",
        "\ufefftime;wind_speed\n0;5\n1;6\n2;7\n",
        "# a remark, with a comma\nTimestamp\tother\tWind_Speed\n0.0\tx\t5\n1.0\ty\t6\n2.0\tz\t7\n\n",
        'station,time,wind_speed\n"A, north",0,5\nB,1,6\nC,2,7\n',
    ],
)
def test_forms_of_a_file(tmp_path: Path, text: str) -> None:
    data = windfile.read(write(tmp_path, text))
    np.testing.assert_array_equal(data.times, [0, 1, 2])
    np.testing.assert_array_equal(data.speeds, [5, 6, 7])
    assert data.rate_hz == 1.0
    assert data.deviations is None


def test_columns_by_name(tmp_path: Path) -> None:
    path = write(tmp_path, "t,v80,v60,s60\n0,1,5,.5\n600,2,6,.6\n")
    data = windfile.read(path, "t", "v60", "s60")
    assert data.deviations is not None
    assert (list(data.speeds), list(data.deviations)) == ([5.0, 6.0], [0.5, 0.6])
    assert windfile.read(path, "t", "v80").deviations is None


def test_rate_far_from_the_start(tmp_path: Path) -> None:
    text = "time,wind_speed\n" + "\n".join(f"{1.7e9 + i / 20:.2f},5" for i in range(50))
    assert windfile.read(write(tmp_path, text)).rate_hz == 20.0


def test_irregular_series_has_no_rate(tmp_path: Path) -> None:
    data = windfile.read(write(tmp_path, "time,wind_speed\n0,5\n1,5\n2.2,5\n3,5\n4.1,6\n"))
    assert data.rate_hz is None
    assert data.gaps == ()


HEAD = "time,wind_speed\n0,5\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"row 1: expected a time column .*, got an empty file"),
        ("wind_speed\n5\n6\n", r"row 1: expected a time column \(time, timestamp, .*\), got columns wind_speed$"),
        (
            "time,speed\n0,5\n",
            r"row 1: expected a wind speed column \(wind_speed, wind_speed_mean\), got columns time, speed",
        ),
        ("time,wind_speed_mean\n0,5\n", r"row 1: expected a column of standard deviations \(wind_speed_std\)"),
        (HEAD + "1,fast\n", r"row 3, column wind_speed: expected a wind speed from 0 to 150 m/s .*, got 'fast'"),
        (HEAD + "1,-3.5\n", r"row 3, column wind_speed: .* got -3.5"),
        (HEAD + "1,9999\n", r"row 3, column wind_speed: .* got 9999"),
        (HEAD + "1,inf\n", r"row 3, column wind_speed: .* got inf"),
        (
            HEAD + "yesterday,5\n",
            r"row 3, column time: expected a date and time in ISO 8601 or seconds, got 'yesterday'",
        ),
        (HEAD + ",5\n", r"row 3, column time: .* got ''"),
        (HEAD + "nan,5\n", r"row 3, column time: .* got 'nan'"),
        (HEAD + "1e300,5\n", r"row 3, column time: .* got '1e300'"),
        (HEAD + "1,5\n1,6\n", r"row 4: expected a time after 1970-01-01T00:00:01, got 1970-01-01T00:00:01"),
        (HEAD + "2,5\n\n1,6\n", r"row 5: expected a time after 1970-01-01T00:00:02, got 1970-01-01T00:00:01"),
        (HEAD + "2020-01-01T00:00:00+01:00,5\n", r"row 3: expected a time like those before"),
        (HEAD + "1\n", r"row 3: expected 2 cells as in the header, got 1"),
        (HEAD, r"wind.csv: expected at least 2 rows with time and wind speed, got 1"),
    ],
)
def test_what_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(InputError, match=message) as caught:
        windfile.read(path)
    assert caught.value.place.startswith(path)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected a readable CSV file, got No such file"):
        windfile.read(tmp_path / "none.csv")
    with pytest.raises(InputError, match="expected a readable CSV file, got Is a directory"):
        windfile.read(tmp_path)
    (tmp_path / "wind.csv").write_bytes(b"time,wind_speed\n0,\xff\n")
    with pytest.raises(InputError, match="expected a text in UTF-8"):
        windfile.read(tmp_path / "wind.csv")
    (tmp_path / "nul.csv").write_bytes(b"time,wind_speed\n0,5\n1,\x00\n")
    with pytest.raises(InputError):
        windfile.read(tmp_path / "nul.csv")


def test_a_named_column_that_is_missing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected a time column named UTC, got columns time, wind_speed"):
        windfile.read(write(tmp_path, HEAD + "1,6\n"), time_column="UTC")
