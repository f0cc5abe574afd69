"""Descriptions of machines: what follows from them, and what is wrong with them, named by file, line and key."""

import math

import numpy as np
import pytest

from nw_gear_common import names, share
from nw_gear_common.errors import InputError
from nw_gear_monitor.machinefile.read import load, parse
from nw_gear_monitor.signals.stream import Second
from test.monitor.gear_signal import paper

TWO_STAGES = """
name: bevel and helical
reference: {shaft: motor, phase: p, speed: 1500 r/min}
stages:
  - {name: slow, driver: {shaft: middle, teeth: 19}, driven: {shaft: out, teeth: 57}}
  - {name: fast, driver: {shaft: motor, teeth: 25}, driven: {shaft: middle, teeth: 75}}
channels:
  - {name: a, stage: fast, column: acc_1, unit: m/s^2}
  - {name: b, stage: slow, column: acc_2, unit: m/s^2, velocity: jerk_2}
bearings:
  - {name: c, shaft: out, columns: [acc_3, acc_4], unit: m/s^2, rollers: 12, cage_factor: 0.42}
"""


def test_speeds_follow_from_the_teeth_in_any_order():
    machine = parse(TWO_STAGES, "two.yaml")
    assert machine.stage_names == ("slow", "fast")
    assert machine.rated_frequency == pytest.approx([25.0 / 3.0 * 19.0, 25.0 * 25.0])
    assert {s.name: s.teeth * 1.0 for s in machine.shafts} == {"motor": 25.0, "middle": 19.0, "out": 57.0}
    out = machine.shaft("out")
    assert machine.stage(out.stage).frequency / out.teeth == pytest.approx(25.0 / 9.0)
    assert machine.bearings[0].orders.outer == pytest.approx(12 * 0.42)
    assert machine.derived == {"v_a": "x_a"}
    assert machine.layout.phases == ("p",)
    assert machine.layout.cycles == pytest.approx((25.0,))  # the faster mesh
    assert machine.layout.values == ("acc_1", "acc_2", "jerk_2", "acc_3", "acc_4")


def test_a_planetary_stage_with_a_turning_carrier_is_given_by_its_cycles():
    text = """
name: planetary
reference: {shaft: carrier, phase: p, speed: 10 r/min}
stages: [{name: P, cycles: 96, driven: {shaft: sun, teeth: 24}}]
channels: [{name: a, stage: P, column: x, unit: m, planet: 2, planet_phase: 120 deg}]
shafts: [{name: generator, ratio: 101.5}]
"""
    machine = parse(text, "planetary.yaml")
    assert machine.rated_frequency == pytest.approx([16.0])
    assert machine.stages[0].teeth is None
    assert machine.channels[0].planet_phase == pytest.approx(2.0 * math.pi / 3.0)
    generator = machine.shaft("generator")
    assert 16.0 / generator.teeth == pytest.approx(101.5 / 6.0)


def test_the_example_is_a_6205_bearing_on_a_pair():
    machine = load(share.find("config/machine_example.yaml"))
    orders = machine.bearings[0].orders
    # SKF's catalogue, from memory: 3.585, 5.415, 0.3983, 2.357
    assert (orders.outer, orders.inner, orders.cage, orders.roller) == pytest.approx(
        (3.585, 5.415, 0.398, 2.357), abs=1e-3
    )
    assert machine.rated_frequency == pytest.approx([100.0])
    assert machine.line_frequency == pytest.approx([100.0, 5.0, 5.0 / 3.0])


