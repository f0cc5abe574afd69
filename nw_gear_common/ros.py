"""The thin rim to ROS that every node uses: life of a process, parameters from declared quantities, tables as messages.

Kept apart from everything that computes. Facts about ROS 2 Jazzy that shaped this file: `EventsExecutor.spin()` of the
wheels dispatches nothing, a loop over its `spin_once` does and costs a third of the default executor; a numpy array
assigned to an array field is copied element by element, `array.array` is not.
"""

from __future__ import annotations

import array
import dataclasses
import os
import signal
import sys
import threading
import typing
from collections.abc import Callable, Sequence
from types import FrameType
from typing import Any, TypeVar

import numpy as np
import rclpy
import rclpy.exceptions
from builtin_interfaces.msg import Time
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Float64MultiArray, MultiArrayDimension

from nw_gear_common.errors import InputError, NwGearError
from nw_gear_common.names import NAMESPACE
from nw_gear_common.quantities import Quantity, check_value, quantities
from nw_gear_common.tables import Table

Settings = TypeVar("Settings")
MAX_RANGE = 1e300
LONGEST_SHOWN = 60


class NodeFailure(NwGearError):
    """A node can't go on: it stops with this message and exit code 1."""


class Stop:
    """Asks a process to end: set by a signal or by a node, looked at by every loop."""

    def __init__(self) -> None:
        self.event = threading.Event()
        self.error: NwGearError | None = None

    def __bool__(self) -> bool:
        return self.event.is_set()

    def __call__(self, error: NwGearError | None = None) -> None:
        """Ask for the end; with an error the process ends with its message and a non-zero exit code."""
        if error is not None and self.error is None:
            self.error = error
        self.event.set()


def run(name: str, make: Callable[[Stop], Node], argv: Sequence[str]) -> int:
    """Run one node from start to end and return the exit code of its process.

    Args:
        name: executable, for messages.
        make: builds the node; a method `close()` of the node, where there is one, is called before it is destroyed.
        argv: the command line, ROS arguments included.

    Returns:
        0 after SIGINT, SIGTERM or a finished task; 2 for wrong input; 1 for any other failure that was foreseen.
    """
    stop = Stop()
    _listen_to_signals(stop)
    node: Node | None = None
    try:
        _init(argv)
        node = make(stop)
        spin(node, stop)
    except NwGearError as error:
        stop(error)
    finally:
        _listen_to_signals(stop)
        if node is not None:
            try:
                if hasattr(node, "close"):
                    node.close()
                node.destroy_node()
            except NwGearError as error:
                stop(error)
        rclpy.try_shutdown()
    if stop.error is None:
        return 0
    print(f"{name}: {stop.error}", file=sys.stderr, flush=True)
    return stop.error.exit_code


def _listen_to_signals(stop: Stop) -> None:
    def answer(_number: int, _frame: FrameType | None) -> None:
        stop()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, answer)


def _init(argv: Sequence[str]) -> None:
    arguments = list(argv)
    try:
        own = rclpy.utilities.remove_ros_args(arguments)[1:]
        if own:
            raise InputError("arguments", "only ROS arguments (--ros-args ...)", " ".join(own))
        rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    except NwGearError:
        raise
    except Exception as error:  # rcl raises several unrelated types here, all about the arguments
        reason = str(error).splitlines()[0].split(", at /")[0].removeprefix("Failed to parse ROS arguments: ")
        raise InputError("--ros-args", "valid ROS arguments", reason) from None


def make_node(cls: Callable[..., Node], name: str, **kwargs: Any) -> Node:
    """Build a node whose default namespace is the project's (a namespace remapped on the command line wins)."""
    return cls(name, namespace=NAMESPACE, **kwargs)


def spin(node: Node, stop: Stop) -> None:
    """Dispatch callbacks until asked to stop."""
    executor = EventsExecutor()
    executor.add_node(node)
    try:
        while not stop:
            executor.spin_once(timeout_sec=0.1)
    finally:
        executor.remove_node(node)
        executor.shutdown()


