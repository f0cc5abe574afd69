"""Publishes the wind.

In wall time each sample is published when it is due. In simulated time (`use_sim_time`) the node keeps one second ahead
of the clock, from time 0 on even before there is a clock, so that a simulator can wait for the wind it needs and a run
is a function of its seed. A clock that jumps back begins the wind anew.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Vector3Stamped
from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from nw_gear_common import names
from nw_gear_common.diagnostics import OK, WARN, Diagnostics
from nw_gear_common.ros import Stop, declare_parameters, make_node, run
from nw_gear_sim import config
from nw_gear_sim.nodes.schedule import Schedule
from nw_gear_sim.wind import Settings, Source, make_source

FRAME = "rotor"
LEAD = 1.0
DEPTH = 20
MEAN_OVER = 60.0
"""Length of the running mean in the diagnostics (s)."""

NANO = 1_000_000_000
MOST_LOGGED = 10


class WindNode(Node):
    """A plain node around a `Source`.

    Args:
        name: of the node.
        stop: ends the process.
        kwargs: of `Node`.

    Raises:
        InputError: a parameter or the wind file can't be used.
    """

    def __init__(self, name: str, stop: Stop, **kwargs: Any) -> None:
        super().__init__(name, **kwargs)
        self._stop = stop
        self._settings = declare_parameters(self, Settings, self._change)
        self._configuration = config.load(self._settings.config or None)
        self._source = self._make(self._settings)
        self._simulated = bool(self.get_parameter("use_sim_time").value)
        depth = max(DEPTH, math.ceil((LEAD + 1.0) * self._settings.rate))
        self._schedule = Schedule(self._settings.rate, LEAD if self._simulated else 0.0, depth)
        self._recent: deque[float] = deque(maxlen=max(1, round(MEAN_OVER * self._settings.rate)))
        qos = QoSProfile(
            depth=depth, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
        )
        self._publisher = self.create_publisher(Vector3Stamped, names.WIND_SPEED, qos)
        self._diagnostics = Diagnostics(self)
        self._announce()
        self._begin()
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(1.0, self._report, clock=steady)
        if self._simulated:
            threshold = JumpThreshold(
                min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1), on_clock_change=True
            )
            self._jumps = self.get_clock().create_jump_callback(threshold, post_callback=self._on_clock)
        else:
            self.create_timer(min(0.05, 0.25 / self._settings.rate), self._publish_due, clock=steady)

    # --- the wind -----------------------------------------------------------------------------------------------------

    def _make(self, settings: Settings) -> Source:
        return make_source(settings, self._configuration.wind, self._configuration.turbine)

    def _change(self, settings: Settings) -> None:
        before, self._source = self._settings.source, self._make(settings)
        self._settings = settings
        if settings.source != before:
            self._announce()

    def _begin(self) -> None:
        """Begin with sample 0: at time 0 of a simulation, or now."""
        now = self.get_clock().now().nanoseconds
        self._recent.clear()
        self._schedule.begin(0 if self._simulated else now, now)
        self._publish_due()

    def _on_clock(self, _jump: TimeJump) -> None:
        self._publish_due()

    def _publish_due(self) -> None:
        now = self.get_clock().now().nanoseconds
        if self._schedule.went_back(now):
            self.get_logger().info("the clock went back: the wind begins anew")
            self._begin()
            return
        for index in self._schedule.due(now):
            if self._source.at_end == "stop" and self._source.is_over(index):
                self.get_logger().info(f"the end of {self._settings.file} is reached")
                self._stop()
                return
            self._publish(index)

    def _publish(self, index: int) -> None:
        speed = self._source.sample(index)
        self._recent.append(speed)
        message = Vector3Stamped()
        seconds, nanoseconds = divmod(self._schedule.stamp_ns(index), NANO)
        message.header.stamp = Time(sec=seconds, nanosec=nanoseconds)
        message.header.frame_id = FRAME
        message.vector.x = speed
        self._publisher.publish(message)

    # --- what it says about itself ------------------------------------------------------------------------------------

    def _announce(self) -> None:
        source = self._source
        self.get_logger().info(f"wind: {source.description}")
        for gap in source.gaps[:MOST_LOGGED]:
            self.get_logger().warning(f"gap of {gap.seconds:g} s after {gap.label} bridged by a straight line")
        if len(source.gaps) > MOST_LOGGED:
            more = len(source.gaps) - MOST_LOGGED
            self.get_logger().warning(f"{more} further gaps bridged; {source.bridged:g} s in all")
        if math.isfinite(source.end):
            what = {"hold": "its last row holds", "loop": "it begins again", "stop": "the node ends"}[source.at_end]
            self.get_logger().info(f"the file ends after {source.end:g} s; then {what}")

    def _report(self) -> None:
        source = self._source
        mean = sum(self._recent) / len(self._recent) if self._recent else math.nan
        remarks = []
        if source.gaps:
            remarks.append(f"{len(source.gaps)} gaps bridged")
        if self._recent and source.is_over(self._schedule.last):
            remarks.append("the file has ended, " + ("its last row holds" if source.at_end == "hold" else "it repeats"))
        if source.exceeded:
            remarks.append(
                f"{source.exceeded} intervals with more deviation than the file gives, forced by their means"
            )
        if self._schedule.left_out:
            remarks.append(f"{self._schedule.left_out} samples left out by a jump of the clock")
        values = {
            "source": self._settings.source,
            "seed": str(self._settings.seed),
            "wind speed (m/s)": f"{self._recent[-1]:.4f}" if self._recent else "nan",
            f"mean of {MEAN_OVER:g} s (m/s)": f"{mean:.4f}",
            "gaps (1)": str(len(source.gaps)),
            "bridged (s)": f"{source.bridged:g}",
            **source.values,
        }
        message = "; ".join([source.description, *remarks])
        self._diagnostics.publish([self._diagnostics.status("wind", WARN if remarks else OK, message, values)])


def main(argv: Sequence[str]) -> int:
    """Run the node until it is stopped; returns the exit code."""
    return run("wind_node", lambda stop: make_node(WindNode, "wind_node", stop=stop), argv)
