"""Chaos indicators beside other packages, in one run: Lorenz' x at 100 Hz, 3 coordinates, lag 11, Theiler window 75.

Peers are measured where they are installed (`make peers`); they are called here and used nowhere else.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from nw_gear_common.benchmarking import Figure, Part
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.correlation_dimension import correlation_dimension
from nw_gear_monitor.indicators.embedding import embed
from nw_gear_monitor.indicators.permutation_entropy import permutation_entropy
from nw_gear_monitor.indicators.recurrence import recurrence
from nw_gear_monitor.indicators.rosenstein import rosenstein
from nw_gear_monitor.indicators.sample_entropy import sample_entropy
from nw_gear_monitor.indicators.zero_one import zero_one

SIZE, LONG, SHORT = 16384, 65536, 2000
DIMENSION, LAG, THEILER, HORIZON = 3, 11, 75, 300
STEP = 0.01
RADIUS = 1.0
"""Of a recurrence: 0.8 % of the pairs."""
PERMUTATION = 4
SLOW, ONCE = 1.0, 8.0
"""A call that takes longer (s) isn't repeated often; one that takes longer than a compiler might, not at all."""
SQUARES = 20.0
"""Bytes a pair of samples that peers with tables of distances may need: 5 GB at N = 16384."""
MEMORY_GOAL = 300.0
"""MB, at N = 65536, interpreter and libraries included."""
Peer = Callable[[Any, Array], object]


@dataclass(frozen=True)
class Task:
    """One indicator.

    Attributes:
        name: for the JSON object; own: computes it; size: samples.
        peers: module of another package, and how it computes the same.
        goal_ms: CPU time that it may take; goal_ratio: how many times faster than a peer it has to be.
    """

    name: str
    own: Callable[[Array], float]
    size: int
    peers: Mapping[str, Peer]
    goal_ms: float | None = None
    goal_ratio: Mapping[str, float] | None = None


@dataclass(frozen=True)
class Timed:
    """CPU time of all threads (ms), and what was computed; None where that isn't a number to compare."""

    milliseconds: float
    value: float | None


@cache
def lorenz(size: int) -> Array:
    """Return x of Lorenz' flow (10, 28, 8/3), 100 samples per unit time, classical Runge-Kutta, after 20 units."""

    def slope(x: float, y: float, z: float) -> tuple[float, float, float]:
        return 10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z

    x, y, z = 1.0, 1.0, 20.0
    found: Array = np.empty(size)
    half = 0.5 * STEP
    for number in range(-2000, size):
        a = slope(x, y, z)
        b = slope(x + half * a[0], y + half * a[1], z + half * a[2])
        c = slope(x + half * b[0], y + half * b[1], z + half * b[2])
        d = slope(x + STEP * c[0], y + STEP * c[1], z + STEP * c[2])
        x += STEP / 6.0 * (a[0] + 2.0 * b[0] + 2.0 * c[0] + d[0])
        y += STEP / 6.0 * (a[1] + 2.0 * b[1] + 2.0 * c[1] + d[1])
        z += STEP / 6.0 * (a[2] + 2.0 * b[2] + 2.0 * c[2] + d[2])
        found[max(number, 0)] = x
    return found


def _exponent(x: Array, references: int | None = None) -> float:
    points = embed(x, DIMENSION, LAG)
    settings = {"theiler": THEILER, "horizon": HORIZON - 1, "fit": (0, HORIZON - 1), "references": references}
    return rosenstein(points, rate=1.0 / STEP, **settings).exponent  # type: ignore[arg-type]


def _nolds_exponent(package: Any, x: Array) -> float:
    settings = {"emb_dim": DIMENSION, "lag": LAG, "min_tsep": THEILER, "tau": STEP, "trajectory_len": HORIZON}
    return float(package.lyap_r(x, fit="poly", **settings))


def _neurokit_exponent(package: Any, x: Array) -> float:
    settings = {"delay": LAG, "dimension": DIMENSION, "separation": THEILER, "len_trajectory": HORIZON}
    return float(package.complexity_lyapunov(x, **settings)[0]) / STEP


