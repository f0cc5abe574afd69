"""What keeps a hop short: kernels compiled beforehand, a new comb formed bit by bit, hops that took long counted."""

import importlib
import pkgutil

import numpy as np
import pytest
from numba.core.registry import CPUDispatcher

import nw_gear_monitor
from nw_gear_common import names
from nw_gear_monitor.indicators import explained_lines
from nw_gear_monitor.indicators.explained_lines import LineExplainer, LineSecond
from nw_gear_monitor.nodes.computation import Computation
from nw_gear_monitor.pipeline import Pipeline
from nw_gear_monitor.signals.linefit import fit
from nw_gear_monitor.signals.normal import normal_second
from nw_gear_monitor.warm_up import warm_up
from test.monitor.gear_signal import blocks, paper, waveform


def kernels():
    """Every compiled function of the monitor, by name."""
    found = {}
    for info in pkgutil.walk_packages(nw_gear_monitor.__path__, "nw_gear_monitor."):
        if not any(part in info.name for part in (".nodes", ".review", ".bench")):
            module = importlib.import_module(info.name)
            own = {k: v for k, v in vars(module).items() if isinstance(v, CPUDispatcher)}
            found |= {f"{v.py_func.__module__}.{k}": v for k, v in own.items()}
    return found


def test_nothing_is_compiled_after_the_warm_up():
    """At other sample rates, with changing speed and with irregular motion as well."""
    warm_up(paper())
    before = {name: list(kernel.signatures) for name, kernel in kernels().items()}
    assert before["nw_gear_monitor.signals.normal._design"]
    rough = {"II": lambda time, phase: 1e-5 * np.random.default_rng(3).standard_normal(time.size)}
    for table in (
        waveform(9.0, extra=rough, speed=lambda t: 1.0 + 0.02 * np.sin(t)),
        waveform(5.0, rate=20480),
    ):
        table.data[:, 18:] += 10.0 * np.random.default_rng(4).standard_normal((len(table), 12))
        pipeline = Pipeline(paper())
        hops = [hop for block in blocks(table, 2048) for hop in pipeline.feed(block)]
    assert np.isfinite(hops[-1].bearing_indicators["sb"].column("mean")[0])
    assert {name: list(kernel.signatures) for name, kernel in kernels().items()} == before


def half_order(_time, phase):
    return 2e-6 * np.cos(phase / 2)


def line_seconds(count):
    gears = paper()
    table = waveform(float(count), extra={"II": half_order})
    rows = np.split(table.data, count)
    return [LineSecond(float(k), 5120.0, r[:, 0], r[:, 1:4], r[:, 4:11].copy()) for k, r in enumerate(rows)], gears


@pytest.fixture
def formed(monkeypatch):
    """Counts the normal equations that are formed."""
    calls = []

    def counted(name, real):
        def call(*args):
            calls.append(name)
            return real(*args)

        return call

    for name in ("normal_second", "extended_second"):
        monkeypatch.setattr(explained_lines, name, counted(name, getattr(explained_lines, name)))
    return calls


def explainer(gears):
    return LineExplainer(gears.rated_frequency, gears.places)


def test_a_rebuilt_comb_is_formed_a_few_seconds_per_hop_and_ends_as_if_formed_at_once(formed):
    seconds, gears = line_seconds(12)
    slow, counts, seen = explainer(gears), [], []
    for end in (9, 10, 11, 12):
        before = len(formed)
        seen.append(slow.explain(seconds[end - 9 : end]))
        counts.append(len(formed) - before)
    assert max(counts[1:]) <= explained_lines.AT_ONCE + 1  # and the new second for the base comb
    assert all(explained.subharmonic == (1, 2) for explained in seen)
    assert [explained.fit.comb is slow.base for explained in seen] == [True, True, False, False]
    assert all(explained.rho["II"] < 0.01 for explained in seen)
    comb = seen[-1].fit.comb
    whole = [normal_second(s.time, s.phase, s.x, s.start, comb) for s in seconds[3:]]
    assert seen[-1].fit.residual == pytest.approx(fit(whole, comb, 5120.0).residual, rel=1e-9)
    assert len(comb.lines) > len(slow.base.modulated) + len(slow.base.steady)


def test_a_comb_rebuilt_while_the_first_window_fills_is_there_when_labels_begin(formed):
    seconds, gears = line_seconds(8)
    early = explainer(gears)
    for end in range(1, 8):
        early.prepare(seconds[:end])
    before = len(formed)
    explained = early.explain(seconds)
    assert len(formed) - before == 2  # the newest second, for either comb
    assert len(explained.fit.seconds) == 8
    assert explained.rho["II"] < 0.01


def test_hops_that_took_long_are_counted():
    computation = Computation()
    assert computation.status(0).values["hops (1)"] == "0"
    for seconds in (0.1, 0.3, 1.2, 0.2):
        computation.add(seconds)
    status = computation.status(7)
    assert status.message == "keeping up"
    assert status.values["overruns (1)"] == "1"
    assert status.values["hops over 0.25 s (1)"] == "2"
    assert status.values["largest hop (s)"] == "1.2000"
    assert status.values["blocks waiting (1)"] == "7"
    computation.add(1.5)
    assert computation.status(0).level > status.level
    assert names.UNKNOWN not in computation.status(0).message
