"""Faults as live parameters of the simulator: put in, refused, told as truth, over DDS."""

from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters

from nw_gear_common.ros import latched_qos
from test.system.processes import Probe, running

COMPILING = 120.0
NODE = "/nw_gear/gear_sim_node"


def of(value):
    if isinstance(value, str):
        return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=value)
    if isinstance(value, int):
        return ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=value)
    return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)


def put(probe, sim, **values):
    request = SetParameters.Request(parameters=[ParameterMessage(name=n, value=of(v)) for n, v in values.items()])
    return probe.call(SetParameters, f"{NODE}/set_parameters", request, sim).results


def test_a_crack_grows_while_the_gearbox_runs():
    with Probe() as probe:
        truth = probe.collect(DiagnosticStatus, "/nw_gear/truth", latched_qos())
        with running("gear_sim_node", ["config:=rated", "fault_ramp:=4.0"]) as sim:
            probe.wait_until(lambda: truth, sim, limit=COMPILING)
            assert truth[-1].message == "no fault injected"
            assert put(probe, sim, fault_crack_gear="pinion")[0].successful
            refused = put(probe, sim, fault_crack_tooth=20)[0]
            assert not refused.successful
            assert "fault_crack_tooth: expected 0 to 19 on the pinion, got 20" in refused.reason
            assert put(probe, sim, fault_crack=0.4)[0].successful
            severity = lambda status: float(values(status).get("fault cracked tooth: crack (1)", 0.0))  # noqa: E731
            probe.wait_until(lambda: severity(truth[-1]) == 0.4, sim, limit=30.0)
            grown = [severity(status) for status in truth if status.message == "cracked tooth"]
            assert grown == sorted(grown)
            assert any(0.0 < s < 0.4 for s in grown)
            assert values(truth[-1])["fault cracked tooth"] == "pinion, 0"
            sim.interrupt()


def values(status):
    return {pair.key: pair.value for pair in status.values}
