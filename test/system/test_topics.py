"""The topics of running nodes are those of the catalogue, from which the README's table is made."""

from contextlib import ExitStack

from nw_gear_common.catalogue import TOPICS, resolved
from test.system.processes import Probe, running

OWN = {name: topic.kind for topic in TOPICS for name in resolved(topic)}
OF_ROS = {"/parameter_events", "/rosout"}
COMPILING = 120.0
"""Longest wait for nodes that may have to compile their kernels first (s)."""


def test_the_nodes_publish_what_the_catalogue_lists_and_nothing_else():
    with ExitStack() as stack:
        nodes = [
            stack.enter_context(running(name, parameters))
            for name, parameters in (
                ("wind_node", ["source:=constant"]),
                ("gear_sim_node", ["publish_clock:=true", "wait_for:=90"]),
                ("gear_monitor_node", []),
            )
        ]
        probe = stack.enter_context(Probe())

        def published():
            offered = dict(probe.node.get_topic_names_and_types())
            return {name: kinds for name, kinds in offered.items() if probe.node.count_publishers(name)}

        probe.wait_until(lambda: set(OWN) <= set(published()), *nodes, limit=COMPILING)
        found = {name: kinds for name, kinds in published().items() if name not in OF_ROS}
    assert found == {name: [kind] for name, kind in OWN.items()}
