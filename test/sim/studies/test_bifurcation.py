"""Bifurcation studies: periods of known sections, exponents against modes, folders that go on where they stopped."""

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

from nw_gear_common import cli
from nw_gear_sim.batch.batch import Batch
from nw_gear_sim.config import load
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.linear import find_shapes, linearise
from nw_gear_sim.studies.bifurcation import label, period_of
from nw_gear_sim.studies.exponents import largest_exponents

k = np.arange(200)


@pytest.mark.parametrize(
    ("x", "period"),
    [
        (np.zeros(200), 1),
        (0.3 * np.cos(np.pi * k), 2),
        (0.3 * np.cos(2 * np.pi * k / 3), 3),
        (0.3 * np.cos(2 * np.pi * k / 16), 16),
        (0.3 * np.cos(np.pi * k) + 0.05 * np.cos(2 * np.pi * 0.3819 * k), 2),  # with a line of the rollers
        (0.3 * np.cos(2 * np.pi * 0.3819 * k), 1),  # a line of its own frequency is no subharmonic
        (0.3 * np.cos(2 * np.pi * (34 / 9 - 0.0044) * k), 1),  # nor is one that is only close to a fraction
        (np.zeros(20), 0),
    ],
)
def test_period_of_a_section(x, period):
    assert period_of(x + 5.0, np.roll(x, 1), (1.0, 1.0)) == period


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ((2, -5.0, 1.0, np.nan), "period-2"),
        ((2, 5.0, 1.0, np.nan), "chaotic"),
        ((1, 2.0, 1.0, np.nan), "unknown"),
        ((0, -5.0, 1.0, np.nan), "unknown"),
        ((1, np.nan, np.nan, np.nan), "unknown"),
        ((1, -5.0, 1.0, 0.3), "diverged"),
    ],
)
def test_labels(numbers, words):
    assert label(*numbers) == words


@pytest.mark.slow
def test_exponents_of_the_gearbox():
    """Regular motion: twins approach each other as the least damped mode decays. Rattling: they part."""
    points = [load("rated"), load("rattling")]
    gearbox = Gearbox(points[0])
    speed, torque = gearbox.kinematics.ring_speed, gearbox.kinematics.input_torque
    _, shapes = find_shapes(linearise(gearbox, find_equilibrium(gearbox, torque, speed=speed).q))
    slowest = -float(np.max(shapes.eigenvalues.real))
    batch = Batch(points, step=1 / 20480, excitation="kinematic", ring="flexible")
    batch.advance(5.0)
    found = largest_exponents(
        points, batch.end(), excitation="kinematic", ring="flexible", step=1 / 20480, interval=0.25, intervals=40
    )
    assert found.rate[0] == pytest.approx(-slowest, abs=3.0 * found.error[0])
    assert found.error[0] < 0.7
    assert found.rate[1] > 10.0


@pytest.fixture
def run(monkeypatch, capsys):
    monkeypatch.setattr(cli.signal, "signal", lambda *_: None)

    def call(*arguments, code=0):
        assert cli.main(["study", "bifurcation", *arguments]) == code
        return capsys.readouterr()

    return call


SHORT = ["--transient", "20", "--record", "40", "--exponent-periods", "0", "--excitation", "kinematic"]


@pytest.mark.slow
def test_a_study_is_written_and_goes_on(run, tmp_path: Path):
    arguments = ["--over", "operation.load=0.05:1:2", *SHORT, "-o", str(tmp_path / "study"), "--workers", "1", "--json"]
    first = run(*arguments)
    found = json.loads(first.out)
    assert "1 of 1 pieces" in first.err
    assert found["axes"] == ["operation.load"]
    assert [(row["operation.load"], row["mesh"]) for row in found["rows"]][7] == (1.0, "I_1")
    loads = {row["operation.load"]: row for row in found["rows"] if row["mesh"] == "II_1"}
    assert loads[0.05]["deviation"] != loads[1.0]["deviation"]
    assert "s of a worker per point, 1 worker" in first.err
    table = pyarrow.parquet.read_table(tmp_path / "study" / "points.parquet")
    assert table["deviation"].to_pylist() == [row["deviation"] for row in found["rows"]]
    points = pyarrow.parquet.read_table(tmp_path / "study" / "sections.parquet").to_pylist()
    piece = np.load(tmp_path / "study" / "pieces" / "points-000000.npz")
    mine = [p["x_m"] for p in points if p["operation.load"] == 1.0 and p["mesh"] == "II_1"]
    assert mine == piece["x"][1, 3][: len(mine)].tolist()
    assert np.isnan(piece["x"][1, 3][len(mine) :]).all()
    kept = tmp_path / "study" / "pieces" / "points-000000.npz"
    before = kept.stat().st_mtime_ns
    assert json.loads(run(*arguments).out)["rows"] == found["rows"]
    assert kept.stat().st_mtime_ns == before
    other = run("--over", "operation.load=0.05:1:3", *arguments[2:], code=2).err
    assert "axes" in other
    assert other.count("\n") == 1


@pytest.mark.slow
def test_a_sweep_carries_the_state(run, tmp_path: Path):
    """The first point of the upward sweep begins at rest, the same point of the downward one where another ended."""
    arguments = ["--over", "operation.load=0.3:0.31:2", *SHORT, "--sweep", "-o", str(tmp_path / "sweep"), "--json"]
    rows = json.loads(run(*arguments).out)["rows"]
    assert {(row["sweep"], row["operation.load"]) for row in rows} == {
        (sweep, load) for sweep in ("up", "down") for load in (0.3, 0.31)
    }
    with np.load(tmp_path / "sweep" / "pieces" / "sweep-000001.npz") as archive:
        ended = archive["end.angle"]
    with np.load(tmp_path / "sweep" / "pieces" / "sweep-000000.npz") as archive:
        began = archive["end.angle"]
    turned = (ended - began) % (2 * np.pi)
    speed = load("rated").turbine.rated_speed
    period = 2 * np.pi / (speed * 83 * 91 / 22)  # of stage II
    assert turned == pytest.approx(speed * 60 * period, abs=1e-3)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--over", "operation.mass=0:1:5"], "operation.mass"),
        (["--over", "operation.load=5:1:5"], "STOP above START"),
        (["--over", "operation.load"], "NAME="),
        (["--over", "operation.load=0:1:3", "--record", "10"], "--record"),
        (["--over", "operation.load=0:1:3", "--ring", "soft"], "flexible or rigid"),
        (["--over", "operation.load=0:1:3", "--over", "operation.load=0:1:3", "--sweep"], "one axis"),
    ],
)
def test_refusals(run, tmp_path, arguments, words):
    said = run(*arguments, "-o", str(tmp_path / "study"), code=2).err
    assert words in said
    assert said.count("\n") == 1
