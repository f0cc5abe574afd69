"""Tidy tables: what other programs read is what was written, and a disk that refuses takes nothing away."""

import numpy as np
import pyarrow.parquet
import pytest

from nw_gear_common import tidy
from nw_gear_common.errors import InputError

TABLE = {"time_s": np.linspace(0.0, 1.0, 7) / 3.0, "mesh": ["I_1"] * 4 + ["III"] * 3, "rate": [1.5, None] + [2.0] * 5}


def test_parquet_has_the_bits_and_what_it_is(tmp_path):
    tidy.write(tmp_path / "a.parquet", TABLE, {"study": "bifurcation"})
    read = pyarrow.parquet.read_table(tmp_path / "a.parquet")
    assert read.schema.metadata[b"study"] == b"bifurcation"
    assert read["time_s"].to_numpy().tobytes() == TABLE["time_s"].tobytes()
    assert read["mesh"].to_pylist() == TABLE["mesh"]
    assert read["rate"].to_pylist() == TABLE["rate"]


def test_numpy_reads_the_csv(tmp_path):
    tidy.write(tmp_path / "a.csv", TABLE, {})
    read = np.genfromtxt(tmp_path / "a.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    assert np.array_equal(read["time_s"], TABLE["time_s"])
    assert np.isnan(read["rate"][1])


def test_what_was_there_stays_where_the_new_one_cant_be_written(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("old")
    (tmp_path / "a.csv.unfinished").mkdir()
    with pytest.raises(InputError):
        tidy.write(path, TABLE, {})
    assert path.read_text() == "old"


def test_another_suffix_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"\.parquet or \.csv"):
        tidy.write(tmp_path / "a.xlsx", TABLE, {})