def _radii(x: Array) -> Array:
    """A tenth to half a standard deviation in steps of 3 %, as nolds takes them."""
    sd = float(np.std(x, ddof=1))
    return np.asarray(0.1 * sd * 1.03 ** np.arange(int(np.log(5.0) / np.log(1.03)) + 1), dtype=np.float64)


def _dimension(x: Array) -> float:
    return correlation_dimension(embed(x, DIMENSION, LAG), theiler=THEILER, radii=_radii(x)).dimension


def _nolds_dimension(package: Any, x: Array) -> None:
    package.corr_dim(x, DIMENSION, lag=LAG, rvals=_radii(x), fit="poly")  # no Theiler window: another value


def _recurrence(x: Array) -> float:
    return recurrence(embed(x, DIMENSION, LAG), radius=RADIUS, theiler=None).determinism


def _accrqa(package: Any, x: Array) -> float:
    norm, platform = package.accrqaDistance("maximal"), package.accrqaCompPlatform("cpu")
    return float(np.ravel(package.DET(x, LAG, DIMENSION, 2, RADIUS, norm, True, platform, False))[0])


def tasks(size: int, long: int) -> tuple[Task, ...]:
    """Everything that is measured, with `size` samples, and `long` ones where a long record is asked for."""
    return (
        Task(
            "largest_exponent", _exponent, size,
            {"neurokit2": _neurokit_exponent, "nolds": _nolds_exponent}, 60.0, {"neurokit2": 40.0},
        ),
        Task("largest_exponent_2000_points", lambda x: _exponent(x, 2000), size, {}, 9.0),
        Task("largest_exponent_long", _exponent, long, {}, 500.0),
        Task(
            "sample_entropy", sample_entropy, size,
            {"antropy": lambda p, x: float(p.sample_entropy(x)), "nolds": lambda p, x: float(p.sampen(x))},
            None, {"antropy": 2.0},
        ),
        Task("recurrence", _recurrence, size, {"accrqa": _accrqa}, None, {"accrqa": 1.0}),
        Task(
            "correlation_dimension", _dimension, size,
            {
                "nolds": _nolds_dimension,
                "neurokit2": lambda p, x: p.fractal_correlation(x, delay=LAG, dimension=DIMENSION) and None,
            },
            None, {"nolds": 13.0, "neurokit2": 13.0},
        ),
        Task(
            "permutation_entropy", lambda x: permutation_entropy(x, PERMUTATION), size,
            {"antropy": lambda p, x: float(p.perm_entropy(x, order=PERMUTATION))}, None, {"antropy": 1.0},
        ),
        Task("zero_one_1000_strobes", lambda x: zero_one(x[:1000]), size, {}, 6.0),
    )  # fmt: skip


def measure(config: str | None, *, quick: bool, say: Callable[[str], None]) -> Part:
    """Measure (see `benchmarking.Benchmark`); the configuration plays no part."""
    size, long = (SHORT, 2 * SHORT) if quick else (SIZE, LONG)
    found: dict[str, dict[str, Any]] = {}
    figures: list[Figure] = []
    for task in tasks(size, long):
        say(f"peers: {task.name}")
        entry = _entry(task, 3 if quick else 7)
        found[task.name] = entry
        figures += _figures(task, entry, judged=not quick)
    memory = peak_memory(long)
    found["largest_exponent_long"]["peak_megabytes"] = memory
    met = None if quick else memory <= MEMORY_GOAL
    figures.append(Figure(f"memory of it, N = {long}", f"{memory:.0f} MB", f"<= {MEMORY_GOAL:g} MB", met))
    conditions = (
        f"Lorenz' x at 100 Hz, N = {size} (long: {long}), {DIMENSION} coordinates, lag {LAG}, Theiler window "
        f"{THEILER}, {HORIZON} steps; recurrence radius {RADIUS:g}; permutations of {PERMUTATION}; "
        "0-1 test: 1000 values, 100 c",
        "CPU time of all threads, medians; peers that take over a second: once. Memory: peak of a process of its own",
        "peers count where they are installed: neurokit2, nolds, antropy, accrqa (make peers)",
    )
    return Part("Chaos indicators and their peers", tuple(figures), conditions, {"indicators": found})


