"""A file that refuses to read more than it has, whatever a length inside it claims."""

from __future__ import annotations

import os
from typing import BinaryIO

LARGEST_RECORD = 512 * 1024 * 1024
"""Bytes of one record above which it isn't read."""


class Bounded:
    """What the readers of MCAP need of a stream.

    Args:
        stream: an open file.
    """

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._size = os.fstat(stream.fileno()).st_size
        self._at = stream.tell()

    def read(self, length: int = -1) -> bytes:
        """Read so many bytes (-1 = the rest).

        Raises:
            ValueError: there aren't so many, or they are too many.
        """
        left = self._size - self._at
        wanted = left if length < 0 else length
        if wanted > left:
            raise ValueError("a record is longer than the file")
        if wanted > LARGEST_RECORD:
            raise ValueError(f"a record of {wanted} bytes")
        data = self._stream.read(wanted)
        self._at += len(data)
        return data

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a place."""
        self._at = self._stream.seek(offset, whence)
        return self._at

    def tell(self) -> int:
        """The place where it is."""
        return self._at

    def seekable(self) -> bool:
        """Whether it can go to any place."""
        return True
