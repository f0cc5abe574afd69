"""Opens a recording for reading: topics, time, provenance, tables and messages.

    with Recording.open("runs/today/recording") as recording:
        for time, table in recording.tables("/nw_gear/waveform"):
            print(time, table.column("x_III").std())

Everything comes in the order in which it was recorded, chunk by chunk: memory stays bounded.
"""

from __future__ import annotations

import contextlib
import functools
import tempfile
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Self

from mcap_ros2.decoder import DecoderFactory

from nw_gear_common.errors import InputError, NwGearError
from nw_gear_common.tables import Table
from nw_gear_monitor.records.cdr import TABLE_TYPE, to_table
from nw_gear_monitor.records.decoding import decoder_of
from nw_gear_monitor.records.files import files_of
from nw_gear_monitor.records.mcapfile import McapFile, unusable
from nw_gear_monitor.records.qos import Qos, from_yaml
from nw_gear_monitor.records.rescue import rescue
from nw_gear_monitor.records.schema import PROVENANCE, QOS_KEY


class Topic(NamedTuple):
    """Type of a topic, for instance `std_msgs/msg/String`, and how many messages there are."""

    type: str
    messages: int


class RawMessage(NamedTuple):
    """A message as it was recorded: topic, log and publish time (ns), CDR bytes."""

    topic: str
    log_time: int
    publish_time: int
    data: bytes


class Entry(NamedTuple):
    """A message with its topic, log time (s) and content: a `Table`, or an object with the fields of its type."""

    topic: str
    log_time: float
    value: Any


