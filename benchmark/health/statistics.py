"""What is kept of recorded minutes: statistics of every alarm feature, enough to draw others like them.

y = ln(x + offset) is taken apart into a mean and a standard deviation per bin of speed and load and a score common to
all bins. Of the scores are kept: the distribution (see `tails`), the autocorrelation of their normal scores, and the
correlation between features. Operating points are kept second by second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from health.recording import Recording
from nw_gear_common.tables import Array
from nw_gear_monitor.alarms.features import LONG, SHORT, rule_of
from nw_gear_monitor.alarms.operating import Bin, Steadiness
from nw_gear_monitor.alarms.settings import LONG_SPREAD, AlarmSettings
from nw_gear_monitor.operating import Operating

WINDOWS = {SHORT: 4, LONG: 16}
LEAST_IN_BIN = 12
"""Windows of a bin that count: fewer say little about its mean."""
LEAST_DEVIATION = 1e-9
"""A feature that varies by less is a constant with rounding."""
LEAST_SCORES = 100
LAGS = 40
"""Seconds over which the autocorrelation is kept."""
SIGNIFICANT = 3
"""Digits that are kept."""
Keys = list[Bin | None]


@dataclass(frozen=True, eq=False)
class Scores:
    """A feature taken apart.

    Attributes:
        name: of the feature.
        bins: bin -> (mean, standard deviation, windows) of y.
        series: per recording, (seconds,), the score or nan.
    """

    name: str
    bins: dict[Bin, tuple[float, float, int]]
    series: list[Array]


def keys_of(speed: Array, load: Array) -> dict[str, Keys]:
    """The bin of every second's windows, None where they aren't compared, as the alarms find them."""
    settings = AlarmSettings()
    steadiness = Steadiness(max(WINDOWS.values()))
    found: dict[str, Keys] = {window: [] for window in WINDOWS}
    for s, t in zip(speed, load, strict=True):
        steadiness.add(Operating(float(t), float(s)))
        for window, seconds in WINDOWS.items():
            times = LONG_SPREAD if window == LONG else 1.0
            limits = times * settings.steady_speed, times * settings.steady_load
            found[window].append(steadiness.bin(seconds, *limits)[0])
    return found


def scores(recordings: Sequence[Recording]) -> list[Scores]:
    """Every feature that raises alarms and has enough values."""
    keys = [keys_of(r.speed, r.load) for r in recordings]
    found = []
    for name in recordings[0].columns:
        rule = rule_of(name)
        if rule is None:
            continue
        columns = [r.values[:, r.columns.index(name)] + rule.offset for r in recordings]
        with np.errstate(invalid="ignore", divide="ignore"):
            logarithms = [np.where(c > 0.0, np.log(c), np.nan) for c in columns]
        own = _scores(name, logarithms, [k[rule.window] for k in keys])
        if own.bins:
            found.append(own)
    return found


def _scores(name: str, logarithms: list[Array], keys: list[Keys]) -> Scores:
    members: dict[Bin, list[float]] = {}
    for values, own in zip(logarithms, keys, strict=True):
        for y, key in zip(values, own, strict=True):
            if key is not None and np.isfinite(y):
                members.setdefault(key, []).append(float(y))
    bins = {k: (float(np.mean(v)), float(np.std(v)), len(v)) for k, v in members.items() if len(v) >= LEAST_IN_BIN}
    series = []
    for values, own in zip(logarithms, keys, strict=True):
        score = np.full(len(values), np.nan)
        for i, key in enumerate(own):
            if key in bins and bins[key][1] > LEAST_DEVIATION:
                mean, deviation, _ = bins[key]
                score[i] = (values[i] - mean) / deviation
        series.append(score)
    return Scores(name, bins, series)


def normal_scores(series: Sequence[Array]) -> list[Array]:
    """The same ranks with a normal distribution; nan stays."""
    joined = np.concatenate(series)
    seen = np.isfinite(joined)
    normal = np.full(joined.size, np.nan)
    normal[seen] = stats.norm.ppf(stats.rankdata(joined[seen]) / (seen.sum() + 1.0))
    return np.split(normal, np.cumsum([s.size for s in series])[:-1])


def autocorrelation(series: Sequence[Array], lags: int = LAGS) -> Array:
    """(lags + 1,) correlation of normal scores with those some seconds later, over pairs that both exist."""
    found: Array = np.zeros(lags + 1)
    found[0] = 1.0
    for lag in range(1, lags + 1):
        pairs = [(s[:-lag], s[lag:]) for s in series if s.size > lag]
        a, b = (np.concatenate(side) for side in zip(*pairs, strict=True))
        both = np.isfinite(a) & np.isfinite(b)
        if both.sum() >= LEAST_SCORES:
            found[lag] = float(np.mean(a[both] * b[both]) / np.sqrt(np.mean(a[both] ** 2) * np.mean(b[both] ** 2)))
    return found


def correlation(features: Sequence[list[Array]]) -> Array:
    """(features, features) correlation of normal scores, over windows that both have."""
    joined = np.array([np.concatenate(series) for series in features])
    seen = np.isfinite(joined)
    filled = np.where(seen, joined, 0.0)
    count = seen.astype(float) @ seen.T
    own = np.sqrt((filled**2) @ seen.T)
    with np.errstate(invalid="ignore", divide="ignore"):
        found: Array = (filled @ filled.T) / (own * own.T)
    found[~((count >= LEAST_SCORES) & np.isfinite(found))] = 0.0
    np.fill_diagonal(found, 1.0)
    return found


def tails(series: Sequence[Array]) -> tuple[float, float]:
    """Tukey's g and h of scores: q(z) = (e^(g z) - 1)/g e^(h z^2 / 2), from quantiles on either side.

    g is the median over probabilities of ln(upper / lower) / z, h at least 0 the slope over z^2/2 of
    ln(g (upper + lower) / (e^(g z) - e^(-g z))); Hoaglin 1985. Upper and lower are quantiles' distances to the median.
    """
    joined = np.concatenate(series)
    joined = joined[np.isfinite(joined)]
    if joined.size < LEAST_SCORES:
        return 0.0, 0.0
    share = np.array([0.9, 0.95, 0.975, 0.99, 0.995])
    share = share[share <= 1.0 - 3.0 / joined.size]
    z = stats.norm.ppf(share)
    upper = np.quantile(joined, share) - np.median(joined)
    lower = np.median(joined) - np.quantile(joined, 1.0 - share)
    if np.any(upper <= 0.0) or np.any(lower <= 0.0):
        return 0.0, 0.0
    g = float(np.median(np.log(upper / lower) / z))
    width = upper + lower
    scale = 2.0 * np.sinh(g * z) / g if abs(g) > 1e-3 else 2.0 * z
    h = float(np.polyfit(z**2 / 2.0, np.log(width / scale), 1)[0])
    return g, max(h, 0.0)


def describe(recordings: Sequence[Recording]) -> dict[str, Any]:
    """Everything that `surrogate` needs, as plain numbers."""
    found = scores(recordings)
    normal = [normal_scores(feature.series) for feature in found]
    features = {}
    for feature, own in zip(found, normal, strict=True):
        g, h = tails(feature.series)
        features[feature.name] = {
            "g": _round(g),
            "h": _round(h),
            "autocorrelation": [_round(r) for r in autocorrelation(own)],
            "bins": [[k.speed, k.load, _round(m, 5), _round(s), n] for k, (m, s, n) in feature.bins.items()],
        }
    return {
        "seconds": [len(r.speed) for r in recordings],
        "speed": [[_round(v, 4) for v in r.speed] for r in recordings],
        "load": [[_round(v, 4) for v in r.load] for r in recordings],
        "features": features,
        "correlation": [[round(float(v), 2) for v in row] for row in correlation(normal)],
    }


def _round(value: float, digits: int = SIGNIFICANT) -> float:
    return float(f"{value:.{digits}g}")