def leave_now(code: int) -> None:
    """End the process although a thread is still inside a compiler that can't be interrupted."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


# --- parameters -------------------------------------------------------------------------------------------------------


def declare_parameters(
    node: Node, cls: type[Settings], on_change: Callable[[Settings], None] | None = None
) -> Settings:
    """Declare a ROS parameter for every quantity of a dataclass and return an instance with the values that were set.

    Args:
        node: owner of the parameters.
        cls: frozen dataclass of quantities; those marked `live` may be set while the node runs, others are read-only.
        on_change: called with the new settings after live parameters changed; it may raise InputError to refuse them.

    Raises:
        InputError: an unknown parameter, a wrong type, a value out of range.
    """
    known = {name for name, *_rest in quantities(cls)} | {"use_sim_time", "start_type_description_service"}
    for name in node._parameter_overrides:  # rclpy has no public way to list the overrides of a node
        if name not in known and not name.startswith("qos_overrides."):
            raise InputError(f"parameter {name}", "one of " + ", ".join(sorted(known)), "an unknown name")
    values: dict[str, Any] = {}
    for name, kind, default, description in quantities(cls):
        place = f"parameter {name}"
        try:
            value = node.declare_parameter(name, _as_parameter(default), _descriptor(kind, description)).value
        except rclpy.exceptions.ParameterException as error:
            got = repr(node._parameter_overrides[name].value) if name in node._parameter_overrides else str(error)
            raise InputError(place, description.expected(kind), got) from None
        given = () if value is None and typing.get_origin(kind) is tuple else _from_parameter(value)  # [] has no type
        values[name] = check_value(place, given, kind, description)
    settings = cls(**values)
    if on_change is not None:
        _follow_changes(node, settings, on_change)
    return settings


def was_set(node: Node, name: str) -> bool:
    """Whether a parameter was given from outside, as opposed to its default."""
    return name in node._parameter_overrides


def _follow_changes(node: Node, settings: Any, on_change: Callable[[Any], None]) -> None:
    kinds = {name: (kind, text) for name, kind, _default, text in quantities(settings)}
    current = [settings]

    def accept(parameters: list[Parameter]) -> SetParametersResult:
        try:
            changes = {
                p.name: check_value(f"parameter {p.name}", _from_parameter(p.value), *kinds[p.name])
                for p in parameters
                if p.name in kinds
            }
            if changes:
                changed = dataclasses.replace(current[0], **changes)
                on_change(changed)
                current[0] = changed
        except InputError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    node.add_on_set_parameters_callback(accept)


def _as_parameter(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _from_parameter(value: Any) -> Any:
    if isinstance(value, array.array):
        return tuple(value)
    return tuple(value) if isinstance(value, list) else value


def _descriptor(kind: type, description: Quantity) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(description=description.text, read_only=not description.live)
    descriptor.additional_constraints = description.expected(kind)
    bounded = description.minimum is not None or description.maximum is not None
    low = -MAX_RANGE if description.minimum is None else description.minimum
    high = MAX_RANGE if description.maximum is None else description.maximum
    if kind is float and bounded:
        descriptor.floating_point_range = [FloatingPointRange(from_value=float(low), to_value=float(high))]
    if kind is int and bounded:
        limit = 2**62
        lowest = -limit if description.minimum is None else int(low)
        highest = limit if description.maximum is None else int(high)
        descriptor.integer_range = [IntegerRange(from_value=lowest, to_value=highest)]
    if typing.get_origin(kind) is tuple:
        descriptor.dynamic_typing = True  # an empty list has no type of its own in ROS
    return descriptor


# --- time and quality of service --------------------------------------------------------------------------------------


def to_seconds(stamp: Time) -> float:
    """Turn a stamp into seconds."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def to_stamp(seconds: float) -> Time:
    """Turn seconds into a stamp, rounded to the nanosecond."""
    nanoseconds = round(seconds * 1e9)
    return Time(sec=int(nanoseconds // 1_000_000_000), nanosec=int(nanoseconds % 1_000_000_000))


def live_qos(depth: int) -> QoSProfile:
    """Reliable, volatile, with a depth that should hold a second of the topic."""
    return QoSProfile(depth=depth, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.RELIABLE)


def latched_qos() -> QoSProfile:
    """Reliable and transient local: a late subscriber gets the last message."""
    return QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)


# --- tables -----------------------------------------------------------------------------------------------------------


def to_message(table: Table) -> Float64MultiArray:
    """Turn a table into the message form fixed by the contract (row-major, columns named in the second label)."""
    rows, columns = table.data.shape
    message = Float64MultiArray()
    message.layout.dim = [
        MultiArrayDimension(label=table.row, size=rows, stride=rows * columns),
        MultiArrayDimension(label=",".join(table.columns), size=columns, stride=columns),
    ]
    values = array.array("d")
    values.frombytes(np.ascontiguousarray(table.data, dtype=np.float64).tobytes())
    message.data = values
    return message


def from_message(message: Float64MultiArray, place: str) -> Table:
    """Turn a message back into a table.

    Args:
        message: as received (or decoded from a recording by a library with the same field names).
        place: the topic, for the error.

    Raises:
        InputError: the layout isn't that of a table (strides of 0 count as not given), names of columns are missing or
            there twice, or the amount of data doesn't fit.
    """
    dimensions = message.layout.dim
    if len(dimensions) != 2:
        raise InputError(f"{place}: layout", "two dimensions", str(len(dimensions)))
    columns = tuple(dimensions[1].label.split(","))
    if "" in columns or len(set(columns)) != len(columns):
        raise InputError(f"{place}: columns", "names that differ", repr(dimensions[1].label[:LONGEST_SHOWN]))
    rows = int(dimensions[0].size)
    strides, usual = tuple(dimension.stride for dimension in dimensions), (rows * len(columns), len(columns))
    if message.layout.data_offset or any(
        given not in (0, wanted) for given, wanted in zip(strides, usual, strict=True)
    ):
        got = f"strides {strides} from {message.layout.data_offset} on"
        raise InputError(f"{place}: layout", f"rows in a row: strides {usual} from 0 on", got)
    data = np.frombuffer(message.data, dtype=np.float64) if len(message.data) else np.empty(0)
    if len(columns) != dimensions[1].size or data.size != rows * len(columns):
        raise InputError(f"{place}: data", f"{rows} x {len(columns)} numbers", str(data.size))
    return Table(dimensions[0].label, columns, data.reshape(rows, len(columns)))
