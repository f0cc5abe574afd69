"""What the study found, as plain objects for JSON and for pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.params import Configuration
from nw_gear_sim.studies.section4 import space, study
from nw_gear_sim.studies.section4.evaluate import PLAN
from nw_gear_sim.studies.section4.judging import Evidence, Verdict, gathered, holding, judge, judge_motions
from nw_gear_sim.studies.section4.scoring import chance, guesses, held, motions, occurrences, regimes
from nw_gear_sim.studies.section4.statements import read_labels
from nw_gear_sim.studies.store import Store


def collect(base: Configuration, question: study.Question, store: Store, run: study.Run) -> dict[str, Any]:
    """Compute what the store hasn't and return all that was found: `held`, `total`, `rows`, and the `search`.

    Args:
        base: configuration that the draws are laid over; question: how many; store: of the study.
        run: computes pieces (key -> piece) that the store hasn't.
    """
    even, near = study.search(base, question, store, run)
    chosen = study.best(even)
    run(study.closely(base, chosen))
    prefixes = study.set_names(chosen)
    verdicts = judge(_evidence(store, prefixes["best"]))
    base_motions = gathered(*(store.get(f"{prefixes['base']}-{name}") for name in ("labels", *study.GRID_PARTS)))
    of_base = judge_motions(base_motions)
    return {
        "held": holding(verdicts),
        "total": len(verdicts),
        "rows": [_row(verdict, of_base.get(verdict.statement.id)) for verdict in verdicts],
        "base": {"score": study.score(store, f"{prefixes['base']}-labels"), "regimes": regimes(base_motions)},
        "search": _search(store, question, even, near),
        "plan": asdict(PLAN),
    }


def _evidence(store: Store, prefix: str) -> Evidence:
    def piece(name: str) -> Mapping[str, Array]:
        return store.get(f"{prefix}-{name}")

    return Evidence(
        labels=piece("labels"),
        grid=tuple(piece(name) for name in study.GRID_PARTS),
        kinematic=piece("kinematic"),
        rigid=piece("rigid"),
        minute=piece("minute"),
        tied_lines=piece("lines-tied"),
        kinematic_lines=piece("lines-kinematic"),
        rk4={omega_e: piece(f"rk4-{1e3 * omega_e:.0f}") for omega_e in study.FIGURES},
    )


def _row(verdict: Verdict, base: tuple[bool, str] | None) -> dict[str, Any]:
    statement = verdict.statement
    return {
        "id": statement.id,
        "holds": verdict.holds,
        "value": verdict.value,
        "claim": statement.text,
        "figure": statement.figure,
        "stage": statement.stage,
        "agrees": verdict.agrees,
        "kinematic": verdict.kinematic,
        "base": None if base is None else {"agrees": base[0], "value": base[1]},
    }


def _search(
    store: Store, question: study.Question, even: Sequence[study.Draw], near: Sequence[study.Draw]
) -> dict[str, Any]:
    labels = read_labels()
    chosen = study.best(even)
    found = [motions(store.get(draw.key)) for draw in even]
    each = np.array([held(labels, motion) for motion in found])
    scores = np.array([draw.score for draw in even])
    own = found[even.index(chosen)]
    counts = np.array([list(regimes(motion).values()) for motion in found])
    return {
        **asdict(question),
        "unknowns": [asdict(unknown) for unknown in space.SPACE],
        "scores": [round(float(score), 4) for score in scores],
        "quartiles": [float(q) for q in np.quantile(scores, (0.25, 0.5, 0.75))],
        "best": {**_of_draw(store, chosen), "regimes": regimes(own)},
        "near": {"count": len(near), **(_of_draw(store, study.best(near)) if near else {})},
        "guesses": guesses(labels),
        "chance": asdict(chance(labels, found, question.seed)),
        "expected": occurrences(labels),
        "all_regimes": int(np.sum(np.all(counts[:, :3] > 0, axis=1))),
        "regimes": dict(zip(regimes(own), (int(n) for n in counts.sum(axis=0)), strict=True)),
        "labels": [
            {
                "statement": label.statement, "stage": label.stage, "omega_e": label.omega_e,
                "expected": label.expected, "found": own[label.stage, label.omega_e],
                "held_by": int(each[:, k].sum()),
            }
            for k, label in enumerate(labels)
        ],
    }  # fmt: skip


def _of_draw(store: Store, draw: study.Draw) -> dict[str, Any]:
    return {
        "draw": draw.key,
        "score": draw.score,
        "score_by_exponent": study.score(store, draw.key, "exponent"),
        "parameters": space.named(draw.shares),
    }