def test_the_built_in_gearbox_has_its_numbers_of_teeth_and_rollers():
    machine = paper()
    assert machine.stage_names == names.STAGES
    assert machine.channel_names == names.MESHES
    assert [stage.strobes for stage in machine.stages] == [16, 4, 2]
    assert machine.layout.chosen(names.waveform_columns()) == names.waveform_columns()
    rates = {s.name: machine.stage(s.stage).frequency / s.teeth for s in machine.shafts}
    assert [rates[name] for name in names.SHAFTS] == pytest.approx([0.288, 1.193, 2.475, 16.21], rel=2e-3)  # Hz
    assert [b.name for b in machine.bearings] == list(names.BEARINGS)
    assert all(b.orders.outer == pytest.approx(b.rollers * b.orders.cage) for b in machine.bearings)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("speed: 1500 r/min", "speed: 1500", "line 3: reference.speed: expected a number with its unit"),
        ("speed: 1500 r/min", "speed: -3 r/min", "line 3: reference.speed"),
        ("teeth: 25", "teeth: 25.5", "line 6: stages[1].driver.teeth: expected a whole number"),
        ("teeth: 25", "tooth: 25", "nearest: 'teeth'"),
        ("shaft: middle, teeth: 75", "shaft: idler, teeth: 75", "line 5: stages[0]: expected teeth on a shaft whose"),
        ("stage: fast", "stage: faster", "line 8: channels[0].stage: expected one of slow, fast, got faster"),
        ("{name: b, stage: slow", "{name: a, stage: slow", "line 9: channels[1]: expected different names"),
        ("{name: c, shaft", "{name: a, shaft", "line 11: bearings[0]: expected different names"),
        ("shaft: out, columns", "shaft: outer, columns", "line 11: bearings[0].shaft"),
        ("name: fast", "name: 2nd", "line 6: stages[1].name: expected a name of letters"),
        ("column: acc_1", "column: time", "line 8: channels[0].column"),
        ("column: acc_1, unit", "unit", "line 8: channels[0]: expected a value for column"),
        ("cage_factor: 0.42", "cage_factor: 1.42", "line 11: bearings[0].cage_factor"),
        ("rollers: 12, cage_factor: 0.42", "rollers: 12", "line 11: bearings[0].orders"),
        ("cage_factor: 0.42", "cage_factor: 0.42, outer: 3", "outer too"),
        ("[acc_3, acc_4]", "[acc_3, acc_4, acc_5]", "expected one or two columns, got 3"),
        ("[acc_3, acc_4]", "acc_3", "expected a list"),
        ("b, stage: slow, column: acc_2, unit: m/s^2", "b, stage: fast, column: acc_2, unit: m", "all in one unit"),
        ("name: bevel and helical", "title: x", "line 2: expected one of name"),
        ("name: bevel and helical\n", "", "two.yaml: expected a value for name, got none"),
        ("bearings:", "bearings: 3\nfoo:", "two.yaml, line"),
        ("TWO", "TWO", None),
    ],
)
def test_what_is_wrong_is_named(old, new, said):
    text = TWO_STAGES.replace(old, new)
    if said is None:
        assert parse(text, "two.yaml").name == "bevel and helical"
        return
    assert text != TWO_STAGES
    with pytest.raises(InputError) as caught:
        parse(text, "two.yaml")
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith("two.yaml")
    assert said in str(caught.value)


def test_two_ways_to_one_speed_must_agree():
    text = TWO_STAGES + "shafts: [{name: out, ratio: 0.112}]\n"
    with pytest.raises(InputError, match="times the speed of the reference"):
        parse(text, "two.yaml")
    assert parse(TWO_STAGES + f"shafts: [{{name: out, ratio: {1 / 9!r}}}]\n", "two.yaml")


def test_columns_inside_have_their_own_names_and_mesh_phases():
    machine = parse(TWO_STAGES, "two.yaml")

    columns = ("jerk_2", "acc_4", "acc_3", "p", "time", "acc_2", "acc_1", "else")
    data = np.arange(24.0).reshape(3, 8)
    inside = machine.inside(Second(0, 0, 100.0, columns, data))
    expected = ("time", "phase_slow", "phase_fast", "x_a", "x_b", "v_b", "fx_c", "fy_c")
    assert inside.columns == expected
    assert np.array_equal(inside.column("phase_slow"), data[:, 3] * 25.0 / 75.0 * 19.0)
    assert np.array_equal(inside.column("phase_fast"), data[:, 3] * 25.0)
    sources = {"x_a": 6, "x_b": 5, "v_b": 0, "fx_c": 2, "fy_c": 1}
    assert all(np.array_equal(inside.column(name), data[:, i]) for name, i in sources.items())
