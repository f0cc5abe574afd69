"""Results of a study on disk: one file per finished piece of work, so that nothing is computed twice or lost.

A study's folder holds `study.json`, which says what is computed, and `pieces/<key>.npz` with the arrays of each piece.
Files appear under their names only when they are complete (written beside, flushed to disk, renamed), hence a crash at
any moment leaves finished pieces and nothing else. One process writes; others may read.
"""

from __future__ import annotations

import json
import os
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

IDENTITY = "study.json"
PIECES = "pieces"
UNFINISHED = ".unfinished"
DAMAGED = ".damaged"
VERSION = 1


class Store:
    """The folder of one study.

    Args:
        folder: made where it isn't there.
        identity: what is computed: anything that JSON can hold. Another study is refused.

    Attributes:
        damaged: keys of pieces that can't be read; their files were put aside and they count as not computed.

    Raises:
        InputError: the folder can't be made or written to, or belongs to another study.
    """

    def __init__(self, folder: Path, identity: Mapping[str, Any]) -> None:
        self.folder = folder
        self.damaged: list[str] = []
        wanted = json.loads(json.dumps({"version": VERSION, **identity}))
        try:
            (folder / PIECES).mkdir(parents=True, exist_ok=True)
            found = self._identity()
            if found is None:
                _replace(folder / IDENTITY, json.dumps(wanted, indent=1).encode())
        except OSError as error:
            raise InputError(f"-o {folder}", "a folder that can be written to", error.strerror or str(error)) from None
        if found is not None and found != wanted:
            raise InputError(f"-o {folder}", "a new folder, or one of the same study", _difference(found, wanted))

    def done(self) -> set[str]:
        """Return the keys of all finished pieces that can be read; damaged ones are put aside."""
        keys = set()
        for path in sorted((self.folder / PIECES).glob("*.npz")):
            if _readable(path):
                keys.add(path.stem)
            else:
                path.rename(path.with_suffix(path.suffix + DAMAGED))
                self.damaged.append(path.stem)
        return keys

    def put(self, key: str, arrays: Mapping[str, Array]) -> None:
        """Keep a finished piece.

        Raises:
            InputError: the disk is full or read-only; what was kept before stays.
        """
        path = self._path(key)
        beside = path.with_suffix(UNFINISHED)
        try:
            with beside.open("wb") as file:
                np.savez_compressed(file, allow_pickle=False, **arrays)
                file.flush()
                os.fsync(file.fileno())
            beside.replace(path)
        except OSError as error:
            beside.unlink(missing_ok=True)
            raise InputError(f"-o {self.folder}", "room for the results", error.strerror or str(error)) from None

    def get(self, key: str) -> dict[str, Array]:
        """Return the arrays of a finished piece.

        Raises:
            InputError: there is none of this key, or it can't be read.
        """
        path = self._path(key)
        try:
            with np.load(path, allow_pickle=False) as archive:
                return {name: archive[name] for name in archive.files}
        except (OSError, ValueError, zipfile.BadZipFile) as error:
            raise InputError(str(path), "a finished piece", str(error)) from None

    def _path(self, key: str) -> Path:
        if not re.fullmatch(r"[A-Za-z0-9_.+-]+", key):
            raise InputError("key of a piece", "letters, digits and _ . + -", repr(key))
        return self.folder / PIECES / f"{key}.npz"

    def _identity(self) -> Any:
        path = self.folder / IDENTITY
        if not path.exists():
            if any((self.folder / PIECES).iterdir()):
                raise InputError(f"-o {self.folder}", f"a new folder, or one with {IDENTITY}", "pieces without it")
            return None
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise InputError(str(path), "a study's description", str(error)) from None


def _readable(path: Path) -> bool:
    try:
        with zipfile.ZipFile(path) as archive:
            return archive.testzip() is None
    except (OSError, zipfile.BadZipFile):
        return False


def _replace(path: Path, content: bytes) -> None:
    beside = path.with_suffix(UNFINISHED)
    with beside.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    beside.replace(path)


def _difference(found: Any, wanted: Any, place: str = "") -> str:
    """Return in words where two descriptions differ first."""
    if isinstance(found, dict) and isinstance(wanted, dict):
        for key in [*wanted, *found]:
            if found.get(key) != wanted.get(key):
                return _difference(found.get(key), wanted.get(key), f"{place}.{key}" if place else str(key))
    return f"one of another study: {place} is {_short(found)} there, {_short(wanted)} here"


def _short(value: Any) -> str:
    text = "nothing" if value is None else json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "..."
