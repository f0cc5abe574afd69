"""What bad input gets at the command line: exit code 2 and one line that names it, from every program that reads it."""

import json
import subprocess
from pathlib import Path

import pytest

from nw_gear_common import cli
from nw_gear_sim.equilibrium import NoEquilibrium, check_stiffness, find_equilibrium, free_motions
from test.sim.gearboxes import RATED_TORQUE, at_rest, make
from test.system.processes import command, environment

CANT_BE_ASSEMBLED = {
    "planets collide": (
        "gears: {planet_2: {teeth: 110}, sun: {teeth: 13}}",
        "expected planets whose tip diameter is less than the distance",
    ),
    "no working angle": ("centre_distance: {planets: 900 mm}", "no working pressure angle"),
    "planets don't fit": ("gears: {sun: {teeth: 41}}", "so that three equal planets fit"),
    "negative clearance": ("bearings: {sb: {clearance: -1 um}}", "bearings.sb.clearance: expected a number in m >= 0"),
    "negative backlash": ("mesh: {I: {backlash: -1 um}}", "mesh.I.backlash: expected a number in m >= 0"),
    "few segments": ("ring: {segments: 11}", "ring.segments: expected a whole number >= 12 and <= 1000, got 11"),
    "negative mesh stiffness": ("mesh: {II: {stiffness: -9e9 N/m}}", "mesh.II.stiffness: expected a number in N/m"),
    "stiffness that changes its sign": ("mesh: {I: {stiffness_variation: 1.2}}", "stiffness_variation: expected"),
    "negative shaft stiffness": ("shafts: {sun_radial: -1 N/m}", "shafts.sun_radial: expected a number in N/m >= 0"),
    "negative torsion": ("torsion: {sun: -1.5e8 N m/rad}", "torsion.sun: expected a number in N m/rad"),
    "negative damping": ("bearings: {b1: {damping: -1 N s/m}}", "bearings.b1.damping: expected"),
    "bore without gear": ("gears: {sun: {bore_radius: 400 mm}}", "gears.sun.bore_radius: expected less than"),
    "ring without rim": ("ring: {outer_radius: 1.3 m}", "ring.outer_radius: expected more than the root radius"),
    "planet larger than ring": ("gears: {planet_1: {teeth: 91}}", "teeth of the ring in stage I: expected more than"),
    "no number": ("ring: {segments: many}", "ring.segments: expected a whole number"),
    "not finite": ("generator: {stiffness: .inf N m/rad}", "generator.stiffness"),
    "unknown key": ("mesh: {IV: {backlash: 1 um}}", "'IV'"),
}
CANT_REST = {
    "sun on no shaft": ("shafts: {sun_radial: 0 N/m}", "nothing holds the motion h1"),
    "planets free axially": (
        "bearings: {pb1: {contact_angle: 0 deg}, pb2: {contact_angle: 0 deg}}",
        "nothing holds the motion p2",
    ),
    "bearings that push the same way": ("bearings: {pb2: {contact_angle: 12 deg}}", "gives way to"),
    "ring free axially": ("ring: {axial_support: 0 N/m}", "nothing holds the motion ring z"),
    "ring of rubber": ("ring: {elastic_modulus: 1 MPa}", "0.1 m is the most"),
}


@pytest.fixture
def file(tmp_path: Path):
    def write(text: str) -> str:
        path = tmp_path / "bad.yaml"
        path.write_text(text)
        return str(path)

    return write


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """A process of its own; nothing of it may be left."""
    variables = environment()
    return subprocess.run(arguments, capture_output=True, text=True, timeout=120, env=variables, check=False)


def assert_refused(done: subprocess.CompletedProcess[str], words: str) -> None:
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    (line,) = [line for line in done.stderr.splitlines() if "compiling kernels" not in line]  # a notice, once a machine
    assert words in line


@pytest.mark.parametrize("case", CANT_BE_ASSEMBLED)
def test_configurations_that_cant_be_assembled(case: str, file, capsys) -> None:
    """All of them in this process, through the same entry as the command line's."""
    text, words = CANT_BE_ASSEMBLED[case]
    for name in ("equilibrium", "modes"):
        assert cli.main([name, "--config", file(text), "--json"]) == 2
        out, err = capsys.readouterr()
        assert out == ""
        (line,) = err.splitlines()
        assert words in line
        assert "bad.yaml" in line


