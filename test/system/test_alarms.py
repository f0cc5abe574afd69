"""Alarms of the monitor as a process: learned, raised, acknowledged, reset; the baselines' file across runs."""

import json

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import SetBool, Trigger

from nw_gear_common import names
from nw_gear_common.ros import live_qos, to_message, to_seconds
from nw_gear_monitor.alarms import store
from nw_gear_monitor.alarms.baseline import Baseline
from nw_gear_monitor.alarms.center import ERROR, AlarmCenter
from nw_gear_monitor.alarms.features import LONG, SHORT, features
from nw_gear_monitor.alarms.identity import identity_of
from nw_gear_monitor.alarms.settings import AlarmSettings
from nw_gear_monitor.pipeline import Pipeline, Windows
from test.monitor.gear_signal import blocks, paper, waveform
from test.system.processes import Probe, running

COMPILING = 120.0
STARTING = 60.0
"""Longest waits for compiled kernels and for a process that refuses (s)."""
HEALTHY = 28.0
"""Seconds before stage II gets louder: enough for five windows of 4 s that don't overlap."""
SECONDS = 46.0
"""Four windows more, whole or in part."""
NODE = "/nw_gear/gear_monitor_node"


def louder(time, phase):
    return np.where(time < HEALTHY, 0.0, 2e-4) * np.cos(phase)


class Watcher:
    """A probe that plays the simulator and reads the entry `alarms`."""

    def __init__(self, probe, monitor):
        self.probe, self.monitor = probe, monitor
        self.arrays = probe.collect(DiagnosticArray, names.DIAGNOSTICS)
        self._publisher = probe.node.create_publisher(Float64MultiArray, "/nw_gear/waveform", live_qos(1000))
        probe.wait_until(lambda: self._publisher.get_subscription_count() > 0, monitor, limit=COMPILING)
        probe.wait_for_match(names.DIAGNOSTICS, monitor, publishers=1)

    def feed(self, tables):
        for table in tables:
            self._publisher.publish(to_message(table))
            self.probe.spin_once(0.0)

    def entries(self, name):
        """All statuses of this name as (stamp, level, message, values), oldest first."""
        return [
            (to_seconds(array.header.stamp), s.level, s.message, {pair.key: pair.value for pair in s.values})
            for array in self.arrays
            for s in array.status
            if s.name == f"gear_monitor_node: {name}"
        ]

    def wait_for(self, condition, limit=90.0):
        """Wait until the newest entry `alarms` fulfils a condition of (level, message, values)."""

        def holds():
            found = self.entries("alarms")
            return bool(found) and condition(*found[-1][1:])

        self.probe.wait_until(holds, self.monitor, limit=limit)
        return self.entries("alarms")[-1]

    def call(self, kind, service, **request):
        return self.probe.call(kind, f"{NODE}/{service}", kind.Request(**request), self.monitor)


def offline(table):
    """The transitions that the same samples give without ROS."""
    pipeline, found = Pipeline(paper()), []
    center = AlarmCenter(AlarmSettings(least_windows=5), {SHORT: 4, LONG: 16})
    for block in blocks(table):
        for hop in pipeline.feed(block):
            found += center.update(hop.time, hop.operating, features(hop.indicators, hop.bearing_indicators))
    return found


def acknowledge_freeze_export_reset(watcher, copy):
    """Every service once."""
    before = len(watcher.arrays)
    response = watcher.call(Trigger, "acknowledge")
    assert response.success
    assert "II_1/harmonic_1" in response.message
    watcher.wait_for(lambda _l, _m, v: v["not acknowledged (1)"] == "0")
    assert len(watcher.arrays) > before
    assert watcher.entries("alarms")[-1][3]["II_1/harmonic_1"].endswith(", acknowledged")
    assert watcher.call(SetBool, "freeze_baseline", data=True).success
    watcher.wait_for(lambda _l, _m, v: v["baseline"] == "frozen")
    assert watcher.call(Trigger, "export_baseline").message == str(copy)
    watcher.call(Trigger, "reset")
    assert watcher.call(Trigger, "reset_alarms").message.startswith("reset: ")
    watcher.wait_for(lambda _l, _m, v: v["active (1)"] == "0" and v["bins that judge (1)"] != "0")


