"""The recorder under fire: it says what is wrong, what it loses is bounded or counted, what it wrote opens everywhere.

The same scenarios, longer, fill the table of docs/records.md: benchmark/recorder_under_fire.py.
"""

import pytest

from test.system.fire import changes, disks, load
from test.system.fire.killed import kill_many


def mounting(scenario, tmp_path):
    try:
        return scenario(tmp_path)
    except disks.CannotMount as error:
        pytest.skip(f"no file system can be mounted here: {error}")


def test_a_second_recorder_to_the_same_folder_is_refused(tmp_path):
    assert disks.two_recorders(tmp_path)["messages"] > 0


def test_a_read_only_folder_is_refused_in_one_line(tmp_path):
    mounting(disks.read_only_folder, tmp_path)


@pytest.mark.slow
def test_a_full_disk_ends_it_with_a_message_and_a_recording(tmp_path):
    assert mounting(disks.full_disk, tmp_path)["messages"] > 10


@pytest.mark.slow
def test_topics_that_come_late_and_change(tmp_path):
    changes.changing_topics(tmp_path)


@pytest.mark.slow
def test_a_clock_that_jumps_back_begins_an_epoch(tmp_path):
    changes.clock_back(tmp_path)


@pytest.mark.slow
def test_two_hundred_topics(tmp_path):
    load.many_topics(tmp_path, seconds=2.0)


@pytest.mark.slow
def test_a_hundred_megabytes_a_second(tmp_path):
    found = load.heavy(tmp_path, seconds=2.0)
    assert found["recorded"] + found["lost"] + found["before_the_first"] + found["after_the_last"] == found["sent"]


@pytest.mark.slow
def test_killed_at_random_moments(tmp_path):
    deaths = kill_many(tmp_path, 3, seed=11)
    assert any(death.started for death in deaths)
