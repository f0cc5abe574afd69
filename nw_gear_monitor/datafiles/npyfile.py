"""NumPy's own files (.npy): one array, plain or with named fields; never pickled objects."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.datafiles.source import Source, content, numbered, printable, with_times

KIND = "a NumPy file (.npy)"
VERSIONS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read(path: Path) -> Source:
    """Read an array: (samples,), (samples, channels), or (samples,) of a structured type with a field per channel.

    Raises:
        InputError: not such a file, objects, complex numbers, another shape, more or fewer bytes than the header says.
    """
    data = content(path, KIND)
    place = str(path)
    shape, fortran, kind, offset = _header(place, data)
    if kind.hasobject:
        raise InputError(place, "an array of numbers", "pickled objects, which could run anything")
    fields = _fields(place, kind)
    count = math.prod(shape)
    if count * kind.itemsize != len(data) - offset:
        raise InputError(
            place, f"{count * kind.itemsize} bytes of data for shape {shape}", f"{len(data) - offset} bytes"
        )
    if len(shape) not in ((1,) if fields else (1, 2)):
        raise InputError(place, "an array of one or two dimensions" if not fields else "rows of fields", f"{shape}")
    array = np.frombuffer(data, kind, count, offset).reshape(shape, order="F" if fortran else "C")
    if fields:
        columns = {name: _plain(array[name]) for name in fields}
        return Source(place, columns, time=with_times(columns))
    return Source(place, numbered(place, _plain(array)))


def _plain(array: np.ndarray[Any, Any]) -> Array:
    return np.ascontiguousarray(array, dtype=np.float64)


def _fields(place: str, kind: np.dtype[Any]) -> tuple[str, ...]:
    """Names of the fields of a structured type; none for a plain one."""
    names = kind.names or ()
    for name, part in [(name, kind[name]) for name in names] or [("", kind)]:
        if part.kind not in "iuf" or part.shape:
            raise InputError(f"{place}{': ' if name else ''}{printable(name)}", "real numbers", f"type {part}"[:80])
    return names


def _header(place: str, data: bytes) -> tuple[tuple[int, ...], bool, np.dtype[Any], int]:
    file = io.BytesIO(data)
    try:
        version = npy.read_magic(file)
        if version not in VERSIONS:
            raise InputError(place, "a NumPy file of version 1.0 or 2.0", f"version {version[0]}.{version[1]}")
        shape, fortran, kind = VERSIONS[version](file)
    except InputError:
        raise
    except Exception as error:  # the header is a Python literal: whatever its parsers say, it isn't one
        raise InputError(place, KIND, printable(str(error).partition("\n")[0]) or type(error).__name__) from None
    if any(not isinstance(side, int) or side < 0 for side in shape):
        raise InputError(place, "sides of zero or more", printable(str(shape)))
    return shape, fortran, kind, file.tell()
