"""The rim to ROS: parameters, stamps, exit codes; with real nodes, in this process and in others."""

import signal
import subprocess
import sys
from dataclasses import dataclass

import pytest
import rclpy
from hypothesis import given
from hypothesis import strategies as st
from rclpy.context import Context
from rclpy.parameter import Parameter

from nw_gear_common.errors import InputError
from nw_gear_common.quantities import quantity
from nw_gear_common.ros import declare_parameters, to_seconds, to_stamp, was_set
from test.system.processes import Probe, Process, environment


@dataclass(frozen=True)
class Settings:
    rate: float = quantity(10.0, "Rate.", "Hz", minimum=1.0, maximum=100.0)
    speed: float = quantity(11.5, "Speed.", "m/s", minimum=0.0, live=True)
    count: int = quantity(1, "Count.", minimum=0)
    source: str = quantity("weibull", "Source.", choices=("weibull", "gust"))
    names: tuple[str, ...] = quantity(("a", "b"), "Names.")


@pytest.fixture
def make():
    context = Context()
    rclpy.init(context=context)
    nodes = []

    def build(**values):
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        nodes.append(rclpy.create_node("example", context=context, parameter_overrides=overrides))
        return nodes[-1]

    yield build
    for node in nodes:
        node.destroy_node()
    rclpy.shutdown(context=context)


def test_defaults_are_declared_with_text_unit_and_range(make):
    node = make()
    assert declare_parameters(node, Settings) == Settings()
    descriptor = node.describe_parameter("rate")
    assert descriptor.description == "Rate."
    assert "Hz" in descriptor.additional_constraints
    assert (descriptor.floating_point_range[0].from_value, descriptor.floating_point_range[0].to_value) == (1.0, 100.0)
    assert descriptor.read_only
    assert not node.describe_parameter("speed").read_only


def test_values_from_outside_are_taken(make):
    node = make(rate=20.0, count=4, source="gust", names=["c"])
    assert declare_parameters(node, Settings) == Settings(20.0, 11.5, 4, "gust", ("c",))
    assert was_set(node, "rate")
    assert not was_set(node, "speed")


@pytest.mark.parametrize(
    ("name", "value"),
    [("rate", 0.5), ("rate", 1000.0), ("rate", "fast"), ("rate", 20), ("count", 2.0), ("source", "storm"), ("typo", 1)],
)
def test_wrong_values_are_refused_in_one_line(make, name, value):
    with pytest.raises(InputError) as refused:
        declare_parameters(make(**{name: value}), Settings)
    assert refused.value.place == f"parameter {name}"
    assert "\n" not in str(refused.value)


def test_a_live_parameter_changes_and_the_others_do_not(make):
    node = make()
    seen = []
    declare_parameters(node, Settings, seen.append)
    assert node.set_parameters([Parameter("speed", value=8.0)])[0].successful
    assert seen == [Settings(speed=8.0)]
    assert not node.set_parameters([Parameter("rate", value=20.0)])[0].successful
    assert not node.set_parameters([Parameter("speed", value=-1.0)])[0].successful
    assert seen == [Settings(speed=8.0)]


def test_a_refused_change_leaves_the_old_value(make):
    node = make()

    def refuse(_settings):
        raise InputError("parameter speed", "less", "more")

    declare_parameters(node, Settings, refuse)
    result = node.set_parameters([Parameter("speed", value=8.0)])[0]
    assert (result.successful, result.reason) == (False, "parameter speed: expected less, got more")
    assert node.get_parameter("speed").value == 11.5


@given(st.floats(0.0, 4e9))
def test_stamps_keep_seconds_to_the_nanosecond(seconds):
    stamp = to_stamp(seconds)
    assert 0 <= stamp.nanosec < 1_000_000_000
    assert to_seconds(stamp) == pytest.approx(seconds, rel=2e-16, abs=0.6e-9)


NODE = """
import sys
from rclpy.node import Node
from nw_gear_common import ros
from nw_gear_common.errors import InputError

class Example(Node):
    def __init__(self, name, stop, **kwargs):
        super().__init__(name, **kwargs)
        ending = self.declare_parameter("ending", "").value
        self.pub = self.create_publisher(__import__("std_msgs.msg").msg.Empty, "here", 1)
        if ending == "input":
            raise InputError("parameter ending", "nothing", ending)
        if ending == "finished":
            stop()
        if ending == "failure":
            stop(ros.NodeFailure("step 3: x_I_1 is 1e9"))
    def close(self):
        print("closed", flush=True)

sys.exit(ros.run("example", lambda stop: ros.make_node(Example, "example", stop=stop), sys.argv))
"""


def run_node(*arguments):
    command = [sys.executable, "-c", NODE, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=30, env=environment())


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["--ros-args", "-p", "ending:=finished"], 0, ""),
        (["--ros-args", "-p", "ending:=failure"], 1, "example: step 3: x_I_1 is 1e9\n"),
        (["--ros-args", "-p", "ending:=input"], 2, "example: parameter ending: expected nothing, got input\n"),
        (["left", "over"], 2, "example: arguments: expected only ROS arguments (--ros-args ...), got left over\n"),
    ],
)
def test_the_end_of_a_node_is_its_exit_code(arguments, code, message):
    done = run_node(*arguments)
    assert (done.returncode, done.stderr) == (code, message)


def test_ros_arguments_that_make_no_sense_are_refused():
    done = run_node("--ros-args", "-p", "nonsense")
    assert done.returncode == 2
    assert done.stderr.startswith("example: --ros-args: expected valid ROS arguments, got ")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("namespace", ["/nw_gear", "/other"])
def test_a_node_lives_in_its_namespace_and_ends_on_a_signal(number, namespace):
    arguments = [] if namespace == "/nw_gear" else ["--ros-args", "-r", f"__ns:={namespace}"]
    process = Process([sys.executable, "-c", NODE, *arguments])
    try:
        with Probe() as probe:
            probe.wait_for_match(f"{namespace}/here", process, publishers=1)
        process.signal(number)
        assert process.wait() == 0
        assert process.stdout == "closed\n"
    finally:
        process.close()
