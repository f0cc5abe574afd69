"""config/nodes.yaml: ROS reads it in any namespace, and it says what the nodes declare."""

import importlib
import subprocess

import pytest
import yaml
from geometry_msgs.msg import Vector3Stamped

from nw_gear_common.launcher import NODES
from nw_gear_common.quantities import check_value, quantities
from test.system.installing import ROOT
from test.system.processes import Probe, command, environment, running

FILE = ROOT / "config" / "nodes.yaml"
DECIDED_BY_THE_NODE = {"publish_clock"}


def test_every_parameter_stands_there_with_its_default_and_type():
    content = yaml.safe_load(FILE.read_text(encoding="utf-8"))
    assert set(content) == {f"/**/{node}" for node in NODES}
    for node, module in NODES.items():
        written = content[f"/**/{node}"]["ros__parameters"]
        declared = {
            n: (kind, default, text) for n, kind, default, text in quantities(importlib.import_module(module).Settings)
        }
        assert {n for n, (_k, default, _t) in declared.items() if default != ()} - DECIDED_BY_THE_NODE == set(written)
        for name, value in written.items():
            kind, default, text = declared[name]
            assert not (kind is float and isinstance(value, int)), f"{node}: {name} is a double and needs its point"
            assert check_value(f"{node}: {name}", value, kind, text) == default


@pytest.mark.parametrize("node", sorted(NODES))
@pytest.mark.parametrize("namespace", ["/nw_gear", "/park/turbine_7"])
def test_the_file_reaches_every_node_in_every_namespace(node, namespace, tmp_path):
    changed = tmp_path / "changed.yaml"
    text = FILE.read_text(encoding="utf-8")
    head = f"/**/{node}:\n  ros__parameters:\n"
    assert head in text
    changed.write_text(text.replace(head, head + "    no_such_parameter: 1\n"), encoding="utf-8")
    arguments = ["--ros-args", "--params-file", str(changed), "-r", f"__ns:={namespace}"]
    words = [*command(node), *arguments]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60, env=environment())
    assert done.returncode == 2
    assert "parameter no_such_parameter" in done.stderr


def test_a_node_runs_with_the_file(tmp_path):
    changed = tmp_path / "changed.yaml"
    text = (
        FILE.read_text(encoding="utf-8")
        .replace('source: "weibull"', 'source: "constant"')
        .replace("speed: 11.5", "speed: 6.25")
    )
    changed.write_text(text, encoding="utf-8")
    ros = ["--params-file", str(changed), "-r", "__ns:=/park/turbine_7"]
    with running("wind_node", ros=ros) as wind, Probe() as probe:
        received = probe.collect(Vector3Stamped, "/park/turbine_7/wind_speed", depth=20)
        probe.wait_until(lambda: len(received) >= 2, wind)
    assert {message.vector.x for message in received} == {6.25}
