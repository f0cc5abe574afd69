"""The simulator as a process, looked at over DDS."""

import re

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import WrenchStamped
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import SetBool, Trigger

from nw_gear_common import names
from nw_gear_common.ros import from_message, latched_qos, to_seconds
from nw_gear_monitor.records.reader import Recording
from test.system.processes import Probe, running

COMPILING = 120.0
"""Longest wait for the first block (s): a machine without compiled kernels makes them first."""
FIXED = ["config:=rated", "wait_for:=1"]


def waveform(messages):
    return np.vstack([from_message(m, names.WAVEFORM).data for m in messages])


def statuses(arrays, name="gear_sim_node: integration"):
    return [s for array in arrays for s in array.status if s.name == name]


def test_waveform_is_contiguous_and_named_as_the_contract_says():
    with Probe() as probe:
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        with running("gear_sim_node", [*FIXED, "duration:=1.5", "real_time_factor:=0.0"]) as sim:
            probe.wait_until(lambda: len(blocks) >= 30, sim, limit=COMPILING)
            assert sim.wait() == 0
    tables = [from_message(m, "waveform") for m in blocks]
    assert {len(t) for t in tables} == {256}
    assert tables[0].columns == names.waveform_columns()
    assert tables[0].row == "sample"
    data = waveform(blocks)
    assert data[:, 0] == pytest.approx(np.arange(30 * 256) / 5120.0, abs=1e-9)
    assert np.isfinite(data).all()
    teeth_times_speed = 91 * 17.3 * np.pi / 30
    assert np.diff(data[:, 1]) == pytest.approx(teeth_times_speed / 5120.0, rel=1e-6)


def test_every_topic_of_the_contract_is_there_in_real_time():
    with Probe() as probe:
        mesh = probe.collect(JointState, "/nw_gear/mesh")
        shafts = probe.collect(JointState, "/nw_gear/shafts")
        bearings = {b: probe.collect(WrenchStamped, f"/nw_gear/bearings/{b}") for b in names.BEARINGS}
        truth = probe.collect(DiagnosticStatus, "/nw_gear/truth", latched_qos())
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        diagnostics = probe.collect(DiagnosticArray, "/diagnostics")
        with running("gear_sim_node", FIXED) as sim:
            probe.wait_until(lambda: len(blocks) >= 40 and len(truth) >= 2, sim, limit=COMPILING)
            assert list(mesh[0].name) == list(names.MESHES)
            assert list(shafts[0].name) == list(names.SHAFTS)
            assert all(bearings.values())
            turned = np.array(shafts[-1].position) - np.array(shafts[0].position)
            assert turned[3] / turned[0] == pytest.approx(56.2184, rel=1e-3)
            assert {"excitation", "open fraction III (1)"} <= {pair.key for pair in truth[-1].values}
            assert statuses(diagnostics)
            seen = to_seconds(probe.node.get_clock().now().to_msg())
            assert abs(waveform(blocks)[-1, 0] - seen) < 2.0
            sim.interrupt()
            assert sim.wait() == 0


def test_the_same_seed_gives_the_same_waveform_bit_for_bit():
    def record():
        with Probe() as probe:
            blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
            parameters = ["wait_for:=1", "duration:=2.0", "real_time_factor:=0.0"]
            with (
                running("gear_sim_node", parameters) as sim,
                running("wind_node", ["seed:=7", "use_sim_time:=true"]) as wind,
            ):
                probe.wait_until(lambda: sim.code is not None, wind, limit=COMPILING)
                assert sim.code == 0, sim.report()
                probe.wait_until(lambda: len(blocks) >= 40)  # the reader lags behind the process
            return [bytes(m.data) for m in blocks]

    first, second = record(), record()
    assert len(first) == 40
    assert first == second


def test_a_machine_that_cannot_keep_pace_says_so():
    with Probe() as probe:
        diagnostics = probe.collect(DiagnosticArray, "/diagnostics")
        with running("gear_sim_node", ["config:=rated", "real_time_factor:=500.0"]) as sim:
            slow = lambda: [s for s in statuses(diagnostics) if s.level == DiagnosticStatus.WARN]  # noqa: E731
            probe.wait_until(lambda: bool(slow()), sim, limit=COMPILING)
            assert "can't keep pace" in slow()[0].message
            values = {pair.key: pair.value for pair in slow()[0].values}
            assert 0.0 < float(values["real_time_factor reached (1)"]) < 500.0
            probe.wait_until(lambda: "can't keep pace" in sim.stderr, sim)


