"""Configuration files: completeness, units, presets, round trips, and what bad files get."""

import math
from collections.abc import Sequence
from dataclasses import FrozenInstanceError
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from nw_gear_common import names, share
from nw_gear_common.errors import InputError
from nw_gear_common.quantities import optional
from nw_gear_sim import config, configfile
from nw_gear_sim.params import Configuration

BASE = share.find("config/gearbox.yaml")
CONFIGURATION = config.load()
RPM = 2 * math.pi / 60


def written(folder: Path, text: str | bytes) -> Path:
    path = folder / "mine.yaml"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def row(section: str, field: str, values: Sequence[float]) -> dict[str, float]:
    """Keys and values of a row of the paper's Table 2; one value for each gear or each stage."""
    columns = GEARS if section == "gears" else names.STAGES
    return {f"{section}.{column}.{field}": number for column, number in zip(columns, values, strict=True)}


GEARS = ("ring", "planet_1", "planet_2", "sun", "herringbone_1", "herringbone_2")
PAPER = {  # its Tables 1 and 2, Eqs 1 and 8
    "turbine.rated_wind": 11.5,
    "turbine.cut_out_wind": 25,
    "turbine.blade_diameter": 171,
    "turbine.rated_torque": 4.3e6,
    "turbine.rated_speed": 17.3 * RPM,
    "wind.weibull_shape": 5.0,
    "wind.weibull_scale": 11.5,
    **row("gears", "teeth", (91, 22, 83, 40, 131, 20)),
    **row("gears", "mass", (5690, 950, 2320, 440, 5369, 125)),
    **row("toothing", "normal_module", (0.028, 0.016, 0.010)),
    **row("toothing", "pressure_angle", (math.radians(20), math.radians(20), math.radians(15))),
    **row("toothing", "helix_angle", (math.radians(4), math.radians(7.2), math.radians(32))),
    **row("toothing", "face_width", (0.56, 0.41, 0.365)),
    **row("mesh", "backlash", (55e-6, 45e-6, 50e-6)),
    "friction.base": 0.05,
    "friction.decay": 0.125,
    "friction.growth": 0.002,
}


def value(configuration: Configuration, key: str) -> object:
    found: object = configuration
    for name in key.split("."):
        found = getattr(found, name)
    return found


@pytest.mark.parametrize("key", PAPER)
def test_the_paper_s_tables(key: str) -> None:
    assert value(CONFIGURATION, key) == pytest.approx(PAPER[key], rel=1e-15)


def test_every_value_has_its_source_and_every_number_its_unit() -> None:
    """Read by another route: PyYAML's own loader, key by key."""
    tree = yaml.safe_load(BASE.read_text(encoding="utf-8"))
    for key, leaf in configfile.leaves().items():
        node = tree
        for name in key.split("."):
            node = node[name]
        assert len(node["source"]) >= len("guess"), key
        assert ("unit" in node) == bool(leaf.description.unit), key


def test_numbers_are_correctly_rounded() -> None:
    assert CONFIGURATION.mesh.I.error_amplitude == 13.3e-6
    assert CONFIGURATION.gears.planet_1.bore_radius == 0.1629
    assert CONFIGURATION.numerics.time_step == 1 / 20480
    assert CONFIGURATION.bearings.exponent == 10 / 9


def test_frozen() -> None:
    with pytest.raises(FrozenInstanceError):
        CONFIGURATION.mesh.I.backlash = 1.0  # type: ignore[misc]


PRESETS = {
    "rated": (1.0, 17.3, (13.3, 6.4, 5.3), (None, None, None)),
    "rattling": (0.05, 17.3, (45, 45, 45), (None, None, None)),
    "period2": (0.20, 16.4, (13, 67, 5.3), (None, None, None)),
    "period4": (0.1, 30.1, (0.5, 23.0, 0.5), (0.02, 0.1, 0.0094)),
}


@pytest.mark.parametrize("name", names.PRESETS)
def test_presets(name: str) -> None:
    load, rpm, errors, variations = PRESETS[name]
    preset = config.load(name)
    meshes = [getattr(preset.mesh, stage) for stage in names.STAGES]
    assert preset.operation.drive == "fixed"
    assert preset.operation.load == load
    assert preset.operation.ring_speed == pytest.approx(rpm * RPM, rel=1e-15)
    assert [mesh.error_amplitude for mesh in meshes] == pytest.approx([e * 1e-6 for e in errors], rel=1e-15)
    assert tuple(mesh.stiffness_variation for mesh in meshes) == variations
    assert preset.bearings == CONFIGURATION.bearings


def test_a_preset_is_found_by_its_path_too() -> None:
    assert config.load(share.find("config/period2.yaml")) == config.load("period2")
    assert config.load("") == CONFIGURATION


def test_round_trip_of_all_presets(tmp_path: Path) -> None:
    for name in names.PRESETS:
        preset = config.load(name)
        text = config.to_yaml(preset)
        assert config.from_yaml(text) == preset
        assert config.load(written(tmp_path, text)) == preset


