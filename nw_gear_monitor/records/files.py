"""Finds the MCAP files that make up a recording."""

from __future__ import annotations

from pathlib import Path

from nw_gear_common.errors import InputError
from nw_gear_monitor.records import metadata


def files_of(path: Path, lenient: bool = False) -> tuple[list[Path], str]:
    """The MCAP files of a recording in order, and what is wrong with the folder (empty where nothing is).

    Args:
        path: a folder, or one MCAP file.
        lenient: take the files that are there where metadata.yaml is missing or can't be read.

    Raises:
        InputError: there is no recording here.
    """
    if path.is_file():
        return [path], ""
    if not path.is_dir():
        raise InputError(str(path), "a recording (a folder or an MCAP file)", "nothing of that name")
    present = sorted((file for file in path.glob("*.mcap") if file.is_file()), key=_numbered)
    if not present and not (path / metadata.FILE).exists():
        raise InputError(str(path), "a recording with MCAP storage", _instead(path))
    try:
        listed = [path / name for name in metadata.read(path).files]
    except InputError as error:
        if lenient and present:
            return present, "metadata.yaml is missing" if error.place.endswith(metadata.FILE) else str(error)
        if present and not (path / metadata.FILE).exists():
            got = "none: the recording wasn't finished, see `nw_gear recover`"
            raise InputError(error.place, error.expected, got) from None
        raise
    missing = [file.name for file in listed if not file.is_file()]
    if missing:
        raise InputError(str(path), f"the files that {metadata.FILE} names", f"no {', '.join(missing)}")
    return listed, ""


def _instead(path: Path) -> str:
    """What a folder without MCAP files is, in words."""
    if any(path.glob("*.db3")):
        return f"an SQLite bag: {metadata.CONVERT}"
    if any(path.glob("*.mcap.zstd")):
        return f"files compressed as a whole: {metadata.CONVERT}"
    if any(path.glob("*.bag")):
        return f"a bag of ROS 1: {metadata.CONVERT_ROS1}"
    return "a folder without MCAP files"


def _numbered(path: Path) -> tuple[int, str]:
    """Files of a split recording end in a number: `_9` comes before `_10`."""
    number = path.stem.rpartition("_")[2]
    return (int(number) if number.isdecimal() else 0, path.name)
