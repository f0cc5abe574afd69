"""What a benchmark of a package hands over, and how time is taken: CPU time of the thread, medians of repeats."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol


@dataclass(frozen=True)
class Figure:
    """One line of the table for people.

    Attributes:
        name, value: what was measured, and the result with its unit.
        goal: what is wanted, with its unit; "" where nothing is.
        met: whether the goal is reached; None where there is none, or where it can't be judged here.
    """

    name: str
    value: str
    goal: str = ""
    met: bool | None = None


@dataclass(frozen=True)
class Part:
    """What one package measured.

    Attributes:
        title: of its lines; figures: the lines; conditions: what has to be known to read them.
        values: for `--json`, merged with those of the other packages.
    """

    title: str
    figures: tuple[Figure, ...]
    conditions: tuple[str, ...]
    values: Mapping[str, Any] = field(default_factory=dict)


class Benchmark(Protocol):
    """The function that stands behind an entry point of the group `nw_gear.benchmarks`."""

    def __call__(self, config: str | None, *, quick: bool, say: Callable[[str], None]) -> Part:
        """Measure.

        Args:
            config: file or preset laid over the default configuration, or None.
            quick: run everything once and shortly; the figures are then rough.
            say: takes a line about what is being done.

        Raises:
            InputError: the configuration can't be used.
        """


def cpu_seconds(function: Callable[[], object], repeats: int) -> float:
    """Return the median CPU time (s) that the calling thread spends in a call, over some repeats."""
    spent = []
    for _ in range(repeats):
        began = time.thread_time()
        function()
        spent.append(time.thread_time() - began)
    return statistics.median(spent)


def calls_for(function: Callable[[], object], seconds: float) -> int:
    """Return how many calls take about some seconds of CPU time; at least 1."""
    began = time.thread_time()
    function()
    return max(1, int(seconds / max(time.thread_time() - began, 1e-7)))
