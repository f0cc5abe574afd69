"""The paths in the layouts for Foxglove and PlotJuggler, looked up in a recording with a foreign reader."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

from rosbags.highlevel import AnyReader

CONFIG = Path(__file__).resolve().parents[2] / "config"
STEP = re.compile(r'\.(?P<field>\w+)|\[(?P<index>\d*):?\]|\{(?P<key>\w+)=="(?P<value>[^"]*)"\}')


def foxglove():
    """Message paths of the Foxglove layout."""
    panels = json.loads((CONFIG / "foxglove.json").read_text(encoding="utf-8"))["configById"].values()
    lines = [path["value"] for panel in panels for path in panel.get("paths", ())]
    return lines + [p[key] for p in panels for key in ("topicPath", "topicToRender") if key in p]


def plotjuggler():
    """Names of series of the PlotJuggler layout."""
    return [curve.get("name") for curve in ElementTree.parse(CONFIG / "plotjuggler.xml").iter("curve")]


def rqt_plot():
    """Paths in the lines for rqt_plot of the README, as message paths."""
    readme = (CONFIG.parent / "README.md").read_text(encoding="utf-8")
    return [path for line in re.findall(r"rqt_plot rqt_plot ([^`]+)", readme) for path in line.split()]


def values(message, path):
    """What a path of Foxglove (without the topic) selects in a message; see its page on message path syntax."""
    found, at = [message], 0
    while at < len(path):
        step = STEP.match(path, at)
        assert step, f"no message path: {path}"
        at = step.end()
        if step["field"]:
            found = [getattr(thing, step["field"]) for thing in found]
        elif step["key"]:
            found = [thing for thing in found if getattr(thing, step["key"]) == step["value"]]
        elif step["index"]:
            found = [thing[int(step["index"])] for thing in found if int(step["index"]) < len(thing)]
        else:
            found = [part for thing in found for part in thing]
    return found


def series(topic, message):
    """Names that PlotJuggler's ROS parser gives to what is in a message of the types that the layout shows."""
    kind = type(message).__name__.rsplit("__", 1)[-1]
    if kind == "JointState":
        return {f"{topic}/{joint}/{field}" for joint in message.name for field in ("position", "velocity", "effort")}
    if kind == "Float64MultiArray":
        return {f"{topic}/data[{k}]" for k in range(len(message.data))}
    if kind == "Vector3Stamped":
        return {f"{topic}/vector/{axis}" for axis in "xyz"}
    if kind == "WrenchStamped":
        return {f"{topic}/wrench/{part}/{axis}" for part in ("force", "torque") for axis in "xyz"}
    return set()


def missing(recording):
    """Paths of both layouts, and of the lines for rqt_plot, for which a recording has nothing."""
    wanted, names, lines = set(foxglove()), set(plotjuggler()), rqt_plot()
    assert len(wanted) > 30
    assert len(names) > 30
    assert lines
    with AnyReader([recording]) as reader:
        topics = sorted((c.topic for c in reader.connections), key=len, reverse=True)
        for line in lines:
            topic = next(topic for topic in topics if line.startswith(topic + "/"))
            wanted.add(topic + line.removeprefix(topic).replace("/", "."))
        for connection, _time, data in reader.messages():
            mine = {path for path in wanted if re.split(r"[.\[{]", path)[0] == connection.topic}
            shown = {name for name in names if name.startswith(connection.topic + "/")}
            if mine or shown:
                message = reader.deserialize(data, connection.msgtype)
                wanted -= {path for path in mine if values(message, path.removeprefix(connection.topic))}
                names -= series(connection.topic, message)
    return sorted(wanted | names)
