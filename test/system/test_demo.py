"""`nw_gear demo` from start to report, and what it leaves behind when it can't."""

import json
import signal
import subprocess
import time

import numpy as np
import pytest

from nw_gear_monitor.records.reader import Recording
from test.system import layout_paths
from test.system.processes import command, environment, running

START = 180.0
"""Longest wait for a short demo (s), compilation of kernels included."""


def demo(*arguments):
    return subprocess.run(
        [*command("nw_gear"), "demo", *arguments],
        capture_output=True,
        text=True,
        timeout=START,
        env=environment(),
        check=False,
    )


def waveform(folder):
    with Recording.open(folder / "recording") as recording:
        assert recording.complete
        return np.vstack([table.data for _time, table in recording.tables("/nw_gear/waveform")])


def test_a_short_demo_leaves_a_recording_and_a_report(tmp_path):
    folder = tmp_path / "run"
    done = demo("--duration", "4", "--real-time-factor", "0", "-o", str(folder), "--json")
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["run"] == str(folder)
    data = waveform(folder)
    assert len(data) == 4 * 5120
    assert np.diff(data[:, 0]) == pytest.approx(1 / 5120.0, abs=1e-9)
    page = (folder / "report.html").read_text()
    assert "Poincar" in page
    with Recording.open(folder / "recording") as recording:
        nodes = {key for key in recording.provenance if key.startswith("nw_gear.node.")}
        assert {f"nw_gear.node.{n}" for n in ("wind_node", "gear_sim_node", "gear_monitor_node")} <= nodes
        assert recording.provenance["nw_gear.node.wind_node"]["seed"] == "1"
        assert "backlash" in recording.provenance["nw_gear.node.gear_sim_node"]["resolved_config"]
    assert layout_paths.missing(folder / "recording") == []


@pytest.mark.slow
def test_two_demos_with_one_seed_record_the_same_waveform(tmp_path):
    runs = [tmp_path / name for name in ("first", "second")]
    for run in runs:
        arguments = ["--duration", "3", "--real-time-factor", "0", "--seed", "5", "--no-report", "-o", str(run)]
        assert demo(*arguments).returncode == 0
    first, second = (waveform(run) for run in runs)
    assert first.tobytes() == second.tobytes()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--wind", "no/such/file.csv"], "no/such/file.csv"),
        (["--config", "no_such_preset"], "no_such_preset"),
        (["--duration", "-3"], "duration"),
        (["--wnd", "gust"], "--wnd"),
    ],
)
def test_wrong_input_gets_one_line_and_leaves_nothing(tmp_path, arguments, words):
    folder = tmp_path / "run"
    done = demo("-o", str(folder), *arguments)
    assert done.returncode == 2, done.stderr
    assert words in done.stderr
    assert "Traceback" not in done.stderr
    assert not folder.exists()


def test_an_existing_folder_is_refused_and_untouched(tmp_path):
    (tmp_path / "mine").write_text("keep")
    done = demo("-o", str(tmp_path), "--duration", "1")
    assert done.returncode == 2
    assert [p.name for p in tmp_path.iterdir()] == ["mine"]


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_interrupted_it_leaves_a_readable_recording(tmp_path, number, code):
    folder = tmp_path / "run"
    arguments = ["demo", "--duration", "600", "-o", str(folder), "--config", "rated"]
    with running("nw_gear", arguments=arguments) as process:
        wait_for_progress(process)
        process.signal(number)
        assert process.wait(40.0) == code, process.report()
    assert len(waveform(folder)) > 0


def wait_for_progress(process):
    """Wait until the simulator has got somewhere, by the progress that the demo prints."""
    end = time.monotonic() + START
    while not any(line[0].isdigit() and not line.startswith("0.0") for line in process.stderr.splitlines() if line):
        assert time.monotonic() < end, process.report()
        assert process.code is None, process.report()
        time.sleep(0.1)
