"""`nw_gear study superharmonic` and `claims`: what other programs read, and what is refused."""

import csv
import json

import numpy as np
import pytest

from nw_gear_common import cli
from nw_gear_sim.superharmonic.firstorder import branches, coefficients
from nw_gear_sim.superharmonic.pair import gear_pair
from test.monitor.browser import look


@pytest.fixture
def run(monkeypatch, capsys):
    monkeypatch.setattr(cli.signal, "signal", lambda *_: None)

    def call(*arguments, code=0):
        assert cli.main(["study", *arguments]) == code
        return capsys.readouterr()

    return call


def test_points_as_the_contract_says(run):
    found = json.loads(
        run("superharmonic", "--stage", "I", "--zeta", "0.04", "--omega", "0.158:0.164:61", "--json").out
    )
    assert {"stage", "mode", "trust", "points", "folds"} <= set(found)
    assert (found["stage"], found["mode"]) == ("I", "corrected")
    pair = gear_pair("I").having(zeta=0.04)
    c = coefficients(pair, 0.164)
    assert found["trust"] == pytest.approx(pair.eps * 3 * pair.q * float(c.forced) ** 2 / pair.w0 / 0.005, rel=1e-12)
    for point in found["points"]:
        c = coefficients(pair, point["omega"])
        square = point["alpha"] ** 2
        assert square * (c.mu**2 + (c.shift - c.bend * square) ** 2) == pytest.approx(float(c.drive) ** 2, rel=1e-9)
    between = [point for point in found["points"] if found["folds"][0] < point["omega"] < found["folds"][1]]
    assert len(found["folds"]) == 2
    assert len(between) % 3 == 0
    assert sum(not point["stable"] for point in between) == len(between) // 3


def test_single_frequencies_may_be_repeated(run):
    found = json.loads(run("superharmonic", "--omega", "0.33", "--omega", "0.329", "--g-d", "-0.2", "--json").out)
    assert sorted({point["omega"] for point in found["points"]}) == [0.329, 0.33]


def test_curves_over_a_parameter_and_the_table(run, tmp_path):
    file = tmp_path / "curves.csv"
    out = run("superharmonic", "--stage", "I", "--over", "g_d=-0.4:0.4:201", "--omega", "0.1598", "-o", str(file)).out
    assert "omega = 0.1598" in out
    rows = list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))
    expected = branches(gear_pair("I"), "g_d", np.linspace(-0.4, 0.4, 201), omega=0.1598)
    alphas = expected.alpha[np.isfinite(expected.alpha)]
    assert [float(row["alpha"]) for row in rows] == alphas.tolist()


def test_a_family_with_the_delay_equation_beside_it(run, tmp_path):
    file = tmp_path / "curves.html"
    arguments = ("--stage", "II", "--family", "zeta=0.04,0.08", "--exact", "-o", str(file), "--json")
    found = json.loads(run("superharmonic", *arguments).out)
    assert [curve["name"] for curve in found["curves"]] == ["zeta = 0.04", "zeta = 0.08"]
    for curve in found["curves"]:
        first = max(point["alpha"] for point in curve["points"])
        exact = max(point["alpha"] for point in curve["exact"])
        assert exact == pytest.approx(first, rel=0.06)  # eps = 0.01
    seen, console = look(file, tmp_path)
    assert seen["loads"] == []
    assert max(figure["colours"] for figure in seen["figures"]) > 20
    assert console == []


def test_claims_as_the_contract_says(run):
    found = json.loads(run("claims", "--json").out)
    for mode, held in (("corrected", 107), ("paper_eq75", 93)):
        rows = found[mode]["rows"]
        assert (found[mode]["held"], found[mode]["total"]) == (held, 131)
        assert sum(row["holds"] is True for row in rows) == held
        assert {row["holds"] for row in rows} == {True, False, "contradicts"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["superharmonic", "--stage", "IV"], "stage: expected one of I, II, III"),
        (["superharmonic", "--omega", "1:2"], "START:STOP:COUNT"),
        (["superharmonic", "--omega", "0.3:0.2:5"], "STOP above START"),
        (["superharmonic", "--omega", "0.2:0.3:1"], "COUNT"),
        (["superharmonic", "--omega", "nan"], "finite"),
        (["superharmonic", "--omega", "0.3", "--over", "mass=0:1:5"], "one of zeta"),
        (["superharmonic", "--over", "zeta=0:1:5"], "--omega"),
        (["superharmonic", "--family", "zeta"], "NAME="),
        (["superharmonic", "--exact", "--omega", "0.33"], "a range"),
        (["superharmonic", "--mode", "paper"], "corrected or paper_eq75"),
        (["superharmonic", "-o", "curve.png"], ".html, .csv, .parquet"),
        (["superharmonic", "-o", "/nowhere/curve.csv"], "room for the results"),
        (["claims", "--section", "7"], "--section"),
    ],
)
def test_refusals(run, arguments, words):
    said = run(*arguments, code=2).err
    assert said.startswith("nw_gear: ")
    assert said.count("\n") == 1
    assert words in said
