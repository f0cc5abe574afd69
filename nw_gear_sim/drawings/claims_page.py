"""The page of all statements, as Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from nw_gear_sim.drawings.claims_search import search_part
from nw_gear_sim.drawings.claims_table import table
from nw_gear_sim.superharmonic.claims import CONTRADICTIONS
from nw_gear_sim.superharmonic.earlier import REASONS, read_differences

WORDS = {True: "holds", False: "fails"}
HEAD = """# What holds of the paper's statements

Every statement of the paper's Sec. 4 (Figs 13-21, the whole gearbox) and Sec. 5.2 (Figs 22-30, superharmonic
resonance) that can be checked, with what was found. `contradicts`: the paper contradicts it elsewhere; it isn't
counted as held. This page is written by

    nw_gear study claims --section all --draws {draws} --around {around} --seed {seed} -o FOLDER --markdown FILE
"""
SECTION_4 = """## Section 4: the whole gearbox

The paper doesn't give the torque, nor mesh stiffness, transmission errors, damping, clearances (its Table 3 isn't in
print). So the statements are judged on the best of {draws} even draws from these unknowns (next section), chosen by
{labels} labels of Figs 13-15 and 19-21; the motions of this project's own configuration, at rated torque, stand
beside it. All meshes run at one frequency, omega_e in units of omega_n of stage II (`tied`), as the paper's figures
imply; the last column has what every stage shows at its own mesh frequency (`kinematic`). A section of few dots
counts as periodic (scatter under 5 % of the signal's standard deviation) even where the exponent of the gearbox, of
which there is one for all stages, is above 0. An interval holds when every frequency computed in it agrees.
`unknown`: the exponent is above 0 by less than three standard errors; `period-1` is also what no period up to 16
explains and isn't chaotic.
"""
SECTION_5 = """## Section 5.2: superharmonic resonance

Statements about a family (figures `a`) are tested at nu = w0/3, those about a curve over a parameter (figures `b`)
along 2401 values; see [superharmonic resonance](superharmonic.md). `corrected` is the consistent derivation,
`paper_eq75` has the printed sign of the velocity gain and the printed stability condition. What was found is given
for `corrected`, and for `paper_eq75` where it differs.
"""
EARLIER = """## Differences from an earlier count of Section 5.2

An earlier count with a calibration of its own for `paper_eq75` and looser rules held 111 and 106 of the 131
statements. These rows came out otherwise:
"""


def page(shown: Mapping[str, Any]) -> str:
    """Return the page of what `nw_gear study claims --section all --json` prints."""
    four = shown["section_4"]
    search = four["search"]
    places = {name: search[name] for name in ("draws", "around", "seed")}
    parts = [HEAD.format(**places), _summary(shown), SECTION_4.format(labels=len(search["labels"]), **places)]
    parts += [_statements_4(four["rows"]), search_part(four), *section_5(shown)]
    return "\n".join(part.rstrip() + "\n" for part in parts)


def section_5(shown: Mapping[str, Any]) -> list[str]:
    """Return the parts about Sec. 5.2."""
    return [SECTION_5, _statements_5(shown), EARLIER, _differences(shown)]


def _summary(shown: Mapping[str, Any]) -> str:
    four = shown["section_4"]
    contradicting = sum(row["holds"] == "contradicts" for row in four["rows"])
    rows = [
        ["4, best of the even draws", four["held"], four["total"], contradicting],
    ]
    for mode in ("corrected", "paper_eq75"):
        found = shown[mode]
        rows.append([f"5.2, `{mode}`", found["held"], found["total"],
                     sum(row["holds"] == "contradicts" for row in found["rows"])])  # fmt: skip
    return table(["section", "hold", "of", "contradict others"], rows)


def _statements_4(rows: Sequence[Mapping[str, Any]]) -> str:
    lines = []
    for row in rows:
        claim = f"{row['stage']}: {row['claim']}" if row["stage"] else row["claim"]
        base = row["base"]["value"] if row["base"] else ""
        lines.append([row["id"], row["figure"], claim, f"**{_outcome(row)}**", row["value"], base, row["kinematic"]])
    heads = ["id", "Fig.", "statement", "outcome", "best draw", "base configuration", "kinematic"]
    return table(heads, lines)


def _outcome(row: Mapping[str, Any]) -> str:
    return WORDS.get(row["holds"], str(row["holds"]))


def _statements_5(shown: Mapping[str, Any]) -> str:
    lines = []
    for a, b in zip(shown["corrected"]["rows"], shown["paper_eq75"]["rows"], strict=True):
        value = a["value"] if a["value"] == b["value"] else f"{a['value']} (paper_eq75: {b['value']})"
        lines.append([a["id"], a["claim"], _outcome(a), _outcome(b), value])
    return table(["id", "statement", "corrected", "paper_eq75", "found"], lines)


def _differences(shown: Mapping[str, Any]) -> str:
    lines = []
    for difference in read_differences():
        row = next(row for row in shown[difference.mode]["rows"] if row["id"] == difference.id)
        earlier = WORDS[difference.earlier]
        lines.append([row["id"], difference.mode, earlier, _outcome(row), row["value"], REASONS[difference.reason]])
    others = "; ".join(f"{id} with {' with '.join(those)}" for id, those in CONTRADICTIONS.items())
    return f"{table(['id', 'mode', 'earlier', 'here', 'found here', 'reason'], lines)}\nContradicting rows: {others}."
