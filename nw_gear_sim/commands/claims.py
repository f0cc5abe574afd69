"""`nw_gear study claims`: which of the paper's statements hold."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nw_gear_common.errors import InputError
from nw_gear_sim.commands.claims_section4 import WORDS, Choices, section_4, show_section_4
from nw_gear_sim.commands.point import ConfigOption, JsonOption

if TYPE_CHECKING:
    from nw_gear_sim.superharmonic.claims import Outcome

SECTIONS = ("4", "5", "all")


def claims(
    section: Annotated[str, typer.Option("--section", help="Section of the paper: 4, 5 or all.")] = "5",
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder of Sec. 4's search; an interrupted one goes on there.")
    ] = Path("claims-section-4"),
    config: ConfigOption = "",
    draws: Annotated[int, typer.Option("--draws", help="Parameter sets that the search draws evenly.")] = 48,
    around: Annotated[int, typer.Option("--around", help="Draws around each of the four best; 0: none.")] = 4,
    seed: Annotated[int, typer.Option("--seed", help="Of the draws.")] = 0,
    markdown: Annotated[
        Path | None, typer.Option("--markdown", help="Write all statements into a page as well (--section all).")
    ] = None,
    workers: Annotated[int | None, typer.Option("--workers", help="Processes for Sec. 4 (default: cores).")] = None,
    dask: Annotated[str, typer.Option("--dask", help="Scheduler of an existing Dask cluster.")] = "",
    as_json: JsonOption = False,
) -> None:
    """Test every statement of the paper's Sec. 4 (the whole gearbox) and 5.2 (superharmonic resonance, both modes)."""
    if section not in SECTIONS:
        raise InputError("--section", " or ".join(SECTIONS), section)
    if markdown and section != "all":
        raise InputError("--markdown", "--section all", f"--section {section}")
    outcomes = {} if section == "4" else _section_5()
    shown: dict[str, Any] = {mode: _as_object(found) for mode, found in outcomes.items()}
    if section != "5":
        shown["section_4"] = section_4(Choices(output, config, draws, around, seed, workers, dask))
    if markdown:
        _write(markdown, shown)
    if as_json:
        print(json.dumps(shown))
        return
    if section != "5":
        show_section_4(shown["section_4"])
    if section != "4":
        _show_section_5(outcomes)


def _section_5() -> dict[str, tuple[Outcome, ...]]:
    from nw_gear_sim.superharmonic.claims import judge  # noqa: PLC0415 - scipy only where it is needed
    from nw_gear_sim.superharmonic.firstorder import MODES  # noqa: PLC0415

    return {mode: judge(mode) for mode in MODES}


def _as_object(found: tuple[Outcome, ...]) -> dict[str, Any]:
    from nw_gear_sim.superharmonic.claims import held  # noqa: PLC0415 - see _section_5

    rows = [{"id": o.claim.id, "holds": o.holds, "value": o.value, "claim": o.claim.text} for o in found]
    return {"held": held(found), "total": len(found), "rows": rows}


def _show_section_5(outcomes: dict[str, tuple[Outcome, ...]]) -> None:
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415 - rich only where it is needed
    from nw_gear_sim.superharmonic.claims import held  # noqa: PLC0415

    rows = [
        [a.claim.id, WORDS.get(a.holds, str(a.holds)), WORDS.get(b.holds, str(b.holds)), a.claim.text, a.value]
        for a, b in zip(*outcomes.values(), strict=True)
    ]
    show("Statements of the paper's Sec. 5.2", ["id", *outcomes, "meaning", "what"], rows)
    for mode, found in outcomes.items():
        print(f"{mode}: {held(found)} of {len(found)} hold")


def _write(path: Path, shown: dict[str, Any]) -> None:
    from nw_gear_sim.drawings.claims_page import page  # noqa: PLC0415 - see _section_5

    try:
        path.write_text(page(shown), encoding="utf-8")
    except OSError as error:
        raise InputError(f"--markdown {path}", "a file that can be written", error.strerror or str(error)) from None