NUMBERS = {key: leaf for key, leaf in configfile.leaves().items() if optional(leaf.kind)[0] is float}
FREE = sorted(key for key in NUMBERS if key.startswith(("mesh.", "bearings.", "shafts.", "friction.", "wind.")))


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_round_trip_of_any_values(data: st.DataObject) -> None:
    key = data.draw(st.sampled_from(FREE))
    limits = NUMBERS[key].description
    number = data.draw(st.floats(limits.minimum, limits.maximum))
    configuration = config.with_values({key: number}, CONFIGURATION)
    assert value(configuration, key) == number
    assert config.from_yaml(config.to_yaml(configuration)) == configuration


@pytest.mark.parametrize(("text", "key", "expected"), [
    ("mesh: {I: {backlash: 45 um}}", "mesh.I.backlash", 45e-6),
    ("mesh: {I: {backlash: 0.045mm}}", "mesh.I.backlash", 45e-6),
    ("mesh: {I: {backlash: {value: 4.5e-5, unit: m}}}", "mesh.I.backlash", 45e-6),
    ("mesh: {I: {backlash: 1e1 um}}", "mesh.I.backlash", 1e-5),
    ("mesh: {I: {damping_ratio: 3 %}}", "mesh.I.damping_ratio", 0.03),
    ("mesh: {I: {damping_ratio: 5e-2}}", "mesh.I.damping_ratio", 0.05),
    ("mesh: {I: {error_mean: -2 um}}", "mesh.I.error_mean", -2e-6),
    ("operation: {ring_speed: 60 r/min}", "operation.ring_speed", 2 * math.pi),
    ("gravity: {direction: -45 deg}", "gravity.direction", -math.pi / 4),
    ("ring: {elastic_modulus: 210 GPa}", "ring.elastic_modulus", 210e9),
    ("friction: {enabled: false}", "friction.enabled", False),
    ("mesh: {II: {stiffness: 9 kN/mm}}", "mesh.II.stiffness", 9e6),
    ("mesh: {II: {stiffness: null}}", "mesh.II.stiffness", None),
    ("excitation: {omega_e: 0.17}", "excitation.omega_e", 0.17),
    ("# nothing at all\n", "excitation.omega_e", None),
])  # fmt: skip
def test_forms_of_a_value(tmp_path: Path, text: str, key: str, expected: object) -> None:
    found = value(config.load(written(tmp_path, text)), key)
    assert found == (pytest.approx(expected, rel=1e-15) if type(expected) is float else expected)


BAD = {
    "mesh: {I: {backlsh: 45 um}}": ("line 1: mesh.I", "nearest: 'backlash'", "got 'backlsh'"),
    "\nmeshes: 3": ("line 2", "nearest: 'mesh'", "got 'meshes'"),
    "zzz: 3": ("line 1", "one of gears, toothing", "got 'zzz'"),
    "mesh: {I: {backlash: 45}}": ("mesh.I.backlash", "a number with its unit (m, cm, mm, um)", "45 without unit"),
    "mesh: {I: {backlash: 45 s}}": ("mesh.I.backlash", "a number in m, cm, mm, um", "45.0 s"),
    "mesh: {I: {backlash: 45 m}}": ("mesh.I.backlash", "a number in m >= 0 and <= 0.01", "45"),
    "mesh: {I: {backlash: 45 mm}}": ("mesh.I.backlash", "<= 0.01", "45.0 mm"),
    "mesh: {I: {backlash: -1 um}}": ("mesh.I.backlash", ">= 0", "-1.0 um"),
    "mesh: {I: {backlash: {value: 45, unit: kg}}}": ("mesh.I.backlash", "a number in m, cm, mm, um", "45 kg"),
    "mesh: {I: {backlash: {unit: um}}}": ("mesh.I.backlash", "a value", "none"),
    "mesh: {I: {backlash: {value: 45, units: um}}}": ("mesh.I.backlash", "nearest: 'unit'", "'units'"),
    "mesh: {I: {backlash: [45, um]}}": ("mesh.I.backlash", "one value", "a list"),
    "mesh: {I: {backlash: wide}}": ("mesh.I.backlash", "a number in m", "'wide'"),
    "mesh: {I: {backlash: }}": ("mesh.I.backlash", "a number in m", "None"),
    "mesh: {I: {damping_ratio: 5 um}}": ("mesh.I.damping_ratio", "a number without unit", "5.0 um"),
    "mesh: {I: {damping_ratio: .nan}}": ("mesh.I.damping_ratio", "a number", "nan"),
    "mesh: {I: {damping_ratio: .inf}}": ("mesh.I.damping_ratio", "a number", "inf"),
    "mesh: {I: {damping_ratio: 1" + 400 * "0" + "}}": ("mesh.I.damping_ratio", "a number", "inf"),
    "mesh: {I: {damping_ratio: !!int five}}": ("mesh.I.damping_ratio", "one value", "'five'"),
    "mesh: {I: {damping_ratio: !!python/object:os.system ls}}": ("line 1", "a YAML document", "constructor"),
    "gears: {ring: {teeth: 91.5}}": ("gears.ring.teeth", "a whole number", "91.5"),
    "gears: {ring: {teeth: true}}": ("gears.ring.teeth", "a whole number", "True"),
    "gears: {ring: {teeth: 1" + 400 * "0" + "}}": ("gears.ring.teeth", "a whole number", "1000"),
    "ring: {segments: 11}": ("ring.segments", "a whole number >= 12", "11"),
    "friction: {enabled: 1}": ("friction.enabled", "true or false", "1"),
    "operation: {drive: water}": ("operation.drive", "one of wind, fixed", "'water'"),
    "operation: fixed": ("operation", "a mapping", "'fixed'"),
    "operation:": ("operation", "a mapping", "nothing"),
    "- 1\n- 2": ("line 1", "a mapping", "a list"),
    "ring:\n  segments: 50\n  segments: 60": ("line 3: ring.segments", "each key once", "it twice"),
    "ring: {segments: 50": ("line 1", "a YAML document", "expected"),
    "ring:\n\tsegments: 50": ("line 2", "a YAML document", "cannot start any token"),
    "a: 1\n---\nb: 2": ("line 2", "a YAML document", "another document"),
    "[" * 5000: ("mine.yaml", "a YAML document", ""),
    "? [1, 2]\n: 3": ("line 1", "a plain key", "a list"),
    "turbine: {cut_in_wind: 12 m/s}": ("turbine", "cut_in_wind < rated_wind < cut_out_wind", "12, 11.5, 25"),
    "centre_distance: {planets: 800 mm}": ("centre distance of stage I", "more than", "0.8 m"),
    b"\xff\xfe\x00": ("mine.yaml", "a readable YAML file", "UTF-8"),
}


