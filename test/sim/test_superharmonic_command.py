"""`nw_gear study superharmonic` and `claims`: what other programs read, and what is refused."""

import csv
import json

import numpy as np
import pytest
from pyarrow import parquet

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


def test_jumps_of_the_papers_figures(run):
    """Fig. 23b at 0.1598: A4 to A3 and down to A1 as g_d grows, from A2 up to A4 on the way back."""
    arguments = ("--stage", "I", "--over", "g_d=-0.4:0.4:401", "--omega", "0.1598", "--json")
    back, forth = json.loads(run("superharmonic", *arguments).out)["curves"][0]["jumps"]
    assert (forth["sweep"], forth["from"]["point"], forth["to"]["point"]) == ("up", "A3", "A1")
    assert (back["sweep"], back["from"]["point"], back["to"]["point"]) == ("down", "A2", "A4")
    assert back["at"] < forth["at"]
    assert back["to"]["alpha"] > forth["from"]["alpha"] > back["from"]["alpha"] > forth["to"]["alpha"]
    assert "A3" in run("superharmonic", *arguments[:-1]).out


def test_a_fit_and_the_backlash_itself(run, tmp_path):
    found = json.loads(run("superharmonic", "--fit", "4", "--omega", "0.2", "--json").out)
    assert found["fit"]["delta_1"] == pytest.approx(0.3444, abs=5e-5)
    assert found["fit"]["delta_2"] == pytest.approx(0.0300, abs=5e-5)
    assert found["w0"] ** 2 == pytest.approx(found["fit"]["slope"] * found["fit"]["delta_1"])
    assert "delta_1 = 0.3444" in run("superharmonic", "--fit", "4", "--omega", "0.2").out
    file = tmp_path / "gap.parquet"
    arguments = ("--restoring", "backlash", "--omega", "0.31:0.33:41", "-o", str(file), "--json")
    found = json.loads(run("superharmonic", *arguments).out)
    assert found["restoring"] == "backlash"
    exact = found["curves"][0]["exact"]
    assert exact[0]["alpha"] == pytest.approx(1.805, abs=0.002)  # integrated: 1.8049
    rows = parquet.read_table(file)
    assert rows.column("method").to_pylist().count("harmonic balance") == len(exact)
    assert rows.schema.metadata[b"restoring"] == b"backlash"


def test_a_chart_over_two_gains(run, tmp_path):
    file = tmp_path / "gains.csv"
    arguments = ("--map", "g_d=-0.4:0.4:5", "--map", "g_v=-0.4:0.4:9", "--omega", "0.33")
    found = json.loads(run("superharmonic", *arguments, "-o", str(file), "--json").out)
    assert (len(found["mu"]), len(found["mu"][0])) == (5, 9)
    assert found["mu"][2][4] == pytest.approx(gear_pair("II").c * 0.05)  # no gains: c zeta
    rows = list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))
    assert len(rows) == 45
    assert float(rows[4 * 9 + 1]["mu"]) == found["mu"][4][1]
    assert "two folds" in run("superharmonic", *arguments).out


def test_a_sweep_and_basins(run):
    common = ("--stage", "I", "--zeta", "0.04")
    found = json.loads(run("superharmonic", *common, "--sweep", "--omega", "0.1594:0.1598:3", "--json").out)
    assert [step["direction"] for step in found["steps"]] == ["up"] * 3 + ["down"] * 3
    assert [jump["sweep"] for jump in found["jumps"]] == ["up"]
    grid = ("--basin", "x=-8:8:3", "--basin", "v=-3:3:3", "--omega", "0.1593")
    found = json.loads(run("superharmonic", *common, *grid, "--history", "free", "--json").out)
    assert [orbit["stable"] for orbit in found["orbits"]] == [True, False, True]
    assert sum(orbit["share"] for orbit in found["orbits"]) + found["elsewhere"] == pytest.approx(1.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ("--stage", "I", "--zeta", "0.04", "--sweep", "--omega", "0.157:0.162:21"),
        ("--map", "g_d=-0.4:0.4:41", "--map", "g_v=-0.4:0.4:41", "--omega", "0.33", "--exact"),
        ("--stage", "I", "--zeta", "0.04", "--omega", "0.1593", "--basin", "x=-8:8:21", "--basin", "v=-3:3:21"),
        ("--stage", "III", "--restoring", "backlash", "--omega", "0.34:0.37:61"),
        ("--fit", "15"),
    ],
)
def test_pages_draw_and_load_nothing(run, tmp_path, arguments):
    file = tmp_path / "page.html"
    run("superharmonic", *arguments, "-o", str(file))
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
        (["superharmonic", "--restoring", "rubber"], "cubic or backlash"),
        (["superharmonic", "--restoring", "backlash", "--slope", "-1"], "above 0"),
        (["superharmonic", "--slope", "1"], "--restoring backlash"),
        (["superharmonic", "--fit", "2"], "2.2433"),
        (["superharmonic", "--fit", "nan"], "half the backlash"),
        (["superharmonic", "--restoring", "backlash", "--over", "zeta=0:1:5", "--omega", "0.33"], "--restoring"),
        (["superharmonic", "--sweep", "--omega", "0.33"], "a range"),
        (["superharmonic", "--sweep", "--family", "zeta=0.1,0.2"], "--family"),
        (["superharmonic", "--sweep", "--periods", "3"], "--periods"),
        (["superharmonic", "--sweep", "--tau-d", "1e-9", "--omega", "0.32:0.33:3"], "tau_d"),
        (["superharmonic", "--sweep", "--map", "g_d=0:1:3"], "at a time"),
        (["superharmonic", "--restoring", "backlash", "--tau-v", "1e-9"], "tau_d, tau_v"),
        (["superharmonic", "--periods", "9"], "--periods"),
        (["superharmonic", "--map", "g_d=0:1:3"], "twice"),
        (["superharmonic", "--map", "g_d=0:1:3", "--map", "g_d=0:1:3"], "two different"),
        (["superharmonic", "--map", "tau=0:1:3", "--map", "tau_d=0:1:3"], "two different"),
        (["superharmonic", "--map", "tau=-1:1:3", "--map", "g_d=0:1:3"], "at least 0"),
        (["superharmonic", "--map", "mass=0:1:3", "--map", "g_d=0:1:3"], "one of zeta"),
        (["superharmonic", "--map", "g_v=0:1:3000", "--map", "g_d=0:1:3000"], "at most"),
        (["superharmonic", "--map", "g_v=0:1:3", "--map", "g_d=0:1:3", "--restoring", "backlash"], "--restoring"),
        (["superharmonic", "--map", "g_v=0:1:3", "--map", "g_d=0:1:3", "--omega", "0.3:0.4:3"], "one frequency"),
        (["superharmonic", "--basin", "x=0:1:3", "--omega", "0.33"], "v=START"),
        (["superharmonic", "--basin", "x=0:1:3", "--basin", "v=0:1:3"], "one frequency"),
        (["superharmonic", "--basin", "x=0:1:3", "--basin", "v=0:1:3", "--omega", "-1"], "omega"),
        (["superharmonic", "--basin", "x=0:1:3", "--basin", "v=0:1:3", "--omega", "0.33", "--history", "x"], "free"),
        (["superharmonic", "--basin", "x=0:1:3", "--basin", "v=0:1:3", "--omega", "0.33", "--workers", "0"], "least 1"),
        (["claims", "--section", "7"], "--section"),
    ],
)
def test_refusals(run, arguments, words):
    said = run(*arguments, code=2).err
    assert said.startswith("nw_gear: ")
    assert said.count("\n") == 1
    assert words in said
