"""Puts the page's requests to the nodes and notes their answers; polls the parameters that the page shows."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.srv import GetParameters, SetParametersAtomically
from rclpy.client import Client
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.task import Future
from std_srvs.srv import SetBool, Trigger

from nw_gear_monitor.dashboard.controls import MONITOR, POLLED, RECORDER, REPLAY, SIM, WIND, Request
from nw_gear_monitor.dashboard.feed import Feed

PATIENCE = 5.0
"""Seconds after which a request counts as not answered."""
POLL = 1.0
SERVICES: dict[tuple[str, str], Any] = {
    **{(node, "pause"): SetBool for node in (SIM, RECORDER, REPLAY)},
    **{(node, "reset"): Trigger for node in (SIM, MONITOR)},
    (MONITOR, "acknowledge"): Trigger,
    (MONITOR, "reset_alarms"): Trigger,
    (MONITOR, "freeze_baseline"): SetBool,
}


@dataclass
class _Waiting:
    """A question that is under way.

    Attributes:
        client: that it went through.
        future: of the answer.
        asked: wall time (s, monotonic).
        words: what was asked, "" where nobody needs to know.
        take: takes the response: whether the node did it, and what it said.
    """

    client: Client
    future: Future
    asked: float
    words: str
    take: Callable[[Any], tuple[bool, str]] = field(repr=False)


class Calls:
    """Requests to other nodes, without ever waiting for an answer.

    Args:
        node: that asks.
        feed: takes answers and parameters.
    """

    def __init__(self, node: Node, feed: Feed) -> None:
        self._feed = feed
        self._set = {
            n: node.create_client(SetParametersAtomically, f"{n}/set_parameters_atomically") for n in (WIND, SIM)
        }
        self._get = {n: node.create_client(GetParameters, f"{n}/get_parameters") for n in POLLED}
        self._services = {key: node.create_client(kind, "/".join(key)) for key, kind in SERVICES.items()}
        self._waiting: list[_Waiting] = []
        self._lock = threading.Lock()
        node.create_timer(POLL, self._poll)
        node.create_timer(0.1, self._look)

    def ask(self, request: Request) -> None:
        """Put a request; may be called by any thread."""
        words = f"{request.node}: {request.words}"
        if request.parameters:
            message = SetParametersAtomically.Request(
                parameters=[_message(k, v) for k, v in request.parameters.items()]
            )
            self._put(self._set[request.node], message, words, lambda answer: self._done(request, answer))
            return
        client = self._services[request.node, request.service]
        message = Trigger.Request() if request.flag is None else SetBool.Request(data=request.flag)
        self._put(client, message, words, lambda answer: (bool(answer.success), str(answer.message)))

    def _done(self, request: Request, answer: Any) -> tuple[bool, str]:
        if answer.result.successful:
            self._feed.add_parameters(request.node, request.parameters)
            return True, "accepted"
        return False, f"refused: {answer.result.reason}"

    def _put(self, client: Client, message: Any, words: str, take: Callable[[Any], tuple[bool, str]]) -> None:
        if not client.service_is_ready():
            if words:
                self._feed.answer(words, False, "the node isn't there")
            return
        waiting = _Waiting(client, client.call_async(message), time.monotonic(), words, take)
        with self._lock:
            self._waiting.append(waiting)

    def _look(self) -> None:
        """Take answers that have come, give up on those that don't."""
        with self._lock:
            under_way, self._waiting = self._waiting, []
        left, now = [], time.monotonic()
        for waiting in under_way:
            if waiting.future.done():
                accepted, said = waiting.take(waiting.future.result())
            elif now > waiting.asked + PATIENCE:
                waiting.client.remove_pending_request(waiting.future)
                accepted, said = False, f"no answer for {PATIENCE:g} s"
            else:
                left.append(waiting)
                continue
            if waiting.words:
                self._feed.answer(waiting.words, accepted, said)
        with self._lock:
            self._waiting += left

    def _poll(self) -> None:
        """Ask for the parameters that the page shows, unless the last question is still open."""
        with self._lock:
            busy = {id(waiting.client) for waiting in self._waiting}
        for node, names in POLLED.items():
            client = self._get[node]
            if id(client) not in busy:
                self._put(client, GetParameters.Request(names=list(names)), "", self._taker(node, names))

    def _taker(self, node: str, names: tuple[str, ...]) -> Callable[[Any], tuple[bool, str]]:
        def take(answer: Any) -> tuple[bool, str]:
            values = [parameter_value_to_python(value) for value in answer.values]
            self._feed.add_parameters(node, dict(zip(names, values, strict=False)))
            return True, ""

        return take


def _message(name: str, value: Any) -> ParameterMessage:
    return Parameter(name, value=value).to_parameter_msg()
