"""`nw_gear bench`: the keys that other programs read, and what bad input gets."""

import json
import math
import subprocess
from pathlib import Path
from typing import Any

import pytest

from test.system.processes import command


def bench(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*command("nw_gear"), "bench", *arguments], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def measured() -> dict[str, Any]:
    done = bench("--json", "--quick")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def numbers(values: Any) -> list[float]:
    if isinstance(values, dict):
        return [number for value in values.values() for number in numbers(value)]
    if isinstance(values, list):
        return [number for value in values for number in numbers(value)]
    return [values] if isinstance(values, int | float) and not isinstance(values, bool) else []


def test_keys_of_the_contract(measured):
    keys = {
        "right_hand_side_us",
        "step_us",
        "step",
        "real_time_factor",
        "error_um",
        "fast",
        "ratio_scipy_same_rhs",
        "ratio_scipy_numpy_rhs",
        "sweep_points_per_second",
        "indicators",
    }
    assert keys <= set(measured)
    assert {"step", "real_time_factor", "error_um"} <= set(measured["fast"])
    for indicator in measured["indicators"].values():
        assert {"milliseconds", "peer", "ratio"} <= set(indicator)
        assert (indicator["peer"] is None) == (indicator["ratio"] is None)
    without_load = {key: value for key, value in measured.items() if key != "machine"}
    without_load["indicators"] = {
        name: {key: value for key, value in indicator.items() if key not in ("value", "peer_value")}  # may be below 0
        for name, indicator in measured["indicators"].items()
    }
    assert numbers(without_load)
    assert all(math.isfinite(number) and number > 0 for number in numbers(without_load))


def test_figures_hang_together(measured):
    """A step and its cost give the factor; the two settings differ by a factor of two; errors keep to their bound."""
    for setting in (measured, measured["fast"]):
        assert setting["real_time_factor"] == pytest.approx(1e6 * setting["step"] / setting["step_us"], rel=1e-9)
        assert setting["error_um"] < 0.15
    assert measured["fast"]["step"] == pytest.approx(2 * measured["step"])
    assert measured["first_errors_um"]["torque_step"] < measured["fast"]["first_errors_um"]["torque_step"]
    classical = measured["integrators"][-1]
    assert classical["error_um"] < measured["error_um"]
    same, plain = measured["scipy"]["same_rhs"], measured["scipy"]["numpy_rhs"]
    assert measured["ratio_scipy_same_rhs"] * measured["step_us"] * 1e-6 / measured["step"] == pytest.approx(
        same["cpu_s_per_s"]
    )
    assert same["calls_per_s"] == pytest.approx(plain["calls_per_s"], rel=0.1)
    assert max(same["error_um"], plain["error_um"]) < 0.02


def test_names_the_machine(measured):
    machine = measured["machine"]
    assert machine["processor"]
    assert machine["cores"] >= 1
    assert {"Python", "numpy", "numba", "llvmlite"} <= set(machine["versions"])


@pytest.mark.parametrize(
    ("text", "said"), [("numerics: {step: 1 s}\n", "numerics.step"), ("gears: {nothing: 1}\n", "gears")]
)
def test_a_wrong_configuration(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "wrong.yaml"
    path.write_text(text, encoding="utf-8")
    done = bench("--json", "--quick", "--config", str(path))
    assert done.returncode == 2
    assert done.stdout == ""
    assert said in done.stderr.splitlines()[-1]
    assert "Traceback" not in done.stderr


def test_a_missing_file() -> None:
    done = bench("--config", "not-there.yaml")
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("nw_gear: not-there.yaml: expected")
