"""MAT files of MATLAB, version 5 to 7: real arrays, also within structures."""

from __future__ import annotations

from pathlib import Path

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.datafiles.matelements import Elements, variables
from nw_gear_monitor.datafiles.source import Source, content, numbered, with_times

KIND = "a MAT file (version 5 to 7)"
HEADER = 128
HDF5 = b"\x89HDF\r\n\x1a\n"
ORDERS = {b"IM": "<", b"MI": ">"}
RATES = ("fs", "sr", "sample_rate", "samplerate")
"""Names, in small letters, of a number that is the sample rate, Hz."""


def read(path: Path) -> Source:
    """Read all real vectors and matrices (channels name_1, name_2, ..) of a MAT file.

    Raises:
        InputError: another kind of file, version 7.3 or 4, a damaged one, two sample rates that differ, no numbers.
    """
    data = content(path, KIND)
    place = str(path)
    if data.startswith((b"MATLAB 7.3", HDF5)) or data[512:520] == HDF5:
        got = "version 7.3, which is HDF5: save it with save(.., '-v7')"
        raise InputError(place, KIND, got)
    order = ORDERS.get(data[126:128])
    if order is None:
        raise InputError(place, KIND, "another kind of file, or version 4")
    columns: dict[str, Array] = {}
    left_out: dict[str, str] = {}
    rates: dict[str, float] = {}
    for variable in variables(Elements(place, memoryview(data)[HEADER:], order)):
        name, numbers = variable.name, variable.numbers
        if numbers is None or numbers.ndim > 2 or numbers.size < 2:
            if numbers is not None and numbers.size == 1 and name.lower().rpartition(".")[2] in RATES:
                rates[name] = float(numbers.reshape(-1)[0])
            left_out[name] = variable.reason or ("a single number" if numbers is not None else "nothing")
        elif 1 in numbers.shape:
            columns[name] = numbers.reshape(-1)
        else:
            columns |= numbered(place, numbers, f"{name}_")
    if not columns:
        raise InputError(place, "a vector or matrix of real numbers", ", ".join(sorted(left_out))[:80] or "nothing")
    return Source(place, columns, _rate(place, rates), time=with_times(columns), left_out=left_out)


def _rate(place: str, rates: dict[str, float]) -> float | None:
    if len(set(rates.values())) > 1:
        raise InputError(place, "one sample rate", ", ".join(f"{name} = {rate:g}" for name, rate in rates.items())[:80])
    return next(iter(rates.values()), None)
