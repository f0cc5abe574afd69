"""Repairs a recording whose writer was killed: new files of what is intact, the index and metadata.yaml anew."""

from __future__ import annotations

import contextlib
import fcntl
import shutil
from dataclasses import dataclass, replace
from pathlib import Path

from nw_gear_common.errors import InputError, NwGearError
from nw_gear_monitor.records import metadata
from nw_gear_monitor.records.files import files_of
from nw_gear_monitor.records.mcapfile import McapFile, unusable
from nw_gear_monitor.records.qos import from_yaml
from nw_gear_monitor.records.rescue import Rescued, rescue
from nw_gear_monitor.records.scan import Scan
from nw_gear_monitor.records.schema import HASH_KEY, QOS_KEY

DAMAGED = ".mcap.damaged"


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


def _examine(path: Path) -> str:
    """What is wrong with a file, its chunks included; empty where it is whole."""
    reason = unusable(path)
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
        kept = _free_name(path)
        rescued = replace(rescue(path, new, reason), kept_as=kept.name)
        try:
            kept.hardlink_to(path)  # at no moment is there no file of the old name
        except OSError:
            path.rename(kept)
        new.replace(path)
        done.append(rescued)
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