@pytest.mark.slow
def test_an_alarm_from_learning_to_the_next_run(tmp_path):
    table = waveform(SECONDS, noise=0.02, extra={"II": louder})
    transitions = offline(table)
    first = min(t.time for t in transitions if t.alarm.level == ERROR)
    assert first <= HEALTHY + 16.0
    assert min(t.time for t in transitions) > HEALTHY
    file, copy = tmp_path / "baseline.json", tmp_path / "copy.json"
    parameters = [f"baseline_file:={file}", f"export_file:={copy}", "least_windows:=5", "stale_after:=1.0"]
    with Probe() as probe, running("gear_monitor_node", parameters) as monitor:
        watcher = Watcher(probe, monitor)
        watcher.feed(blocks(table))
        watcher.wait_for(lambda level, _m, _v: level == DiagnosticStatus.STALE)
        _, _, message, values = watcher.entries("alarms")[-1]
        assert message.startswith("no samples, held: ERROR: ")
        assert values["II_1/harmonic_1"].startswith("ERROR: ")
        raised = next(entry for entry in watcher.entries("alarms") if entry[1] == DiagnosticStatus.ERROR)
        assert raised[0] == pytest.approx(first)  # in the message of the very second
        stage = next(e for e in watcher.entries("stage II") if e[0] == raised[0])
        assert stage[1] == DiagnosticStatus.ERROR
        assert "; ERROR: II_" in stage[2]
        lines = [line for line in monitor.stderr.splitlines() if "II_1/harmonic_1" in line]
        changes = [t for t in transitions if t.alarm.feature == "II_1/harmonic_1"]
        assert len(lines) == len(changes)  # a line for a transition, none for what lasts
        acknowledge_freeze_export_reset(watcher, copy)
        monitor.interrupt()
        assert monitor.wait() == 0
    kept = json.loads(file.read_text())
    assert kept["frozen"] is True
    assert kept == json.loads(copy.read_text())
    with Probe() as probe, running("gear_monitor_node", parameters) as monitor:
        watcher = Watcher(probe, monitor)
        _, level, message, values = watcher.wait_for(lambda _l, _m, v: v["bins that judge (1)"] != "0")
        assert (level, message, values["baseline"]) == (DiagnosticStatus.OK, "no alarm", "frozen")
        assert "baseline of" in monitor.stderr


@pytest.fixture
def kept(tmp_path):
    """The file of a baseline of this machine."""
    path = tmp_path / "baseline.json"
    store.write(path, Baseline(), identity_of(paper(), Windows()))
    return path


def refused(path, *parameters):
    """The one line with which the node ends."""
    before = path.read_bytes() if path.is_file() else None
    with running("gear_monitor_node", [f"baseline_file:={path}", *parameters]) as monitor:
        assert monitor.wait(STARTING) == 2
        (line,) = [line for line in monitor.stderr.splitlines() if line.strip()]
    assert before is None or path.read_bytes() == before
    assert [other for other in path.parent.iterdir() if other != path] == [] if before is not None else True
    return line


def test_files_that_are_no_baseline_of_this_machine_are_refused_and_kept(kept, tmp_path):
    assert "identity: windows (s): expected [4, 32] as of this machine, got [4, 16]" in refused(
        kept, "label_seconds:=32"
    )
    kept.write_bytes(kept.read_bytes().replace(b'"frozen": false', b'"frozen": true'))
    assert "damaged, or changed by hand" in refused(kept)
    kept.write_bytes(kept.read_bytes()[:50])
    assert "damaged: not JSON" in refused(kept)
    assert "no folder" in refused(tmp_path / "missing" / "baseline.json")
