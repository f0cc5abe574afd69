"""The measured wind behind a run is shown where its file is at hand, and said to be missing where it isn't."""

from pathlib import Path

import pytest

from nw_gear_monitor.review.measured import find
from nw_gear_monitor.review.page import render
from test.monitor import synthetic
from test.monitor.test_review_page import Page, gathered

CSV = """time,wind_speed_mean,wind_speed_std
2021-05-01T00:00,9.5,1.1
2021-05-01T00:10,10.5,1.3
2021-05-01T00:20,8.0,0.9
"""


def run_from(file, **values):
    parameters = {"source": "file", "file": str(file), **values}
    return gathered(synthetic.stream(2), provenance={"nw_gear.node.wind_node": parameters})


@pytest.fixture
def mast(tmp_path):
    file = tmp_path / "mast.csv"
    file.write_text(CSV)
    return file


def test_measured_means_are_laid_over_the_run_at_the_offset_in_the_file(mast):
    measured, text = find(run_from(mast, start_offset="600.0"))
    assert measured.times == pytest.approx([-600.0, 0.0, 600.0], abs=1e-3)
    assert measured.speeds.tolist() == [9.5, 10.5, 8.0]
    assert measured.deviations.tolist() == [1.1, 1.3, 0.9]
    assert measured.interval == 600.0
    assert "3 rows from 2021-05-01T00:00:00" in text


def test_page_tells_the_measured_wind_from_what_was_drawn(mast):
    html = render(run_from(mast))
    assert "Measured: means and standard deviations over 600 s, 3 rows" in Page(html).words
    for legend in ("measured mean", "measured standard deviation", "drawn, published and used"):
        assert legend in html


def test_a_file_that_is_gone_is_said_to_be_missing(tmp_path):
    run = run_from(tmp_path / "gone.csv")
    measured, text = find(run)
    assert measured is None
    assert "gone.csv" in text
    assert "The measured wind isn't shown" in Page(render(run)).words


def test_other_winds_have_no_measured_record():
    assert find(gathered(synthetic.stream(1))) == (None, "")


def test_real_mast_data_can_be_shown():
    file = Path(__file__).parents[1] / "data" / "mast_wind_10min.csv"
    measured, _text = find(run_from(file))
    assert measured.deviations is not None
    assert measured.times[0] == pytest.approx(0.0, abs=1e-3)
