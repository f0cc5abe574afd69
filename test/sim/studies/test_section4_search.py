"""The search for the parameters of Sec. 4: nothing twice, and what the command and the page say of it."""

import json

import numpy as np
import pytest

from nw_gear_common import cli
from nw_gear_sim import config
from nw_gear_sim.kinematics import derive
from nw_gear_sim.studies.bifurcation import Plan
from nw_gear_sim.studies.section4 import result, space, study
from nw_gear_sim.studies.section4.evaluate import Labelled
from nw_gear_sim.studies.section4.waveforms import Integrated, Spectra
from nw_gear_sim.studies.store import Store
from test.sim.studies.test_section4_judging import paper, piece, spectra

BASE = config.load("")


class Laboratory:
    """Computes pieces out of thin air, the more like the paper the higher a draw's load; counts what it computed."""

    def __init__(self, store):
        self.store = store
        self.computed = []

    def __call__(self, pieces):
        for key, wanted in pieces.items():
            if key not in self.store.done():
                self.computed.append(key)
                self.store.put(key, _made_up(wanted))


def _made_up(wanted):
    if isinstance(wanted, Spectra):
        return spectra(1.0)
    if isinstance(wanted, Integrated):
        whole = piece((wanted.omega_e,), paper)
        return {name: whole[name][0] for name in ("period", "deviation", "x")}
    assert isinstance(wanted, Labelled)
    limit = 0.16 + 0.11 * wanted.configuration.operation.load
    return piece(wanted.omega_e, lambda stage, w: paper(stage, w) if w < limit else "period-3")


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "store", study.describe(BASE, study.Question()))


@pytest.fixture
def run(monkeypatch, capsys):
    monkeypatch.setattr(cli.signal, "signal", lambda *_: None)

    def call(*arguments, code=0):
        assert cli.main(["study", "claims", *arguments]) == code
        return capsys.readouterr()

    return call


def test_the_best_draw_is_found_and_nothing_computed_twice(store):
    laboratory = Laboratory(store)
    question = study.Question(draws=6, around=2)
    found = result.collect(BASE, question, store, laboratory)
    loads = space.shares(6, 0)[:, 0]
    assert found["search"]["best"]["draw"] == f"draw-{int(np.argmax(loads)):06d}"
    assert found["search"]["best"]["score"] == pytest.approx(max(found["search"]["scores"]), abs=1e-4)
    assert found["search"]["near"]["count"] == 2 * study.PARENTS
    assert len(found["search"]["scores"]) == 6
    assert sum(label["held_by"] for label in found["search"]["labels"]) == round(39 * sum(found["search"]["scores"]))
    first, laboratory.computed = list(laboratory.computed), []
    assert len(set(first)) == len(first)
    assert result.collect(BASE, question, store, laboratory) == found
    assert laboratory.computed == []
    result.collect(BASE, study.Question(draws=8, around=0), store, laboratory)
    assert [key for key in laboratory.computed if key.startswith("draw")] == ["draw-000006", "draw-000007"]


def test_a_draw_sets_what_it_names():
    numbers = space.named(space.shares(3, 0)[2])
    made = space.configured(numbers, BASE)
    assert made.operation.load == pytest.approx(numbers["load"])
    assert made.mesh.III.error_amplitude == pytest.approx(numbers["error_III"])
    assert made.bearings.sb.clearance == pytest.approx(numbers["clearance"] * BASE.bearings.sb.clearance)
    for stage, own, base in zip("123", derive(made).stages, derive(BASE).stages, strict=True):
        ratio = own.stiffness.transverse / base.stiffness.transverse
        assert ratio == pytest.approx(numbers["stiffness_" + "I" * int(stage)])


def test_the_command_on_a_finished_store(store, run, tmp_path):
    result.collect(BASE, study.Question(draws=4, around=0), store, Laboratory(store))
    arguments = ("--draws", "4", "--around", "0", "-o", str(store.folder))
    page = tmp_path / "page.md"
    out = run("--section", "all", *arguments, "--json", "--markdown", str(page)).out
    found = json.loads(out)
    assert {"corrected", "paper_eq75", "section_4"} <= set(found)
    four = found["section_4"]
    assert four["held"] == sum(row["holds"] is True for row in four["rows"])
    assert four["total"] == len(four["rows"]) == 39
    outcomes = {row["id"]: row["holds"] for row in four["rows"]}
    assert all(isinstance(outcome, bool) or outcome == "contradicts" for outcome in outcomes.values())
    assert outcomes["C5"] == "contradicts"
    assert all(row["value"] for row in four["rows"])
    text = page.read_text(encoding="utf-8")
    for row in [*four["rows"], *found["corrected"]["rows"]]:
        assert f"\n| {row['id']} |" in text
    assert f"{four['search']['best']['score']:.3f}" in text
    plain = run("--section", "4", *arguments).out
    assert f"{four['held']} of 39 hold" in plain
    assert "always period-1: 0.410" in plain


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (["--section", "6"], "--section"),
        (["--section", "4", "--draws", "0"], "--draws"),
        (["--section", "4", "--around", "-1"], "--around"),
        (["--section", "4", "--seed", "-1"], "--seed"),
        (["--markdown", "page.md"], "--markdown"),
        (["--section", "4", "--config", "nowhere.yaml"], "nowhere.yaml"),
    ],
)
def test_bad_input_is_one_line(run, tmp_path, arguments, place):
    error = run(*arguments, "-o", str(tmp_path / "new"), code=2).err
    assert place in error
    assert len(error.strip().splitlines()) == 1


def test_the_folder_of_another_seed_is_refused(store, run):
    error = run("--section", "4", "--seed", "7", "-o", str(store.folder), code=2).err
    assert "seed is 0 there, 7 here" in error


@pytest.mark.slow
def test_a_small_real_search(run, tmp_path, monkeypatch):
    """Two draws from their beginning to the verdicts, all of them short: a minute is a tenth of a second here."""
    monkeypatch.setattr(study, "MINUTE", 0.1)
    monkeypatch.setattr(study, "PLAN", Plan(transient=20, record=40, exponent_periods=4))
    monkeypatch.setattr(study, "GRID", study.GRID[1::3])
    monkeypatch.setattr(study, "GRID_PARTS", study.GRID_PARTS[:1])
    arguments = ("--section", "4", "--draws", "2", "--around", "0", "--workers", "1", "-o", str(tmp_path / "store"))
    first = run(*arguments, "--json")
    found = json.loads(first.out)["section_4"]
    assert "pieces" in first.err
    assert sum(found["search"]["regimes"].values()) == 2 * 39
    rows = {row["id"]: row for row in found["rows"]}
    assert rows["C10.2.I"]["value"].startswith("strongest line at ")
    assert found["base"]["score"] >= 16 / 39 - 0.2  # at rated torque the gearbox doesn't rattle
    again = run(*arguments, "--json")
    assert json.loads(again.out)["section_4"] == found
    assert "pieces" not in again.err
