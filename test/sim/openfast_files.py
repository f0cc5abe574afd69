"""Writes OpenFAST's binary output, as its format is published (for tests of the reader)."""

import struct
from collections.abc import Sequence

import numpy as np

NAMES = ("Time", "Wind1VelX", "RotSpeed", "RotTorq")
UNITS = ("(s)", "(m/s)", "(rpm)", "(kN-m)")


def binary(
    identifier: int,
    times: np.ndarray,
    data: np.ndarray,
    names: Sequence[str] = NAMES,
    units: Sequence[str] = UNITS,
    width: int = 10,
) -> bytes:
    """Times (n,) in s and channels (n, k) as a file of the identifier; packed channels use the whole range of int16."""
    rows, channels = data.shape
    head = struct.pack("<h", identifier) + (struct.pack("<h", width) if identifier == 4 else b"")
    head += struct.pack("<ii", channels, rows)
    clock = b""
    if identifier == 1:
        scale = 2.0e9 / (times[-1] - times[0])
        offset = -1.0e9 - scale * times[0]
        head += struct.pack("<dd", scale, offset)
        clock = np.round(scale * times + offset).astype("<i4").tobytes()
    else:
        head += struct.pack("<dd", times[0], times[1] - times[0])
    if identifier == 3:
        body = data.astype("<f8").tobytes()
    else:
        spans = np.ptp(data, axis=0)
        scales = np.where(spans > 0.0, 65000.0 / np.where(spans > 0.0, spans, 1.0), 1.0).astype("<f4")
        offsets = (-32500.0 - scales * data.min(axis=0)).astype("<f4")
        head += scales.tobytes() + offsets.tobytes()
        stored = np.round(scales.astype(float) * data + offsets.astype(float))
        body = np.clip(stored, -32768, 32767).astype("<i2").tobytes()
    words = b"".join(text.ljust(width).encode("ascii") for text in (*names, *units))
    return head + struct.pack("<i", 7) + b"written" + words + clock + body
