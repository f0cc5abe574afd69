"""Repairs a recording whose writer was killed: whole chunks go into a new file, the index and metadata.yaml anew."""

from __future__ import annotations

import contextlib
import fcntl
import shutil
from dataclasses import dataclass
from pathlib import Path

from mcap.records import Channel, Message, Metadata, Schema

from nw_gear_common.errors import InputError, NwGearError
from nw_gear_monitor.records import metadata
from nw_gear_monitor.records.files import files_of
from nw_gear_monitor.records.mcapfile import McapFile, damage
from nw_gear_monitor.records.qos import from_yaml
from nw_gear_monitor.records.scan import Scan
from nw_gear_monitor.records.schema import HASH_KEY, PROVENANCE, QOS_KEY
from nw_gear_monitor.records.writer import McapWriter

RECORD = f"{PROVENANCE}recovered"
"""Metadata record that a repaired file carries."""

DAMAGED = ".mcap.damaged"


@dataclass(frozen=True)
class Rescued:
    """What came out of one damaged file.

    Attributes:
        file: its name.
        reason: what was wrong with it.
        messages: how many were recovered.
        lost_bytes: bytes that held nothing usable.
        lost_messages: messages of topics whose description was lost.
        kept_as: name of the damaged file afterwards, empty where it was left alone.
    """

    file: str
    reason: str
    messages: int
    lost_bytes: int
    lost_messages: int = 0
    kept_as: str = ""

    def words(self) -> str:
        """One sentence part for people."""
        orphans = f", {self.lost_messages} messages of unknown topics left out" if self.lost_messages else ""
        return f"{self.messages} messages recovered, {self.lost_bytes} bytes lost{orphans}"


@dataclass(frozen=True)
class Recovery:
    """What was done to a recording: nothing where it is healthy."""

    folder: Path
    files: tuple[Rescued, ...]
    metadata_rebuilt: bool

    @property
    def healthy(self) -> bool:
        """Whether there was nothing to do."""
        return not self.files and not self.metadata_rebuilt


def recover(folder: Path, output: Path | None = None) -> Recovery:
    """Repair a recording.

    Args:
        folder: of the recording. Without `output` it is repaired in place; each damaged file is kept beside the new
            one as `*.mcap.damaged`.
        output: new folder for the repaired recording; the damaged one stays as it is.

    Raises:
        InputError: not a recording, one that is still being written, or an output that exists.
        NwGearError: the repaired files can't be written; nothing is left of them.
    """
    if not folder.is_dir():
        got = "a file" if folder.exists() else "nothing of that name"
        raise InputError(str(folder), "the folder of a recording", got)
    if output is not None and output.exists():
        raise InputError(f"-o {output}", "a new folder", "one that exists")
    paths = files_of(folder, lenient=True)[0]
    for path in paths:
        _refuse_while_written(path)
    broken = {path: reason for path in paths if (reason := _examine(path))}
    listed = not broken and _is_listed(folder, paths)
    if listed:
        return Recovery(folder, (), False)
    try:
        if output is not None:
            return _into(output, paths, broken)
        return _in_place(folder, paths, broken)
    except OSError as error:
        raise NwGearError(f"{output or folder}: the repaired recording can't be written: {error.strerror}") from None


def rescue(path: Path, new: Path, reason: str = "") -> Rescued:
    """Copy whatever is intact in a damaged MCAP file into a new one, whole chunks at a time."""
    scan = Scan(path)
    schemas, channels = _known(path)
    with contextlib.ExitStack() as stack:
        stack.callback(new.unlink, missing_ok=True)
        compression = _compression(path)
        writer = McapWriter(new, compression)
        stack.callback(writer.abandon)
        numbers: dict[int, int] = {}
        orphans = 0
        for record in scan.records():
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Metadata):
                writer.add_metadata(record.name, record.metadata)
            else:
                number = record.id if isinstance(record, Channel) else record.channel_id
                if isinstance(record, Channel):
                    channels[number] = record
                if number not in numbers and number in channels:
                    numbers[number] = _begin(writer, channels[number], schemas)
                if isinstance(record, Message) and number in numbers:
                    times = (record.log_time, record.publish_time, record.sequence)
                    writer.write(numbers[number], record.data, *times)
                elif isinstance(record, Message):
                    orphans += 1
        rescued = Rescued(path.name, reason, writer.count.messages, scan.lost_bytes, orphans)
        noted = {"file": path.name, "reason": reason, "messages": str(rescued.messages)}
        writer.add_metadata(RECORD, {**noted, "lost_bytes": str(rescued.lost_bytes)})
        writer.close()
        stack.pop_all()
    return rescued


