"""The simulator driven by something else than the wind, through load cases, and from checkpoints, over DDS."""

import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Trigger

from nw_gear_common import names
from nw_gear_common.ros import from_message, latched_qos, to_stamp
from test.system.processes import Probe, running

COMPILING = 120.0
"""Longest wait for the first block (s): a machine without compiled kernels makes them first."""
FREE = ["real_time_factor:=0.0", "wait_for:=1"]
RATED_SPEED, RATED_TORQUE = 17.3 * math.pi / 30, 4.3e6


def ended(probe, blocks, sim, seconds):
    """Wait for the end of a run, and for the block that ends with it: the reader lags behind the process."""
    probe.wait_until(lambda: sim.code is not None, sim, limit=COMPILING)
    assert sim.code == 0, sim.report()
    last = lambda: from_message(blocks[-1], names.WAVEFORM).data[-1, 0] if blocks else -1.0  # noqa: E731
    probe.wait_until(lambda: last() > seconds - 1.5 / 5120)


def kept():
    """Quality of service of a publisher whose late subscribers get all that has been said."""
    qos = latched_qos()
    qos.depth = 10
    return qos


def run(parameters, seconds):
    """Waveform rows, truth and shafts of a run that ends by itself."""
    with Probe() as probe:
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        truth = probe.collect(DiagnosticStatus, "/nw_gear/truth", latched_qos())
        shafts = probe.collect(JointState, "/nw_gear/shafts")
        with running("gear_sim_node", [*FREE, *parameters]) as sim:
            ended(probe, blocks, sim, seconds)
    values = [{pair.key: pair.value for pair in status.values} for status in truth]
    return np.vstack([from_message(b, names.WAVEFORM).data for b in blocks]), values, shafts


def test_a_file_as_openfast_writes_it(tmp_path):
    file = tmp_path / "turbine.out"
    rows = "".join(f"{0.5 * k:.3f}\t{12 + k}\t{2000 + 100 * k}\n" for k in range(5))
    file.write_text("A run\n\nDescription\n\nOne turbine\n\nTime\tRotSpeed\tRotTorq\n(s)\t(rpm)\t(kN-m)\n" + rows)
    data, _, _ = run([f"drive_file:={file}"], 2.0)
    assert len(data) == 2 * 5120  # ends with the file
    phase = data[:, names.waveform_columns().index("phase_I")]
    speed = np.diff(phase) * 5120 / 91 * 30 / math.pi
    assert speed == pytest.approx(12 + 2 * (np.arange(len(speed)) + 0.5) / 5120, rel=1e-4)


def test_a_loss_of_the_grid_reverses_the_torque():
    data, truth, shafts = run(["config:=rated", "scenario:=grid_loss", "scenario_time:=1.0", "duration:=4.0"], 4.0)
    assert truth[-1]["drive"] == "load case grid_loss"
    assert float(truth[-1]["event (s)"]) == pytest.approx(1.0, abs=0.02)
    torque = [message.effort[0] for message in shafts]
    assert min(torque) < -0.2 * RATED_TORQUE
    assert np.isfinite(data).all()
    back = {key: max(float(values[key]) for values in truth) for key in truth[-1] if key.startswith("back-flank")}
    assert min(back.values()) > 0.0


def test_somebody_else_says_speed_and_torque():
    """The elongations follow the torque that was sent, and a message that makes no sense is refused."""
    with Probe() as probe:
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        publisher = probe.node.create_publisher(JointState, "/nw_gear/drive", kept())
        with running("gear_sim_node", [*FREE, "drive:=topic", "duration:=2.0"]) as sim:
            for speed in (math.nan, RATED_SPEED):
                for stamp in (0.0, 5.0):
                    torque = RATED_TORQUE * (1.0 - 0.1 * stamp)
                    message = JointState(name=["ring"], velocity=[speed], effort=[torque])
                    message.header.stamp = to_stamp(stamp)
                    publisher.publish(message)
            ended(probe, blocks, sim, 2.0)
    data = np.vstack([from_message(b, names.WAVEFORM).data for b in blocks])
    x = data[:, names.waveform_columns().index("x_III")]
    start, end = x[:512].mean() - 50e-6, x[-512:].mean() - 50e-6
    assert end / start == pytest.approx(1.0 - 0.1 * 1.95, rel=0.03)  # the force follows; 50 um is the backlash


@pytest.mark.parametrize(
    "drive", [["config:=rated"], ["config:=rated", "scenario:=emergency_stop", "scenario_time:=0.3"]]
)
def test_a_checkpoint_goes_on_byte_for_byte(tmp_path, drive):
    file = tmp_path / "state.npz"
    parameters = [*drive, "real_time_factor:=0.0", "wait_for:=1", f"checkpoint:={file}"]
    with Probe() as probe:
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        with running("gear_sim_node", [*parameters, "duration:=6.0"]) as sim:
            probe.wait_until(lambda: len(blocks) >= 5, sim, limit=COMPILING)
            answer = probe.call(Trigger, "/nw_gear/gear_sim_node/checkpoint", Trigger.Request(), sim)
            assert answer.success, answer.message
            ended(probe, blocks, sim, 6.0)
    whole = np.vstack([from_message(b, names.WAVEFORM).data for b in blocks])
    later, _, _ = run([*drive, f"resume:={file}", "duration:=6.0"], 6.0)
    assert 0 < len(later) < len(whole)
    assert later.tobytes() == whole[-len(later) :].tobytes()


