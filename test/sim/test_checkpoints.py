"""Checkpoints on disk: complete or not there, of the same configuration or refused."""

import math
from pathlib import Path

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_sim import config
from nw_gear_sim.checkpoints import read_checkpoint, write_checkpoint
from nw_gear_sim.drivefile import DriveSeries
from nw_gear_sim.drives import FixedPoint, Followed, Recorded, Source, WindDriven
from nw_gear_sim.loadcase import LoadCase
from nw_gear_sim.nodes.session import Session

BASE = config.load()
TEXT = config.to_yaml(BASE)
VALUES = {"a": np.array([1.0, math.pi, -0.0, 5e-324]), "n": 3, "t": 0.1 + 0.2, "words": "grid loss"}


def test_everything_comes_back_bit_for_bit(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "state.npz"
    write_checkpoint(path, TEXT, VALUES)
    found = read_checkpoint(path, TEXT)
    assert found["a"].tobytes() == VALUES["a"].tobytes()  # type: ignore[attr-defined]
    assert {name: found[name] for name in ("n", "t", "words")} == {name: VALUES[name] for name in ("n", "t", "words")}
    assert [entry.name for entry in path.parent.iterdir()] == ["state.npz"]


def test_another_configuration_is_refused_with_the_first_difference(tmp_path: Path) -> None:
    path = tmp_path / "state.npz"
    write_checkpoint(path, TEXT, VALUES)
    other = config.to_yaml(config.with_values({"mesh.II.backlash": 46e-6}, BASE))
    with pytest.raises(InputError, match=r"state\.npz: mesh\.II\.backlash: expected 4\.6e-05 m, got 4\.5e-05 m"):
        read_checkpoint(path, other)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.999])
def test_a_cut_file_is_refused(tmp_path: Path, share: float) -> None:
    path = tmp_path / "state.npz"
    write_checkpoint(path, TEXT, VALUES)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(InputError, match="a damaged or foreign file"):
        read_checkpoint(path, TEXT)


def test_foreign_files_are_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "foreign.npz", a=np.zeros(3))
    (tmp_path / "text.npz").write_text("not an archive")
    for name, got in (
        ("foreign.npz", "damaged or foreign"),
        ("text.npz", "damaged or foreign"),
        ("none.npz", "no such"),
    ):
        with pytest.raises(InputError, match=got):
            read_checkpoint(tmp_path / name, TEXT)


def test_a_place_that_cant_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="a file that can be written"):
        write_checkpoint(tmp_path / "file" / "state.npz", TEXT, VALUES)


@pytest.mark.parametrize("case", ["wind", "grid_loss"])
def test_a_session_goes_on_bit_for_bit(tmp_path: Path, case: str) -> None:
    """Through the file, in wind and in the middle of a load case."""

    def make() -> Session:
        source: Source = WindDriven(BASE) if case == "wind" else LoadCase(BASE, case, 0.02, windy=True)
        return Session(BASE, source, "kinematic", "equilibrium", 5120.0)

    def wind(session: Session) -> dict[str, float]:
        return {"wind": 11.0 + math.sin(40.0 * session.time)}

    first = make()
    first.begin({"wind": 11.0})
    for _ in range(4):
        first.advance(wind(first))
    write_checkpoint(tmp_path / "state.npz", TEXT, first.checkpoint())
    second = make()
    second.resume(read_checkpoint(tmp_path / "state.npz", TEXT))
    assert second.time == first.time
    for _ in range(4):
        expected, found = first.advance(wind(first)), second.advance(wind(second))
        for name in ("time", "phase", "x", "v", "force", "bearing_force", "shaft_torque"):
            assert np.array_equal(getattr(found, name), getattr(expected, name)), name
    assert second.source.events() == first.source.events()


def session(source: Source) -> Session:
    return Session(BASE, source, "kinematic", "equilibrium", 5120.0)


def series(torque: float) -> DriveSeries:
    return DriveSeries(np.array([0.0, 9.0]), np.array([1.8, 1.8]), np.array([torque, torque]), "a file")


def test_a_checkpoint_of_another_drive_is_refused() -> None:
    sources: dict[str, Source] = {
        "wind": WindDriven(BASE),
        "topic": Followed(),
        "fixed": FixedPoint(BASE),
        "grid_loss": LoadCase(BASE, "grid_loss", 1.0, windy=True),
        "later": LoadCase(BASE, "grid_loss", 2.0, windy=True),
        "steady": LoadCase(BASE, "grid_loss", 1.0, windy=False),
        "shutdown": LoadCase(BASE, "shutdown", 1.0, windy=True),
        "file": Recorded(series(4e6), hold=True),
        "other file": Recorded(series(4.1e6), hold=True),
    }
    for name, source in sources.items():
        first = session(source)
        first.begin({"wind": 11.0, "speed": 1.8, "torque": 4e6})
        saved = first.checkpoint()
        for other, another in sources.items():
            again = session(another)
            if name == other:
                again.resume(saved)
                assert again.begun
            else:
                with pytest.raises(InputError, match=r"^checkpoint: (drive|scenario_time|drive_file \(SHA-256\)): "):
                    again.resume(saved)
                assert not again.begun


@pytest.mark.parametrize("name", ["simulation.speed", "simulation.samples", "source.speed", "source.train.phase"])
def test_an_incomplete_checkpoint_is_refused(name: str) -> None:
    first = session(LoadCase(BASE, "grid_loss", 1.0, windy=False))
    first.begin({})
    saved = first.checkpoint()
    del saved[name]
    with pytest.raises(InputError, match=name.rsplit(".", maxsplit=1)[-1]):
        session(LoadCase(BASE, "grid_loss", 1.0, windy=False)).resume(saved)


@pytest.mark.parametrize("name", ["simulation.state.x", "simulation.state.force"])
def test_a_checkpoint_with_arrays_of_another_size_is_refused(name: str) -> None:
    first = session(FixedPoint(BASE))
    first.begin({})
    saved = first.checkpoint()
    assert name in saved
    saved[name] = saved[name][:-1]
    with pytest.raises(InputError, match="checkpoint"):
        session(FixedPoint(BASE)).resume(saved)
