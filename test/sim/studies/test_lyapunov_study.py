"""Lyapunov studies: exponents against modes at rest, sums against divergence, folders, files, refusals."""

import json
import math

import numpy as np
import pyarrow.parquet
import pytest

from nw_gear_common import cli
from nw_gear_sim import config
from nw_gear_sim.drawings.lyapunov_page import page
from nw_gear_sim.studies import lyapunov as study
from nw_gear_sim.studies.store import Store


def row(rates, errors=None, values=(), states=6, diverged=math.nan):
    """A row as a study finds it, with a mean that settles."""
    rate = np.array(rates, dtype=float)
    error = np.full(len(rate), 0.1) if errors is None else np.array(errors)
    time = np.linspace(0.1, 5.0, 20)
    return study.Row(
        values, rate, error, time, rate + np.outer(1 / time, np.ones(len(rate))), -3.0, states, 5.0, 0.01, diverged
    )


@pytest.mark.parametrize(
    ("found", "word"),
    [
        (row([2.0, -1.0]), "chaotic"),
        (row([-2.0]), "regular"),
        (row([0.2]), "unknown"),
        (row([-0.2]), "unknown"),
        (row([np.nan], diverged=0.4), "diverged"),
    ],
)
def test_motion_in_words(found, word):
    assert found.motion == word


def test_row_as_an_object():
    found = row([2.0, -0.5, -4.0], values=(0.3,), states=3).as_object(["operation.load"])
    assert found["operation.load"] == 0.3
    assert found["kaplan_yorke_dimension"] == pytest.approx(2.375)
    assert found["rate_per_period"] == pytest.approx([0.02, -0.005, -0.04])
    assert found["sum"] == pytest.approx(-2.5)
    assert found["diverged"] is None
    json.dumps(row([np.nan], diverged=0.2).as_object([]), allow_nan=False)


def test_tables_have_a_row_for_each_exponent_and_time():
    found = [row([2.0, -1.0], values=(0.1,)), row([-1.0, -1.5], values=(0.2,))]
    exponents, means = (table(found, ["load"]) for table in (study.exponents_table, study.convergence_table))
    assert exponents["load"].tolist() == [0.1, 0.1, 0.2, 0.2]
    assert exponents["rate"].tolist() == [2.0, -1.0, -1.0, -1.5]
    assert exponents["exponent"] == [1, 2, 1, 2]
    assert exponents["motion"] == ["chaotic"] * 2 + ["regular"] * 2
    assert {len(values) for values in means.values()} == {2 * 20 * 2}
    last = (means["load"] == 0.2) & (means["exponent"] == 2) & (means["time"] == 5.0)
    assert means["mean"][last] == pytest.approx([-1.5 + 0.2])


@pytest.mark.parametrize("keys", [[], ["operation.load"]])
def test_page_stands_alone_and_names_its_axes(keys):
    values = [(0.1,), (0.2,)] if keys else [()]
    text = page([row([2.0, -1.0, -4.0], values=value, states=3) for value in values], keys)
    assert "src=" not in text.split("</head>")[1]
    for word in ("exponent (1/s)", "time since the deviations settled (s)", "divergence", *keys):
        assert word in text


def test_plan_and_damaged_numbers_are_refused(capsys, tmp_path):
    for words, named in (
        (["--count", "-1"], "--count"),
        (["--record", "5"], "--record"),
        (["--transient", "-1"], "--transient"),
        (["--ring", "steel"], "--ring"),
        (["--over", "operation.load=1:0:3"], "--over"),
        (["--over", "operation.lod=0.1:0.2:3", "-o", str(tmp_path / "x")], "operation.lod"),
        (["--config", "no_such_preset"], "no_such_preset"),
    ):
        assert cli.main(["study", "lyapunov", *words]) == 2
        out, error = capsys.readouterr()
        assert named in error
        assert out == ""
        assert "Traceback" not in error


@pytest.mark.slow
def test_study_along_an_axis_goes_on_where_it_stopped(tmp_path, capsys):
    folder = tmp_path / "loads"
    options = "--over operation.load=0.05,0.8 --excitation kinematic --count 2 --transient 60 --record 150 --workers 1"
    words = ["study", "lyapunov", "--config", "rattling", *options.split(), "-o", str(folder), "--json"]
    assert cli.main(words) == 0
    first = json.loads(capsys.readouterr().out)
    rattling, loaded = first["rows"]
    assert rattling["rate"][0] > loaded["rate"][0]
    assert loaded["rate"][0] < 0.0
    assert loaded["kaplan_yorke_dimension"] == 0.0
    table = pyarrow.parquet.read_table(folder / "exponents.parquet").to_pydict()
    assert table["operation.load"] == [0.05, 0.05, 0.8, 0.8]
    assert table["rate"] == pytest.approx(rattling["rate"] + loaded["rate"])
    (folder / "pieces" / "point-000001.npz").unlink()
    assert cli.main(words) == 0
    again = capsys.readouterr()
    repeated = json.loads(again.out)
    assert repeated["rows"][0] == rattling  # kept
    assert repeated["rows"][1]["rate"] == pytest.approx(loaded["rate"], rel=1e-9)  # LAPACK's last digits may differ
    assert repeated["files"] == first["files"]
    assert "1 of 2 pieces" in again.err
    assert cli.main([*words, "--count", "1"]) == 2
    assert "plan.count" in capsys.readouterr().err


@pytest.mark.slow
def test_all_exponents_of_a_loaded_gearbox(tmp_path):
    """They come in descending order, and their sum is the divergence."""
    base = config.with_values({"operation.drive": "fixed"}, config.load("rated"))
    plan = study.Plan(excitation="kinematic", count=0, transient=20, record=60)
    store = Store(tmp_path, study.describe(base, [], plan))
    for key, piece in study.pieces([base], plan).items():
        store.put(key, study.compute(piece))
    (found,) = study.rows(store, [()])
    assert len(found.rate) == found.states == 134
    assert np.all(np.diff(found.rate) <= 0.0)
    assert found.rate.sum() == pytest.approx(found.divergence, rel=2e-3)
    assert found.dimension == 0.0
