"""Writes the made-up run of `synthetic` into a recording, with message definitions and serialisation by rosbags."""

from functools import cache

import numpy as np
from rosbags.typesys import Stores, get_typestore

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.writer import RecordingWriter
from test.monitor import synthetic

TABLE = "std_msgs/msg/Float64MultiArray"
TYPES = {
    names.WIND_SPEED: "geometry_msgs/msg/Vector3Stamped",
    names.SHAFTS_TOPIC: "sensor_msgs/msg/JointState",
    names.MESH_TOPIC: "sensor_msgs/msg/JointState",
    names.TRUTH: "diagnostic_msgs/msg/DiagnosticStatus",
    names.DIAGNOSTICS: "diagnostic_msgs/msg/DiagnosticArray",
    **{names.bearing_topic(b): "geometry_msgs/msg/WrenchStamped" for b in names.BEARINGS},
}


@cache
def typestore():
    """Message types of ROS 2 Jazzy."""
    return get_typestore(Stores.ROS2_JAZZY)


def message(kind, value):
    """A rosbags message of a type from an object with the same fields (what it lacks is zero)."""
    cls = typestore().types[kind]
    fields = {}
    for name, field in typestore().get_msgdef(kind).fields:
        fields[name] = convert(field, getattr(value, name, None))
    return cls(**fields)


def convert(field, value):
    """One field of a message, by rosbags' description of its type: (kind of node, its type)."""
    node, detail = field
    if node.name == "NAME":
        return message(detail, value)
    if node.name == "BASE":
        if value is None:
            return "" if detail[0] == "string" else 0
        return value[0] if isinstance(value, bytes) else value
    (inner, kind), _size = detail
    items = [] if value is None else value
    if inner.name == "NAME":
        return [message(kind, item) for item in items]
    return list(items) if kind[0] == "string" else np.array(items, dtype=kind[0])


def table_message(table):
    """A table in the message form of the contract."""
    types = typestore().types
    rows, columns = table.data.shape
    dimension = types["std_msgs/msg/MultiArrayDimension"]
    layout = types["std_msgs/msg/MultiArrayLayout"](
        dim=[
            dimension(label=table.row, size=rows, stride=rows * columns),
            dimension(label=",".join(table.columns), size=columns, stride=columns),
        ],
        data_offset=0,
    )
    return types[TABLE](layout=layout, data=np.ascontiguousarray(table.data).ravel())


def write(folder, items, *, space=names.NAMESPACE, provenance=None, finish=True):
    """Write a run into a new recording; without `finish` it stays as a killed recorder would leave it."""
    writer = RecordingWriter(folder)
    numbers = {}
    for name, content in (synthetic.PROVENANCE if provenance is None else provenance).items():
        writer.add_metadata(name, dict(content))
    for topic, at, value in items:
        kind = TABLE if isinstance(value, Table) else TYPES[topic]
        name = topic if topic.startswith("/") else f"{space}/{topic}"
        if name not in numbers:
            definition, _hash = typestore().generate_msgdef(kind, ros_version=2)
            numbers[name] = writer.add_topic(TopicEntry(name, kind), definition)
        content = table_message(value) if kind == TABLE else message(kind, value)
        data = bytes(typestore().serialize_cdr(content, kind))
        writer.write(numbers[name], data, round(1e9 * at), round(1e9 * at))
    writer.flush()
    if finish:
        writer.close()
    else:
        writer.abandon()
