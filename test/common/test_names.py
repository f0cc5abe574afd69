"""The vocabulary of the contract: it agrees with itself."""

import re

import pytest

from nw_gear_common import catalogue, names
from nw_gear_common.launcher import NODES


def test_every_mesh_belongs_to_a_stage():
    assert {m: names.STAGE_OF_MESH[m] for m in ("I_2", "II_3", "III")} == {"I_2": "I", "II_3": "II", "III": "III"}
    assert sum((names.MESHES_OF_STAGE[s] for s in names.STAGES), ()) == names.MESHES


def test_the_waveform_has_time_phases_motions_and_forces():
    columns = names.waveform_columns()
    assert len(columns) == 1 + 3 + 7 + 7 + 2 * 6
    assert columns[:4] == ("time", "phase_I", "phase_II", "phase_III")
    assert columns[4:6] == ("x_I_1", "x_I_2")
    assert columns[-2:] == ("fx_b22", "fy_b22")
    assert len(set(columns)) == len(columns)


def test_topics_are_valid_ros_names():
    for topic in catalogue.TOPICS:
        for name in catalogue.resolved(topic):
            assert re.fullmatch(r"(/[A-Za-z][A-Za-z0-9_]*)+", name), name


def test_placeholders_stand_for_every_member():
    resolved = {topic.name: catalogue.resolved(topic) for topic in catalogue.TOPICS}
    assert len(resolved["bearings/<b>"]) == len(names.BEARINGS)
    assert len(resolved["indicators/<mesh>"]) == len(names.MESHES)
    assert resolved["section/<stage>"][-1] == "/nw_gear/section/III"
    assert resolved["/clock"] == ("/clock",)


def test_every_executable_is_described():
    assert set(catalogue.EXECUTABLES) == {*NODES, "nw_gear"}


@pytest.mark.parametrize("label", ["period-1", "period-16", "chaotic", "unknown"])
def test_states_are_those_of_the_contract(label):
    assert label in names.STATES
    assert len(names.STATES) == 16 + 5
