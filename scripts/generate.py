"""Write what follows from the code: the tables of README.md, config/nodes.yaml and layouts for other tools.

python scripts/generate.py           writes the files
python scripts/generate.py --check   says which of them are out of date; exit code 1 where one is
"""

from __future__ import annotations

import importlib
import sys
import typing
from collections.abc import Callable
from pathlib import Path
from typing import Any

from layouts import foxglove, plotjuggler

from nw_gear_common.catalogue import EXECUTABLES, TOPICS
from nw_gear_common.launcher import NODES
from nw_gear_common.quantities import Quantity, quantities

ROOT = Path(__file__).resolve().parent.parent
README = ROOT / "README.md"
CONFIG = ROOT / "config"
NODES_YAML = CONFIG / "nodes.yaml"

LEFT_TO_THE_NODE = {"publish_clock"}
"""Parameters for which being unset has a meaning of its own; nodes.yaml shows them as a comment."""

KINDS = {float: "double", int: "integer", bool: "bool", str: "string"}


def settings_of(node: str) -> type[Any]:
    """The dataclass of a node's parameters: `Settings` in its module."""
    return typing.cast(type[Any], importlib.import_module(NODES[node]).Settings)


def as_yaml(value: Any) -> str:
    """One value as a ROS parameter file wants it (a double keeps its point)."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, tuple):
        return "[" + ", ".join(as_yaml(item) for item in value) + "]"
    return repr(value)


def executables_table() -> str:
    """The executables and what they do."""
    rows = [f"| `{name}` | {sentence} |" for name, sentence in EXECUTABLES.items()]
    return "\n".join(["| executable | does |", "|---|---|", *rows])


def topics_table() -> str:
    """The topics, their types, contents and rates."""
    head = ["| topic | type | content | rate | from |", "|---|---|---|---|---|"]
    rows = [f"| `{t.name}` | `{t.kind.replace('/msg/', '/')}` | {t.content} | {t.rate} | {t.node} |" for t in TOPICS]
    return "\n".join([*head, *rows])


def _accepts(kind: Any, text: Quantity) -> str:
    if text.choices is not None:
        return ", ".join(f"`{choice}`" if choice else "empty" for choice in text.choices)
    low = "" if text.minimum is None else f"≥ {text.minimum:g}"
    high = "" if text.maximum is None else f"≤ {text.maximum:g}"
    return ", ".join(part for part in (low, high) if part) or KINDS.get(kind, "list")


def parameters_tables() -> str:
    """One table of parameters for each node."""
    parts = []
    for node in NODES:
        head = [f"### {node}\n", "| parameter | default | unit | accepts | meaning |", "|---|---|---|---|---|"]
        rows = [
            f"| `{name}`{' (live)' if text.live else ''} | `{as_yaml(default)}` | {text.unit} | {_accepts(kind, text)} "
            f"| {text.text} |"
            for name, kind, default, text in quantities(settings_of(node))
        ]
        parts.append("\n".join([*head, *rows]))
    return "\n\n".join(parts)


TABLES: dict[str, Callable[[], str]] = {
    "executables": executables_table,
    "topics": topics_table,
    "parameters": parameters_tables,
}


def readme(current: str) -> str:
    """The README with its tables made anew, between `<!-- NAME -->` and `<!-- end of NAME -->`."""
    for name, make in TABLES.items():
        start, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
        if current.count(start) != 1 or current.count(end) != 1:
            raise SystemExit(f"{README.name}: expected one pair of markers for {name}")
        before, rest = current.split(start)
        current = before + start + "\n" + make() + "\n\n" + end + rest.split(end)[1]
    return current


def nodes_yaml() -> str:
    """A ROS parameter file with every parameter of every node at its default."""
    lines = [
        "# Parameters of all nodes at their defaults, in any namespace. Made by `make docs` from the code.",
        "#",
        "#   wind_node --ros-args --params-file nodes.yaml",
        "#",
        "# A number with a point has to keep it: ROS refuses 2 where a double is declared.",
    ]
    for node in NODES:
        lines += ["", f"/**/{node}:", "  ros__parameters:"]
        for name, _kind, default, text in quantities(settings_of(node)):
            unit = f" ({text.unit})" if text.unit else ""
            mark = "# " if name in LEFT_TO_THE_NODE or default == () else ""
            lines += [f"    # {text.text}{unit}", f"    {mark}{name}: {as_yaml(default)}"]
    return "\n".join(lines) + "\n"


def main(arguments: list[str]) -> int:
    """Write the files, or check them."""
    wanted = {
        README: readme(README.read_text(encoding="utf-8")),
        NODES_YAML: nodes_yaml(),
        CONFIG / "foxglove.json": foxglove(),
        CONFIG / "plotjuggler.xml": plotjuggler(),
    }
    stale = [p for p, text in wanted.items() if not p.exists() or p.read_text(encoding="utf-8") != text]
    if "--check" in arguments:
        for path in stale:
            print(f"{path.relative_to(ROOT)} is out of date; `make docs` writes it anew")
        return int(bool(stale))
    for path in stale:
        path.write_text(wanted[path], encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
