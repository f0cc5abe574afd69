"""Recordings made by the writer from known messages, and the same messages as foreign readers see them."""

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_typestore
from std_msgs.msg import String

from nw_gear_common.ros import to_message
from nw_gear_common.tables import Table
from nw_gear_monitor.records.definitions import define
from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.qos import Qos
from nw_gear_monitor.records.writer import RecordingWriter

with warnings.catch_warnings():  # rclpy loads this later on; a parser that it uses imports a deprecated module
    warnings.simplefilter("ignore", DeprecationWarning)
    import rosidl_generator_py  # noqa: F401 - for the import alone

LATCHED = Qos(durability="transient_local")
START = 1_700_000_000_000_000_000


PLAN = "trajectory_msgs/msg/JointTrajectory"
STORE = get_typestore(Stores.ROS2_JAZZY)


@dataclass(frozen=True)
class Message:
    """One message to record: topic, type, CDR bytes and log time (ns)."""

    topic: str
    kind: str
    data: bytes
    log_time: int


def table(rows, seed=0):
    """A table `sample` of (rows, 3) random numbers."""
    data = np.random.default_rng(seed).normal(size=(rows, 3))
    return Table("sample", ("time", "x_III", "v_III"), data)


def plan(i):
    """A serialised JointTrajectory; `serialize_message` of the wheels leaves eight bytes too many behind this type."""
    types = STORE.types
    header = types["std_msgs/msg/Header"](stamp=types["builtin_interfaces/msg/Time"](sec=i, nanosec=0), frame_id="")
    none, duration = np.empty(0), types["builtin_interfaces/msg/Duration"](sec=0, nanosec=0)
    point = types["trajectory_msgs/msg/JointTrajectoryPoint"](
        positions=np.array([1.0 * i, 2.0]), velocities=none, accelerations=none, effort=none, time_from_start=duration
    )
    message = types[PLAN](header=header, joint_names=["a", "b"], points=[point])
    return bytes(STORE.serialize_cdr(message, PLAN))


def mixed(count=40):
    """Messages of several packages, interleaved, 10 ms apart."""
    made = []
    for i in range(count):
        time = START + i * 10_000_000
        status = DiagnosticStatus(
            level=b"\x01", name="a: b", message="ü", values=[KeyValue(key="rms (m)", value=str(i))]
        )
        odometry = Odometry(child_frame_id=f"frame {i}")
        odometry.pose.pose.position.x = 0.5 * i
        odometry.pose.covariance[35] = float(i)
        messages = {
            ("/nw_gear/waveform", "std_msgs/msg/Float64MultiArray"): to_message(table(8, seed=i)),
            ("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"): DiagnosticArray(status=[status]),
            ("/odometry", "nav_msgs/msg/Odometry"): odometry,
            ("/chatter", "std_msgs/msg/String"): String(data="x" * i),
        }
        made += [Message(topic, kind, serialize_message(m), time) for (topic, kind), m in messages.items()]
        made.append(Message("/plan", PLAN, plan(i), time))
    return made


def start(folder: Path, messages, compression="zstd"):
    """A writer with the topics of some messages, and the numbers of these topics."""
    writer = RecordingWriter(folder, compression)
    numbers = {}
    for topic, kind in dict.fromkeys((m.topic, m.kind) for m in messages):
        definition = define(kind)
        qos = (LATCHED,) if topic == "/chatter" else (Qos(), Qos(reliability="best_effort"))
        numbers[topic] = writer.add_topic(TopicEntry(topic, kind, definition.type_hash, qos), definition.text)
    return writer, numbers


def write(folder: Path, messages=(), compression="zstd", flush_every=0):
    """Write a recording and return its folder; `flush_every` messages make a chunk."""
    writer, numbers = start(folder, messages, compression)
    writer.add_metadata("nw_gear.run", {"command_line": "made by a test"})
    for i, message in enumerate(messages):
        writer.write(numbers[message.topic], message.data, message.log_time, message.log_time + 5, i)
        if flush_every and i % flush_every == flush_every - 1:
            writer.flush()
    writer.close()
    return folder
