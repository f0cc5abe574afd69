"""`nw_gear import`: somebody's measurements as a recording."""

from __future__ import annotations

import hashlib
import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from nw_gear_common.errors import InputError


class Angle(StrEnum):
    """Units of phase columns."""

    RAD = "rad"
    DEG = "deg"
    TURN = "turn"


def import_file(
    file: Annotated[Path, typer.Argument(help="CSV, NPY, WAV or MAT file with the samples.", show_default=False)],
    machine: Annotated[
        Path, typer.Option("--machine", help="YAML file that describes the machine.", show_default=False)
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="New folder for the recording.", show_default=False)],
    column: Annotated[
        list[str] | None,
        typer.Option("--column", help="NAME=COLUMN: where a column of the machine is called otherwise in the file."),
    ] = None,
    rate: Annotated[float | None, typer.Option(help="Samples per second, where the file has no times (Hz).")] = None,
    tacho: Annotated[str, typer.Option(help="Column with the tacho of the reference shaft; makes its phase.")] = "",
    pulses: Annotated[int, typer.Option(min=1, max=100000, help="Pulses of the tacho in a turn.")] = 1,
    angle: Annotated[Angle, typer.Option(help="Unit of the phase columns.")] = Angle.RAD,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Turn a file of measurements into a recording that replay_node plays and gear_monitor_node watches."""
    from nw_gear_monitor.datafiles.read import read  # noqa: PLC0415 - numpy, scipy and readers of recordings are heavy
    from nw_gear_monitor.foreign.recording import write  # noqa: PLC0415
    from nw_gear_monitor.foreign.waveform import Options, waveform  # noqa: PLC0415
    from nw_gear_monitor.machinefile.read import load  # noqa: PLC0415

    if output.exists():
        raise InputError(str(output), "a new folder", "one that exists")
    described = load(machine)
    options = Options(_renamed(column or []), rate, tacho, pulses, angle.value)
    made = waveform(read(file), described, options)
    about = {
        "machine": machine.read_text(encoding="utf-8"),
        "file": file.name,
        "sha256": hashlib.sha256(file.read_bytes()).hexdigest(),
    }
    blocks = write(output, made.table, made.rate, about)
    found = {
        "recording": str(output),
        "machine": described.name,
        "samples": len(made.table),
        "rate": made.rate,
        "duration": len(made.table) / made.rate,
        "blocks": blocks,
        "columns": list(made.table.columns),
        "left_out": made.left_out,
        "tacho_faults": [{"kind": f.kind, "time": f.time, "pulses": f.pulses} for f in made.faults],
    }
    if as_json:
        print(json.dumps(found))
        return
    print(f"{output}: {found['duration']:.6g} s of {described.name}, {made.rate:g} samples a second")
    if made.left_out:
        print(f"{made.left_out:.6g} s before the first and after the last pulse of the tacho left out")
    for fault in made.faults:
        print(f"tacho: {fault.pulses} {fault.kind} at {fault.time:.6g} s")


def _renamed(given: list[str]) -> dict[str, str]:
    """Options NAME=COLUMN as a mapping.

    Raises:
        InputError: no equal sign, an empty name, or a name given twice.
    """
    found: dict[str, str] = {}
    for text in given:
        name, sign, column = text.partition("=")
        if not (sign and name and column):
            raise InputError(f"--column {text}", "NAME=COLUMN", text)
        if name in found:
            raise InputError(f"--column {text}", "each column once", f"{name} twice")
        found[name] = column
    return found
