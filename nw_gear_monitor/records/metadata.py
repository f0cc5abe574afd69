"""`metadata.yaml` of a rosbag2 folder, version 9: what `ros2 bag`, rosbags and this project read first."""

from __future__ import annotations

import contextlib
import os
import tempfile
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import yaml

from nw_gear_common.errors import InputError
from nw_gear_monitor.records.disk import sync_folder
from nw_gear_monitor.records.qos import Qos, as_list
from nw_gear_monitor.records.yamltext import LONGEST, plain

FILE = "metadata.yaml"
VERSION = 9
ROOT_KEY = "rosbag2_bagfile_information"
STORAGE = "mcap"
DISTRIBUTION = "jazzy"
CONVERT = "`ros2 bag convert`, or `rosbags-convert --dst-storage mcap`, makes plain MCAP of it"
CONVERT_ROS1 = "`rosbags-convert --dst-storage mcap` makes a recording of it"
LONGEST_SHOWN = 60


@dataclass(frozen=True)
class TopicEntry:
    """One topic of a recording.

    Attributes:
        name: absolute.
        type: for instance `std_msgs/msg/String`.
        type_hash: RIHS01 text, empty where unknown.
        qos: what the publishers offered.
        count: messages.
    """

    name: str
    type: str
    type_hash: str = ""
    qos: tuple[Qos, ...] = ()
    count: int = 0


@dataclass(frozen=True)
class FileEntry:
    """One MCAP file: name inside the folder, first and last log time (ns), messages."""

    name: str
    start: int
    end: int
    count: int


@dataclass(frozen=True)
class Metadata:
    """The files and topics of a recording."""

    files: tuple[FileEntry, ...] = ()
    topics: tuple[TopicEntry, ...] = field(default=())

    def to_yaml(self) -> str:
        """The text of `metadata.yaml`."""
        filled = [file for file in self.files if file.count]
        start = min((file.start for file in filled), default=0)
        end = max((file.end for file in filled), default=0)
        content = {
            "version": VERSION,
            "storage_identifier": STORAGE,
            "duration": {"nanoseconds": end - start},
            "starting_time": {"nanoseconds_since_epoch": start},
            "message_count": sum(file.count for file in self.files),
            "topics_with_message_count": [_topic(topic) for topic in self.topics],
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [file.name for file in self.files],
            "files": [_file(file) for file in self.files],
            "custom_data": None,
            "ros_distro": DISTRIBUTION,
        }
        return yaml.safe_dump({ROOT_KEY: content}, sort_keys=False, allow_unicode=True)


def _topic(topic: TopicEntry) -> dict[str, Any]:
    described = {
        "name": topic.name,
        "type": topic.type,
        "serialization_format": "cdr",
        "offered_qos_profiles": as_list(topic.qos),
        "type_description_hash": topic.type_hash,
    }
    return {"topic_metadata": described, "message_count": topic.count}


def _file(file: FileEntry) -> dict[str, Any]:
    return {
        "path": file.name,
        "starting_time": {"nanoseconds_since_epoch": file.start},
        "duration": {"nanoseconds": file.end - file.start},
        "message_count": file.count,
    }


def write(folder: Path, metadata: Metadata, fsync: bool = False) -> None:
    """Write `metadata.yaml` as a whole or not at all; one that is there is replaced; with `fsync` it is on the disk."""
    partial = None
    try:
        with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=folder, prefix=f".{FILE}.", delete=False) as file:
            partial = Path(file.name)
            file.write(metadata.to_yaml())
            if fsync:
                file.flush()
                os.fsync(file.fileno())
        mask = os.umask(0)
        os.umask(mask)
        partial.chmod(0o666 & ~mask)
        partial.replace(folder / FILE)
        if fsync:
            sync_folder(folder)
    except BaseException:
        if partial is not None:
            with contextlib.suppress(OSError):
                partial.unlink()
        raise


@dataclass(frozen=True)
class Listed:
    """What `metadata.yaml` says: the names of the files, and how many messages they hold."""

    files: tuple[str, ...]
    count: int


def read(folder: Path) -> Listed:
    """Read which files belong to a recording.

    Raises:
        InputError: there is no `metadata.yaml`, it isn't one of rosbag2, or names a storage other than plain MCAP.
    """
    path = folder / FILE
    content = _content(path)
    try:
        information = content[ROOT_KEY]
        storage, mode = information["storage_identifier"], information.get("compression_mode") or ""
        names = information["relative_file_paths"]
        count = int(information["message_count"])
        if not all(isinstance(text, str) for text in (storage, mode, *names)):
            raise TypeError
    except (LookupError, TypeError, ValueError, AttributeError, OverflowError):
        raise InputError(str(path), f"a rosbag2 metadata file ({ROOT_KEY})", "something else") from None
    if storage != STORAGE:
        got = f"{storage[:LONGEST_SHOWN]}: {CONVERT}"
        raise InputError(str(folder), "a recording with MCAP storage", got)
    if mode.lower() not in ("", "none"):
        got = f"compression mode {mode[:LONGEST_SHOWN].lower()}: {CONVERT}"
        raise InputError(str(folder), "MCAP files, compressed inside if at all", got)
    return Listed(tuple(_inside(name, path) for name in names), count)


def _content(path: Path) -> Any:
    """What a metadata file says, as plain data."""
    try:
        if path.exists() and not path.is_file():
            raise InputError(str(path), "a rosbag2 metadata file", "no file")
        if path.stat().st_size > LONGEST:
            raise InputError(str(path), "a rosbag2 metadata file", f"{path.stat().st_size} bytes")
        return plain(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(str(path), "a rosbag2 metadata file", error.strerror or str(error)) from None
    except ValueError:
        raise InputError(str(path), "a rosbag2 metadata file", "something that isn't YAML") from None


def _inside(name: str, path: Path) -> str:
    """Name of a file in the folder of its metadata; old versions put the name of the folder before it.

    Raises:
        InputError: it points out of the folder.
    """
    parts = PurePosixPath(name).parts
    if not parts or "\0" in name or PurePosixPath(name).is_absolute() or ".." in parts or len(parts) > 2:
        raise InputError(f"{path}: relative_file_paths", "names of files in this folder", repr(name[:LONGEST_SHOWN]))
    return parts[-1]
