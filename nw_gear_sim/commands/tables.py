"""Tables on standard output: boxes and bold type on a terminal, plain text with the same columns elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.table import Table

WIDTH = 160
"""Columns of a table that goes to a file or a pipe."""


def show(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print one table; the first column is text, the others are numbers unless a heading says `in words`."""
    terminal = sys.stdout.isatty()
    console = Console(width=None if terminal else WIDTH, no_color=not terminal, highlight=False)
    table = Table(box=box.SIMPLE_HEAD if terminal else None, pad_edge=False)
    for k, column in enumerate(columns):
        words = k == 0 or column in ("what", "meaning", "strain energy in", "excited by")
        table.add_column(column, justify="left" if words else "right", overflow="fold")
    for row in rows:
        table.add_row(*row)
    print()
    console.print(title, style="bold")
    console.print(table)
