"""Chunks of MCAP files, decompressed with what they claim held against limits before any memory is asked for."""

from __future__ import annotations

import zlib

import lz4.frame
import zstandard

LARGEST = 256 * 1024 * 1024
"""Bytes of a chunk, decompressed, above which it is refused; writers make chunks of some megabytes at most, unless a
single message is larger."""


def decompress(compression: str, packed: bytes | memoryview, size: int, crc: int = 0) -> bytes | memoryview:
    """Content of a chunk.

    Args:
        compression: as MCAP names it: zstd, lz4 or nothing.
        packed: bytes as they stand in the file.
        size: bytes that the chunk claims to have.
        crc: checksum of the content, 0 = none.

    Raises:
        ValueError, RuntimeError, zstandard.ZstdError: unknown compression, a size that is beyond reason or wrong, or a
            wrong checksum.
    """
    if size > LARGEST:
        raise ValueError(f"a chunk claims to have {size} bytes, {LARGEST} are the limit")
    content = _content(compression, packed, size)
    if len(content) != size or (crc and zlib.crc32(content) != crc):
        raise ValueError("the content of a chunk doesn't fit its checksum")
    return content


def _content(compression: str, packed: bytes | memoryview, size: int) -> bytes | memoryview:
    if compression == "zstd":
        claimed = zstandard.get_frame_parameters(packed).content_size
        if claimed not in (size, zstandard.CONTENTSIZE_UNKNOWN):
            raise ValueError("a chunk isn't as large as it says")
        return zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
    if compression == "lz4":
        content: bytes = lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size + 1)
        return content
    if compression:
        raise ValueError(f"compression {compression}")
    return packed
