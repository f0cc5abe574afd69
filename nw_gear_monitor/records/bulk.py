"""Reads a recording chunk by chunk, for whoever wants all of it fast: an hour of samples in seconds.

with Recording.open(folder) as recording, BulkReader(recording) as reader:
    for batch in reader.batches(["/nw_gear/waveform"]):
        for number in batch.of("/nw_gear/waveform"):
            table = batch.value(number)
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Table
from nw_gear_monitor.records.cdr import TABLE_TYPE, Layout, layout, to_table
from nw_gear_monitor.records.chunks import Batch, Bytes, ChunkReader, Place, Whole
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.records.stamped import TYPES, Form, Rows, rows

_NANO = 1e-9


class _Channel:
    """One channel of one file: its topic, and how its messages are read."""

    def __init__(self, topic: str, kind: str, decode: Callable[[], Callable[[bytes], Any]]) -> None:
        self.topic = topic
        self.kind = kind
        self._decoder = decode
        self._decode: Callable[[bytes], Any] | None = None
        self._layout: Layout | None = None
        self._head = b""
        self._form: Form | None = None

    def value(self, batch: Batch, number: int, copy: bool) -> Any:
        """A table, or an object with the fields of the type."""
        begin, end = int(batch.start[number]), int(batch.end[number])
        if self._layout is not None and batch.data[begin : begin + len(self._head)].tobytes() == self._head:
            numbers = begin + self._layout.begin
            if numbers + self._layout.size <= end:
                return _table(self._layout, batch.data[numbers : numbers + self._layout.size], copy)
        data = batch.data[begin:end].tobytes()
        if self.kind == TABLE_TYPE:
            with contextlib.suppress(InputError):
                self._layout = layout(data, self.topic)
                self._head = data[: self._layout.begin]
                return to_table(data, self.topic)
        if self._decode is None:
            self._decode = self._decoder()
        return self._decode(data)

    def rows(self, batch: Batch, numbers: Whole) -> Iterator[Rows]:
        """Numbers of stamped messages."""
        for form, found in rows(batch, numbers, self.kind, self.topic, self._form):
            self._form = form
            yield found


def _table(known: Layout, content: Bytes, copy: bool) -> Table:
    """A table whose head is the one before."""
    values = (content.copy() if copy else content).view(known.order + "f8").astype(np.float64, copy=False)
    return Table(known.row, known.columns, values.reshape(known.rows, len(known.columns)))


class BulkBatch:
    """Messages of one chunk.

    Attributes:
        place: where it stands in the recording, for `BulkReader.again`.
    """

    def __init__(self, place: Place, batch: Batch, channels: Mapping[int, _Channel]) -> None:
        self.place = place
        self._batch = batch
        self._channels = channels

    @property
    def last(self) -> float:
        """When its last message was recorded, s."""
        return _NANO * float(self._batch.log_time[-1])

    def of(self, *topics: str) -> Whole:
        """Numbers of the messages of some topics, in their order."""
        wanted = [number for number, channel in self._channels.items() if channel.topic in topics]
        if len(wanted) == 1:
            return np.flatnonzero(self._batch.channel == wanted[0])
        return np.flatnonzero(np.isin(self._batch.channel, wanted))

    def topic(self, number: int) -> str:
        """Topic of a message."""
        return self._channels[int(self._batch.channel[number])].topic

    def log_time(self, number: int) -> float:
        """When a message was recorded, s."""
        return _NANO * float(self._batch.log_time[number])

    def value(self, number: int, *, copy: bool = True) -> Any:
        """Content of a message: a `Table`, or an object with the fields of its type.

        Args:
            number: of the message.
            copy: without it a table may be a read-only view of the chunk, which isn't aligned.

        Raises:
            InputError: it doesn't fit its type.
        """
        return self._channels[int(self._batch.channel[number])].value(self._batch, number, copy)

    def rows(self, topic: str, numbers: Whole) -> Iterator[Rows]:
        """Numbers of messages of a topic whose type is one of `stamped.TYPES`.

        Raises:
            InputError: one doesn't fit its type.
        """
        held = self._batch.channel[numbers]
        for number in set(held.tolist()):
            channel = self._channels[number]
            yield from channel.rows(self._batch, numbers[held == number])


class BulkReader:
    """Chunks of an open recording, in their order; use it in a `with` block."""

    def __init__(self, recording: Recording) -> None:
        self._stack = contextlib.ExitStack()
        self._files = [self._stack.enter_context(ChunkReader(f, i)) for i, f in enumerate(recording.files)]
        self._channels = [_channels(recording, i) for i in range(len(recording.files))]

    def __enter__(self) -> BulkReader:
        return self

    def __exit__(self, *_ended: object) -> None:
        self._stack.close()

    def batches(self, topics: Collection[str]) -> Iterator[BulkBatch]:
        """Every chunk that holds some of the topics.

        Raises:
            InputError: a chunk is damaged.
        """
        for reader, channels in zip(self._files, self._channels, strict=True):
            wanted = {number for number, channel in channels.items() if channel.topic in topics}
            if wanted:
                for place, batch in reader.batches(wanted):
                    yield BulkBatch(place, batch, channels)

    def again(self, place: Place) -> BulkBatch:
        """One chunk again.

        Raises:
            InputError: it is damaged.
        """
        return BulkBatch(place, self._files[place.file].at(place), self._channels[place.file])


def stamped(kind: str) -> bool:
    """Whether messages of a type can be read by `BulkBatch.rows`."""
    return kind in TYPES


def _channels(recording: Recording, number: int) -> dict[int, _Channel]:
    file = recording.files[number]
    found = {}
    for key, channel in file.summary.channels.items():
        schema = file.summary.schemas.get(channel.schema_id)

        def decode(key: int = key) -> Callable[[bytes], Any]:
            return recording.decoder(file, key)

        found[key] = _Channel(channel.topic, schema.name if schema else "", decode)
    return found
