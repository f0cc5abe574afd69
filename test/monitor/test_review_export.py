"""Data of a recording as Parquet, CSV and JSON, read back by foreign readers and held against what was recorded."""

import csv as csv_module
import json

import numpy as np
import pytest
from pyarrow import parquet

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Table
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.review.export import sinks
from nw_gear_monitor.review.export.document import document
from nw_gear_monitor.review.export.run import export
from nw_gear_monitor.review.read import read
from test.monitor import recorded, synthetic

SECONDS = 3


def silent(_words):
    pass


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    folder = tmp_path_factory.mktemp("export") / "recording"
    recorded.write(folder, synthetic.stream(SECONDS))
    return folder


@pytest.fixture(scope="module")
def tables(source):
    folder = source.parent / "parquet"
    files, remarks = export(source, folder, "parquet", silent)
    assert remarks == []
    assert {file.name for file in folder.iterdir()} == set(files)
    found = {name.removesuffix(".parquet"): parquet.read_table(folder / name) for name in files}
    assert {name: len(table) for name, table in found.items()} == {k.split(".")[0]: n for k, n in files.items()}
    return found


def rows_of(source, topic):
    with Recording.open(source) as recording:
        return np.concatenate([table.data for _time, table in recording.tables(f"{names.NAMESPACE}/{topic}")])


def column(table, name):
    return table.column(name).to_numpy()


def test_waveform_in_parquet_is_the_recording_bit_by_bit(source, tables):
    data = rows_of(source, names.WAVEFORM)
    table = tables["waveform"]
    assert tuple(table.column_names) == names.waveform_columns()
    for i, name in enumerate(table.column_names):
        assert column(table, name).tobytes() == data[:, i].tobytes(), name


def test_views_in_parquet_are_what_the_foreign_decoder_reads(source, tables):
    with Recording.open(source) as recording:
        joints = [m.value for m in recording.messages([f"{names.NAMESPACE}/shafts"])]
        forces = [m.value for m in recording.messages([f"{names.NAMESPACE}/bearings/sb"])]
        winds = [m.value for m in recording.messages([f"{names.NAMESPACE}/wind_speed"])]
    shafts = tables["shafts"]
    assert shafts.column("shaft").to_pylist() == list(names.SHAFTS) * len(joints)
    assert column(shafts, "angular_velocity").tolist() == [v for j in joints for v in j.velocity]
    assert column(shafts, "torque").tolist() == [v for j in joints for v in j.effort]
    times = [j.header.stamp.sec + 1e-9 * j.header.stamp.nanosec for j in joints]
    assert column(shafts, "time")[:: len(names.SHAFTS)].tolist() == times
    own = tables["bearings"].filter(np.array(tables["bearings"].column("bearing").to_pylist()) == "sb")
    assert column(own, "fz").tolist() == [m.wrench.force.z for m in forces]
    assert column(tables["wind_speed"], "speed").tolist() == [m.vector.x for m in winds]


def test_units_and_provenance_are_in_the_parquet_files(tables):
    schema = tables["waveform"].schema
    units = {f.name: f.metadata[b"unit"].decode() for f in schema}
    assert units["time"] == "s"
    assert units["phase_II"] == "rad"
    assert units["x_III"] == "m"
    assert units["v_I_2"] == "m/s"
    assert units["fy_sb"] == "N"
    assert json.loads(schema.metadata[b"provenance"])["nw_gear.node.wind_node"]["seed"] == "7"
    assert tables["indicators"].schema.field("rms").metadata[b"unit"] == b"m"
    assert tables["bearing_indicators"].schema.field("rms").metadata[b"unit"] == b"N"


def test_tables_without_a_time_get_the_time_of_recording(source, tables):
    with Recording.open(source) as recording:
        spectra = list(recording.tables(f"{names.NAMESPACE}/{names.SPECTRUM}"))
    found = tables["spectrum"]
    assert column(found, "log_time").tolist() == [time for time, t in spectra for _ in range(len(t))]
    assert column(found, "II_2").tobytes() == np.concatenate([t.column("II_2") for _, t in spectra]).tobytes()


