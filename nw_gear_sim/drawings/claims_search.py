"""The search behind Sec. 4's statements, as Markdown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from nw_gear_sim.drawings.claims_table import table

SEARCH = """## The search for Section 4's parameters

{draws} scrambled Sobol points (seed {seed}) fill the ranges of {unknowns} unknowns evenly. Each is run at 13 values
of omega_e: {transient} mesh periods of stage II left out, {record} recorded, exponent by twin trajectories. The score
is the share of {labels} labels that hold: 9 motions of Figs 13-15, and 30 of Figs 19-21 (three stages at ten
frequencies). Labels of a contradicting pair are among them, so that 1 can't be reached. Nothing but the labels chose
the best draw, and no range was changed afterwards.
"""
CHANCE = """The chance row shuffles the labels over the {labels} places {shuffles} times and takes the best of
the {draws} draws each time: 95 % of these best scores are at most {upper:.3f}. A score like that of
the best even draw, or a better one, comes out of a share of {probability:.3g} of the
shuffles.{verdict}
"""
WEAK = " So the best draw isn't told from chance."
FITTED = """Draws around the {parents} best even ones (normal, 10 % of each range) are fitted to the labels:
their score is no test.
"""


def search_part(four: Mapping[str, Any]) -> str:
    """Return what was searched, how the best draw scored, and what guesses and chance score."""
    search, plan = four["search"], four["plan"]
    intro = SEARCH.format(
        draws=search["draws"], seed=search["seed"], unknowns=len(search["unknowns"]), labels=len(search["labels"]),
        transient=plan["transient"], record=plan["record"],
    )  # fmt: skip
    chance = search["chance"]
    told = CHANCE.format(
        labels=len(search["labels"]), draws=search["draws"], verdict=WEAK if chance["probability"] > 0.05 else "",
        **{name: chance[name] for name in ("shuffles", "upper", "probability")},
    )  # fmt: skip
    parts = [intro, _scores(four), told]
    if search["near"]["count"]:
        parts.append(FITTED.format(parents=search["near"]["count"] // search["around"]))
    return "\n".join([*parts, _distribution(search), _parameters(search), _labels(search)])


def _scores(four: Mapping[str, Any]) -> str:
    search = four["search"]
    rows: list[list[object]] = [
        [
            f"best of the {search['draws']} even draws (`{search['best']['draw']}`)",
            f"**{search['best']['score']:.3f}**",
        ],
        ["the same, by the exponent alone", f"{search['best']['score_by_exponent']:.3f}"],
        ["base configuration", f"{four['base']['score']:.3f}"],
    ]
    near = search["near"]
    if near["count"]:
        rows.append([f"best of {near['count']} draws around the best (fitted)", f"{near['score']:.3f}"])
    rows += [[f"guess: {name}", f"{score:.3f}"] for name, score in search["guesses"].items()]
    rows.append([f"chance: best of {search['draws']} draws, mean", f"{search['chance']['mean']:.3f}"])
    return table(["what", "score"], rows)


def _distribution(search: Mapping[str, Any]) -> str:
    low, middle, high = search["quartiles"]
    counts = Counter(search["scores"])
    rows = [[f"{score:.3f}", count] for score, count in sorted(counts.items(), reverse=True)]
    kinds = ", ".join(f"{kind} {count}" for kind, count in search["regimes"].items())
    return (
        f"Quartiles of the scores: {low:.3f}, {middle:.3f}, {high:.3f}. Motions in all draws: {kinds} (other: exponent"
        f" undecided, or diverged). {search['all_regimes']} of {search['draws']} draws have periodic, multi-period and"
        f" chaotic motions at once.\n\n{table(['score', 'draws'], rows)}"
    )


def _parameters(search: Mapping[str, Any]) -> str:
    best, near = search["best"]["parameters"], search["near"].get("parameters", {})
    rows = []
    for unknown in search["unknowns"]:
        name = unknown["name"]
        span = f"{unknown['low']:.3g} .. {unknown['high']:.3g}" + (" (log)" if unknown["logarithmic"] else "")
        fitted = f"{near[name]:.3g}" if near else ""
        rows.append([name, unknown["kind"], span, f"{best[name]:.3g}", fitted, unknown["why"]])
    heads = ["unknown", "is", "range (SI)", "best even draw", "best fitted", "why this range"]
    return table(heads, rows)


def _labels(search: Mapping[str, Any]) -> str:
    rows = [
        [label["statement"], label["stage"], f"{label['omega_e']:.4f}", label["expected"], label["found"],
         f"{label['held_by']} of {search['draws']}"]
        for label in search["labels"]
    ]  # fmt: skip
    heads = ["statement", "stage", "omega_e", "paper", "best even draw", "held by draws"]
    return f"The labels (`multi`: any period from 2 up):\n\n{table(heads, rows)}"
