"""The launch files: what they would start, and whether the executables and parameters they name exist."""

import importlib
import runpy
from pathlib import Path

import pytest

from nw_gear_common.launcher import NODES
from nw_gear_common.quantities import check_value, quantities
from test.system import fake_launch

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def described(monkeypatch):
    fake_launch.install(monkeypatch)
    return lambda name: runpy.run_path(str(ROOT / "launch" / name))["generate_launch_description"]()


def started(description, **given):
    context = description.arguments(**given)
    return {node.executable: fake_launch.parameters(node, context) for node in description.nodes(context)}


def check_against_the_nodes(nodes):
    for executable, values in nodes.items():
        settings = importlib.import_module(NODES[executable]).Settings
        declared = {name: (kind, text) for name, kind, _default, text in quantities(settings)}
        for name, value in values.items():
            if name != "use_sim_time":
                check_value(f"{executable}: {name}", value, *declared[name])


def test_simulate_starts_the_suite_without_a_recorder(described):
    nodes = started(described("simulate.launch.py"))
    assert set(nodes) == {"wind_node", "gear_sim_node", "gear_monitor_node"}
    assert nodes["gear_sim_node"]["wait_for"] == 1
    check_against_the_nodes(nodes)


def test_simulate_records_where_a_folder_is_named(described):
    nodes = started(described("simulate.launch.py"), record="runs/one", wind="gust", seed="3", config="rated")
    assert nodes["recorder_node"]["uri"] == "runs/one"
    assert nodes["gear_sim_node"]["wait_for"] == 2
    assert (nodes["wind_node"]["source"], nodes["wind_node"]["seed"]) == ("gust", 3)
    check_against_the_nodes(nodes)


@pytest.mark.parametrize(("factor", "follows"), [("1.0", False), ("0.0", True), ("2.5", True)])
def test_simulate_follows_the_clock_where_time_is_not_real(described, factor, follows):
    nodes = started(described("simulate.launch.py"), real_time_factor=factor, record="x")
    assert nodes["gear_sim_node"]["real_time_factor"] == float(factor)
    assert {n: v.get("use_sim_time") for n, v in nodes.items() if n != "gear_sim_node"} == dict.fromkeys(
        ("wind_node", "gear_monitor_node", "recorder_node"), follows
    )


def test_simulate_puts_all_nodes_into_one_namespace(described):
    description = described("simulate.launch.py")
    context = description.arguments(namespace="turbine_7")
    assert {context.text(node.namespace) for node in description.nodes(context)} == {"turbine_7"}


@pytest.mark.parametrize(("name", "more"), [("simulate.launch.py", {}), ("replay.launch.py", {"uri": "runs/one"})])
def test_a_domain_is_set_for_all_nodes_where_one_is_named(described, name, more):
    description = described(name)
    assert description.environment(description.arguments(**more)) == {}
    assert description.environment(description.arguments(domain="7", **more)) == {"ROS_DOMAIN_ID": "7"}


def test_simulate_shows_a_page_where_it_is_wanted(described):
    nodes = started(described("simulate.launch.py"), dashboard="true", port="5007", record="runs/one", config="rated")
    assert nodes["dashboard_node"]["port"] == 5007
    assert nodes["gear_sim_node"]["wait_for"] == 3
    check_against_the_nodes(nodes)


def test_simulate_takes_other_loads_than_the_wind(described):
    nodes = started(described("simulate.launch.py"), scenario="grid_loss", drive_file="turbine.outb")
    assert nodes["gear_sim_node"]["scenario"] == "grid_loss"
    assert nodes["gear_sim_node"]["drive_file"] == "turbine.outb"
    check_against_the_nodes(nodes)


def test_replay_records_what_the_monitor_says_anew(described):
    given = {"uri": "runs/one", "monitor": "true", "record": "runs/again", "dashboard": "True", "namespace": "a"}
    description = described("replay.launch.py")
    context = description.arguments(**given)
    places = {node.executable: context.text(node.namespace) for node in description.nodes(context)}
    again = dict.fromkeys(("gear_monitor_node", "recorder_node"), "again/a")
    assert places == {**again, **dict.fromkeys(("replay_node", "dashboard_node"), "a")}
    nodes = started(description, **given)
    assert nodes["replay_node"]["wait_for"] == 2
    check_against_the_nodes(nodes)


@pytest.mark.parametrize(("name", "more"), [("simulate.launch.py", {}), ("replay.launch.py", {"uri": "runs/one"})])
def test_another_namespace_has_a_clock_of_its_own(described, name, more):
    description = described(name)
    for namespace, clock in ((None, "/clock"), ("nw_gear", "/clock"), ("/turbine_7", "/turbine_7/clock")):
        context = description.arguments(**more, **({"namespace": namespace} if namespace else {}))
        for node in description.nodes(context):
            assert [(a, context.text(b)) for a, b in node.remappings] == [("/clock", clock)]


def test_replay_starts_a_replay(described):
    nodes = started(described("replay.launch.py"), uri="runs/one", rate="2.0", loop="true")
    assert set(nodes) == {"replay_node"}
    expected = {"uri": "runs/one", "rate": 2.0, "loop": True}
    assert expected.items() <= nodes["replay_node"].items()
    check_against_the_nodes(nodes)


def test_replay_asks_for_a_recording(described):
    with pytest.raises(AssertionError, match="uri is required"):
        started(described("replay.launch.py"))


def test_the_monitor_of_a_replay_listens_to_what_is_replayed(described):
    nodes = started(described("replay.launch.py"), uri="runs/one", monitor="true", namespace="a")
    assert nodes["gear_monitor_node"]["waveform_topic"] == "/a/waveform"
    assert nodes["gear_monitor_node"]["use_sim_time"] is True
    assert nodes["replay_node"]["wait_for"] == 1
    check_against_the_nodes(nodes)


@pytest.mark.parametrize("name", ["simulate.launch.py", "replay.launch.py"])
def test_every_parameter_file_named_exists(described, name):
    description = described(name)
    context = description.arguments(**({"uri": "x"} if name.startswith("replay") else {}))
    for node in description.nodes(context):
        files = [context.text(part) for part in node.parameters if not isinstance(part, dict)]
        assert files
        assert all(Path(file).is_file() for file in files)