def test_without_wind_it_waits_and_says_for_what():
    with Probe() as probe:
        diagnostics = probe.collect(DiagnosticArray, "/diagnostics")
        with running("gear_sim_node") as sim:
            waiting = lambda: [s for s in statuses(diagnostics) if "waiting for" in s.message]  # noqa: E731
            probe.wait_until(lambda: bool(waiting()), sim, limit=COMPILING)
            assert "wind_speed" in waiting()[0].message


def test_a_diverged_integration_ends_with_time_state_and_step_and_publishes_no_nan(tmp_path):
    """A file whose torque rises to a million times the rated one tears the gearbox apart; its recording is whole."""
    file = tmp_path / "apart.csv"
    file.write_text("time (s),speed (rad/s),torque (N m)\n0,1.8,4e6\n1,1.8,4e6\n1.01,1.8,4e12\n9,1.8,4e12\n")
    drive = [f"drive_file:={file}", "drive_gaps:=bridge"]
    with Probe() as probe:
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        with (
            running("recorder_node", [f"uri:={tmp_path / 'run'}"]) as recorder,
            running("gear_sim_node", ["real_time_factor:=0.0", "wait_for:=2", *drive]) as sim,
        ):
            probe.wait_until(lambda: sim.code is not None, recorder, limit=COMPILING)
            assert sim.code == 1
            probe.wait_until(lambda: len(blocks) >= 20)  # those before the torque rose
            recorder.interrupt()
            assert recorder.wait() == 0
            message = sim.stderr.strip().splitlines()[-1]
    assert re.match(r"gear_sim_node: integration diverged at 1\.\d+ s \(step \d+\): \S+.* is \S+ m", message), message
    data = waveform(blocks)
    assert np.isfinite(data).all()
    assert len(data) == 20 * 256
    with Recording.open(tmp_path / "run") as recording:
        assert recording.complete
        recorded = np.vstack([table.data for _time, table in recording.tables("/nw_gear/waveform")])
    assert np.array_equal(recorded, data)


def test_pause_stops_time_and_reset_starts_again():
    with Probe() as probe:
        clocks = probe.collect(Clock, "/clock")
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        diagnostics = probe.collect(DiagnosticArray, "/diagnostics")
        with running("gear_sim_node", ["config:=rated", "publish_clock:=true", "wait_for:=1"]) as sim:
            probe.wait_until(lambda: len(blocks) >= 10, sim, limit=COMPILING)
            assert probe.call(SetBool, "/nw_gear/gear_sim_node/pause", SetBool.Request(data=True), sim).success
            probe.wait_until(lambda: _quiet(probe, blocks), sim)
            probe.wait_until(lambda: any(s.message == "paused" for s in statuses(diagnostics)), sim)
            assert probe.call(Trigger, "/nw_gear/gear_sim_node/reset", Trigger.Request(), sim).success
            assert probe.call(SetBool, "/nw_gear/gear_sim_node/pause", SetBool.Request(data=False), sim).success
            before = len(blocks)
            probe.wait_until(lambda: len(blocks) >= before + 5, sim)
    times = [from_message(b, "waveform").data[0, 0] for b in blocks]
    assert times.count(0.0) == 2
    stamps = [to_seconds(c.clock) for c in clocks]
    assert min(np.diff(stamps)) < 0.0


def _quiet(probe, blocks):
    before = len(blocks)
    for _ in range(8):
        probe.spin_once(0.05)
    return len(blocks) == before


@pytest.mark.parametrize(
    ("parameter", "words"),
    [
        ("sample_rate:=5000.0", "sample_rate"),
        ("sample_rate:=1e6", "sample_rate"),
        ("excitation:=sideways", "excitation"),
        ("sped:=3", "sped"),
        ("real_time_factor:=fast", "real_time_factor"),
        ("config:=no_such_preset", "no_such_preset"),
        ("waveform_bearings:=[sb, b99]", "b99"),
    ],
)
def test_wrong_parameters_are_refused_in_one_line(parameter, words):
    with running("gear_sim_node", [parameter]) as sim:
        assert sim.wait() == 2
        lines = [line for line in sim.stderr.splitlines() if line.startswith("gear_sim_node:")]
        assert len(lines) == 1
        assert words in lines[0]
        assert "Traceback" not in sim.stderr


@pytest.mark.parametrize("delay", [0.15, 0.4, 1.0, 2.5])
def test_interrupted_at_any_moment_it_leaves_with_zero(delay):
    with Probe() as probe, running("gear_sim_node", ["config:=rated"]) as sim:
        ready = probe.node.get_clock().now().nanoseconds + int(delay * 1e9)
        while probe.node.get_clock().now().nanoseconds < ready:
            probe.spin_once(0.01)
        sim.interrupt()
        assert sim.wait() == 0, sim.report()
        assert "Traceback" not in sim.stderr
