"""The monitor as a process, fed over DDS with waveforms whose state is known by construction."""

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Trigger

from nw_gear_common import names
from nw_gear_common.ros import from_message, live_qos, to_message
from nw_gear_common.tables import Table
from nw_gear_monitor.pipeline import Pipeline
from test.monitor.gear_signal import blocks, paper, waveform
from test.system.processes import Probe, running

COMPILING = 120.0
"""Longest wait for the subscription (s): a machine without compiled kernels makes them first."""


def half_order(_time, phase):
    return 6e-6 * np.cos(0.5 * phase) + 2e-6 * np.cos(1.5 * phase)


class Feeder:
    """A probe that plays the simulator for a monitor that runs."""

    def __init__(self, probe, monitor):
        self.probe, self.monitor = probe, monitor
        self.diagnostics = probe.collect(DiagnosticArray, names.DIAGNOSTICS)
        self._publisher = probe.node.create_publisher(Float64MultiArray, "/nw_gear/waveform", live_qos(1000))
        probe.wait_until(lambda: self._publisher.get_subscription_count() > 0, monitor, limit=COMPILING)
        probe.wait_for_match(names.DIAGNOSTICS, monitor, publishers=1)

    def feed(self, tables):
        for table in tables:
            self.publish(to_message(table))
            self.probe.spin_once(0.0)

    def publish(self, message):
        self._publisher.publish(message)

    def latest(self, name):
        """The newest status of this name as (level, message, values); None before the first."""
        for array in reversed(self.diagnostics):
            for status in array.status:
                if status.name == f"gear_monitor_node: {name}":
                    return status.level, status.message, {pair.key: pair.value for pair in status.values}
        return None

    def wait_for(self, name, condition, limit=60.0):
        def holds():
            latest = self.latest(name)
            return latest is not None and condition(*latest)

        self.probe.wait_until(holds, self.monitor, limit=limit)
        return self.latest(name)


def test_what_it_publishes_is_what_the_pipeline_gives_offline():
    table = waveform(11.0, extra={"II": half_order}, noise=0.01)
    offline = Pipeline(paper())
    hops = [hop for block in blocks(table, 999) for hop in offline.feed(block)]
    published = {
        names.SPECTRUM: [hop.spectrum for hop in hops if hop.spectrum],
        names.ORDERS: [hop.orders for hop in hops if hop.orders],
        **{names.section_topic(stage): [hop.sections[stage] for hop in hops] for stage in names.STAGES},
        **{names.indicators_topic(mesh): [hop.indicators[mesh] for hop in hops] for mesh in names.MESHES},
    }
    topics = list(published)
    with Probe() as probe, running("gear_monitor_node") as monitor:
        received = {topic: probe.collect(Float64MultiArray, f"/nw_gear/{topic}") for topic in topics}
        feeder = Feeder(probe, monitor)
        for topic in topics:
            probe.wait_for_match(f"/nw_gear/{topic}", monitor, publishers=1)
        feeder.feed(blocks(table))
        level, message, values = feeder.wait_for("stage II", lambda _l, _m, v: v["state"] == "period-2")
        assert level == DiagnosticStatus.WARN
        assert message.startswith("period-2: ")
        assert values["subharmonic"] == "f_II/2"
        assert float(values["rho (1)"]) < 0.01
        assert feeder.latest("stage I")[1].startswith("period-1: ")
        assert feeder.latest("bearing sb")[2]["mean (N)"] == "14142.1"
        assert feeder.latest("computation")[2]["hops (1)"] != "0"
        probe.wait_until(lambda: all(len(received[t]) == len(published[t]) for t in topics), monitor)
        monitor.interrupt()
        assert monitor.wait() == 0
    for topic in topics:
        for message, wanted in zip(received[topic], published[topic], strict=True):
            got = from_message(message, topic)
            assert (got.row, got.columns) == (wanted.row, wanted.columns)
            assert np.allclose(got.data, wanted.data, rtol=1e-9, atol=1e-18, equal_nan=True)


def test_gaps_bad_blocks_silence_and_reset_are_reported():
    table = waveform(13.0)
    pieces = blocks(table)
    with Probe() as probe, running("gear_monitor_node", ["stale_after:=1.0"]) as monitor:
        feeder = Feeder(probe, monitor)
        feeder.wait_for("stage I", lambda _l, m, _v: m.startswith("unknown: no whole second"))
        feeder.feed(pieces[:220])
        feeder.wait_for("stage III", lambda _l, _m, v: v["state"] == "period-1")
        level, message, values = feeder.wait_for("stage III", lambda _l, _m, v: v["state"] == "stale")
        assert level == DiagnosticStatus.STALE
        assert "no samples" in message
        response = probe.call(Trigger, "/nw_gear/gear_monitor_node/reset", Trigger.Request(), monitor)
        assert response.success
        feeder.publish(Float64MultiArray())
        feeder.publish(to_message(Table("bin", table.columns, table.data[:4])))
        _, _, values = feeder.wait_for("stream", lambda _l, _m, v: v["malformed blocks (1)"] == "2")
        assert "row meaning" in values["last malformed"]
        feeder.feed([*pieces[220:229], *pieces[230:]])
        level, message, values = feeder.wait_for("stream", lambda _l, _m, v: v["gaps (1)"] == "1")
        assert float(values["lost (s)"]) == pytest.approx(0.05, abs=1e-6)
        assert "0.05 s missing before 11.5" in values["last break"]
        feeder.wait_for("stage III", lambda _l, m, _v: m.startswith("unknown: 1 of at least 8 s"))


@pytest.mark.parametrize(
    ("parameter", "said"),
    [
        ("label_seconds:=4", "label_seconds"),
        ("window:=16", "window"),
        ("config:=no_such_file.yaml", "no_such_file.yaml"),
    ],
)
def test_wrong_parameters_end_it_with_one_line(parameter, said):
    with running("gear_monitor_node", [parameter]) as monitor:
        assert monitor.wait() == 2
        lines = [line for line in monitor.stderr.splitlines() if line.strip()]
        assert len(lines) == 1
        assert said in lines[0]
        assert "expected" in lines[0]
