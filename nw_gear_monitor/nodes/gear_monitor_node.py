"""`gear_monitor_node`: spectra, Poincaré sections, indicators, states and alarms from the waveform, online.

The executor's thread takes messages in and answers services and signals; a second thread compiles the kernels,
subscribes, computes and publishes. What it publishes follows from the stamped samples alone;
wall time decides only when a silent stream is called stale and how long computing took.
"""

from __future__ import annotations

import copy
import queue
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rclpy.node import Node
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Trigger

from nw_gear_common import names
from nw_gear_common.errors import InputError, NwGearError
from nw_gear_common.quantities import quantity
from nw_gear_common.ros import Stop, declare_parameters, from_message, leave_now, live_qos, make_node, run
from nw_gear_monitor import health
from nw_gear_monitor.gearing import gearing
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.machinefile.read import load
from nw_gear_monitor.nodes.alarm_watch import AlarmWatch, WatchSettings
from nw_gear_monitor.nodes.computation import HOP_SECONDS, Computation
from nw_gear_monitor.nodes.monitor_publishing import Publishing
from nw_gear_monitor.pipeline import Hop, Pipeline
from nw_gear_monitor.signals.stream import Continuity
from nw_gear_monitor.warm_up import warm_up
from nw_gear_sim import config

WAVEFORM_DEPTH = 1000
"""Blocks that may wait in the middleware while a hop is computed or samples come much faster than real time."""
JOIN_WITHIN = 4.0


@dataclass(frozen=True)
class Settings(WatchSettings):
    """Parameters of `gear_monitor_node`."""

    config: str = quantity("", "Configuration laid over the default gearbox: a YAML file, or the name of a preset.")
    machine: str = quantity("", "Another machine than the built-in gearbox: a YAML file (docs/foreign.md).")
    waveform_topic: str = quantity(names.WAVEFORM, "Topic of the waveform, relative to the namespace.")
    stale_after: float = quantity(
        2.0, "Wall time without samples after which every state is stale.", "s", minimum=0.1, maximum=3600.0
    )


class GearMonitorNode(Node):
    """The monitor as a ROS node."""

    def __init__(self, name: str, stop: Stop, **kwargs: object) -> None:
        super().__init__(name, **kwargs)
        self._stop = stop
        self._settings = declare_parameters(self, Settings, self._on_settings)
        self._machine = _machine(self._settings)
        self._pipeline = Pipeline(self._machine, self._settings)
        self._blocks: queue.SimpleQueue[Float64MultiArray | None] = queue.SimpleQueue()
        self._news = threading.Event()
        self._alarms = AlarmWatch(self, self._machine, self._settings, self._on_news)
        self._publishing = Publishing(self, self._machine)
        self._reset = threading.Event()
        self._computation = Computation()
        self._reported = Continuity()
        self._statuses = health.waiting(self._settings.waveform_topic, self._machine)
        self._heard = time.monotonic()
        self._next_quiet_report = self._heard + self._settings.stale_after
        self.create_service(Trigger, "~/reset", self._on_reset)
        self._thread = threading.Thread(target=self._work, name="monitor", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the second thread; a compiler that is still busy there is not waited for."""
        self._stop.event.set()
        self._blocks.put(None)
        self._thread.join(JOIN_WITHIN)
        if self._thread.is_alive():
            leave_now(0 if self._stop.error is None else 1)
        self._alarms.close()

    # --- the executor's thread --------------------------------------------------------------------------------------

    def _on_waveform(self, message: Float64MultiArray) -> None:
        self._blocks.put(message)

    def _on_reset(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._reset.set()
        self._blocks.put(None)
        response.success, response.message = True, "windows flushed"
        return response

    def _on_settings(self, settings: Settings) -> None:
        self._alarms.change(settings)

    def _on_news(self) -> None:
        self._news.set()
        self._blocks.put(None)

    # --- the thread that computes -------------------------------------------------------------------------------------

    def _work(self) -> None:
        try:
            warm_up(self._machine)
            topic = self._settings.waveform_topic
            subscription = self.create_subscription(
                Float64MultiArray, topic, self._on_waveform, live_qos(WAVEFORM_DEPTH)
            )
            self.get_logger().info(f"monitoring {subscription.topic_name}")
            while not self._stop:
                self._next()
        except NwGearError as error:
            self._stop(error)
        except Exception as error:  # a thread that dies in silence would leave a node that does nothing
            self._stop(NwGearError(f"{type(error).__name__}: {error}"))
            raise

    def _next(self) -> None:
        """Work on the next block, or look whether the stream has gone quiet."""
        try:
            message = self._blocks.get(timeout=0.1)
        except queue.Empty:
            self._look_for_silence()
            return
        if self._reset.is_set():
            self._reset.clear()
            self._pipeline.reset()
            self._alarms.interrupt()
        if self._news.is_set():
            self._news.clear()
            self._publish_diagnostics(self._statuses, self._now())
        if message is not None:
            self._heard = time.monotonic()
            self._compute(message)
            self._look_for_silence()

    def _compute(self, message: Float64MultiArray) -> None:
        began = time.monotonic()
        try:
            hops = self._pipeline.feed(from_message(message, self._settings.waveform_topic))
        except InputError as error:
            self._pipeline.reject(str(error))
            return
        for hop in hops:
            self._publish(hop)
        if hops:
            self._computation.add((time.monotonic() - began) / len(hops))

    def _publish(self, hop: Hop) -> None:
        self._publishing.tables(hop)
        self._alarms.update(hop)
        self._statuses = health.stage_statuses(hop, self._machine)
        self._publish_diagnostics(self._statuses, hop.time)
        self._next_quiet_report = time.monotonic() + self._settings.stale_after

    def _look_for_silence(self) -> None:
        """Where no second has become whole for a while, say so once a second."""
        now = time.monotonic()
        if now < self._next_quiet_report:
            return
        self._next_quiet_report = now + HOP_SECONDS
        silent = now - self._heard
        if self._pipeline.continuity.blocks and silent >= self._settings.stale_after:
            self._statuses = health.stale(self._statuses, silent)
        self._publish_diagnostics(self._statuses, self._now())

    def _publish_diagnostics(self, statuses: list[health.Status], stamp: float) -> None:
        stream = health.stream_status(self._pipeline.continuity, self._reported)
        self._reported = copy.copy(self._pipeline.continuity)
        computation = self._computation.status(self._blocks.qsize())
        self._publishing.diagnostics([*self._alarms.entries(statuses), stream, computation], stamp)

    def _now(self) -> float:
        return float(self.get_clock().now().nanoseconds) * 1e-9


def _machine(settings: Settings) -> Machine:
    """What to watch.

    Raises:
        InputError: a file that can't be used, or both files given.
    """
    if not settings.machine:
        return gearing(config.load(settings.config or None))
    if settings.config:
        raise InputError("parameter machine", "one of `machine` and `config`", "both")
    return load(Path(settings.machine))


def main(argv: Sequence[str]) -> int:
    """Run the node until it is asked to stop."""
    return run("gear_monitor_node", lambda stop: make_node(GearMonitorNode, "gear_monitor_node", stop=stop), argv)
