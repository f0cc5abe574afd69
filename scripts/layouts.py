"""Layouts that show our topics in Foxglove and PlotJuggler, made from the names in the code (see generate.py).

Foxglove addresses a field by a message path (`/topic.field[3]`), PlotJuggler by the series that its ROS parser makes
(`/topic/<joint>/position` of a JointState, `/topic/data[3]` of an array).
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

from nw_gear_common import names
from nw_gear_monitor.indicators import bearing_registry, registry

COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22")
SHOWN = {"RMS of the displacement (m)": "rms", "Residual (1)": "residual_ratio", "0-1 test K (1)": "zero_one_k"}
"""Indicators of the meshes in the layouts, by title."""
MONITOR = "gear_monitor_node"


@dataclass(frozen=True)
class Line:
    """A line of a plot: what it is called, where Foxglove finds it and where PlotJuggler does."""

    label: str
    foxglove: str
    plotjuggler: str


Plots = dict[str, list[Line]]


def _topic(name: str) -> str:
    return f"{names.NAMESPACE}/{name}"


def _joints(topic: str, joints: Sequence[str], field: str) -> list[Line]:
    path = _topic(topic)
    return [Line(joint, f"{path}.{field}[{k}]", f"{path}/{joint}/{field}") for k, joint in enumerate(joints)]


def _element(topic: str, label: str, index: int) -> Line:
    return Line(label, f"{_topic(topic)}.data[{index}]", f"{_topic(topic)}/data[{index}]")


def _indicator(column: str) -> list[Line]:
    index = 1 + [c.name for c in registry.COLUMNS].index(column)
    return [_element(names.indicators_topic(mesh), mesh, index) for mesh in names.MESHES]


def tabs() -> dict[str, Plots]:
    """What is shown: tab -> plot -> lines."""
    wind = _topic(names.WIND_SPEED)
    bearings = [(b, _topic(names.bearing_topic(b))) for b in names.WAVEFORM_BEARINGS]
    rms = 1 + [c.name for c in bearing_registry.COLUMNS].index("rms")
    return {
        "Operation": {
            "Wind speed (m/s)": [Line("wind", f"{wind}.vector.x", f"{wind}/vector/x")],
            "Speed of the shafts (rad/s)": _joints(names.SHAFTS_TOPIC, names.SHAFTS, "velocity"),
            "Torque of the shafts (N m)": _joints(names.SHAFTS_TOPIC, names.SHAFTS, "effort"),
        },
        "Meshes": {
            "Meshing displacement (m)": _joints(names.MESH_TOPIC, names.MESHES, "position"),
            "Mesh force (N)": _joints(names.MESH_TOPIC, names.MESHES, "effort"),
        },
        "Bearings": {
            "Bearing force x (N)": [Line(b, f"{t}.wrench.force.x", f"{t}/wrench/force/x") for b, t in bearings],
            "Bearing force y (N)": [Line(b, f"{t}.wrench.force.y", f"{t}/wrench/force/y") for b, t in bearings],
            "RMS of the bearing force (N)": [_element(names.indicators_topic(b), b, rms) for b, _ in bearings],
        },
        "Indicators": {title: _indicator(column) for title, column in SHOWN.items()},
    }


def foxglove() -> str:
    """The layout for Foxglove: a tab each, beside states, diagnostics and truth."""
    panels: dict[str, Any] = {
        "StateTransitions!states": {"paths": [_state(stage) for stage in names.STAGES], "isSynced": True},
        "DiagnosticSummary!all": {"topicToRender": names.DIAGNOSTICS, "minLevel": 0, "sortByLevel": True},
        "RawMessages!truth": {"topicPath": _topic(names.TRUTH), "diffEnabled": False},
        "Tab!plots": {"activeTabIdx": 0, "tabs": []},
    }
    for tab, plots in tabs().items():
        identities = []
        for title, lines in plots.items():
            identities.append(f"Plot!{len(panels)}")
            panels[identities[-1]] = _plot(title, lines)
        panels["Tab!plots"]["tabs"].append({"title": tab, "layout": _stack(identities)})
    beside = _stack(["StateTransitions!states", "DiagnosticSummary!all", "RawMessages!truth"])
    layout = {"direction": "row", "first": "Tab!plots", "second": beside, "splitPercentage": 65}
    whole = {"configById": panels, "globalVariables": {}, "userNodes": {}, "playbackConfig": {"speed": 1}}
    return json.dumps({**whole, "layout": layout}, indent=1) + "\n"


def _plot(title: str, lines: list[Line]) -> dict[str, Any]:
    paths = [
        {
            "value": line.foxglove,
            "label": line.label,
            "enabled": True,
            "timestampMethod": "receiveTime",
            "color": colour,
        }
        for line, colour in zip(lines, COLOURS, strict=False)
    ]
    shown = {"showLegend": True, "legendDisplay": "floating", "showXAxisLabels": True, "showYAxisLabels": True}
    return {
        "title": title,
        "foxglovePanelTitle": title,
        "paths": paths,
        **shown,
        "xAxisVal": "timestamp",
        "isSynced": True,
    }


def _state(stage: str) -> dict[str, str]:
    status = f'{{name=="{MONITOR}: stage {stage}"}}'
    path = f'{names.DIAGNOSTICS}.status[:]{status}.values[:]{{key=="state"}}.value'
    return {"value": path, "label": f"stage {stage}", "timestampMethod": "receiveTime"}


def _stack(panels: list[str]) -> Any:
    """Panels above each other, of equal height."""
    if len(panels) == 1:
        return panels[0]
    rest = {"first": panels[0], "second": _stack(panels[1:]), "splitPercentage": round(100 / len(panels), 2)}
    return {"direction": "column", **rest}


def plotjuggler() -> str:
    """The layout for PlotJuggler: a tab each."""
    root = ElementTree.Element("root")
    widget = ElementTree.SubElement(root, "tabbed_widget", {"name": "Main Window", "parent": "main_window"})
    for tab, plots in tabs().items():
        container = ElementTree.SubElement(
            ElementTree.SubElement(widget, "Tab", tab_name=tab, containers="1"), "Container"
        )
        sizes = ";".join([f"{1 / len(plots):.6f}"] * len(plots))
        splitter = ElementTree.SubElement(
            container, "DockSplitter", orientation="-", count=str(len(plots)), sizes=sizes
        )
        for title, lines in plots.items():
            area = ElementTree.SubElement(splitter, "DockArea", name=title)
            plot = ElementTree.SubElement(
                area, "plot", mode="TimeSeries", style="Lines", flip_x="false", flip_y="false"
            )
            ElementTree.SubElement(plot, "range", left="0", right="1", bottom="0", top="1")
            ElementTree.SubElement(plot, "limitY")
            for line, colour in zip(lines, COLOURS, strict=False):
                ElementTree.SubElement(plot, "curve", name=line.plotjuggler, color=colour)
    ElementTree.SubElement(widget, "currentTabIndex", index="0")
    ElementTree.SubElement(root, "use_relative_time_offset", enabled="1")
    ElementTree.indent(root, " ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"