def test_a_checkpoint_goes_on_in_the_same_wind(tmp_path):
    """The wind of a seed is the same at every time, however late it is asked for."""
    file = tmp_path / "state.npz"
    windy = ["use_sim_time:=true", "seed:=5"]
    with Probe() as probe:
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        parameters = [*FREE, "duration:=6.0", f"checkpoint:={file}"]
        with running("gear_sim_node", parameters) as sim, running("wind_node", windy):
            probe.wait_until(lambda: len(blocks) >= 45, sim, limit=COMPILING)
            answer = probe.call(Trigger, "/nw_gear/gear_sim_node/checkpoint", Trigger.Request(), sim)
            assert answer.success, answer.message
            ended(probe, blocks, sim, 6.0)
        before = len(blocks)
        diagnostics = probe.collect(DiagnosticArray, "/diagnostics")
        waits = lambda: any("wind_speed from" in s.message for a in diagnostics for s in a.status)  # noqa: E731
        with running("gear_sim_node", [*FREE, "duration:=6.0", f"resume:={file}"]) as sim:
            probe.wait_until(waits, sim, limit=COMPILING)  # the wind node comes last
            with running("wind_node", windy):
                probe.wait_until(lambda: sim.code is not None, sim, limit=COMPILING)
            assert sim.code == 0, sim.report()
            probe.wait_until(lambda: from_message(blocks[-1], names.WAVEFORM).data[-1, 0] > 5.99)
    whole, later = blocks[:before], blocks[before:]
    assert 0 < len(later) < before - 44
    assert [bytes(b.data) for b in later] == [bytes(b.data) for b in whole[-len(later) :]]


def test_a_checkpoint_goes_on_in_wall_time(tmp_path):
    """The samples that waited for their block come out with the stamps of the new run; the motion has no gap."""
    file = tmp_path / "state.npz"
    with Probe() as probe:
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        with running("gear_sim_node", ["config:=rated", f"checkpoint:={file}"]) as sim:
            probe.wait_until(lambda: len(blocks) >= 3, sim, limit=COMPILING)
            probe.wait_until(lambda: waiting(probe, sim, file) > 0, sim)
    with Probe() as probe:
        blocks = probe.collect(Float64MultiArray, "/nw_gear/waveform")
        with running("gear_sim_node", ["config:=rated", "wait_for:=1", f"resume:={file}"]) as sim:
            probe.wait_until(lambda: len(blocks) >= 3, sim, limit=COMPILING)
    data = np.vstack([from_message(b, names.WAVEFORM).data for b in blocks])
    assert np.diff(data[:, 0]) == pytest.approx(1 / 5120, rel=2e-3)  # stamps of today resolve 0.24 us
    assert np.diff(data[:, 1]) == pytest.approx(91 * RATED_SPEED / 5120, rel=1e-6)


def waiting(probe, sim, file):
    """Take a checkpoint, and return how many samples in it wait for their block."""
    answer = probe.call(Trigger, "/nw_gear/gear_sim_node/checkpoint", Trigger.Request(), sim)
    assert answer.success, answer.message
    with np.load(file) as archive:
        return len(archive["waveform.pending"])


def test_input_that_ends_is_waited_for_and_said():
    with Probe() as probe:
        diagnostics = probe.collect(DiagnosticArray, "/diagnostics")
        publisher = probe.node.create_publisher(JointState, "/nw_gear/drive", kept())
        with running("gear_sim_node", ["real_time_factor:=0.0", "drive:=topic"]) as sim:
            for stamp in (0.0, 0.5):
                message = JointState(name=["ring"], velocity=[RATED_SPEED], effort=[RATED_TORQUE])
                message.header.stamp = to_stamp(stamp)
                publisher.publish(message)
            waits = lambda: [  # noqa: E731
                s for a in diagnostics for s in a.status if s.message == "waiting for drive beyond 0.500 s"
            ]
            probe.wait_until(lambda: bool(waits()), sim, limit=COMPILING)
            assert waits()[0].level == DiagnosticStatus.WARN
            sim.interrupt()
            assert sim.wait() == 0


def test_bad_drives_end_with_one_line(tmp_path):
    (tmp_path / "bad.npz").write_bytes(b"not a checkpoint")
    for parameters, said in (
        (["drive:=file"], "drive_file"),
        (["drive_file:=/nowhere.out"], "nowhere.out"),
        (["drive:=topic", "scenario:=grid_loss"], "scenario"),
        (["config:=rattling", "scenario:=grid_loss"], "operation.load"),
        (["config:=rated", f"resume:={tmp_path / 'bad.npz'}"], "damaged or foreign"),
    ):
        with running("gear_sim_node", [*parameters, "real_time_factor:=0.0"]) as sim:
            assert sim.wait(COMPILING) == 2, sim.report()
            lines = [line for line in sim.stderr.strip().splitlines() if not line.startswith("[INFO]")]
            assert len(lines) == 1
            assert said in lines[0]
            assert "Traceback" not in sim.stderr