@pytest.mark.parametrize("text", BAD, ids=lambda text: str(text[:40]))
def test_bad_files(tmp_path: Path, text: str | bytes) -> None:
    place, expected, got = BAD[text]
    path = written(tmp_path, text)
    with pytest.raises(InputError) as caught:
        config.load(path)
    assert str(path) in caught.value.place
    assert place in caught.value.place
    assert expected in str(caught.value)
    assert got in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"rate: expected a YAML file or one of the presets rated, .* got no such file"
    ):
        config.load("rate")
    with pytest.raises(InputError, match="got a folder"):
        config.load(tmp_path)


def test_base_without_a_key(tmp_path: Path) -> None:
    lines = BASE.read_text(encoding="utf-8").splitlines()
    base = written(tmp_path, "\n".join(line for line in lines if "rated_wind" not in line))
    with pytest.raises(InputError, match=r"mine.yaml: expected a value for turbine.rated_wind, got none"):
        config.load(base=base)
    with pytest.raises(InputError, match=r"and .* more keys"):
        config.from_yaml("ring: {segments: 50}")


def test_base_without_a_source(tmp_path: Path) -> None:
    text = BASE.read_text(encoding="utf-8").replace('{value: 25, unit: m/s, source: "paper Table 1"}', "25 m/s")
    with pytest.raises(InputError, match=r"turbine.cut_out_wind: expected a source"):
        config.load(base=written(tmp_path, text))


def test_with_values_refuses() -> None:
    with pytest.raises(InputError, match=r"nearest: 'mesh.I.backlash'"):
        config.with_values({"mesh.I.backlsh": 45e-6}, CONFIGURATION)
    with pytest.raises(InputError, match=r"mesh.I.backlash: expected a number in m"):
        config.with_values({"mesh.I.backlash": "45 um"}, CONFIGURATION)


def test_with_values_keeps_the_rest() -> None:
    changed = config.with_values({"mesh.I.backlash": 45e-6, "ring.segments": 24}, CONFIGURATION)
    assert changed.ring.segments == 24
    assert config.with_values({"mesh.I.backlash": 55e-6, "ring.segments": 100}, changed) == CONFIGURATION


@pytest.mark.parametrize(("stage", "diameter", "module", "grade"), [
    ("I", 91 * 28 / math.cos(math.radians(4)), 28, 6),
    ("II", 83 * 16 / math.cos(math.radians(7.2)), 16, 5),
    ("III", 131 * 10 / math.cos(math.radians(32)), 10, 5),
])  # fmt: skip
def test_transmission_error_is_half_the_pitch_deviation(stage: str, diameter: float, module: float, grade: int) -> None:
    """f_pT = (0.001 d + 0.4 m_n + 5) sqrt(2)^(A - 5) um (ISO 1328-1:2013) of the stage's larger gear; d, m_n in mm."""
    deviation = (0.001 * diameter + 0.4 * module + 5) * math.sqrt(2) ** (grade - 5)
    amplitude = getattr(CONFIGURATION.mesh, stage).error_amplitude
    assert amplitude * 1e6 == pytest.approx(deviation / 2, abs=0.06)
