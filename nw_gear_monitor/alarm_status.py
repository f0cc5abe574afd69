"""Alarms in `/diagnostics`: beside the state of the stage or bearing they belong to, and all together in an entry."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from nw_gear_monitor.alarms.baseline import Progress
from nw_gear_monitor.alarms.center import Alarm, Transition
from nw_gear_monitor.alarms.features import BEARING, rule_of, unit_of
from nw_gear_monitor.alarms.operating import NO_LOAD, Bin
from nw_gear_monitor.alarms.settings import LOAD_RATIO, SPEED_RATIO
from nw_gear_monitor.health import OK, STALE, WARN, Status
from nw_gear_monitor.machine import Machine

WORDS = ("OK", "WARN", "ERROR")
NAME = "alarms"


@dataclass(frozen=True)
class Learning:
    """What is known about the baselines.

    Attributes:
        progress: bins and windows.
        doing: `learning`, `frozen`, or why it rests.
        pause: why this second's windows are compared with nothing, "" where they are.
        file: path, "" where there's none.
        trouble: what keeps the baselines from being used or kept, "" where nothing does.
    """

    progress: Progress
    doing: str
    pause: str
    file: str
    trouble: str


def with_alarms(statuses: Sequence[Status], alarms: Sequence[Alarm], machine: Machine) -> list[Status]:
    """Raise the level of each stage and bearing to that of its alarms and name the worst after the state."""
    found: dict[str, list[Alarm]] = {}
    for alarm in alarms:
        found.setdefault(_owner(alarm, machine), []).append(alarm)
    return [_with(status, found.get(status.name, []), machine) for status in statuses]


def alarm_status(alarms: Sequence[Alarm], learning: Learning, machine: Machine, silent: bool) -> Status:
    """The entry `alarms`: how many there are, each with value, limit and bin, and how far learning is.

    Args:
        alarms: worst first.
        learning: about the baselines.
        machine: what is watched.
        silent: whether samples have stopped, so that alarms stay as they were.
    """
    active = [alarm for alarm in alarms if alarm.level > OK]
    level = max((alarm.level for alarm in active), default=OK)
    unseen = sum(not alarm.acknowledged for alarm in alarms)
    progress = learning.progress
    values = {
        "active (1)": str(len(active)),
        "not acknowledged (1)": str(unseen),
        "baseline": learning.doing,
        "bins that judge (1)": str(progress.judging),
        "bins seen (1)": str(progress.bins),
        "windows learned (1)": str(progress.windows),
        "not compared": learning.pause,
        "file": learning.file,
        **{alarm.feature: describe(alarm, machine) for alarm in alarms},
    }
    words = describe(active[0], machine, named=True) if active else _quiet(learning, unseen)
    if len(active) > 1:
        words += f"; and {len(active) - 1} more"
    if learning.trouble:
        level, words = max(level, WARN), f"{learning.trouble}; {words}"
    if silent:
        level, words = STALE, f"no samples, held: {words}"
    return Status(NAME, level, "", words, values)


def describe(alarm: Alarm, machine: Machine, named: bool = False) -> str:
    """One alarm in words: level, value, limit, bin, since when, whether it has been seen."""
    unit = unit_of(alarm.feature)
    unit = f" {unit}" if unit else ""
    side = "over" if alarm.level > OK else "under 0.9 of"
    name = f"{alarm.feature} " if named else ""
    seen = "acknowledged" if alarm.acknowledged else "not acknowledged"
    begun = f"since {alarm.since:.0f} s"
    if alarm.level == OK:
        begun = f"was {WORDS[alarm.worst]}, {begun}"
    bound = f"{side} {alarm.limit:.4g}{unit}" if math.isfinite(alarm.limit) else "limit not learned"
    return (
        f"{WORDS[alarm.level]}: {name}{alarm.value:.4g}{unit} {bound} ({bin_text(alarm.bin, machine)}), {begun}, {seen}"
    )


def log_line(transition: Transition, machine: Machine) -> str:
    """A change of level for the log."""
    rule = rule_of(transition.alarm.feature)
    reason = f"; {rule.reason}" if rule is not None and transition.alarm.level > transition.before else ""
    words = describe(transition.alarm, machine, named=True).partition(", since")[0]
    return f"{words} at {transition.time:.0f} s{reason}"


def bin_text(key: Bin, machine: Machine) -> str:
    """A bin for people: speed in shares of the nominal one, load in the unit of what stands for it."""
    nominal = machine.stages[0].frequency / 100.0
    low, high = SPEED_RATIO**key.speed / nominal, SPEED_RATIO ** (key.speed + 1) / nominal
    words = f"speed {low:.0f} to {high:.0f} %"
    if key.load != NO_LOAD:
        words += f", load {LOAD_RATIO**key.load:.3g} to {LOAD_RATIO ** (key.load + 1):.3g}"
    return words


def _quiet(learning: Learning, unseen: int) -> str:
    words = "no alarm" if not unseen else f"no alarm, {unseen} that ended not acknowledged"
    if not learning.progress.judging:
        return f"{words}; no bin has learned enough to judge"
    return words


def _with(status: Status, alarms: Sequence[Alarm], machine: Machine) -> Status:
    active = [alarm for alarm in alarms if alarm.level > OK]
    if not active or status.level == STALE:
        return status
    more = f" and {len(active) - 1} more" if len(active) > 1 else ""
    reason = f"{status.reason}; {describe(active[0], machine, named=True)}{more}"
    values = {**status.values, **{alarm.feature: describe(alarm, machine) for alarm in alarms}}
    return replace(status, level=max(status.level, active[0].level), reason=reason, values=values)


def _owner(alarm: Alarm, machine: Machine) -> str:
    element = alarm.feature.rpartition("/")[0]
    if element.startswith(BEARING):
        return element
    return f"stage {machine.channel(element).stage}" if element in machine.channel_names else element
