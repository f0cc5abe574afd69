"""Drive files: units, and columns named in words."""

import math
from pathlib import Path

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_sim.drivefile import DriveColumns, parse_columns, read_drive_file

RPM = math.pi / 30.0


def write(folder: Path, text: str) -> Path:
    path = folder / "drive.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("unit", "factor"), [("r/min", RPM), ("rpm", RPM), ("1/min", RPM), ("Hz", 2 * math.pi), ("rad/s", 1.0)]
)
def test_units_of_speed(tmp_path: Path, unit: str, factor: float) -> None:
    path = write(tmp_path, f"time,speed ({unit}),torque\n0,3,1\n1,4,1\n")
    np.testing.assert_allclose(read_drive_file(path).speed, np.array([3.0, 4.0]) * factor)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("kN-m", 1e3), ("kN m", 1e3), ("kNm", 1e3), ("kN·m", 1e3), ("N*m", 1.0), ("MN.m", 1e6), ("Nm", 1.0)],
)
def test_units_of_torque(tmp_path: Path, unit: str, factor: float) -> None:
    path = write(tmp_path, f"time,speed,torque [{unit}]\n0,3,1.5\n1,4,2\n")
    np.testing.assert_allclose(read_drive_file(path).torque, np.array([1.5, 2.0]) * factor)


def test_columns_in_words() -> None:
    assert parse_columns("time=Time s, speed=RotSpeed r/min, torque=RotTorq kN m") == DriveColumns(
        time="Time", time_unit="s", speed="RotSpeed", speed_unit="r/min", torque="RotTorq", torque_unit="kN m"
    )
    assert parse_columns("speed=Rotor speed") == DriveColumns(speed="Rotor speed")
    for text in ("speed", "speed=", "pace=x", "speed=a,speed=b", ""):
        with pytest.raises(InputError, match="each of time, speed, torque, power once"):
            parse_columns(text)
