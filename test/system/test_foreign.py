"""Somebody else's machine over DDS: a logger's file imported, replayed and watched; bad blocks named."""

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import Float64MultiArray

from nw_gear_common import cli, names, share
from nw_gear_common.ros import from_message
from nw_gear_common.tables import Table
from test.monitor import foreign
from test.system.processes import Probe, running
from test.system.test_monitor_node import Feeder

MACHINE = share.find("config/machine_example.yaml")
SECONDS = 12.0


def test_a_file_of_a_logger_is_imported_replayed_and_labelled(tmp_path):
    time, x, angle = foreign.pair(foreign.OMEGA["period-2"], SECONDS)
    file, folder = tmp_path / "bench.csv", tmp_path / "recording"
    columns = {"t": time, "disp": x, "pulse": foreign.tacho(angle), "a_front": foreign.bearing(time, angle)}
    foreign.write_csv(file, columns)
    options = ["--machine", str(MACHINE), "-o", str(folder), "--column", "x_mesh=disp", "--tacho", "pulse"]
    assert cli.main(["import", str(file), *options]) == 0
    with Probe() as probe, running("gear_monitor_node", [f"machine:={MACHINE}"]) as monitor:
        topics = ("indicators/mesh", "indicators/front", "section/pair", "spectrum", "orders")
        received = {topic: probe.collect(Float64MultiArray, f"/nw_gear/{topic}") for topic in topics}
        feeder = Feeder(probe, monitor)
        for topic in topics:
            probe.wait_for_match(f"/nw_gear/{topic}", monitor, publishers=1)
        with running("replay_node", [f"uri:={folder}", "rate:=10.0", "wait_for:=1"]):
            level, message, values = feeder.wait_for("stage pair", lambda _l, _m, v: v["state"] == "period-2")
        assert level == DiagnosticStatus.WARN
        assert message.startswith("period-2: ")
        assert values["subharmonic"] == "f_pair/2"
        rms = float(feeder.latest("bearing front")[2]["rms (m/s^2)"])
        assert rms == pytest.approx(columns["a_front"].std(), rel=0.05)
        assert feeder.latest("stream")[1] == "contiguous"
        probe.wait_until(lambda: all(received.values()), monitor)
        rows = from_message(received["indicators/front"][-1], "front")
        assert rows.column("bpfo_prominence")[0] > 5.0
        points = from_message(received["section/pair"][-1], "section").column("time")
        assert 1.0 / np.median(np.diff(points)) == pytest.approx(foreign.MESH, rel=1e-3)
        assert from_message(received["spectrum"][-1], "spectrum").columns == ("frequency", "mesh")
        monitor.interrupt()
        assert monitor.wait() == 0


def test_bad_blocks_are_named_on_diagnostics():
    rate, rows = 640, 32
    time = np.arange(6 * rate) / rate
    angle = 2.0 * np.pi * 5.0 * time
    data = np.column_stack([time, angle, 1e-5 * np.cos(20.0 * angle), np.full(time.size, 0.3)])
    good = [foreign.table(data[i : i + rows]) for i in range(0, len(data), rows)]
    spoilt = data[:rows].copy()
    spoilt[7, 2] = np.nan
    with Probe() as probe, running("gear_monitor_node", [f"machine:={MACHINE}", "stale_after:=0.5"]) as monitor:
        feeder = Feeder(probe, monitor)
        feeder.feed(good[:50])
        feeder.wait_for("stream", lambda _l, m, _v: m == "constant: a_front")
        feeder.feed([foreign.table(spoilt), good[49], good[48]])
        feeder.wait_for("stream", lambda _l, _m, v: v["malformed blocks (1)"] == "1")
        _, _, values = feeder.wait_for("stream", lambda _l, _m, v: v["blocks that came twice (1)"] == "2")
        assert values["last malformed"] == "values: expected finite numbers, got others in column x_mesh"
        feeder.feed([Table(names.ROW_SAMPLE, ("time", "x_mesh"), data[:rows, :2])])
        _, _, values = feeder.wait_for("stream", lambda _l, _m, v: v["malformed blocks (1)"] == "2")
        assert values["last malformed"].endswith("got none named phase_pinion, a_front")
        feeder.feed([good[51], good[50], *good[52:]])
        _, _, values = feeder.wait_for("stream", lambda _l, _m, v: v["blocks out of order (1)"] == "1")
        assert (values["gaps (1)"], values["restarts (1)"]) == ("1", "0")
        assert monitor.code is None


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        (["machine:=no_such_file.yaml"], "no_such_file.yaml"),
        ([f"machine:={MACHINE}", "config:=period2"], "parameter machine"),
    ],
)
def test_a_machine_that_can_not_be_used_ends_it_with_one_line(parameters, said):
    with running("gear_monitor_node", parameters) as monitor:
        assert monitor.wait() == 2
        lines = [line for line in monitor.stderr.splitlines() if line.strip()]
        assert len(lines) == 1
        assert said in lines[0]