@pytest.mark.parametrize("case", CANT_REST)
def test_gearboxes_that_cant_rest(case: str, file, capsys) -> None:
    text, words = CANT_REST[case]
    assert cli.main(["equilibrium", "--config", file(text), "--json"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    (line,) = err.splitlines()
    assert words in line


@pytest.mark.parametrize("name", ["equilibrium", "modes"])
@pytest.mark.parametrize("case", ["negative clearance", "planets collide", "few segments"])
def test_refused_by_a_process(name: str, case: str, file) -> None:
    text, words = CANT_BE_ASSEMBLED[case]
    assert_refused(run(*command("nw_gear"), name, "--config", file(text)), words)


def test_a_gearbox_that_cant_rest_is_refused_by_a_process(file) -> None:
    text, words = CANT_REST["sun on no shaft"]
    assert_refused(run(*command("nw_gear"), "modes", "--config", file(text), "--json"), words)


@pytest.mark.parametrize("case", ["no working angle", "sun on no shaft"])
def test_refused_by_the_node(case: str, file) -> None:
    text, words = {**CANT_BE_ASSEMBLED, **CANT_REST}[case]
    path = file(text + "\noperation: {drive: fixed}")
    assert_refused(run(*command("gear_sim_node"), "--ros-args", "-p", f"config:={path}"), words)


def test_a_step_beyond_the_bound_is_refused_by_the_node(file) -> None:
    path = file("numerics: {integrator: rk4, step: 48.828125 us}\noperation: {drive: fixed}")
    done = run(*command("gear_sim_node"), "--ros-args", "-p", f"config:={path}")
    assert_refused(done, "numerics.step")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["equilibrium", "--config", "missing.yaml"], "missing.yaml: expected a YAML file"),
        (["equilibrium", "--load", "much"], "--load: expected a number"),
        (["equilibrium", "--load", "11"], "--load: expected a number >= -10 and <= 10"),
        (["equilibrium", "--speed", "17.3 rpm"], "r/min"),
        (["modes", "--angle", "x"], "--angle: expected a number in rad"),
        (["modes", "--count", "0"], "--count"),
        (["modes", "-o", "/proc/nowhere"], "-o /proc/nowhere: expected a folder that can be made"),
    ],
)
def test_wrong_options(arguments: list[str], words: str, capsys) -> None:
    assert cli.main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    (line,) = err.splitlines()
    assert words in line


def test_an_odd_configuration_is_remarked_on_and_goes_on(file) -> None:
    """91 segments: stage I's mesh frequency; said on standard error and in the object."""
    done = run(*command("nw_gear"), "equilibrium", "--config", file("ring: {segments: 91}"), "--json")
    assert done.returncode == 0
    (line,) = done.stderr.splitlines()
    assert "91 segments pass a planet at the mesh frequency of stage I" in line
    assert json.loads(done.stdout)["remarks"] == [line.removeprefix("nw_gear: ")]


def test_a_stiffness_that_isnt_definite_is_refused() -> None:
    """No configuration gets there (see the bounds above), so the laws are spoilt: a torsion spring of negative rate."""
    gearbox, found = at_rest(("torsion.damping_time", 1e-5))
    check_stiffness(gearbox, found.q)
    springs = gearbox.laws.springs
    k = next(k for k, first in enumerate(springs.first) if first == gearbox.layout.nodes["s"].u)
    for part in (springs.aa, springs.ab, springs.bb):
        part[k] *= -1
    try:
        with pytest.raises(NoEquilibrium, match=r"isn't positive definite: \w+ u would run away"):
            check_stiffness(gearbox, found.q)
    finally:
        for part in (springs.aa, springs.ab, springs.bb):
            part[k] *= -1


def test_free_motions_are_named() -> None:
    gearbox, _ = at_rest()
    assert free_motions(gearbox) == []
    with pytest.raises(NoEquilibrium, match=r"nothing holds the motion h2 x"):
        find_equilibrium(make(("shafts.output_radial", 0.0)), RATED_TORQUE)
    with pytest.raises(NoEquilibrium, match=r"nothing holds .*p[12]_[123] z"):
        find_equilibrium(make(("shafts.planet_axial", 0.0)), RATED_TORQUE)


def test_no_load_is_no_mistake() -> None:
    """Teeth in their gaps are free to move there; that is an equilibrium."""
    found = find_equilibrium(make(), 0.0)
    assert found.residual < 1e-3
