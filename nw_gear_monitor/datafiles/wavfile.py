"""Sound files (.wav): PCM of 8, 16, 24 and 32 bits, floating point of 32 and 64, any number of channels.

Whole numbers are divided by their full scale, so that values lie from -1 to 1. Chunks and formats: Multimedia
Programming Interface and Data Specifications 1.0, IBM and Microsoft 1991, and Microsoft's extensible format.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.datafiles.source import Source, content

KIND = "a WAV file (RIFF, WAVE)"
PCM, FLOAT, EXTENSIBLE = 0x0001, 0x0003, 0xFFFE
BITS = {PCM: (8, 16, 24, 32), FLOAT: (32, 64)}
GUID_REST = bytes.fromhex("000000001000800000aa00389b71")


@dataclass(frozen=True)
class Format:
    """The chunk `fmt `: code of the encoding, channels, samples per second, bytes a frame, bits a sample."""

    code: int
    channels: int
    rate: int
    frame: int
    bits: int


def read(path: Path) -> Source:
    """Read a WAV file; its channels are ch1, ch2, ..

    Raises:
        InputError: not such a file, a compressed or unknown encoding, a chunk that ends after the file.
    """
    place = str(path)
    data = content(path, KIND)
    if data[:4] != b"RIFF" or data[8:12] != b"WAVE":
        raise InputError(place, KIND, "another kind of file")
    chunks = _chunks(place, data)
    for name in (b"fmt ", b"data"):
        if name not in chunks:
            raise InputError(place, f"a chunk '{name.decode()}'", "none")
    form = _format(place, chunks[b"fmt "])
    samples = chunks[b"data"]
    if len(samples) % form.frame:
        raise InputError(place, f"whole frames of {form.frame} bytes", f"{len(samples)} bytes of data")
    if not len(samples):
        raise InputError(place, "samples", "none")
    values = _decoded(samples, form).reshape(-1, form.channels)
    return Source(place, {f"ch{k + 1}": values[:, k] for k in range(form.channels)}, float(form.rate))


def _chunks(place: str, data: bytes) -> dict[bytes, memoryview]:
    """Contents of the chunks by name; the first of each name counts."""
    view, found, at = memoryview(data), dict[bytes, memoryview](), 12
    while at + 8 <= len(data):
        name, size = struct.unpack_from("<4sI", data, at)
        if at + 8 + size > len(data):
            title = name.decode("ascii", "replace").strip()
            raise InputError(place, f"{size} bytes in chunk '{title}'", f"{len(data) - at - 8}: the file is cut short")
        found.setdefault(name, view[at + 8 : at + 8 + size])
        at += 8 + size + size % 2
    return found


def _format(place: str, chunk: memoryview) -> Format:
    if len(chunk) < 16:
        raise InputError(place, "16 bytes or more in chunk 'fmt'", str(len(chunk)))
    code, channels, rate, _bytes, frame, bits = struct.unpack_from("<HHIIHH", chunk)
    if code == EXTENSIBLE and len(chunk) >= 40 and bytes(chunk[26:40]) == GUID_REST:
        code = struct.unpack_from("<H", chunk, 24)[0]
    if bits not in BITS.get(code, ()):
        raise InputError(place, "PCM of 8 to 32 bits or floating point", f"encoding {code:#06x} of {bits} bits")
    if channels == 0 or rate == 0 or frame != channels * bits // 8:
        expected = f"a rate and {max(channels, 1) * bits // 8} bytes for each frame of {max(channels, 1)} channels"
        raise InputError(place, expected, f"{rate} Hz, {frame} bytes, {channels} channels")
    return Format(code, channels, rate, frame, bits)


def _decoded(samples: memoryview, form: Format) -> Array:
    if form.code == FLOAT:
        return np.frombuffer(samples, f"<f{form.bits // 8}").astype(np.float64)
    if form.bits == 8:
        return (np.frombuffer(samples, np.uint8).astype(np.float64) - 128.0) / 128.0
    if form.bits == 24:
        raw = np.frombuffer(samples, np.uint8).reshape(-1, 3)
        padded = np.zeros((len(raw), 4), dtype=np.uint8)
        padded[:, 1:] = raw  # the sign comes along at the top
        return padded.reshape(-1).view("<i4") / 2.0**31
    return np.frombuffer(samples, f"<i{form.bits // 8}") / 2.0 ** (form.bits - 1)