def _entry(task: Task, repeats: int) -> dict[str, Any]:
    x = lorenz(task.size)
    own = _timed(lambda: task.own(x), repeats)
    peers: dict[str, dict[str, float | None]] = {}
    for module, call in task.peers.items():
        theirs = _peer(module, call, x, repeats)
        if theirs is not None:
            same = None if theirs.value is None or own.value is None else abs(theirs.value - own.value)
            ratio = theirs.milliseconds / own.milliseconds
            peers[module] = {"milliseconds": theirs.milliseconds, "ratio": ratio, "difference": same}
    first = next(iter(peers), None)
    return {
        "milliseconds": own.milliseconds,
        "peer": first,
        "peer_milliseconds": None if first is None else peers[first]["milliseconds"],
        "ratio": None if first is None else peers[first]["ratio"],
        "samples": task.size,
        "value": own.value,
        "peers": peers,
    }


def _figures(task: Task, entry: Mapping[str, Any], *, judged: bool) -> list[Figure]:
    own = entry["milliseconds"]
    met = None if task.goal_ms is None or not judged else own <= task.goal_ms
    lines = [Figure(task.name, f"{own:.3g} ms", "" if task.goal_ms is None else f"<= {task.goal_ms:g} ms", met)]
    for module, theirs in entry["peers"].items():
        goal = (task.goal_ratio or {}).get(module)
        same = "" if theirs["difference"] is None else f", same value to {theirs['difference']:.1g}"
        text = f"{theirs['ratio']:.3g} times as long{same}"
        met = None if goal is None or not judged else theirs["ratio"] >= goal
        lines.append(Figure(f"  {module}", text, "" if goal is None else f">= {goal:g}", met))
    return lines


def _peer(module: str, call: Peer, x: Array, repeats: int) -> Timed | None:
    """Time a peer; None where it isn't installed or needs more memory than is free. What it warns of isn't ours."""
    if module in ("nolds", "neurokit2") and SQUARES * x.size**2 > _free_bytes():
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            package = import_module(module)
        except (ImportError, RuntimeError, OSError):  # accrqa without its library says RuntimeError
            return None
        return _timed(lambda: call(package, x), repeats)


def _timed(function: Callable[[], object], repeats: int) -> Timed:
    """Median CPU time of all threads; the first call compiles and doesn't count, unless it is slow anyway."""
    spent: list[float] = []
    value: object = None
    while len(spent) <= repeats:
        began = time.process_time()
        value = function()
        spent.append(time.process_time() - began)
        if spent[-1] > (SLOW if len(spent) > 1 else ONCE):
            break
    number = float(value) if isinstance(value, float) else None
    return Timed(1e3 * statistics.median(spent[1:] or spent), number)


def _free_bytes() -> float:
    return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_AVPHYS_PAGES"))


def peak_memory(size: int) -> float:
    """Largest resident memory (MB) of a process that computes the exponent of so many samples and nothing else."""
    code = f"from nw_gear_monitor import bench_peers; bench_peers.alone({size})"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    return float(json.loads(done.stdout))


def alone(size: int) -> None:
    """Compute the exponent and print the peak of this process' memory (MB); for `peak_memory`."""
    _exponent(lorenz(size))
    print(json.dumps(_peak_megabytes()))


def _peak_megabytes() -> float:
    """Peak since this program began; what getrusage says would include the process that started it (on Linux)."""
    status = Path("/proc/self/status")
    if status.is_file():
        lines = dict(line.split(":", 1) for line in status.read_text(encoding="ascii").splitlines() if ":" in line)
        return float(lines["VmHWM"].split()[0]) / 1024.0
    from resource import RUSAGE_SELF, getrusage  # noqa: PLC0415 - only where there is no /proc

    return getrusage(RUSAGE_SELF).ru_maxrss / 1024.0
