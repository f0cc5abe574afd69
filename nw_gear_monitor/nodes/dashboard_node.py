"""`dashboard_node`: a live page in the browser, by default for this machine alone.

The executor's thread listens, asks other nodes and keeps buffers of fixed size; a second thread serves the page from
them; a third one computes phase diagrams and reduces spectra while anybody looks.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter

from nw_gear_common import names
from nw_gear_common.diagnostics import OK, WARN, Diagnostics
from nw_gear_common.quantities import quantity
from nw_gear_common.ros import Stop, declare_parameters, make_node, run
from nw_gear_monitor.dashboard.feed import Feed
from nw_gear_monitor.dashboard.gate import check_address
from nw_gear_monitor.dashboard.page import Show
from nw_gear_monitor.dashboard.server import Server
from nw_gear_monitor.nodes.dashboard_calls import Calls
from nw_gear_monitor.nodes.dashboard_ears import Ears


@dataclass(frozen=True)
class Settings:
    """Parameters of `dashboard_node`."""

    port: int = quantity(0, "TCP port of the page; 0 = any free one, which is printed.", minimum=0, maximum=65535)
    address: str = quantity(
        "127.0.0.1", "Address to listen on; one that other machines can reach is refused without a token."
    )
    token: str = quantity("", "What every request has to carry; at least 16 letters, digits, - or _; empty = nothing.")
    update_rate: float = quantity(20.0, "Updates of the scrolling figures.", "Hz", minimum=1.0, maximum=60.0)
    history: float = quantity(20.0, "Time that the scrolling figures show.", "s", minimum=2.0, maximum=600.0)
    waveform_topic: str = quantity(names.WAVEFORM, "Topic of the waveform, relative to the namespace.")
    stale_after: float = quantity(
        3.0,
        "Wall time of silence after which a node or the waveform is shown as stale.",
        "s",
        minimum=0.5,
        maximum=3600.0,
    )


class DashboardNode(Node):
    """The page as a ROS node.

    Args:
        name: of the node.
        stop: ends the process.
        kwargs: of `Node`.

    Raises:
        InputError: an address beyond loopback without a token, or a port that can't be had.
    """

    def __init__(self, name: str, stop: Stop, **kwargs: object) -> None:
        super().__init__(name, **kwargs)
        self._stop = stop
        settings = declare_parameters(self, Settings)
        check_address(settings.address, settings.token)
        if settings.token:  # it is a secret: whoever asks for the parameter, a recorder for one, gets this instead
            self._parameters["token"] = Parameter("token", value="(set)")
        self._server = Server(settings.address, settings.port, settings.token)
        self._feed = Feed(settings.history, settings.stale_after)
        self._calls = Calls(self, self._feed)
        self._ears = Ears(self, self._feed, settings.waveform_topic)
        self._diagnostics = Diagnostics(self)
        show = Show(
            feed=self._feed,
            digest=self._server.digest,
            ask=self._calls.ask,
            title=f"Gearbox live: {self.get_namespace().strip('/') or '/'}",
            topic=self.resolve_topic_name(settings.waveform_topic),
            rate=settings.update_rate,
            stale_after=settings.stale_after,
        )
        self._server.start(show)
        print(f"dashboard: {self._server.url}", flush=True)
        self._spent = (time.process_time(), time.monotonic())
        self.create_timer(1.0, self._report, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._report()

    def close(self) -> None:
        """End the server."""
        self._server.stop()

    def _report(self) -> None:
        cpu, wall = time.process_time(), time.monotonic()
        before, self._spent = self._spent, (cpu, wall)
        share = (cpu - before[0]) / (wall - before[1]) if wall > before[1] else 0.0
        trouble = self._server.error
        values = {
            "address": self._server.url,
            "pages (1)": str(self._server.sessions),
            "processor (share of a core)": f"{share:.3f}",
        }
        message = f"some figures can't be drawn: {trouble}" if trouble else f"serving {self._server.url}"
        self._diagnostics.publish([self._diagnostics.status("server", WARN if trouble else OK, message, values)])


def main(argv: Sequence[str]) -> int:
    """Run the node until it is asked to stop."""
    return run("dashboard_node", lambda stop: make_node(DashboardNode, "dashboard_node", stop=stop), argv)
