"""Tables that are written while they grow: row groups of Parquet, or lines of CSV, with bounded memory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
from pyarrow import csv, parquet

from nw_gear_monitor.review.export.units import unit

GROUP = 32 << 20
"""Bytes of numbers that are collected before a row group is written."""

Column = np.ndarray[Any, Any] | Sequence[str]


class Sink:
    """One growing table.

    Args:
        path: without its suffix.
        kind: `parquet` or `csv`.
        about: texts about the table, kept in a Parquet file's metadata.
    """

    def __init__(self, path: Path, kind: str, about: Mapping[str, str]) -> None:
        self.rows = 0
        self.path = path.with_name(f"{path.name}.{kind}")
        self.columns: tuple[str, ...] = ()
        self._kind = kind
        self._about = about
        self._pending: list[pyarrow.RecordBatch] = []
        self._bytes = 0
        self._writer: Any = None
        self._schema: pyarrow.Schema | None = None

    def add(self, columns: Mapping[str, Column]) -> None:
        """Append rows: name -> values, the same names every time."""
        arrays = [pyarrow.array(values) for values in columns.values()]
        if self._schema is None:
            self.columns = tuple(columns)
            self._schema = self._described(arrays)
        batch = pyarrow.RecordBatch.from_arrays(arrays, schema=self._schema)
        self.rows += batch.num_rows
        self._pending.append(batch)
        self._bytes += batch.nbytes
        if self._bytes >= GROUP:
            self._flush()

    def _described(self, arrays: Sequence[pyarrow.Array]) -> pyarrow.Schema:
        """Parquet: names as in the recording, the unit in the field's metadata. CSV: `name (unit)`."""
        table = self.path.stem
        fields = []
        for name, array in zip(self.columns, arrays, strict=True):
            its = unit(table, name)
            shown = f"{name} ({its})" if its and self._kind == "csv" else name
            fields.append(pyarrow.field(shown, array.type, metadata={"unit": its} if its else None))
        return pyarrow.schema(fields, metadata=dict(self._about))

    def _flush(self) -> None:
        if not self._pending:
            return
        table = pyarrow.Table.from_batches(self._pending)
        self._pending, self._bytes = [], 0
        if self._writer is None:
            self._writer = self._opened(table.schema)
        if self._kind == "parquet":
            self._writer.write_table(table, row_group_size=table.num_rows)
        else:
            self._writer.write_table(table)

    def _opened(self, schema: pyarrow.Schema) -> Any:
        if self._kind == "csv":
            return csv.CSVWriter(self.path, schema)
        numbers = [f.name for f in schema if f.type == pyarrow.float64()]
        texts = [f.name for f in schema if f.type == pyarrow.string()]
        return parquet.ParquetWriter(
            self.path,
            schema,
            compression="zstd",
            compression_level=1,
            use_dictionary=texts,
            use_byte_stream_split=numbers,
            write_statistics=True,
        )

    def close(self) -> None:
        """Write what is left and finish the file."""
        self._flush()
        if self._writer is not None:
            self._writer.close()
            self._writer = None


class Sinks:
    """The tables of one export, each in its file.

    A table whose columns change (another set of indicators after a restart) goes on in a file of its own, `name_2`.
    """

    def __init__(self, folder: Path, kind: str, about: Mapping[str, str]) -> None:
        self._folder = folder
        self._kind = kind
        self._about = about
        self._sinks: dict[tuple[str, tuple[str, ...]], Sink] = {}

    def add(self, table: str, columns: Mapping[str, Column]) -> None:
        """Append rows to a table, which begins with the first ones."""
        key = (table, tuple(columns))
        if key not in self._sinks:
            number = 1 + sum(name == table for name, _columns in self._sinks)
            name = table if number == 1 else f"{table}_{number}"
            self._sinks[key] = Sink(self._folder / name, self._kind, {**self._about, "table": table})
        self._sinks[key].add(columns)

    def close(self) -> dict[str, int]:
        """Finish all files; name -> rows."""
        for sink in self._sinks.values():
            sink.close()
        return {sink.path.name: sink.rows for sink in self._sinks.values()}
