"""`nw_gear study superharmonic --map`: damping, folds and peak over two parameters."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_sim.commands import axes
from nw_gear_sim.commands.superharmonic_files import write
from nw_gear_sim.commands.tables import show
from nw_gear_sim.drawings.superharmonic_map_page import page
from nw_gear_sim.superharmonic import gainmap
from nw_gear_sim.superharmonic.gainchecks import Check, checks

if TYPE_CHECKING:
    from nw_gear_common.tables import Array
    from nw_gear_sim.superharmonic.question import Question


def chart(
    question: Question, texts: list[str], frequencies: Array | None, *, exact: bool, files: list[Path], as_json: bool
) -> None:
    """Compute, write and print a chart.

    Args:
        question: what is asked; texts: axes as the user wrote them.
        frequencies: none, or one at which amplitudes are counted besides.
        exact: whether to hold nine points against the delay equation; files: to write; as_json: whether to print JSON.

    Raises:
        InputError: axes that make no chart, several frequencies, or a file that can't be written.
    """
    if len(texts) != 2:
        raise InputError("--map", "twice, once for each axis", f"{len(texts)} times")
    if frequencies is not None and len(frequencies) != 1:
        raise InputError("--omega", "one frequency with --map, or none", f"{len(frequencies)}")
    named = [axes.axis("--map", text) for text in texts]
    omega = None if frequencies is None else float(frequencies[0])
    made = gainmap.chart(question.pair, named, omega=omega, mode=question.mode)
    found: list[Check] = []
    if exact:
        for check in checks(question.pair, made, question.mode):
            found.append(check)
            print(f"{len(found)} points of the delay equation", file=sys.stderr, flush=True)
    shown = _as_object(made, question, found)
    if files:
        shown["files"] = write(files, question, "superharmonic map", lambda: page(made, question, found), made.table)
    if as_json:
        print(json.dumps(shown))
    else:
        _print(made, question, found)


def _as_object(made: gainmap.Chart, question: Question, found: list[Check]) -> dict[str, Any]:
    fields = {
        name: [[float(v) if np.isfinite(v) else None for v in row] for row in values]
        for name, values in (("mu", made.mu), ("folds", made.folds), ("width", made.width), ("peak", made.peak))
    }
    shown = {**question.as_object(), "axes": {name: a.tolist() for name, a in zip(made.names, made.axes, strict=True)}}
    if made.omega is not None:
        shown |= {"omega": made.omega, "stable_amplitudes": made.count.tolist()}
    if found:
        shown["checks"] = [check.as_object() for check in found]
    return shown | fields


def _print(made: gainmap.Chart, question: Question, found: list[Check]) -> None:
    if question.fit is not None:
        print(question.in_words())
    points = made.mu.size
    lines = [["mu, least to greatest", f"{made.mu.min():.4g} to {made.mu.max():.4g}"]]
    lines.append(["mu > 0 (stable motions exist)", f"{100 * np.mean(made.mu > 0.0):.1f} %"])
    for folds, words in ((0, "no fold"), (1, "a fold, the other too far away"), (2, "two folds")):
        lines.append([words, f"{100 * np.mean(made.folds == folds):.1f} %"])
    lines.append(["folds and mu > 0: jumps", f"{100 * np.mean((made.folds > 0) & (made.mu > 0.0)):.1f} %"])
    if np.isfinite(made.peak).any():
        k = np.unravel_index(np.nanargmin(made.peak), made.peak.shape)
        where = ", ".join(f"{name} = {a[i]:.4g}" for name, a, i in zip(made.names, made.axes, k, strict=True))
        lines.append([f"lowest peak, at {where}", f"{made.peak[k]:.4g}"])
    if made.omega is not None:
        for count in range(3):
            part = 100 * np.mean(made.count == count)
            lines.append([f"stable amplitudes at omega = {made.omega:g}: {count}", f"{part:.1f} %"])
    show(f"Stage {question.pair.stage} over {' and '.join(made.names)}, {points} points", ["what", "value"], lines)
    if found:
        rows = [
            [f"{c.first:.4g}", f"{c.second:.4g}", *(f"{_text(a)} / {_text(b)}" for a, b in (
                (c.mu, c.exact_mu), (c.folds, c.exact_folds), (c.width, c.exact_width), (c.peak, c.exact_peak)))]
            for c in found
        ]  # fmt: skip
        show("First order / delay equation", [*made.names, "mu", "folds", "width", "peak"], rows)


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
