"""Parameters that may change while a node runs, as the dashboard changes them."""

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Vector3Stamped
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter

from nw_gear_common import names
from test.system.processes import Probe, running

STARTING = 120.0
"""Longest wait for the first sign of life (s): a machine without compiled kernels makes them first."""


def change(probe, node, process, **values):
    parameters = [Parameter(name, value=value).to_parameter_msg() for name, value in values.items()]
    request = SetParametersAtomically.Request(parameters=parameters)
    service = f"/nw_gear/{node}/set_parameters_atomically"
    return probe.call(SetParametersAtomically, service, request, process).result


class Integration:
    """What the simulator says about its integration."""

    def __init__(self, probe):
        self._arrays = probe.collect(DiagnosticArray, names.DIAGNOSTICS)

    def value(self, key):
        statuses = [s for array in self._arrays for s in array.status if s.name == "gear_sim_node: integration"]
        found = [pair.value for status in statuses for pair in status.values if pair.key == key]
        return float(found[-1]) if found else None


@pytest.mark.slow
def test_the_speed_of_a_run_with_its_own_clock_changes_on_the_way():
    parameters = ["config:=rated", "publish_clock:=true", "real_time_factor:=0.2"]
    with Probe() as probe, running("gear_sim_node", parameters) as simulator:
        said = Integration(probe)
        probe.wait_until(lambda: (said.value("simulated (s)") or 0.0) > 0.0, simulator, limit=STARTING)
        assert said.value("real_time_factor wanted (1)") == 0.2
        before = said.value("simulated (s)")
        assert change(probe, "gear_sim_node", simulator, real_time_factor=0.0).successful
        probe.wait_until(lambda: said.value("real_time_factor wanted (1)") == 0.0, simulator)
        probe.wait_until(lambda: said.value("simulated (s)") > before + 5.0, simulator, limit=60.0)
        assert change(probe, "gear_sim_node", simulator, real_time_factor=0.1).successful
        probe.wait_until(lambda: said.value("real_time_factor wanted (1)") == 0.1, simulator)
        # paced anew from here: neither a rush to make up for what the fast part was ahead, nor a wait for it
        began = said.value("simulated (s)")
        probe.wait_until(lambda: said.value("simulated (s)") > began + 0.05, simulator, limit=10.0)
        assert said.value("lag (s)") < 5.0


@pytest.mark.slow
def test_a_run_at_the_walls_time_refuses_another_speed_and_says_why():
    with Probe() as probe, running("gear_sim_node", ["config:=rated"]) as simulator:
        said = Integration(probe)
        probe.wait_until(lambda: (said.value("simulated (s)") or 0.0) > 0.0, simulator, limit=STARTING)
        answer = change(probe, "gear_sim_node", simulator, real_time_factor=3.0)
        assert not answer.successful
        assert "the wall's" in answer.reason
        assert change(probe, "gear_sim_node", simulator, real_time_factor=1.0).successful


def test_the_source_of_the_wind_changes_on_the_way():
    with Probe() as probe, running("wind_node", ["source:=constant", "speed:=7.0"]) as wind:
        received = probe.collect(Vector3Stamped, "/nw_gear/wind_speed")
        probe.wait_until(lambda: len(received) > 3, wind)
        assert {message.vector.x for message in received} == {7.0}
        assert change(probe, "wind_node", wind, source="weibull").successful
        probe.wait_until(lambda: len({message.vector.x for message in received}) > 5, wind)
        refused = change(probe, "wind_node", wind, source="file")
        assert not refused.successful
        assert "file" in refused.reason
        assert change(probe, "wind_node", wind, source="constant", speed=9.0).successful
        probe.wait_until(lambda: received[-1].vector.x == 9.0, wind)
        assert "wind: constant 9 m/s" in wind.stderr
