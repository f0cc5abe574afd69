"""Accelerometers and tacho of the simulator over DDS: published, recorded, the same after a checkpoint."""

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Trigger

from nw_gear_common import names
from nw_gear_common.ros import from_message
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.signals.tacho import read_pulses, strongest, tacho_orders
from test.system.processes import Probe, running

COMPILING = 120.0
"""Longest wait for the first block (s): a machine without compiled kernels makes them first."""
FREE = ["config:=rated", "real_time_factor:=0.0", "wait_for:=1"]
ACCELERATION, TACHO = "/nw_gear/acceleration", "/nw_gear/tacho"
RATIO = 91 / 22 * 83 / 40 * 131 / 20


def listen(probe):
    return {topic: probe.collect(Float64MultiArray, topic) for topic in (ACCELERATION, TACHO, "/nw_gear/waveform")}


def rows(messages, topic):
    return np.vstack([from_message(m, topic).data for m in messages])


def test_both_topics_come_and_are_recorded_and_read_back(tmp_path):
    folder = tmp_path / "run"
    with Probe() as probe:
        heard = listen(probe)
        parameters = [
            *FREE[:2],
            "wait_for:=2",
            "duration:=3.0",
            "acceleration_rate:=10240.0",
            "accelerometers:=[b21, sb]",
        ]
        with running("recorder_node", [f"uri:={folder}"]) as recorder, running("gear_sim_node", parameters) as sim:
            probe.wait_until(lambda: sim.code is not None, recorder, limit=COMPILING)
            assert sim.code == 0, sim.report()
            probe.wait_until(lambda: len(heard[ACCELERATION]) >= 59 and len(heard["/nw_gear/waveform"]) >= 60)
            recorder.interrupt()
            assert recorder.wait() == 0, recorder.report()
    table = from_message(heard[ACCELERATION][0], ACCELERATION)
    assert (table.row, table.columns) == ("sample", ("time", "ax_b21", "ay_b21", "ax_sb", "ay_sb"))
    samples = rows(heard[ACCELERATION], ACCELERATION)
    assert samples[:, 0] == pytest.approx(np.arange(59 * 512) / 10240.0, abs=1e-12)  # the last block isn't complete
    assert (samples[10240:, 1:].std(axis=0) > 0.1).all()
    pulse = from_message(heard[TACHO][0], TACHO)
    assert (pulse.row, pulse.columns) == ("pulse", ("time",))
    pulses = rows(heard[TACHO], TACHO)[:, 0]
    period = 60.0 / (17.3 * RATIO)
    assert np.diff(pulses) == pytest.approx(period, abs=1e-3 * period)
    assert len(pulses) == pytest.approx(3.0 / period, abs=1.0)
    with Recording.open(folder) as recording:
        assert recording.complete
        for topic, expected in ((ACCELERATION, samples), (TACHO, pulses[:, None])):
            found = np.vstack([t.data for _time, t in recording.tables(topic)])
            assert np.array_equal(found, expected)


@pytest.mark.slow
def test_orders_from_a_recording_in_wind_and_its_replay(tmp_path):
    """Wind, gearbox, recorder; then from acceleration and pulses alone the orders that the true phase gives.

    The line of stage II passes a resonance while the speed changes, so that its phase runs: it isn't just where the
    teeth put it, by either way.
    """
    folder = tmp_path / "run"
    with Probe() as probe:
        heard = listen(probe)
        parameters = ["real_time_factor:=0.0", "wait_for:=2", "duration:=20.0"]
        with (
            running("recorder_node", [f"uri:={folder}"]) as recorder,
            running("gear_sim_node", parameters) as sim,
            running("wind_node", ["seed:=3", "use_sim_time:=true"]) as wind,
        ):
            probe.wait_until(lambda: sim.code is not None, recorder, wind, limit=COMPILING)
            assert sim.code == 0, sim.report()
            recorder.interrupt()
            assert recorder.wait() == 0, recorder.report()
        with Recording.open(folder) as recording:
            table = np.vstack([t.data for _time, t in recording.tables(ACCELERATION)])
            times = np.vstack([t.data for _time, t in recording.tables(TACHO)])[:, 0]
            known = np.vstack([t.select(["time", "phase_III"]) for _time, t in recording.tables("/nw_gear/waveform")])
        complete = lambda: (  # noqa: E731
            sum(len(m.data) for m in heard[ACCELERATION]) == table.size
            and sum(len(m.data) for m in heard[TACHO]) == times.size
        )
        probe.wait_until(complete)  # the reader lags behind the processes
        columns = from_message(heard[ACCELERATION][0], ACCELERATION).columns
        for messages in heard.values():
            messages.clear()
        replayed = [f"uri:={folder}", "rate:=10.0", "wait_for:=1"]
        with running("replay_node", replayed) as replay:
            probe.wait_until(lambda: replay.code is not None, limit=COMPILING)
            assert replay.code == 0, replay.report()
            probe.wait_until(complete)
    assert np.array_equal(rows(heard[ACCELERATION], ACCELERATION), table)
    assert np.array_equal(rows(heard[TACHO], TACHO)[:, 0], times)
    pulses = read_pulses(times)
    assert pulses.faults == ()
    turns = known[:, 1] / (20 * 2 * np.pi)
    marks = np.arange(np.ceil(64 * turns[0]), 64 * turns[-1]) / 64
    truth = read_pulses(np.interp(marks, turns, known[:, 0]), 64)
    for column, order in (("ax_pb1_1", 91 / RATIO), ("ax_sb", 91 / 22 * 83 / RATIO), ("ax_b21", 20.0)):
        x = table[:, columns.index(column)]
        found, expected = (
            strongest(tacho_orders(p, table[:, 0], x), 0.98 * order, 1.02 * order) for p in (pulses, truth)
        )
        assert found == pytest.approx(expected, rel=1e-3)
        assert found[0] == pytest.approx(order, rel=3e-3)


