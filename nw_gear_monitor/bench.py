"""The monitor's part of `nw_gear bench`: what an indicator costs, beside other packages where one offers the same."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from nw_gear_common.benchmarking import Figure, Part, calls_for, cpu_seconds
from nw_gear_common.tables import Array
from nw_gear_monitor import bench_hops
from nw_gear_monitor.gearing import gearing
from nw_gear_monitor.indicators import line_state, registry
from nw_gear_monitor.indicators.tonal_share import tonal_share
from nw_gear_monitor.indicators.window import Indicator, LineResult, MeshWindow
from nw_gear_monitor.indicators.zero_one import zero_one
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.pipeline import Windows
from nw_gear_sim import config as configurations

RATE = bench_hops.RATE
STROBES = 1000
HOP_GOAL = 250.0
"""A quarter of the hop of one second, ms."""
SHORT = registry.ALL[: registry.ALL.index(line_state.INDICATOR)]
"""Indicators of the short window."""
Peer = tuple[str, Callable[[Any, Array], object]]
PEERS: dict[str, Peer] = {
    "kurtosis": ("scipy.stats", lambda package, x: package.kurtosis(x, fisher=False)),
}
"""By indicator: module of another package, and how it computes the same from a displacement."""


@dataclass(frozen=True)
class Timing:
    """CPU time of an indicator (ms), and of a peer where one is installed."""

    milliseconds: float
    peer: str | None = None
    peer_milliseconds: float | None = None

    @property
    def ratio(self) -> float | None:
        """The peer's time over ours."""
        return None if self.peer_milliseconds is None else self.peer_milliseconds / self.milliseconds


def measure(config: str | None, *, quick: bool, say: Callable[[str], None]) -> Part:
    """Measure the monitor (see `benchmarking.Benchmark`).

    Raises:
        InputError: the configuration can't be used.
    """
    gears = gearing(configurations.load(config))
    say("monitor: indicators")
    seconds, repeats = (0.005, 3) if quick else (0.05, 7)
    windows = Windows()
    tasks = _tasks(gears) | bench_hops.tasks(gears)
    timings = {name: _timing(name, function, x, seconds, repeats) for name, (function, x) in tasks.items()}
    say("monitor: hops")
    hops = [1e3 * hop for hop in bench_hops.hops(gears, 2 if quick else 3 * windows.label_seconds)]
    median, p99, largest = statistics.median(hops), float(np.percentile(hops, 99)), max(hops)
    values = {
        "indicators": {
            name: {
                "milliseconds": t.milliseconds,
                "peer": t.peer,
                "peer_milliseconds": t.peer_milliseconds,
                "ratio": t.ratio,
            }
            for name, t in timings.items()
        },
        "monitor": {
            "hop_milliseconds": median,
            "hop_p99_milliseconds": p99,
            "largest_hop_milliseconds": largest,
            "hops": len(hops),
        },
    }
    conditions = (
        f"indicators: one mesh, {windows.spectrum_seconds} s at {RATE} Hz; zero_one_k: {STROBES} strobes, 100 "
        f"frequencies; tonal_share: {STROBES} strobes; medians of {repeats}",
        f"sidebands to contact: one mesh, {bench_hops.BEARING_SECONDS} s; bearing_..: one bearing, "
        f"{bench_hops.BEARING_SECONDS} s",
        f"hop: everything for seven meshes, six bearings and a second of signal; {len(hops)} hops, windows empty at "
        "first; period doubling sets in halfway",
        "peers count where they are installed: " + ", ".join(module for module, _ in PEERS.values()),
    )
    text = f"{largest:.3g} ms ({p99:.3g} ms, {median:.3g} ms)"
    whole = Figure("hop: largest (99th percentile, median)", text, f"<= {HOP_GOAL:g} ms", largest <= HOP_GOAL)
    return Part("Monitor (CPU time)", (*_figures(timings), whole), conditions, values)


def _figures(timings: dict[str, Timing]) -> list[Figure]:
    lines = []
    for name, timing in timings.items():
        beside = "" if timing.ratio is None else f" ({timing.peer}: {timing.ratio:.3g} times as long)"
        lines.append(Figure(name, f"{timing.milliseconds:.3g} ms{beside}"))
    return lines


def _tasks(gears: Machine) -> dict[str, tuple[Callable[[], object], Array]]:
    """Return for each indicator a call and the displacement it is about."""
    table = bench_hops.signal(gears, Windows().spectrum_seconds)
    phase, x, v = (
        np.ascontiguousarray(table.data[:, table.columns.index(c)]) for c in ("phase_II", "x_II_1", "v_II_1")
    )
    rng = np.random.default_rng(2)
    strobes = rng.standard_normal(STROBES)

    def task(indicator: Indicator) -> Callable[[], object]:
        return lambda: indicator.compute(MeshWindow("II_1", RATE, phase, x, v, LineResult(0.0, 0.0, math.nan)))

    # the others look at windows of their own (`bench_hops`), or hand over what the line fit of the hop found
    by_name = {indicator.columns[0].name.removesuffix("_1"): indicator for indicator in SHORT}
    tasks: dict[str, tuple[Callable[[], object], Array]] = {name: (task(i), x) for name, i in by_name.items()}
    tasks["zero_one_k"] = (lambda: zero_one(strobes), strobes)
    tasks["tonal_share"] = (lambda: tonal_share(strobes), strobes)
    return tasks


def _timing(name: str, function: Callable[[], object], x: Array, seconds: float, repeats: int) -> Timing:
    own = _milliseconds(function, seconds, repeats)
    if name not in PEERS:
        return Timing(own)
    module, call = PEERS[name]
    try:
        package = import_module(module)
    except ImportError:
        return Timing(own)
    return Timing(own, module, _milliseconds(lambda: call(package, x), seconds, repeats))


def _milliseconds(function: Callable[[], object], seconds: float, repeats: int) -> float:
    function()
    calls = calls_for(function, seconds)

    def several() -> None:
        for _ in range(calls):
            function()

    return 1e3 * cpu_seconds(several, repeats) / calls