class Recording:
    """A recording that is open for reading; made by `Recording.open`.

    Attributes:
        path: what was opened: a folder, or an MCAP file.
        complete: whether the recording is whole; False where a repaired copy is read, or metadata.yaml is missing.
        damage: what is wrong with it, in words; empty where it is whole.
        topics: name to type and number of messages.
        files: the MCAP files, in order.
        provenance: metadata records, name (`nw_gear.run`, `nw_gear.node.<name>`) to key to text.
        start_ns, end_ns: first and last log time, ns of ROS time.
    """

    def __init__(self, path: Path, files: Sequence[McapFile], damage: str, stack: contextlib.ExitStack) -> None:
        self.path = path
        self.damage = damage
        self.complete = not damage
        self.files = tuple(files)
        self._stack = stack
        self._decoders = {file.path: DecoderFactory() for file in files}
        self.topics: dict[str, Topic] = _topics(files)
        bounds = [file.bounds() for file in files if file.message_count]
        self.start_ns = min((first for first, _last in bounds), default=0)
        self.end_ns = max((last for _first, last in bounds), default=0)
        records = [record for file in files for record in file.metadata()]
        self.provenance: dict[str, dict[str, str]] = {n: c for n, c in records if n.startswith(PROVENANCE)}

    @classmethod
    def open(cls, path: str | Path, *, repair: bool = False) -> Self:
        """Open a recording.

        Args:
            path: a rosbag2 folder with MCAP storage, or an MCAP file.
            repair: read a damaged one through a temporary repaired copy instead of refusing it; `damage` says so.

        Raises:
            InputError: nothing there, not a recording, an SQLite bag, or damaged and `repair` isn't wanted.
        """
        path = Path(path)
        with contextlib.ExitStack() as stack:
            paths, damage = files_of(path, repair)
            if repair:
                paths, damage = _repaired(paths, damage, stack)
            files = [stack.enter_context(McapFile(file)) for file in paths]
            recording = cls(path, files, damage, contextlib.ExitStack())
            recording._stack = stack.pop_all()
        return recording

    @property
    def start(self) -> float:
        """First log time, s of ROS time."""
        return 1e-9 * self.start_ns

    @property
    def end(self) -> float:
        """Last log time, s of ROS time."""
        return 1e-9 * self.end_ns

    @property
    def duration(self) -> float:
        """Seconds from the first to the last message."""
        return 1e-9 * (self.end_ns - self.start_ns)

    @property
    def message_count(self) -> int:
        """Messages of all topics."""
        return sum(topic.messages for topic in self.topics.values())

    def close(self) -> None:
        """Close the files and drop a repaired copy."""
        self._stack.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _trace: TracebackType | None
    ) -> None:
        self.close()

    # --- contents -----------------------------------------------------------------------------------------------------

    def tables(self, topic: str) -> Iterator[tuple[float, Table]]:
        """Log time (s) and table of every message of one topic.

        Raises:
            InputError: there is no such topic, or it doesn't carry tables.
        """
        kind = self._topic(topic).type
        if kind != TABLE_TYPE:
            raise InputError(f"{self.path}: {topic}", f"a table ({TABLE_TYPE})", kind)
        for message in self.raw([topic]):
            yield 1e-9 * message.log_time, to_table(message.data, topic)

    def read(self, topics: Collection[str] | None = None) -> Iterator[Entry]:
        """Every message of some topics (None = all), decoded, in one pass and in the order of recording.

        A Float64MultiArray comes as a `Table` where its layout is one, everything else as an object with the fields
        of its type.

        Raises:
            InputError: a message doesn't fit its type.
        """
        for file in self.files:
            decode = functools.cache(functools.partial(self.decoder, file))
            for channel, message in file.messages(topics):
                value = decode(channel.id)(message.data)
                yield Entry(channel.topic, 1e-9 * message.log_time, value)

    def messages(self, topics: Collection[str] | None = None) -> Iterator[Entry]:
        """The same as `read`, with Float64MultiArray as an object with the fields of that type."""
        for file in self.files:
            decode = functools.cache(functools.partial(self.decoder, file, tables=False))
            for channel, message in file.messages(topics):
                yield Entry(channel.topic, 1e-9 * message.log_time, decode(channel.id)(message.data))

    def raw(self, topics: Collection[str] | None = None, since: int = 0) -> Iterator[RawMessage]:
        """Messages as they were recorded, from a log time (ns) on."""
        for file in self.files:
            for channel, message in file.messages(topics, since):
                yield RawMessage(channel.topic, message.log_time, message.publish_time, message.data)

    def qos(self, topic: str) -> tuple[Qos, ...]:
        """What the publishers of a topic offered when it was recorded; empty where that isn't known."""
        self._topic(topic)
        channels = [c for file in self.files for c in file.summary.channels.values() if c.topic == topic]
        return from_yaml(channels[0].metadata.get(QOS_KEY, ""))

    def _topic(self, name: str) -> Topic:
        if name not in self.topics:
            raise InputError(f"{self.path}: topic {name}", "one of " + ", ".join(self.topics), "none of them")
        return self.topics[name]

    def decoder(self, file: McapFile, number: int, tables: bool = True) -> Callable[[bytes], Any]:
        """What turns messages of a channel of one of the files into tables or objects.

        Raises:
            InputError: its type's definition can't be used; when it is called, a message doesn't fit it.
        """
        channel = file.summary.channels[number]
        schema = file.summary.schemas.get(channel.schema_id)
        decode = decoder_of(self._decoders[file.path], channel, schema, f"{self.path}: {channel.topic}")
        if not tables or schema is None or schema.name != TABLE_TYPE:
            return decode

        def table(data: bytes) -> Any:
            try:
                return to_table(data, channel.topic)
            except InputError:
                return decode(data)

        return table


def _topics(files: Sequence[McapFile]) -> dict[str, Topic]:
    found: dict[str, Topic] = {}
    for file in files:
        for number, channel in sorted(file.summary.channels.items(), key=lambda item: item[1].topic):
            schema = file.summary.schemas.get(channel.schema_id)
            before = found[channel.topic].messages if channel.topic in found else 0
            found[channel.topic] = Topic(schema.name if schema else "", before + file.count(number))
    return found


def _repaired(paths: list[Path], damage: str, stack: contextlib.ExitStack) -> tuple[list[Path], str]:
    """Put repaired copies in the place of damaged files, in a folder that is removed with the stack."""
    broken = {path: words for path in paths if (words := unusable(path))}
    if not broken:
        return paths, damage
    folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="nw_gear_")))
    remarks = [damage] if damage else []
    for path, words in broken.items():
        try:
            rescued = rescue(path, folder / path.name, words)
        except OSError as error:
            reason = f"{error.strerror or error}; `nw_gear recover -o` repairs it elsewhere"
            raise NwGearError(f"{path}: a repaired copy can't be written to {folder.parent}: {reason}") from None
        remarks.append(f"{path.name}: {words}; read through a repaired copy, {rescued.words()}")
    return [folder / path.name if path in broken else path for path in paths], "; ".join(remarks)
