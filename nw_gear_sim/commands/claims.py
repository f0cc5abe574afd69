"""`nw_gear study claims`: which of the paper's statements hold."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from nw_gear_common.errors import InputError
from nw_gear_sim.commands.point import JsonOption

SECTIONS = ("5",)


def claims(
    section: Annotated[str, typer.Option("--section", help="Section of the paper: 5.")] = "5",
    as_json: JsonOption = False,
) -> None:
    """Test every statement of the paper's Sec. 5.2 on its figures, in both modes of the superharmonic study."""
    from nw_gear_sim.superharmonic.claims import held, judge  # noqa: PLC0415 - scipy only where it is needed
    from nw_gear_sim.superharmonic.firstorder import MODES  # noqa: PLC0415

    if section not in SECTIONS:
        raise InputError("--section", " or ".join(SECTIONS), section)
    outcomes = {mode: judge(mode) for mode in MODES}
    if as_json:
        shown: dict[str, Any] = {
            mode: {
                "held": held(found),
                "total": len(found),
                "rows": [{"id": o.claim.id, "holds": o.holds, "value": o.value, "claim": o.claim.text} for o in found],
            }
            for mode, found in outcomes.items()
        }
        print(json.dumps(shown))
        return
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415 - rich only where it is needed

    words = {True: "holds", False: "fails"}
    rows = [
        [a.claim.id, words.get(a.holds, str(a.holds)), words.get(b.holds, str(b.holds)), a.claim.text, a.value]
        for a, b in zip(*outcomes.values(), strict=True)
    ]
    show("Statements of the paper's Sec. 5.2", ["id", *MODES, "meaning", "what"], rows)
    for mode, found in outcomes.items():
        print(f"{mode}: {held(found)} of {len(found)} hold")