def test_diagnostics_and_truth_are_tidy(tables):
    said = tables["diagnostics"].to_pylist()
    assert len(said) == 3 * SECONDS
    assert {row["name"] for row in said} == {f"gear_monitor_node: stage {s}" for s in names.STAGES}
    values = tables["diagnostic_values"].to_pylist()
    assert {row["value"] for row in values if row["key"] == "state"} <= {names.CHAOTIC, "period-1"}
    truth = [row["value"] for row in tables["truth"].to_pylist() if row["key"] == "open fraction II_2 (1)"]
    assert truth == ["0.200000", "0.400000"]


def test_csv_is_read_by_numpy_to_the_last_bit(source):
    folder = source.parent / "csv"
    export(source, folder, "csv", silent)
    with (folder / "waveform.csv").open(encoding="utf-8", newline="") as file:
        head = next(csv_module.reader(file))
    assert head[0] == "time (s)"
    assert head[names.waveform_columns().index("x_I_2")] == "x_I_2 (m)"
    read_back = np.loadtxt(folder / "waveform.csv", delimiter=",", skiprows=1)
    assert np.array_equal(read_back, rows_of(source, names.WAVEFORM))
    with (folder / "indicators.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv_module.DictReader(file))
    assert {row["mesh"] for row in rows} == set(names.MESHES)


def test_a_long_table_is_written_in_row_groups(tmp_path, monkeypatch):
    monkeypatch.setattr(sinks, "GROUP", 4096)
    sink = sinks.Sink(tmp_path / "long", "parquet", {})
    values = np.random.default_rng(5).normal(size=(40, 100))
    for block in values:
        sink.add({"time": block})
        assert sum(batch.nbytes for batch in sink._pending) < 4096 + block.nbytes
    sink.close()
    file = parquet.ParquetFile(tmp_path / "long.parquet")
    assert file.num_row_groups > 5
    assert file.read().column("time").to_numpy().tobytes() == values.tobytes()


def test_a_table_whose_columns_change_goes_on_in_another_file(tmp_path):
    found = sinks.Sinks(tmp_path, "parquet", {})
    found.add("indicators", {"time": np.zeros(2)})
    found.add("indicators", {"time": np.zeros(1), "rms": np.ones(1)})
    found.add("indicators", {"time": np.ones(1)})
    assert found.close() == {"indicators.parquet": 3, "indicators_2.parquet": 1}


def test_a_damaged_recording_is_exported_as_far_as_it_goes_and_said_so(tmp_path):
    recorded.write(tmp_path / "recording", synthetic.stream(1), finish=False)
    files, remarks = export(tmp_path / "recording", tmp_path / "out", "parquet", silent)
    assert "damaged" in remarks[0]
    assert files["waveform.parquet"] == synthetic.RATE
    assert parquet.read_schema(tmp_path / "out" / "waveform.parquet").metadata[b"complete"] == b"false"


def test_nothing_is_left_behind_where_the_data_dont_fit(source, tmp_path, monkeypatch):
    def full(*_arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(sinks.Sink, "_flush", full)
    with pytest.raises(InputError, match="No space left"):
        export(source, tmp_path / "out", "csv", silent)
    assert list(tmp_path.iterdir()) == []


def test_other_tables_of_the_namespace_are_exported_under_their_name(tmp_path):
    strange = Table(names.ROW_SAMPLE, ("a", "b"), np.array([[1.0, np.nan], [3.0, -0.0]]))
    items = [*synthetic.stream(1, monitor=False), ("plant/oil", 0.7, strange)]
    recorded.write(tmp_path / "recording", items)
    export(tmp_path / "recording", tmp_path / "out", "parquet", silent)
    found = parquet.read_table(tmp_path / "out" / "plant_oil.parquet")
    assert column(found, "log_time").tolist() == pytest.approx([0.7, 0.7])
    assert column(found, "b").tobytes() == strange.data[:, 1].tobytes()


def test_the_document_says_what_the_report_says(source):
    found = json.loads(json.dumps(document(read(source, silent)), allow_nan=False))
    assert found["operating_range"]["input_torque_n_m"]["mean"] == pytest.approx(synthetic.TORQUE)
    assert found["stages"][1]["worst"]["state"] == names.CHAOTIC
    assert found["worst"]["stage"] == "II"
    rms = found["indicators"]["III"]["rms"]
    assert rms["unit"] == "m"
    assert rms["last"] == pytest.approx(synthetic.AMPLITUDE["III"] / np.sqrt(2.0))
    assert found["truth"]["mean"]["open fraction II_2 (1)"] == pytest.approx(0.3)
    assert found["waveform"]["samples"] == SECONDS * synthetic.RATE
