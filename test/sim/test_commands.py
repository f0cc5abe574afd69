"""`nw_gear equilibrium` and `nw_gear modes`: what other programs read, against known numbers; pages in a browser."""

import json
import math
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nw_gear_common import cli, names
from test.monitor.browser import look
from test.system.processes import command, environment

UNIT = 45e-6


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        [*command("nw_gear"), *arguments], capture_output=True, text=True, timeout=300, env=environment(), check=False
    )
    assert done.returncode == 0, done.stderr
    return done


@pytest.fixture(scope="module")
def smooth(tmp_path_factory) -> str:
    path = tmp_path_factory.mktemp("config") / "smooth.yaml"
    path.write_text("friction: {enabled: false}")
    return str(path)


@pytest.fixture(scope="module")
def at_rest(smooth: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(run("equilibrium", "--config", smooth, "--nondimensional", "--json").stdout)
    return found


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    folder = tmp_path_factory.mktemp("modes") / "new" / "folder"
    return folder, run("modes", "--count", "24", "--speeds", "5", "--json", "--shapes", "-o", str(folder))


def test_equilibrium_as_the_contract_says(at_rest: dict[str, Any]) -> None:
    found = at_rest
    assert found["residual"] < 0.01
    assert set(found["torque_ratio"]) == {"ring", "sun", "herringbone_1", "generator"}
    assert list(found["torque_ratio"].values()) == pytest.approx([1] * 4, abs=1e-9)
    assert list(found["mesh"]) == list(names.MESHES)
    x = [mesh["displacement"] / UNIT for mesh in found["mesh"].values()]
    assert x == pytest.approx([3.121, 3.951, 3.853, 2.377, 2.325, 2.277, 3.274], abs=6e-4)
    for stage in ("I", "II"):
        assert found["load_share"][stage] == pytest.approx([1.044, 0.996, 0.960], abs=5e-4)
    force = [mesh["force"] for mesh in found["mesh"].values()]
    assert np.mean(force[:3]) == pytest.approx(1.19727e6, rel=2e-5)
    assert force[6] == pytest.approx(7.91857e5, rel=2e-5)
    assert set(found["bearing"]) == set(names.BEARINGS)


def test_bearings_carry_mesh_and_weight(at_rest: dict[str, Any]) -> None:
    """Planet 1: its two bearings take the radial and tangential mesh forces and the weight of gears and rings."""
    found = at_rest
    first, second = (found["mesh"][m]["force"] for m in ("I_1", "II_1"))
    bb = [math.asin(math.sin(math.radians(b)) * math.cos(math.radians(20))) for b in (4.0, 7.2)]
    a = [math.radians(23.480), math.radians(20.146)]
    x = -first * math.cos(bb[0]) * math.sin(a[0]) + second * math.cos(bb[1]) * math.sin(a[1])
    y = first * math.cos(bb[0]) * math.cos(a[0]) + second * math.cos(bb[1]) * math.cos(a[1])
    y -= 9.81 * (950 + 2320 + 400)
    carried = [found["bearing"]["pb1_1"][k] + found["bearing"]["pb2_1"][k] for k in "xyz"]
    axial = first * math.sin(bb[0]) - second * math.sin(bb[1])
    assert carried[:2] == pytest.approx([x, y], rel=1e-4)
    assert carried[2] == pytest.approx(axial, rel=1e-3)


def test_load_speed_and_angle(smooth: str) -> None:
    where = ("--load", "25 %", "--speed", "8.65 r/min", "--angle", "90deg")
    found = json.loads(run("equilibrium", "--config", smooth, *where, "--json").stdout)
    assert found["torque"] == pytest.approx(0.25 * 4.3e6)
    assert found["speed"] == pytest.approx(8.65 * 2 * math.pi / 60)
    assert found["angle"] == pytest.approx(math.pi / 2)
    forces = [found["mesh"][m]["force"] for m in names.MESHES[:3]]
    assert np.mean(forces) == pytest.approx(0.25 * 1.19727e6, rel=2e-5)


def test_no_torque_is_null_not_nan() -> None:
    found = json.loads(run("equilibrium", "--load", "0", "--json").stdout, parse_constant=pytest.fail)
    assert found["torque_ratio"]["ring"] is None


def test_equilibrium_in_words(smooth: str) -> None:
    text = run("equilibrium", "--config", smooth, "--nondimensional").stdout
    assert "friction off" in text
    (row,) = [line.split() for line in text.splitlines() if line.startswith("I_1 ") and len(line.split()) == 5]
    assert float(row[2]) == pytest.approx(3.121, abs=1e-3)
    assert float(row[4]) == pytest.approx(1.044, abs=1e-3)
    assert "omega_n = 5284.62 rad/s" in text
    assert not any(mark in text for mark in "\x1b╭━─")


def test_nondimensional_object(at_rest: dict[str, Any]) -> None:
    found = at_rest["nondimensional"]
    assert found["mesh"]["II_1"]["displacement"] == pytest.approx(2.377, abs=6e-4)
    assert found["mesh"]["II_1"]["force"] == pytest.approx((2.377 - 1) / math.cos(math.radians(6.7637)) ** 2, rel=2e-2)
    assert found["derived"]["f_g"] == pytest.approx(7.8e-3, rel=2e-3)


def test_modes_as_the_contract_says(written) -> None:
    _, done = written
    found = json.loads(done.stdout, parse_constant=pytest.fail)
    assert found["degrees_of_freedom"] == 463
    assert np.all(np.diff(found["frequencies_hz"]) >= 0)
    assert len(found["frequencies_hz"]) == len(found["damping_ratio"]) <= 463
    assert found["frequencies_hz"][:7] == pytest.approx([38.5, 58.25, 58.58, 59.24, 65.7, 79.9, 94.2], abs=0.25)
    assert all(0 < ratio < 1 for ratio in found["damping_ratio"])
    assert found["largest_eigenvalue"] == pytest.approx(1.057e5, rel=1e-3)
    assert found["largest_stable_step"] == pytest.approx(2.79e-5, rel=2e-3)
    assert len(found["modes"]) == 24
    assert found["modes"][18]["name"] == "ring n = 2"


def test_what_is_written(written) -> None:
    folder, done = written
    found = json.loads(done.stdout)
    assert set(found["files"].values()) == {str(path) for path in folder.iterdir()}
    assert {path.name for path in folder.iterdir()} == {
        "modes.json", "shapes.npz", "shapes.html", "campbell.json", "campbell.html",
    }  # fmt: skip
    with np.load(folder / "shapes.npz") as shapes:
        assert shapes["vectors"].shape == (463, 24)
        assert list(shapes["motions"]) == found["shapes"]["motions"]
        assert np.abs(shapes["eigenvalues"]) / (2 * math.pi) == pytest.approx(found["frequencies_hz"][:24], rel=1e-12)
        assert shapes["vectors"][:, 3].real == pytest.approx(np.array(found["shapes"]["real"][3]), abs=1e-15)
    diagram = json.loads((folder / "campbell.json").read_text())
    assert diagram == found["campbell"]
    at = int(np.argmin(np.abs(np.array(diagram["speed"]) - diagram["rated_speed"])))
    followed = [mode["frequencies_hz"][at] for mode in diagram["modes"]]
    assert followed == pytest.approx(found["frequencies_hz"][:24], rel=2e-5)


@pytest.mark.parametrize("page", ["campbell.html", "shapes.html"])
def test_pages_in_a_browser(page: str, written, tmp_path: Path) -> None:
    """Everything is drawn, nothing is fetched, nothing is complained about."""
    folder, _ = written
    seen, console = look(folder / page, tmp_path)
    assert console == []
    assert seen["loads"] == []
    assert not seen["wide"]
    assert max(figure["colours"] for figure in seen["figures"]) > 20


def test_campbell_in_words(capsys) -> None:
    assert cli.main(["modes", "--count", "12", "--campbell", "--speeds", "3", "--constant-load"]) == 0
    out, err = capsys.readouterr()
    assert "Natural frequencies within 10% of an excitation at rated speed" in out
    (row,) = [line for line in out.splitlines() if line.startswith("mesh II  ") and "+1." in line]
    assert row.split()[:5] == ["mesh", "II", "99.0", "8", "100.2"]
    assert "speed 4 of 4" in err  # three speeds and the rated one
