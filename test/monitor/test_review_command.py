"""`nw_gear review` on recordings: whole, damaged, foreign, none at all."""

import json
import subprocess
import sys

import pytest

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.review import command, output, read
from test.monitor import recorded, synthetic
from test.monitor.test_review_page import Page

SECONDS = 4


def review(*arguments):
    """The command as a process of its own: exit code, standard output, standard error."""
    program = "import sys; from nw_gear_common.cli import main; sys.exit(main(sys.argv[1:]))"
    called = [sys.executable, "-c", program, "review", *map(str, arguments)]
    done = subprocess.run(called, capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, done.stdout, done.stderr


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "2030-01-01_00-00-00"
    folder.mkdir()
    recorded.write(folder / "recording", synthetic.stream(SECONDS))
    return folder


@pytest.fixture
def silent():
    return lambda _words: None


def test_a_run_gets_its_report_and_json_tells_of_it(run):
    code, out, err = review(run, "--json")
    assert code == 0, err
    told = json.loads(out)
    assert told["report"] == str(run.resolve() / "report.html")
    assert told["complete"] is True
    assert told["duration"] == pytest.approx(SECONDS, abs=0.01)
    assert set(told["states"]) == set(names.STAGES)
    page = Page((run / "report.html").read_text(encoding="utf-8"))
    assert page.titles == ["Gearbox run 2030-01-01_00-00-00"]
    assert "4.891 MW" in page.words


def test_what_is_read_from_a_file_is_what_was_recorded(run, silent):
    data = read.read(run / "recording", silent)
    assert data.waveform.samples == SECONDS * synthetic.RATE
    assert data.provenance["nw_gear.node.wind_node"]["seed"] == "7"
    assert data.topics["/nw_gear/waveform"] == (recorded.TABLE, 20 * SECONDS)
    assert data.truth["excitation"] == "kinematic"
    assert data.bearing_radial["sb"].high.max() == pytest.approx(5e3)


def test_another_namespace_is_found(tmp_path, silent):
    recorded.write(tmp_path / "bag", synthetic.stream(1), space="/park/turbine_7")
    assert read.read(tmp_path / "bag", silent).waveform.samples == synthetic.RATE


def test_a_killed_recording_is_read_through_a_copy_and_said_to_be_damaged(tmp_path):
    folder = tmp_path / "recording"
    recorded.write(folder, synthetic.stream(2), finish=False)
    before = {file.name: file.read_bytes() for file in folder.iterdir()}
    code, _out, err = review(folder, "-o", tmp_path / "page.html")
    assert code == 0, err
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == before
    words = Page((tmp_path / "page.html").read_text(encoding="utf-8")).words
    assert "damaged, read through a repaired copy" in words
    assert "The recording is damaged" in words
    assert f"{2 * 5120} at 5120 Hz" in words


def test_a_report_that_is_there_is_replaced_as_a_whole(tmp_path):
    page = tmp_path / "report.html"
    page.write_text("old")
    output.write(page, "new")
    assert page.read_text() == "new"
    assert [file.name for file in tmp_path.iterdir()] == ["report.html"]


def one_line(code, out, err):
    assert code == 2
    assert out == ""
    assert len(err.strip().splitlines()) == 1, err
    return err


def test_a_missing_folder_is_named(tmp_path):
    assert "no such folder" in one_line(*review(tmp_path / "nowhere"))


def test_a_folder_without_a_recording_is_refused(tmp_path):
    (tmp_path / "notes.txt").write_text("nothing")
    assert "expected a recording" in one_line(*review(tmp_path))


def test_an_output_folder_that_is_missing_is_refused_before_any_work(run, tmp_path):
    assert "no folder" in one_line(*review(run, "-o", tmp_path / "deep" / "page.html"))


def test_other_formats_are_refused(run):
    assert "html" in one_line(*review(run, "--format", "xml"))


@pytest.mark.parametrize("text", ["5", "a:b", "3:2", "-1:2", "1:inf", "nan:2", ":"])
def test_a_stretch_that_is_none_is_refused(text):
    with pytest.raises(InputError, match="--zoom"):
        command.span(text)


def test_a_stretch_is_two_times():
    assert command.span("3.5:7") == (3.5, 7.0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"kind": command.Format.PARQUET, "other": True}, "html with two runs"),
        ({"kind": command.Format.CSV, "zoom": ["1:2"]}, "--format html"),
        ({"kind": command.Format.PARQUET, "output": "full"}, "a new or empty folder"),
    ],
)
def test_what_doesnt_go_together_is_refused_before_any_work(run, options, words):
    options = dict(options)
    if "other" in options:
        options["other"] = run
    if "output" in options:
        options["output"] = run
    with pytest.raises(InputError, match=words):
        command.review(run, **options)


@pytest.mark.parametrize("content", [b"", b"not an mcap file at all", b"\x89MCAP0\r\n"])
def test_rubbish_is_refused_in_one_line(tmp_path, content):
    folder = tmp_path / "recording"
    folder.mkdir()
    (folder / "recording_0.mcap").write_bytes(content)
    one_line(*review(folder, "-o", tmp_path / "page.html"))
    assert not (tmp_path / "page.html").exists()


def test_a_recording_of_other_things_is_refused(tmp_path, silent):
    foreign = [("/camera/diagnostics", 1.0, synthetic.diagnostics(1.0, {}))]
    kinds = recorded.TYPES | {"/camera/diagnostics": "diagnostic_msgs/msg/DiagnosticArray"}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recorded, "TYPES", kinds)
        recorded.write(tmp_path / "bag", foreign)
    with pytest.raises(InputError, match="expected topics of nw_gear"):
        read.read(tmp_path / "bag", silent)


def test_default_place_of_the_report(tmp_path):
    assert output.default_output(tmp_path / "today" / "recording") == tmp_path / "today" / "report.html"
    assert output.default_output(tmp_path / "bag_7") == tmp_path / "bag_7_report.html"


def test_the_helper_writes_what_the_reader_reads(run):
    with Recording.open(run / "recording") as recording:
        _time, table = next(iter(recording.tables("/nw_gear/waveform")))
    assert table.columns == names.waveform_columns()
    assert table.data.tobytes() == synthetic.waveform(0.0).data.tobytes()
