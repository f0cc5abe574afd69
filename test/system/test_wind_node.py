"""The wind node as a process, seen over real DDS."""

import math
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Vector3Stamped
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock

from nw_gear_common.ros import to_seconds
from nw_gear_sim import config
from nw_gear_sim.wind import Settings, make_source
from test.system.processes import Probe, Process, running

TOPIC = "/nw_gear/wind_speed"
LATCHED = QoSProfile(depth=200, durability=DurabilityPolicy.TRANSIENT_LOCAL)
MAST = Path(__file__).parents[1] / "data" / "mast_wind_10min.csv"


def expected(count: int, **values: Any) -> list[float]:
    """The first samples, computed in this process."""
    configuration = config.load()
    source = make_source(Settings(**values), configuration.wind, configuration.turbine)
    return [source.sample(i) for i in range(count)]


def stamps(messages: list[Any]) -> list[float]:
    return [to_seconds(m.header.stamp) for m in messages]


def clock_of(probe: Probe, node: Process) -> Callable[[float], None]:
    """Publisher of /clock, matched with the node."""
    publisher = probe.node.create_publisher(Clock, "/clock", 10)
    probe.wait_until(lambda: publisher.get_subscription_count() > 0, node)

    def tick(seconds: float) -> None:
        message = Clock()
        message.clock.sec, message.clock.nanosec = int(seconds), round(seconds % 1 * 1e9)
        publisher.publish(message)

    return tick


def test_wall_time_ten_samples_a_second_that_a_late_subscriber_gets_too() -> None:
    with running("wind_node", ["seed:=3"]) as wind, Probe() as probe:
        received = probe.collect(Vector3Stamped, TOPIC, LATCHED)
        probe.wait_until(lambda: len(received) >= 25, wind)
        first, last = stamps([received[0], received[-1]])
        assert (last - first) / (len(received) - 1) == pytest.approx(0.1, abs=1e-6)
        # Stamps are near the wall clock, and samples come when they are due.
        now = probe.node.get_clock().now().nanoseconds * 1e-9
        assert -0.01 < now - last < 2.0
        assert received[0].header.frame_id == "rotor"
        assert (received[0].vector.y, received[0].vector.z) == (0.0, 0.0)
        series = expected(1000, seed=3)
        at = series.index(received[0].vector.x)
        assert [m.vector.x for m in received] == series[at : at + len(received)]
        late = probe.collect(Vector3Stamped, TOPIC, LATCHED)
        probe.wait_until(lambda: len(late) >= 20, wind)
        assert stamps(late)[0] < last


def test_simulated_time_one_second_ahead_and_anew_when_the_clock_goes_back() -> None:
    with running("wind_node", ["seed:=5", "use_sim_time:=true"]) as wind, Probe() as probe:
        received = probe.collect(Vector3Stamped, TOPIC, LATCHED)
        probe.wait_until(lambda: len(received) >= 11, wind)  # without any clock
        tick = clock_of(probe, wind)
        for i in range(1, 31):
            tick(i / 10)
            probe.wait_until(lambda i=i: len(received) >= 11 + i, wind)
        assert stamps(received) == pytest.approx([i / 10 for i in range(41)])
        series = expected(41, seed=5)
        assert [m.vector.x for m in received] == series
        received.clear()
        tick(0.0)
        probe.wait_until(lambda: len(received) >= 11, wind)
        assert stamps(received) == pytest.approx([i / 10 for i in range(11)])
        assert [m.vector.x for m in received] == series[:11]


def test_diagnostics_name_source_seed_gaps_and_mean(tmp_path: Path) -> None:
    lines = MAST.read_text().splitlines()
    path = tmp_path / "gappy.csv"
    path.write_text("\n".join(lines[:4] + lines[6:30]))
    with running("wind_node", ["source:=file", f"file:={path}", "seed:=9"]) as wind, Probe() as probe:
        arrays = probe.collect(DiagnosticArray, "/diagnostics")
        probe.wait_until(lambda: bool(arrays), wind)
        status = arrays[0].status[0]
        values = {v.key: v.value for v in status.values}
        assert (status.name, status.hardware_id, status.level) == ("wind_node: wind", "/nw_gear", b"\x01")
        assert "1 gaps bridged" in status.message
        assert (values["source"], values["seed"], values["gaps (1)"], values["bridged (s)"]) == (
            "file",
            "9",
            "1",
            "1800",
        )
        assert math.isfinite(float(values["mean of 60 s (m/s)"]))
        assert "gap of 1800 s after 2016-03-01T00:20:00 bridged" in wind.stderr