def test_what_is_beyond_the_range_is_said():
    with Probe() as probe:
        diagnostics = probe.collect(DiagnosticArray, "/diagnostics")
        parameters = ["config:=rated", "acceleration_range:=0.5", "accelerometers:=[b21]", "tacho_shaft:=''"]
        with running("gear_sim_node", parameters) as sim:
            told = lambda: [  # noqa: E731
                s
                for a in diagnostics
                for s in a.status
                if s.name == "gear_sim_node: accelerometers" and s.level == DiagnosticStatus.WARN
            ]
            probe.wait_until(lambda: bool(told()), sim, limit=COMPILING)
    assert told()[0].message.startswith("clipped: ax_b21")
    values = {pair.key: float(pair.value) for pair in told()[0].values}
    assert values["clipped ax_b21 (1)"] > 100


@pytest.mark.slow
def test_a_checkpoint_goes_on_byte_for_byte(tmp_path):
    file = tmp_path / "state.npz"
    parameters = [*FREE, "duration:=6.0", "tacho_pulses:=32", f"checkpoint:={file}"]
    with Probe() as probe:
        heard = listen(probe)
        with running("gear_sim_node", parameters) as sim:
            probe.wait_until(lambda: len(heard[ACCELERATION]) >= 5, sim, limit=COMPILING)
            answer = probe.call(Trigger, "/nw_gear/gear_sim_node/checkpoint", Trigger.Request(), sim)
            assert answer.success, answer.message
            finish(probe, sim, heard)
        whole = {topic: rows(messages, topic) for topic, messages in heard.items()}
        for messages in heard.values():
            messages.clear()
        with running("gear_sim_node", [*parameters[:-1], f"resume:={file}"]) as sim:
            finish(probe, sim, heard)
    for topic, before in whole.items():
        later = rows(heard[topic], topic)
        assert 0 < len(later) < len(before)
        assert later.tobytes() == before[-len(later) :].tobytes(), topic


def finish(probe, sim, heard):
    """Wait for the end of the run and of its topics: pulses of a 62 Hz shaft mark come up to the end."""
    ends = {ACCELERATION: 5.94, TACHO: 5.99, "/nw_gear/waveform": 5.99}
    probe.wait_until(lambda: sim.code is not None, limit=COMPILING)
    assert sim.code == 0, sim.report()
    probe.wait_until(lambda: all(heard[t] and from_message(heard[t][-1], t).data[-1, 0] > at for t, at in ends.items()))


@pytest.mark.slow
def test_without_sensors_there_are_no_such_topics():
    with Probe() as probe:
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        parameters = ["config:=rated", "accelerometers:=[]", "tacho_shaft:=''"]
        with running("gear_sim_node", parameters) as sim:
            probe.wait_until(lambda: len(blocks) >= 3, sim, limit=COMPILING)
            there = {name for name, _types in probe.node.get_topic_names_and_types()}
    assert f"{names.NAMESPACE}/{names.WAVEFORM}" in there
    assert not {ACCELERATION, TACHO} & there


@pytest.mark.parametrize(
    ("parameter", "words"),
    [
        ("acceleration_rate:=5000.0", "acceleration_rate: expected 20480 Hz times or over a whole number, got 5000 Hz"),
        ("accelerometers:=[b21, nose]", "nose"),
    ],
)
def test_sensors_that_do_not_fit_are_refused_in_one_line(parameter, words):
    with running("gear_sim_node", ["config:=rated", parameter]) as sim:
        assert sim.wait() == 2
        lines = [line for line in sim.stderr.splitlines() if line.startswith("gear_sim_node:")]
        assert len(lines) == 1
        assert words in lines[0]
