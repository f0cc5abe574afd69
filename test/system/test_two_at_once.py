"""Suites side by side on one machine, in namespaces of one domain and in domains: none notices the others."""

from contextlib import ExitStack

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_monitor.records.reader import Recording
from test.system.processes import domain, running

SECONDS = 3
LIMIT = 180.0


def start(stack, folder, namespace, seed, ros_domain):
    """A suite as fast as it goes, in a namespace with a clock of its own; returns simulator, others, recording."""
    apart = ["-r", f"__ns:={namespace}", "-r", f"/clock:={namespace}/clock"]

    def node(executable, *parameters):
        clocked = [] if executable == "gear_sim_node" else ["use_sim_time:=true"]
        given = [*parameters, *clocked]
        return stack.enter_context(running(executable, given, ros=apart, ros_domain=ros_domain))

    recorder = node("recorder_node", f"uri:={folder}")
    monitor = node("gear_monitor_node")
    sim = node("gear_sim_node", "real_time_factor:=0.0", f"duration:={SECONDS}.0", "wait_for:=2")
    return sim, (node("wind_node", f"seed:={seed}"), monitor, recorder), folder


@pytest.mark.slow
def test_three_suites_at_once(tmp_path):
    """Two share a domain, two share a namespace and a seed: those two record the same waveform, bit by bit."""
    with ExitStack() as stack:
        suites = {
            "a": start(stack, tmp_path / "a", "/a", 5, domain()),
            "b": start(stack, tmp_path / "b", "/b", 6, domain()),
            "other domain": start(stack, tmp_path / "c", "/a", 5, domain() + 1),
        }
        for sim, others, _folder in suites.values():
            assert sim.wait(LIMIT) == 0, sim.report()
            for process in others:
                process.interrupt()
                assert process.wait() == 0, process.report()
    waveforms = {}
    for name, (_sim, _others, folder) in suites.items():
        space = "/b" if name == "b" else "/a"
        with Recording.open(folder) as recording:
            assert recording.complete
            inside = [t for t in recording.topics if t != names.DIAGNOSTICS]
            assert f"{space}/clock" in inside
            assert all(topic.startswith(f"{space}/") for topic in inside)
            assert recording.provenance["nw_gear.node.wind_node"]["seed"] == ("6" if name == "b" else "5")
            waveforms[name] = np.vstack([table.data for _time, table in recording.tables(f"{space}/waveform")])
            assert recording.end - recording.start <= SECONDS + 1.0
    assert {len(data) for data in waveforms.values()} == {SECONDS * 5120}
    assert waveforms["a"].tobytes() == waveforms["other domain"].tobytes()
    assert waveforms["a"].tobytes() != waveforms["b"].tobytes()