def set_parameter(probe: Probe, node: Process, name: str, value: float) -> Any:
    request = SetParameters.Request()
    number = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)
    request.parameters = [Parameter(name=name, value=number)]
    return probe.call(SetParameters, "/nw_gear/wind_node/set_parameters", request, node).results[0]


def test_constant_speed_is_a_live_parameter_and_the_others_are_not() -> None:
    with running("wind_node", ["source:=constant", "speed:=7.0"]) as wind, Probe() as probe:
        received = probe.collect(Vector3Stamped, TOPIC, LATCHED)
        probe.wait_until(lambda: len(received) >= 2, wind)
        assert received[-1].vector.x == 7.0
        assert set_parameter(probe, wind, "speed", 9.0).successful
        probe.wait_until(lambda: received[-1].vector.x == 9.0, wind)
        assert not set_parameter(probe, wind, "speed", -1.0).successful
        assert not set_parameter(probe, wind, "rate", 20.0).successful


def test_parameters_describe_themselves() -> None:
    with running("wind_node") as wind, Probe() as probe:
        request = DescribeParameters.Request(names=["rate"])
        service = "/nw_gear/wind_node/describe_parameters"
        rate = probe.call(DescribeParameters, service, request, wind).descriptors[0]
        assert rate.description == "Samples per second."
        assert (rate.floating_point_range[0].from_value, rate.floating_point_range[0].to_value) == (0.1, 100.0)
        assert "Hz" in rate.additional_constraints


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (["source:=storm"], "parameter source: expected one of weibull, constant, step, gust, file, got 'storm'"),
        (["rate:=0.0"], "parameter rate: expected a number in Hz"),
        (["rate:=10"], "parameter rate: expected a number in Hz"),
        (["sead:=1"], "parameter sead: expected one of"),
        (["source:=file"], "parameter file: expected the CSV file of the wind, since source is file, got nothing"),
        (["source:=file", "file:=/nowhere/wind.csv"], "/nowhere/wind.csv: expected a readable CSV file"),
    ],
)
def test_wrong_parameters_end_with_two_and_one_line(parameters: list[str], message: str) -> None:
    with running("wind_node", parameters) as wind:
        assert wind.wait() == 2
        lines = wind.stderr.strip().splitlines()
        assert len(lines) == 1, wind.report()
        assert lines[0].startswith(f"wind_node: {message}")


def test_the_end_of_the_file_may_end_the_node(tmp_path: Path) -> None:
    path = tmp_path / "short.csv"
    path.write_text("time,wind_speed\n0,5\n0.5,6\n")
    parameters = ["source:=file", f"file:={path}", "at_end:=stop", "use_sim_time:=true"]
    with running("wind_node", parameters) as wind:
        assert wind.wait() == 0, wind.report()
        assert "is reached" in wind.stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("simulated", ["true", "false"])
def test_signals_end_it_with_zero(number: signal.Signals, simulated: str) -> None:
    with running("wind_node", [f"use_sim_time:={simulated}"]) as wind, Probe() as probe:
        received = probe.collect(Vector3Stamped, TOPIC, LATCHED)
        probe.wait_until(lambda: bool(received), wind)
        wind.signal(number)
        assert wind.wait(5.0) == 0, wind.report()
        assert "Traceback" not in wind.stderr


def test_a_signal_during_start_up_ends_it_with_zero() -> None:
    for _attempt in range(3):
        with running("wind_node") as wind:
            wind.wait_until_signals_are_answered()
            wind.interrupt()
            assert wind.wait(5.0) == 0, wind.report()
            assert "Traceback" not in wind.stderr


def test_other_namespace() -> None:
    with running("wind_node", ros=["-r", "__ns:=/other"]) as wind, Probe() as probe:
        received = probe.collect(Vector3Stamped, "/other/wind_speed", LATCHED)
        probe.wait_until(lambda: bool(received), wind)
