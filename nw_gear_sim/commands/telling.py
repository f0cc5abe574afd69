"""What long studies say on standard error while they run, and what they cost in the end."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nw_gear_sim.studies.runner import Progress


class Teller:
    """Says how far a study is; hand `progress` to the runner and call `cost` at the end.

    Args:
        points: of the whole study; its pieces hold several each.
    """

    def __init__(self, points: int) -> None:
        self._points = points
        self._last: Progress | None = None

    def progress(self, progress: Progress) -> None:
        """Say what is done, what is left, and what a piece takes."""
        self._last = progress
        known = progress.left == progress.left
        left = f", {progress.left:.0f} s left, {progress.seconds_per_piece:.2g} s of a worker each" if known else ""
        print(f"{progress.done} of {progress.total} pieces{left}", file=sys.stderr, flush=True)

    def cost(self) -> None:
        """Say what a point took; nothing where all of them were there before."""
        last = self._last
        if last is None or last.seconds_per_piece != last.seconds_per_piece:
            return
        each = last.seconds_per_piece * last.total / self._points
        workers = f"{last.workers} worker{'s' if last.workers > 1 else ''}"
        print(
            f"{each:.3g} s of a worker per point, {workers}, {last.elapsed:.1f} s in all", file=sys.stderr, flush=True
        )
