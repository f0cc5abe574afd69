"""Alarms from features: bins, transients, transitions, acknowledging, and what `/diagnostics` says about them."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nw_gear_common import names
from nw_gear_monitor import health
from nw_gear_monitor.alarm_status import Learning, alarm_status, describe, with_alarms
from nw_gear_monitor.alarms.baseline import Progress
from nw_gear_monitor.alarms.center import ERROR, OK, WARN, AlarmCenter
from nw_gear_monitor.alarms.features import BEARING_RULES, LONG, MESH_RULES, SHORT, features, rule_of, unit_of
from nw_gear_monitor.alarms.operating import NO_LOAD, Steadiness, bin_of
from nw_gear_monitor.alarms.settings import LOAD_RATIO, SPEED_RATIO, AlarmSettings
from nw_gear_monitor.indicators import bearing_registry, registry
from nw_gear_monitor.operating import Operating, operating_point
from nw_gear_monitor.signals.stream import Stream
from test.monitor.gear_signal import LEVEL, paper, waveform

SETTINGS = AlarmSettings(least_windows=20)
POINT = Operating(torque=1.5e-4, speed=26.0)
NAME = "II_1/harmonic_1"
HEALTHY = 1e-6


class Watched:
    """A centre with a clock, fed with one feature in windows of one hop."""

    def __init__(self, learned=60, point=POINT):
        self.center = AlarmCenter(SETTINGS, {SHORT: 1, LONG: 1})
        self.time = 0.0
        self.random = np.random.default_rng(0)
        self.feed([None] * learned, point)

    def feed(self, values, point=POINT):
        """Feed multiples of the limit of WARN (None: a healthy value); returns all transitions."""
        found = []
        for value in values:
            self.time += 1.0
            limit = self.limits(point)[0] if value is not None else 0.0
            x = HEALTHY * math.exp(0.05 * self.random.normal()) if value is None else value * limit
            found += self.center.update(self.time, point, {NAME: x})
        return found

    def limits(self, point=POINT):
        return self.center.limits(bin_of(point.speed, point.load), NAME)

    def level(self):
        return max((alarm.level for alarm in self.center.alarms), default=OK)


def test_an_alarm_comes_in_the_third_window_and_goes_after_five():
    watched = Watched()
    assert watched.feed([1.01, 1.01]) == []
    (raised,) = watched.feed([1.01])
    assert (raised.before, raised.alarm.level, raised.time, raised.alarm.since) == (OK, WARN, 63.0, 63.0)
    assert raised.alarm.value == pytest.approx(1.01 * raised.alarm.limit)
    assert raised.alarm.limit == pytest.approx(watched.limits()[0])
    assert watched.feed([0.95] * 20) == []
    assert watched.feed([0.89] * 4) == []
    (cleared,) = watched.feed([0.89])
    assert (cleared.before, cleared.alarm.level, cleared.alarm.worst) == (WARN, OK, WARN)


def test_error_follows_warn_and_both_go():
    watched = Watched()
    high = 1.01 * watched.limits()[1] / watched.limits()[0]
    assert [(t.before, t.alarm.level) for t in watched.feed([high] * 10)] == [(OK, WARN), (WARN, ERROR)]
    assert [t.alarm.level for t in watched.feed([1.01] * 10)] == [WARN]
    (alarm,) = watched.center.alarms
    assert (alarm.worst, alarm.since) == (ERROR, 63.0)
    assert [t.alarm.level for t in watched.feed([0.8] * 10)] == [OK]


def test_a_bin_never_seen_says_nothing():
    watched = Watched()
    elsewhere = Operating(torque=0.5e-4, speed=13.0)
    assert watched.limits(elsewhere) is None
    for _ in range(19):
        watched.time += 1.0
        assert watched.center.update(watched.time, elsewhere, {NAME: 1.0}) == []


def test_acknowledged_alarms_stay_until_their_cause_goes_and_come_anew_when_they_grow():
    watched = Watched()
    watched.feed([1.01] * 3)
    assert watched.center.acknowledge() == [NAME]
    assert watched.center.acknowledge() == []
    assert [(a.level, a.acknowledged) for a in watched.center.alarms] == [(WARN, True)]
    high = 1.01 * watched.limits()[1] / watched.limits()[0]
    watched.feed([high] * 4)
    assert [(a.level, a.acknowledged) for a in watched.center.alarms] == [(ERROR, False)]
    watched.center.acknowledge()
    watched.feed([1.01] * 5)
    assert [(a.level, a.acknowledged) for a in watched.center.alarms] == [(WARN, True)]
    watched.feed([0.8] * 5)
    assert watched.center.alarms == []


def test_an_alarm_that_ended_unseen_is_kept_until_it_is_acknowledged():
    watched = Watched()
    watched.feed([1.01] * 3 + [0.8] * 5)
    assert [(a.level, a.worst, a.acknowledged) for a in watched.center.alarms] == [(OK, WARN, False)]
    assert watched.center.acknowledge() == [NAME]
    assert watched.center.alarms == []


def test_reset_drops_alarms_and_a_lasting_cause_brings_them_back():
    watched = Watched()
    watched.feed([1.01] * 4)
    limits = watched.limits()
    assert watched.center.reset() == [NAME]
    assert watched.level() == OK
    assert watched.limits() == limits
    assert watched.feed([1.01] * 2) == []
    assert [t.alarm.level for t in watched.feed([1.01])] == [WARN]


def test_an_interruption_keeps_alarms_and_forgets_what_was_counted():
    watched = Watched()
    watched.feed([1.01] * 3)
    watched.feed([0.8] * 4)
    watched.center.interrupt()
    assert watched.feed([0.8] * 4) == []
    assert watched.level() == WARN
    assert [t.alarm.level for t in watched.feed([0.8])] == [OK]


def test_frozen_baselines_judge_and_learn_nothing():
    watched = Watched()
    watched.center.baseline.frozen = True
    before = {key: block.copy() for key, block in watched.center.baseline.bins.items()}
    watched.feed([None] * 50)
    assert all(np.array_equal(block, before[key]) for key, block in watched.center.baseline.bins.items())
    assert len(watched.feed([1.01] * 3)) == 1


@pytest.mark.parametrize("moving", ["speed", "torque"])
def test_transient_windows_are_neither_learned_nor_judged(moving):
    center = AlarmCenter(SETTINGS, {SHORT: 4, LONG: 16})
    for second in range(200):
        swing = 1.0 + 0.3 * math.sin(2.0 * math.pi * second / 8.0)
        center.update(
            float(second), dataclasses.replace(POINT, **{moving: swing * getattr(POINT, moving)}), {NAME: 1.0}
        )
    assert not center.baseline.bins
    name = "load" if moving == "torque" else "speed"
    assert center.pause[SHORT].startswith(f"{name} moved by")


@pytest.mark.parametrize(("window", "name", "apart"), [(SHORT, NAME, 4), (LONG, "II_1/residual_ratio", 8)])
def test_windows_are_judged_apart_and_learned_every_second(window, name, apart):
    center = AlarmCenter(SETTINGS, {SHORT: 4, LONG: 16})
    random = np.random.default_rng(0)
    healthy = {SHORT: 20 * 4, LONG: 20 * 16}[window] + 20
    for second in range(healthy):
        assert center.update(float(second), POINT, {name: 0.01 * math.exp(0.1 * random.normal())}) == []
    (block,) = center.baseline.bins.values()
    assert block[0, 0] == healthy - (4 if window == SHORT else 16) + 1
    found = []
    for second in range(100):
        found += [(second, t.alarm.level) for t in center.update(1000.0 + second, POINT, {name: 10.0})]
    (warned, warn), (erred, error) = found
    assert (warn, error) == (WARN, ERROR)
    assert 2 * apart <= warned < 3 * apart
    assert erred == warned + apart


def test_values_off_their_scale_are_left_out():
    center = AlarmCenter(SETTINGS, {SHORT: 1, LONG: 1})
    for bad in (math.nan, math.inf, 0.0, -1.0):
        assert center.update(1.0, POINT, {NAME: bad, "II_1/mean": 1.0, "nonsense": 1.0}) == []
    assert center.baseline.names == []


@given(st.floats(1e-3, 1e4), st.floats(1e-9, 1e9))
def test_bins_hold_what_falls_into_them(speed, load):
    key = bin_of(speed, load)
    assert SPEED_RATIO**key.speed <= speed * (1 + 1e-9)
    assert speed <= SPEED_RATIO ** (key.speed + 1) * (1 + 1e-9)
    assert LOAD_RATIO**key.load <= load * (1 + 1e-9)
    assert load <= LOAD_RATIO ** (key.load + 1) * (1 + 1e-9)


def test_points_without_a_bin():
    assert bin_of(0.0, 1.0) is None
    assert bin_of(26.0, -1e-5) is None
    assert bin_of(math.nan, 1.0) is None
    assert bin_of(26.0, math.nan).load == NO_LOAD
    assert Operating(math.nan, 26.0, wind=9.0).load == 9.0
    assert math.isnan(Operating(math.nan, 26.0).load)


def test_a_window_without_torque_is_judged_by_speed_alone():
    steadiness = Steadiness(4)
    for _ in range(4):
        steadiness.add(Operating(math.nan, 26.0))
    assert steadiness.bin(4, 0.05, 0.2) == (bin_of(26.0, math.nan), "")
    assert steadiness.bin(5, 0.05, 0.2)[0] is None


def test_the_operating_point_is_read_from_the_waveform():
    machine = paper()
    (second,) = Stream(machine.layout).feed(waveform(1.2))
    point = operating_point(machine.inside(second), machine)
    assert point.speed == pytest.approx(machine.stages[0].frequency, rel=1e-6)
    assert point.torque == pytest.approx(LEVEL, rel=0.05)
    assert math.isnan(point.wind)
    blind = dataclasses.replace(
        machine, channels=tuple(dataclasses.replace(channel, loaded=False) for channel in machine.channels)
    )
    assert math.isnan(operating_point(second, blind).torque)


def test_every_rule_finds_indicators_and_only_scales_that_fit():
    for rules, columns in ((MESH_RULES, registry.COLUMNS), (BEARING_RULES, bearing_registry.COLUMNS)):
        prefix = "bearing sb/" if rules is BEARING_RULES else "II_1/"
        found = {column.name: rule_of(prefix + column.name) for column in columns}
        assert {rule for rule in found.values() if rule is not None} == set(rules)
        for column in columns:
            rule = found[column.name]
            if rule is not None:
                assert unit_of(prefix + column.name) == column.unit
                assert rule.offset == 0.0 or column.unit == ""


def test_features_are_named_after_mesh_and_bearing():
    row = registry.evaluate(5.0, None)
    row.data[0, row.index("rms")] = 2e-6
    bearing = bearing_registry.evaluate(5.0, None)
    bearing.data[0, bearing.index("bpfo")] = 3.0
    assert features({"II_1": row}, {"sb": bearing}) == {"II_1/rms": 2e-6, "bearing sb/bpfo": 3.0}


# --- /diagnostics ----------------------------------------------------------------------------------------------------

LEARNING = Learning(Progress(3, 1, 200), "learning", "", "baseline.json", "")
STATUSES = [
    health.Status("stage II", health.WARN, names.CHAOTIC, "irregular", {"rho (1)": "0.3"}),
    health.Status("stage III", health.OK, names.PERIODS[0], "regular"),
    health.Status("bearing sb", health.OK, names.UNKNOWN, "force 14 kN"),
]


def alarms_of(*levels):
    center = Watched().center
    watched = Watched()
    watched.feed([1.01] * 3)
    (alarm,) = watched.center.alarms
    assert center.alarms == []
    elements = ("II_1/harmonic_1", "bearing sb/bpfo", "III/rms")
    return [dataclasses.replace(alarm, feature=f, level=level) for f, level in zip(elements, levels, strict=False)]


def test_alarms_raise_the_level_of_their_stage_and_bearing_beside_the_state():
    alarms = alarms_of(ERROR, WARN, OK)
    two, three, bearing = with_alarms(STATUSES, alarms, paper())
    assert (two.level, two.label) == (health.ERROR, names.CHAOTIC)
    assert two.message.startswith("chaotic: irregular; ERROR: II_1/harmonic_1 ")
    assert two.values["rho (1)"] == "0.3"
    assert two.values["II_1/harmonic_1"].startswith("ERROR: ")
    assert three == STATUSES[1]
    assert bearing.level == health.WARN
    for part in ("bearing sb/bpfo", " N over ", "speed 97 to 107 %", "load 0.000132 to 0.000158"):
        assert part in bearing.message


def test_silence_outranks_alarms_and_keeps_them():
    alarms = alarms_of(ERROR)
    silent = health.stale(STATUSES, 3.0)
    assert with_alarms(silent, alarms, paper()) == silent
    entry = alarm_status(alarms, LEARNING, paper(), silent=True)
    assert entry.level == health.STALE
    assert entry.message.startswith("no samples, held: ERROR: II_1/harmonic_1")


def test_the_entry_of_alarms_counts_and_describes_them():
    alarms = alarms_of(ERROR, WARN, OK)
    entry = alarm_status(alarms, LEARNING, paper(), silent=False)
    assert entry.level == health.ERROR
    assert entry.message.endswith("; and 1 more")
    assert entry.values["active (1)"] == "2"
    assert entry.values["not acknowledged (1)"] == "3"
    assert entry.values["III/rms"].startswith("OK: ")
    assert "was WARN, since 63 s, not acknowledged" in entry.values["III/rms"]
    seen = dataclasses.replace(alarms[0], acknowledged=True)
    assert describe(seen, paper()).endswith(", acknowledged")
    quiet = alarm_status([], dataclasses.replace(LEARNING, progress=Progress(1, 0, 5)), paper(), silent=False)
    assert (quiet.level, quiet.message) == (health.OK, "no alarm; no bin has learned enough to judge")
    broken = alarm_status([], dataclasses.replace(LEARNING, trouble="disk full"), paper(), silent=False)
    assert (broken.level, broken.message) == (health.WARN, "disk full; no alarm")