def _begin(writer: McapWriter, channel: Channel, schemas: dict[int, Schema]) -> int:
    schema = schemas.get(channel.schema_id)
    number = writer.add_schema(schema.name, schema.encoding, schema.data) if schema else 0
    return writer.add_channel(channel.topic, channel.message_encoding, number, channel.metadata)


def _known(path: Path) -> tuple[dict[int, Schema], dict[int, Channel]]:
    """Schemas and channels from the index, where a file still has one."""
    if damage(path):
        return {}, {}
    with McapFile(path) as file:
        return dict(file.summary.schemas), dict(file.summary.channels)


def _compression(path: Path) -> str:
    """Compression of the first intact chunk, so that the copy looks like its original."""
    scan = Scan(path)
    for _record in scan.records():
        if scan.chunks:
            break
    return (scan.compression or "none") if scan.chunks else "zstd"


def _examine(path: Path) -> str:
    """What is wrong with a file, its chunks included; empty where it is whole."""
    reason = damage(path)
    if reason:
        return reason
    scan = Scan(path)
    for _record in scan.records():
        pass
    if not scan.finished:
        return "a record has a wrong length"
    number = scan.damaged_chunks
    return "" if not number else "1 chunk is damaged" if number == 1 else f"{number} chunks are damaged"


def _refuse_while_written(path: Path) -> None:
    with path.open("rb") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError:
            raise InputError(str(path), "a recording that nobody writes", "one that is being written") from None


def _is_listed(folder: Path, paths: list[Path]) -> bool:
    """Whether metadata.yaml fits the files."""
    try:
        listed = metadata.read(folder)
    except InputError:
        return False
    count = 0
    for path in paths:
        with McapFile(path) as file:
            count += file.message_count
    return listed.count == count and list(listed.files) == [path.name for path in paths]


def _in_place(folder: Path, paths: list[Path], broken: dict[Path, str]) -> Recovery:
    done = []
    for path, reason in broken.items():
        new = folder / f".{path.name}.recovering"
        new.unlink(missing_ok=True)
        rescued = rescue(path, new, reason)
        kept = _free_name(path)
        try:
            kept.hardlink_to(path)  # at no moment is there no file of the old name
        except OSError:
            path.rename(kept)
        new.replace(path)
        done.append(Rescued(path.name, reason, rescued.messages, rescued.lost_bytes, rescued.lost_messages, kept.name))
    metadata.write(folder, describe(paths))
    return Recovery(folder, tuple(done), True)


def _free_name(path: Path) -> Path:
    candidates = (path.with_name(f"{path.stem}{extra}{DAMAGED}") for extra in ("", *(f".{i}" for i in range(1, 1000))))
    return next(candidate for candidate in candidates if not candidate.exists())


def _into(output: Path, paths: list[Path], broken: dict[Path, str]) -> Recovery:
    with contextlib.ExitStack() as stack:
        output.mkdir(parents=True)
        stack.callback(shutil.rmtree, output, ignore_errors=True)
        done = []
        for path in paths:
            if path in broken:
                done.append(rescue(path, output / path.name, broken[path]))
            else:
                shutil.copy2(path, output / path.name)
        metadata.write(output, describe([output / path.name for path in paths]))
        stack.pop_all()
    return Recovery(output, tuple(done), True)


def describe(paths: list[Path]) -> metadata.Metadata:
    """What metadata.yaml has to say about whole MCAP files."""
    files: list[metadata.FileEntry] = []
    topics: dict[str, metadata.TopicEntry] = {}
    for path in paths:
        with McapFile(path) as file:
            files.append(metadata.FileEntry(path.name, *file.bounds(), file.message_count))
            for number, channel in file.summary.channels.items():
                schema = file.summary.schemas.get(channel.schema_id)
                before = topics[channel.topic].count if channel.topic in topics else 0
                topics[channel.topic] = metadata.TopicEntry(
                    name=channel.topic,
                    type=schema.name if schema else "",
                    type_hash=channel.metadata.get(HASH_KEY, ""),
                    qos=from_yaml(channel.metadata.get(QOS_KEY, "")),
                    count=before + file.count(number),
                )
    return metadata.Metadata(tuple(files), tuple(topics.values()))
