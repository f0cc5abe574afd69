"""Any signal that can be read: a JSON object of finite numbers, nulls with reasons, or an InputError."""

import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_monitor.analyse.measure import as_object, measure
from nw_gear_monitor.analyse.options import Options
from nw_gear_monitor.analyse.select import signals
from nw_gear_monitor.datafiles.source import Source

FEW, MANY = 40, 250


@st.composite
def shapes(draw):
    """Signals of all sorts, some of them ugly: steps, spikes, few levels, ramps, tiny and huge numbers, repetitions."""
    size = draw(st.integers(64, 1500))
    random = np.random.default_rng(draw(st.integers(0, 2**32)))
    n = np.arange(size)
    kind = draw(st.sampled_from(("noise", "levels", "step", "spike", "ramp", "sine", "square", "walk", "repeated")))
    x = {
        "noise": random.standard_normal(size),
        "levels": random.integers(0, draw(st.integers(2, 4)), size).astype(float),
        "step": np.where(n < draw(st.integers(1, size - 1)), 0.0, 1.0),
        "spike": np.where(n == draw(st.integers(0, size - 1)), 1.0, 0.0),
        "ramp": n.astype(float),
        "sine": np.sin(draw(st.floats(1e-3, 3.2)) * n),
        "square": np.sign(np.sin(draw(st.floats(1e-3, 3.1)) * n + 0.1)),
        "walk": np.cumsum(random.standard_normal(size)),
        "repeated": np.tile(random.standard_normal(draw(st.integers(2, 60))), size)[:size],
    }[kind]
    scale, offset = draw(st.sampled_from((1.0, 1e-300, 1e300, 1e-9))), draw(st.sampled_from((0.0, 0.0, 1.0, 1e6)))
    return scale * (x + offset) + draw(st.sampled_from((0.0, 1e-9, 0.1))) * scale * random.standard_normal(size)


@st.composite
def wishes(draw):
    if draw(st.booleans()):
        return Options(map=True)
    strobe = draw(st.one_of(st.none(), st.floats(0.01, 49.0)))
    low = draw(st.floats(0.0, 49.0))
    band = draw(st.one_of(st.none(), st.floats(0.1, 50.0).map(lambda width: (low, low + width))))
    shaft = draw(st.one_of(st.none(), st.floats(1e-3, 1e3)))
    orders = () if shaft is None else tuple(draw(st.lists(st.floats(1e-3, 1e3), max_size=3)))
    return Options(rate=100.0, strobe=strobe, envelope=band, shaft_rate=shaft, bearing_orders=orders)


def survive(x, options, with_velocity):
    columns = {"x": x, "v": np.gradient(x)} if with_velocity else {"x": x}
    if with_velocity:
        options = Options(**{**vars(options), "velocity": "v"})
    try:
        with np.errstate(all="ignore"):
            (signal,) = signals(Source("file", columns), options)
            result = measure(signal, options)
    except InputError:
        return
    found = json.loads(json.dumps(as_object(result), allow_nan=False))
    assert found["state"] in names.STATES
    assert 0.0 <= found["confidence"] <= 1.0
    for name, value in found["indicators"].items():
        assert value is not None or name in found["notes"] or name.startswith("exponent_") or "recurrence" in name or (
            found["indicators"]["determinism"] is None)  # fmt: skip


@settings(max_examples=FEW, deadline=None, suppress_health_check=list(HealthCheck))
@given(shapes(), wishes(), st.booleans())
def test_any_signal(x, options, with_velocity):
    survive(x, options, with_velocity)


@pytest.mark.slow
@settings(max_examples=MANY, deadline=None, suppress_health_check=list(HealthCheck))
@given(shapes(), wishes(), st.booleans())
def test_many_signals(x, options, with_velocity):
    survive(x, options, with_velocity)
