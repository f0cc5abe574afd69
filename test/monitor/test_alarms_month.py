"""The series drawn for the month of health: like what was recorded, and counted by alarms that can count."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmark"))

from health.judging import judge
from health.statistics import autocorrelation, tails
from health.surrogate import Surrogate, bend, standard, yule_walker

from nw_gear_monitor.alarms.settings import AlarmSettings

RESULTS = Path(__file__).resolve().parents[2] / "benchmark" / "results"
DAY = 24 * 3600


def statistics():
    return json.loads((RESULTS / "health_statistics.json").read_text())


def test_a_filter_gives_the_autocorrelation_that_it_was_made_from():
    wanted = 0.8 ** np.arange(21)
    _, response = yule_walker(wanted)
    found = np.array([response[: response.size - k] @ response[k:] for k in range(21)])
    assert found / found[0] == pytest.approx(wanted, abs=0.01)


def test_tails_are_found_in_what_they_bent():
    rng = np.random.default_rng(0)
    for g, h in ((0.0, 0.0), (0.5, 0.0), (0.3, 0.15)):
        series = [bend(rng.normal(size=30000), np.array([g]), np.array([h]))]
        assert tails(series) == pytest.approx((g, h), abs=0.04)
    mean, deviation = standard(np.array([0.0, 0.5]), np.array([0.0, 0.0]))
    assert mean == pytest.approx([0.0, (np.exp(0.125) - 1.0) / 0.5], abs=1e-3)
    assert deviation[1] == pytest.approx(np.sqrt(np.exp(0.25) * (np.exp(0.25) - 1.0)) / 0.5, rel=1e-3)


@pytest.mark.slow
def test_surrogates_have_the_recorded_statistics():
    kept = statistics()
    surrogate = Surrogate(kept, 3)
    (piece,) = surrogate.pieces(20000, 20000)
    normal = surrogate._next(20000)
    wanted, found = [], []
    for column, feature in enumerate(kept["features"].values()):
        wanted.append(np.array(feature["autocorrelation"])[[1, 2, 4, 8]])
        found.append(autocorrelation([normal[:, column]], 8)[[1, 2, 4, 8]])
    assert np.median(np.abs(np.array(found) - wanted)) < 0.03
    assert np.std(normal, axis=0) == pytest.approx(1.0, abs=0.1)
    for column, feature in enumerate(kept["features"].values()):
        at = piece.bins[surrogate.windows[column]]
        speed, load, mean, deviation, _ = max(feature["bins"], key=lambda b: b[4])
        here = at == surrogate.keys.index((speed, load))
        y = np.log(piece.values[here, column] + surrogate.offsets[column])
        assert np.mean(y) == pytest.approx(mean, abs=0.3 * deviation + 1e-4)
        assert np.std(y) == pytest.approx(deviation, rel=0.35, abs=1e-4)


@pytest.mark.slow
def test_healthy_days_give_no_error_and_lower_limits_give_many():
    quiet = judge(Surrogate(statistics(), 5), DAY)
    assert quiet.judged.sum() > 1e6
    assert quiet.error.sum() == 0
    assert quiet.warn.sum() < 20
    loud = judge(Surrogate(statistics(), 5), DAY, AlarmSettings(warn_deviations=1.0, error_deviations=1.0))
    assert loud.error.sum() > 1000


def test_the_month_in_the_documentation_has_less_than_one_false_error():
    result = json.loads((RESULTS / "month_of_health.json").read_text())
    assert result["seconds"] >= 30 * DAY
    assert result["error"] == 0
    assert sum(kind["error"] for kind in result["kinds"].values()) == 0
    assert sum(kind["judged"] for kind in result["kinds"].values()) == result["windows_judged"]
    page = (RESULTS.parents[1] / "docs" / "indicators.md").read_text()
    assert f"| {result['warn']} | {result['error']} |" in page
