"""Tidy tables for other programs: one row per observation, one column per variable, as Parquet or CSV."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from nw_gear_common.errors import InputError

if TYPE_CHECKING:
    import pyarrow

FORMATS = ("parquet", "csv")


def write(path: Path, columns: Mapping[str, Sequence[Any] | np.ndarray[Any, Any]], about: Mapping[str, str]) -> None:
    """Write a table; the path's suffix says how.

    Args:
        path: `.parquet` or `.csv`; a file that is there is replaced once the new one is whole.
        columns: name with its unit -> values, all of one length; None is a missing value.
        about: what the table is, kept in a Parquet file's metadata.

    Raises:
        InputError: it can't be written there, or the suffix is another.
    """
    import pyarrow  # noqa: PLC0415 - heavy, and only needed here

    kind = path.suffix.removeprefix(".")
    if kind not in FORMATS:
        raise InputError(str(path), " or ".join(f".{f}" for f in FORMATS), path.suffix or "no suffix")
    table = pyarrow.table({name: _values(values) for name, values in columns.items()})
    beside = path.with_suffix(path.suffix + ".unfinished")
    try:
        _write(table.replace_schema_metadata(dict(about)), beside, kind)
        beside.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            beside.unlink()
        raise InputError(str(path), "room for the results", error.strerror or str(error)) from None


def _values(values: Sequence[Any] | np.ndarray[Any, Any]) -> Any:
    return np.ascontiguousarray(values) if isinstance(values, np.ndarray) else list(values)


def _write(table: pyarrow.Table, path: Path, kind: str) -> None:
    if kind == "parquet":
        from pyarrow import parquet  # noqa: PLC0415 - as above

        parquet.write_table(table, path, compression="zstd")
    else:
        from pyarrow import csv  # noqa: PLC0415 - as above

        csv.write_csv(table, path)
