"""Wind, simulator, monitor and dashboard as processes, for whoever looks at the page."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

from test.system.processes import Process, running

START_WITHIN = 120.0
"""Longest wait for the page's address (s): a machine without compiled kernels makes them first."""
ADDRESS = re.compile(r"^dashboard: (http://\S+)$", re.MULTILINE)


@dataclass
class LiveSuite:
    """The processes by name, and the address of the page."""

    processes: dict[str, Process]
    url: str

    def report(self) -> str:
        """What each of them printed."""
        return "\n".join(process.report() for process in self.processes.values())


@contextmanager
def live_suite(
    wind: Sequence[str] = (), simulator: Sequence[str] = (), dashboard: Sequence[str] = ()
) -> Iterator[LiveSuite]:
    """Start all four and wait for the page's address; simulated time where the simulator publishes the clock."""
    clocked = ["use_sim_time:=true"] if any(p.startswith("publish_clock") for p in simulator) else []
    wanted = {
        "dashboard_node": list(dashboard),
        "wind_node": [*wind, *clocked],
        "gear_monitor_node": clocked,
        "gear_sim_node": list(simulator),
    }
    with ExitStack() as stack:
        processes = {name: stack.enter_context(running(name, given)) for name, given in wanted.items()}
        yield LiveSuite(processes, address_of(processes["dashboard_node"]))


def address_of(dashboard: Process) -> str:
    """Address of a page, once it is printed."""
    end = time.monotonic() + START_WITHIN
    while time.monotonic() < end:
        found = ADDRESS.search(dashboard.stdout)
        if found is not None:
            return found[1]
        if dashboard.code is not None:
            break
        time.sleep(0.05)
    raise AssertionError(f"no address of a page:\n{dashboard.report()}")
