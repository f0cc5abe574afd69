"""Asks the nodes of a namespace for all their parameters, without ever waiting for an answer."""

from __future__ import annotations

import json
import time
from typing import Any

from rcl_interfaces.srv import GetParameters, ListParameters
from rclpy.client import Client
from rclpy.node import Node
from rclpy.parameter import parameter_value_to_python
from rclpy.task import Future

RETRY_AFTER = 5.0
"""Seconds after which a question that got no answer is put again."""

LOOK_EVERY = 0.5
"""Seconds between two looks at which nodes there are."""


def as_text(value: Any) -> str:
    """A parameter's value as text: strings as they are, everything else as JSON has it."""
    return value if isinstance(value, str) else json.dumps(value)


class _Question:
    """Put to one node: first the names of its parameters, then their values."""

    def __init__(self, asking: Node, node: str) -> None:
        self._asking = asking
        self._list: Client = asking.create_client(ListParameters, f"{node}/list_parameters")
        self._get: Client = asking.create_client(GetParameters, f"{node}/get_parameters")
        self._names: list[str] = []
        self._future: Future | None = None
        self._asked = 0.0

    def look(self) -> dict[str, str] | None:
        """Go on if an answer has come; returns name to text at the end, None before."""
        if self._future is not None and self._future.done():
            answer, self._future = self._future.result(), None
            if self._names:
                values = [as_text(parameter_value_to_python(value)) for value in answer.values]
                return dict(zip(self._names, values, strict=True))
            self._names = sorted(answer.result.names)
            if not self._names:
                return {}
        if self._future is None or time.monotonic() > self._asked + RETRY_AFTER:
            self._ask()
        return None

    def _ask(self) -> None:
        client = self._get if self._names else self._list
        if client.service_is_ready():
            request = GetParameters.Request(names=self._names) if self._names else ListParameters.Request()
            self._future = client.call_async(request)
            self._asked = time.monotonic()

    def close(self) -> None:
        """Give the clients back."""
        for client in (self._list, self._get):
            self._asking.destroy_client(client)


class ParameterSurvey:
    """Finds the nodes in the namespace of a node and collects their parameters; one that comes back is asked again.

    Args:
        asking: the node in whose namespace to look; it isn't asked itself.
    """

    def __init__(self, asking: Node) -> None:
        self._asking = asking
        self._open: dict[str, _Question] = {}
        self._answered: set[str] = set()
        self._next_look = 0.0

    @property
    def unanswered(self) -> list[str]:
        """Full names of the nodes that haven't answered yet."""
        return sorted(self._open)

    def look(self) -> dict[str, dict[str, str]]:
        """What has been answered since the last call: full name of the node to its parameters."""
        now = time.monotonic()
        if now >= self._next_look:
            self._next_look = now + LOOK_EVERY
            self._look_for_nodes()
        found = {}
        for node, question in list(self._open.items()):
            answer = question.look()
            if answer is not None:
                found[node] = answer
                self._answered.add(node)
                self._open.pop(node).close()
        return found

    def _look_for_nodes(self) -> None:
        present = self._present()
        self._answered &= present
        for node in present - self._answered - self._open.keys():
            self._open[node] = _Question(self._asking, node)

    def _present(self) -> set[str]:
        inside = self._asking.get_namespace().rstrip("/") + "/"
        found = self._asking.get_node_names_and_namespaces()
        full = {f"{namespace.rstrip('/')}/{name}" for name, namespace in found if not name.startswith("_")}
        return {node for node in full if node.startswith(inside)} - {self._asking.get_fully_qualified_name()}
