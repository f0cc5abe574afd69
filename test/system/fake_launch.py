"""A small stand-in for the packages `launch` and `launch_ros`, of which there are no wheels.

It takes the same arguments as the parts that the launch files use, and resolves substitutions as they do: text is
joined, expressions are evaluated, a parameter's value is read as YAML and held against its type.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import yaml

ROOT = Path(__file__).resolve().parents[2]


@dataclass
class Context:
    """Values of the launch arguments."""

    arguments: dict[str, str] = field(default_factory=dict)

    def text(self, thing: Any) -> str:
        """Resolve a text, a substitution, or a list of them."""
        if isinstance(thing, list | tuple):
            return "".join(self.text(part) for part in thing)
        return thing if isinstance(thing, str) else thing.perform(self)


@dataclass
class LaunchConfiguration:
    name: str

    def perform(self, context: Context) -> str:
        return context.arguments[self.name]


@dataclass
class PathJoinSubstitution:
    parts: list[Any]

    def perform(self, context: Context) -> str:
        return str(Path(*(context.text(part) for part in self.parts)))


@dataclass
class PythonExpression:
    parts: list[Any]

    def perform(self, context: Context) -> str:
        return str(eval(context.text(self.parts), {}))


@dataclass
class FindPackageShare:
    package: str

    def perform(self, _context: Context) -> str:
        assert self.package == "nw_gear"
        return str(ROOT)


@dataclass
class ParameterValue:
    value: Any
    value_type: type

    def evaluate(self, context: Context) -> Any:
        text = context.text(self.value)
        value = text if self.value_type is str else yaml.safe_load(text)
        assert isinstance(value, self.value_type), f"{text!r} isn't a {self.value_type.__name__}"
        return value


@dataclass
class IfCondition:
    value: Any

    def evaluate(self, context: Context) -> bool:
        return {"true": True, "1": True, "false": False, "0": False}[context.text(self.value).lower()]


@dataclass
class DeclareLaunchArgument:
    name: str
    default_value: Any = None
    description: str = ""


@dataclass
class SetEnvironmentVariable:
    name: str
    value: Any
    condition: IfCondition | None = None


@dataclass
class Shutdown:
    reason: str = ""


@dataclass
class Node:
    package: str
    executable: str
    namespace: Any
    parameters: list[Any]
    output: str
    remappings: list[tuple[Any, Any]] = field(default_factory=list)
    condition: IfCondition | None = None
    on_exit: Any = None


@dataclass
class LaunchDescription:
    entities: list[Any]

    def arguments(self, **given: str) -> Context:
        """Values of all declared arguments, in order, as `name:=value` on the command line would set them."""
        context = Context()
        declared = [e for e in self.entities if isinstance(e, DeclareLaunchArgument)]
        assert set(given) <= {d.name for d in declared}
        context.arguments.update(given)
        for entity in declared:
            if entity.name not in given:
                assert entity.default_value is not None, f"{entity.name} is required"
                context.arguments[entity.name] = context.text(entity.default_value)
        return context

    def environment(self, context: Context) -> dict[str, str]:
        """The environment variables that would be set."""
        found = [e for e in self.entities if isinstance(e, SetEnvironmentVariable)]
        return {e.name: context.text(e.value) for e in found if e.condition is None or e.condition.evaluate(context)}

    def nodes(self, context: Context) -> list[Node]:
        """The nodes that would be started."""
        found = [e for e in self.entities if isinstance(e, Node)]
        return [n for n in found if n.condition is None or n.condition.evaluate(context)]


def parameters(node: Node, context: Context) -> dict[str, Any]:
    """The parameters given by name, at their final values."""
    result: dict[str, Any] = {}
    for part in node.parameters:
        if isinstance(part, dict):
            named = {k: v.evaluate(context) if isinstance(v, ParameterValue) else v for k, v in part.items()}
            result.update(named)
    return result


def install(monkeypatch: Any) -> None:
    """Make the stand-ins importable under the real names for one test."""
    contents = {
        "launch": [LaunchDescription],
        "launch.actions": [DeclareLaunchArgument, SetEnvironmentVariable, Shutdown],
        "launch.conditions": [IfCondition],
        "launch.substitutions": [LaunchConfiguration, PathJoinSubstitution, PythonExpression],
        "launch_ros": [],
        "launch_ros.actions": [Node],
        "launch_ros.parameter_descriptions": [ParameterValue],
        "launch_ros.substitutions": [FindPackageShare],
    }
    for name, members in contents.items():
        module = ModuleType(name)
        for member in members:
            setattr(module, member.__name__, member)
        monkeypatch.setitem(sys.modules, name, module)
