"""Choice of the wind by parameters, and the schedule of its samples."""

from pathlib import Path
from typing import Any

import pytest

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_sim import config
from nw_gear_sim.nodes.schedule import Schedule
from nw_gear_sim.physics.wind_gust import DURATION, gust_magnitude
from nw_gear_sim.wind import Settings, Source, make_source

MAST = Path(__file__).parents[1] / "data" / "mast_wind_10min.csv"
NANO = 1_000_000_000


def make(**values: Any) -> Source:
    configuration = config.load()
    settings = Settings(**values)
    return make_source(settings, configuration.wind, configuration.turbine)


def test_every_source_gives_wind() -> None:
    for source in names.WIND_SOURCES:
        made = make(source=source, file=str(MAST))
        assert 0.0 < made.sample(0) < 30.0
        assert made.description


def test_samples_are_at_the_rate() -> None:
    slow, fast = make(rate=10.0), make(rate=40.0)
    assert [slow.sample(i) for i in range(50)] == [fast.sample(4 * i) for i in range(50)]


def test_defaults_of_the_weibull_process_come_from_the_configuration() -> None:
    wind = config.load().wind
    named = make(
        weibull_shape=wind.weibull_shape,
        weibull_scale=wind.weibull_scale,
        sampling_interval=wind.sampling_interval,
        correlation_time=wind.correlation_time,
    )
    assert make().sample(1234) == named.sample(1234)
    assert make(weibull_scale=2 * wind.weibull_scale).sample(77) == pytest.approx(2 * make().sample(77))


def test_gust_takes_the_rotor_from_the_configuration() -> None:
    diameter = config.load().turbine.blade_diameter
    made = make(source="gust", gust_mean=12.0, gust_start=5.0, rate=100.0)
    size = gust_magnitude(12.0, 50.0, 0.14, diameter, 110.0)
    peak = max(made.sample(i) for i in range(2000))
    assert peak == pytest.approx(12.0 + 0.74 * size, abs=1e-3)


def test_gusts_may_not_overlap() -> None:
    with pytest.raises(InputError, match=r"parameter gust_period: expected 0 or at least 10.5 s, got 5 s"):
        make(source="gust", gust_period=5.0)
    assert make(source="gust", gust_period=DURATION).sample(0) > 0.0


def test_offset_into_the_file() -> None:
    whole, late = make(source="file", file=str(MAST)), make(source="file", file=str(MAST), start_offset=1800.0)
    assert late.sample(0) == whole.sample(18000)
    assert late.end == whole.end - 1800.0 == 7 * 86400 - 1800.0
    with pytest.raises(InputError, match=r"start_offset: expected less than the 604800 s of .*, got 604800 s"):
        make(source="file", file=str(MAST), start_offset=604800.0)


def series(folder: Path, text: str = "time,wind_speed\n0,5\n1,6\n2,\n3,8\n4,9\n") -> str:
    path = folder / "wind.csv"
    path.write_text(text)
    return str(path)


def test_gaps_are_bridged_and_reported_or_refused(tmp_path: Path) -> None:
    path = series(tmp_path)
    bridged = make(source="file", file=path, rate=1.0)
    assert [bridged.sample(i) for i in range(7)] == [5, 6, 7, 8, 9, 9, 9]
    assert (len(bridged.gaps), bridged.bridged) == (1, 2.0)
    with pytest.raises(
        InputError, match=r"wind.csv: expected a file without gaps .*, got 1 gaps, the first of 2 s after"
    ):
        make(source="file", file=path, gaps="refuse")


@pytest.mark.parametrize(("rule", "after"), [("hold", 9.0), ("loop", 6.0)])
def test_end_of_the_file(tmp_path: Path, rule: str, after: float) -> None:
    made = make(source="file", file=series(tmp_path), rate=1.0, at_end=rule)
    assert (made.is_over(4), made.is_over(5)) == (False, True)
    assert made.sample(6) == after


def test_a_file_must_be_named_and_its_means_not_too_short(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="parameter file: expected the CSV file of the wind"):
        make(source="file")
    path = series(tmp_path, "time,wind_speed_mean,wind_speed_std\n0,5,1\n5,6,1\n")
    with pytest.raises(InputError, match="expected means over at least 20 s, got rows every 5 s"):
        make(source="file", file=path)


def test_schedule_in_simulated_time_keeps_its_lead() -> None:
    schedule = Schedule(10.0, 1.0, 20)
    schedule.begin(0, 0)
    assert list(schedule.due(0)) == list(range(11))
    assert list(schedule.due(0)) == []
    assert list(schedule.due(NANO // 4)) == [11, 12]
    assert schedule.last == 12


def test_schedule_publishes_at_the_stamp_and_not_before() -> None:
    schedule = Schedule(3.0, 0.0, 20)  # stamps that aren't whole nanoseconds
    origin = 1_700_000_000 * NANO
    schedule.begin(origin, origin)
    assert list(schedule.due(origin)) == [0]
    for i in range(1, 2000):
        stamp = schedule.stamp_ns(i)
        assert abs(stamp - origin - i * NANO / 3) <= 0.51
        assert list(schedule.due(stamp - 1)) == []
        assert list(schedule.due(stamp)) == [i]


def test_schedule_leaves_out_what_a_stall_made_old() -> None:
    schedule = Schedule(10.0, 0.0, 20)
    schedule.begin(0, 0)
    schedule.due(0)
    assert list(schedule.due(2 * NANO)) == list(range(1, 21))
    assert list(schedule.due(102 * NANO)) == list(range(1000, 1021))
    assert schedule.left_out == 1000 - 21


def test_schedule_sees_the_clock_go_back() -> None:
    schedule = Schedule(10.0, 1.0, 20)
    schedule.begin(0, 0)
    schedule.due(5 * NANO)
    assert not schedule.went_back(5 * NANO)
    assert schedule.went_back(5 * NANO - 1)
    schedule.begin(0, 0)
    assert list(schedule.due(0)) == list(range(11))
