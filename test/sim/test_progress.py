"""What a run says about itself."""

import pytest

from nw_gear_sim.nodes.pacing import Pace
from nw_gear_sim.nodes.progress import Progress, Silence


def said(progress: Progress, wall: float, simulated: float, **flags: bool) -> tuple[bool, str]:
    given = {"paused": False, "starved": False, **flags}
    return progress.report(Pace(1.0, wall, simulated), wall, simulated, **given)


def test_a_run_that_goes_on() -> None:
    progress = Progress("wind_speed", waits=True)
    assert said(progress, 1.0, 1.0) == (False, "integrating")
    assert said(progress, 2.0, 1.0, paused=True) == (False, "paused")


def test_waiting_is_told_once_nothing_has_moved_since_the_last_report() -> None:
    """In lock step a run waits for a moment at every report, too."""
    progress = Progress("drive", waits=True)
    assert said(progress, 1.0, 1.0, starved=True) == (False, "integrating")
    assert said(progress, 2.0, 2.0, starved=True) == (False, "integrating")
    assert said(progress, 3.0, 2.0, starved=True) == (True, "waiting for drive beyond 2.000 s")
    assert said(progress, 4.0, 2.5) == (False, "integrating")


def test_a_slow_machine() -> None:
    pace = Pace(2.0, 0.0, 0.0)
    pace.note(4.0, 2.0)
    found = Progress("", waits=False).report(pace, 4.0, 2.0, paused=False, starved=False)
    assert found == (True, "can't keep pace: 0.50 times real time reached, 2 wanted")


def test_in_wall_time_the_last_value_holds_but_not_in_silence() -> None:
    progress = Progress("drive", waits=False)
    assert said(progress, 100.0, 1.0) == (False, "integrating")
    progress.heard(100.0)
    progress.heard(100.1)
    assert said(progress, 104.0, 2.0) == (False, "integrating")
    assert said(progress, 107.1, 3.0) == (True, "nothing on drive for 7 s: its last value holds")
    progress.heard(108.0)
    assert said(progress, 108.0, 4.0) == (False, "integrating")


@pytest.mark.parametrize(("interval", "longest"), [(0.1, 5.0), (10.0, 30.0)])
def test_silence_is_measured_by_the_interval(interval: float, longest: float) -> None:
    silence = Silence()
    assert silence.length(1e9) == 0.0
    for k in range(3):
        silence.heard(k * interval)
    last = 2 * interval
    assert silence.length(last + 0.99 * longest) == 0.0
    assert silence.length(last + 1.01 * longest) == pytest.approx(1.01 * longest)
