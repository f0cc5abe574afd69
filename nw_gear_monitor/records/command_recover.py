"""`nw_gear recover`: repairs a recording whose recorder was killed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from nw_gear_monitor.records.recover import Recovery


def recover(
    folder: Annotated[Path, typer.Argument(help="Folder of the recording.", show_default=False)],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="New folder for the repaired recording (default: in place).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Repair a recording that was cut short; a damaged file is kept as *.mcap.damaged."""
    from nw_gear_monitor.records import recover as repair  # noqa: PLC0415 - the readers of recordings are heavy

    done = repair.recover(folder, output)
    if as_json:
        typer.echo(json.dumps(_as_object(done)))
        return
    if done.healthy:
        typer.echo(f"{folder}: nothing to repair")
    for file in done.files:
        kept = f"; the damaged file is {file.kept_as}" if file.kept_as else ""
        typer.echo(f"{file.file}: {file.reason}: {file.words()}{kept}")
    if done.metadata_rebuilt:
        typer.echo(f"{done.folder}: metadata.yaml written anew")


def _as_object(done: Recovery) -> dict[str, Any]:
    files = [
        {
            "file": file.file,
            "reason": file.reason,
            "messages": file.messages,
            "lost_bytes": file.lost_bytes,
            "lost_messages": file.lost_messages,
            "kept_as": file.kept_as or None,
        }
        for file in done.files
    ]
    recording = str(done.folder)
    return {"recording": recording, "healthy": done.healthy, "files": files, "metadata_rebuilt": done.metadata_rebuilt}
