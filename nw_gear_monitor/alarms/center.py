"""Alarms of one gearbox: features of each second in, transitions out. No clock, no file, no ROS."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from nw_gear_monitor.alarms import kernel
from nw_gear_monitor.alarms.baseline import Baseline
from nw_gear_monitor.alarms.features import LONG, SHORT, Rule, rule_of
from nw_gear_monitor.alarms.kernel import Whole
from nw_gear_monitor.alarms.operating import Bin, Steadiness
from nw_gear_monitor.alarms.settings import LONG_SPREAD, AlarmSettings
from nw_gear_monitor.operating import Operating

OK, WARN, ERROR = range(3)
"""Levels, as those of diagnostic_msgs/DiagnosticStatus."""


@dataclass(frozen=True)
class Alarm:
    """A feature over its limit, or one that was and that nobody has acknowledged.

    Attributes:
        feature: its name.
        level: OK where it is over.
        worst: highest level since it began.
        value, limit: of the window that changed its level last, in the feature's unit.
        bin: operating bin of that window.
        since: end of the window in which it began, s.
        acknowledged: whether somebody has seen it; a higher level has to be seen anew.
    """

    feature: str
    level: int
    worst: int
    value: float
    limit: float
    bin: Bin
    since: float
    acknowledged: bool


@dataclass(frozen=True)
class Transition:
    """A feature's level changed: from `before` to `alarm.level`, at the end of a window (s)."""

    time: float
    before: int
    alarm: Alarm


class AlarmCenter:
    """Learns baselines and raises alarms.

    Args:
        settings: limits and what a bin needs.
        windows: lengths of the windows SHORT and LONG in hops.
        baseline: to start from.

    Attributes:
        baseline: what has been learned.
        learn: whether to learn (unless the baseline is frozen).
        pause: why the last window of SHORT and LONG was compared with nothing, "" where it was.
    """

    def __init__(self, settings: AlarmSettings, windows: Mapping[str, int], baseline: Baseline | None = None) -> None:
        self.baseline = Baseline() if baseline is None else baseline
        self.learn = True
        self.pause = dict.fromkeys((SHORT, LONG), "nothing seen")
        self._settings = settings
        self._windows = dict(windows)
        self._steadiness = Steadiness(max(windows.values()))
        self._states = np.zeros((kernel.STATES, len(self.baseline.names)), dtype=np.int64)
        self._alarms: dict[str, Alarm] = {}
        self._hops = 0

    def update(self, time_s: float, operating: Operating, features: Mapping[str, float]) -> list[Transition]:
        """Take in one second.

        Args:
            time_s: its end, s.
            operating: means over this second.
            features: of the windows that end with it; those that raise no alarms, aren't finite or lie outside their
                scale are left out.

        Returns:
            The changes of level, in the order of the features.
        """
        self._hops += 1
        self._steadiness.add(operating)
        transitions: list[Transition] = []
        for window, seconds in self._windows.items():
            key, self.pause[window] = self._steadiness.bin(seconds, *self._steady(window))
            if key is not None:
                transitions += self._window(time_s, window, key, features)
        return transitions

    def interrupt(self) -> None:
        """The stream broke: windows begin anew, alarms stay as they are, what was counted towards them is forgotten."""
        self._steadiness.clear()
        self._states[kernel.COUNTED] = 0

    def acknowledge(self) -> list[str]:
        """Mark every alarm as seen and drop those that are over; returns the names of the features."""
        seen = [name for name, alarm in self._alarms.items() if not alarm.acknowledged]
        self._alarms = {n: replace(a, acknowledged=True) for n, a in self._alarms.items() if a.level > OK}
        return seen

    def reset(self) -> list[str]:
        """Drop every alarm and begin to count anew; one whose cause lasts comes back. Returns the features' names."""
        dropped = list(self._alarms)
        self._alarms.clear()
        self._states[: kernel.JUDGED] = 0
        return dropped

    @property
    def alarms(self) -> list[Alarm]:
        """Worst first, then in the order in which they came."""
        return sorted(self._alarms.values(), key=lambda alarm: (-alarm.level, alarm.since))

    @property
    def learning(self) -> bool:
        """Whether steady windows are learned."""
        return self.learn and not self.baseline.frozen

    def limits(self, key: Bin, feature: str) -> tuple[float, float] | None:
        """Limits of WARN and ERROR of a feature in a bin; None while it is being learned."""
        rule, block = rule_of(feature), self.baseline.bins.get(key)
        if rule is None or block is None or feature not in self.baseline.names:
            return None
        column = self.baseline.names.index(feature)
        if block[kernel.INDEPENDENT, column] < self._settings.least_windows:
            return None
        warn, error = (kernel.limit(block, column, rule.offset, k) for k in self._deviations)
        return warn, error

    @property
    def _deviations(self) -> tuple[float, float]:
        return self._settings.warn_deviations, self._settings.error_deviations

    def _steady(self, window: str) -> tuple[float, float]:
        """Largest spreads of speed and load: a longer window sees more of them."""
        times = LONG_SPREAD if window == LONG else 1.0
        return times * self._settings.steady_speed, times * self._settings.steady_load

    def _window(self, time: float, window: str, key: Bin, features: Mapping[str, float]) -> list[Transition]:
        chosen = {name: rule for name, value in features.items() if (rule := _usable(name, value, window)) is not None}
        if not chosen:
            return []
        which = self.baseline.columns(list(chosen))
        missing = len(self.baseline.names) - self._states.shape[1]
        if missing:
            self._states = np.pad(self._states, ((0, 0), (0, missing)))
        before = self._levels(which)
        block = self.baseline.statistics(key)
        known = block[:, which]
        kernel.window(
            which,
            np.array([features[name] for name in chosen]),
            np.array([rule.offset for rule in chosen.values()]),
            float(self._windows[window]),
            float(self._hops),
            block,
            self._states,
            self._deviations,
            (float(self._settings.least_windows), float(self._settings.most_windows)),
            self.learning,
        )
        after = self._levels(which)
        changed = np.flatnonzero(before != after)
        names = list(chosen)
        transitions = []
        for i in changed:
            level, name = int(after[i]), names[i]
            k = self._deviations[max(level, int(before[i])) - 1]
            bound = kernel.limit(known, int(i), chosen[name].offset, k)
            transitions.append(self._change(time, name, int(before[i]), level, (features[name], bound), key))
        return transitions

    def _levels(self, which: Whole) -> Whole:
        return kernel.levels(self._states)[which]

    def _change(self, time: float, name: str, before: int, level: int, at: tuple[float, float], key: Bin) -> Transition:
        old = self._alarms.get(name)
        begins = old is None or before == OK
        alarm = Alarm(
            feature=name,
            level=level,
            worst=level if begins or old is None else max(level, old.worst),
            value=at[0],
            limit=at[1],
            bin=key,
            since=time if begins or old is None else old.since,
            acknowledged=level <= before and old is not None and old.acknowledged,
        )
        if level == OK and alarm.acknowledged:
            self._alarms.pop(name, None)
        else:
            self._alarms[name] = alarm
        return Transition(time, before, alarm)


def _usable(name: str, value: float, window: str) -> Rule | None:
    """The rule of a feature that belongs to this window and has a value on its scale."""
    rule = rule_of(name)
    if rule is None or rule.window != window or not math.isfinite(value) or not value + rule.offset > 0.0:
        return None
    return rule
