"""Parameters of `gear_sim_node`."""

from __future__ import annotations

from dataclasses import dataclass

from nw_gear_common import names
from nw_gear_common.quantities import quantity
from nw_gear_sim.params.faults import FaultSettings
from nw_gear_sim.physics.drivetrain import SCENARIOS


@dataclass(frozen=True)
class Settings(FaultSettings):
    """Parameters of `gear_sim_node`."""

    config: str = quantity("", "Configuration laid over the default gearbox: a YAML file, or the name of a preset.")
    real_time_factor: float = quantity(
        1.0,
        "Simulated seconds per second of wall time; 0 = as fast as possible. May change where /clock is published.",
        "1",
        live=True,
        minimum=0.0,
        maximum=1000.0,
    )
    sample_rate: float = quantity(
        5120.0, "Rate of the waveform; divides 1/step and is a multiple of 20.", "Hz", minimum=20.0, maximum=40960.0
    )
    view_rate: float = quantity(
        50.0, "Rate of shafts, mesh and bearings, in wall time.", "Hz", minimum=0.1, maximum=1000.0
    )
    excitation: str = quantity(
        "",
        "Each stage excited at its own mesh frequency, or all at that of stage II; empty = as configured.",
        choices=("", "kinematic", "tied"),
    )
    publish_clock: bool = quantity(
        False, "Publish /clock from 0 on, in lock step with the wind; set by itself where real_time_factor isn't 1."
    )
    drive: str = quantity(
        "",
        "What sets speed and torque: the wind, the configured operating point, the topic `drive` or a file; empty = as "
        "configured.",
        choices=("", "wind", "fixed", "topic", "file"),
    )
    drive_file: str = quantity(
        "", "Speed and torque over time, as OpenFAST (.out, .outb) or a SCADA system writes them."
    )
    drive_columns: str = quantity(
        "",
        "Columns and units of the file, as `time=Time s, speed=RotSpeed r/min, torque=RotTorq kN m`; empty = usual.",
    )
    drive_gaps: str = quantity("refuse", "What to do about gaps in the file.", choices=("refuse", "bridge"))
    drive_end: str = quantity("stop", "What comes after the end of the file.", choices=("stop", "hold"))
    scenario: str = quantity("", "Load case of the drive-train; empty = ordinary operation.", choices=("", *SCENARIOS))
    scenario_time: float = quantity(10.0, "When the load case begins.", "s", minimum=0.0, maximum=1e9)
    checkpoint: str = quantity("", "File that the service `~/checkpoint` writes the whole state to.")
    resume: str = quantity("", "Checkpoint to go on from.")
    start: str = quantity(
        "equilibrium",
        "State at the start: static equilibrium, or all zero as in the paper.",
        choices=("equilibrium", "zero"),
    )
    wait_for: int = quantity(0, "Subscribers of the waveform to wait for before time starts.", minimum=0, maximum=100)
    duration: float = quantity(
        0.0, "Simulated time after which the node ends by itself; 0 = never.", "s", minimum=0.0, maximum=1e9
    )
    waveform_bearings: tuple[str, ...] = quantity(
        names.WAVEFORM_BEARINGS, "Bearings whose forces are in the waveform.", choices=names.BEARINGS
    )
    accelerometers: tuple[str, ...] = quantity(
        names.WAVEFORM_BEARINGS,
        "Bearings whose housings carry an accelerometer in x and y; [] = none.",
        choices=names.BEARINGS,
    )
    acceleration_rate: float = quantity(
        0.0,
        "Rate of the accelerometers; a multiple of 20, and the rate of the steps times or over a whole number; 0 = "
        "sample_rate.",
        "Hz",
        minimum=0.0,
        maximum=40960.0,
    )
    acceleration_range: float = quantity(
        490.0,
        "Largest acceleration that a sensor shows; beyond it clips.",
        "m/s^2",
        minimum=1e-3,
        maximum=1e6,
    )
    acceleration_noise: float = quantity(
        5e-4, "Density of the sensors' white noise; 0 = none.", "m/s^2/sqrt(Hz)", minimum=0.0, maximum=1e3
    )
    acceleration_sensitivity: float = quantity(
        0.0102, "Output of a sensor for 1 m/s^2.", "V s^2/m", minimum=1e-6, maximum=1e3
    )
    acceleration_voltage: float = quantity(
        5.0, "Largest voltage that the converter takes.", "V", minimum=1e-3, maximum=1e3
    )
    acceleration_bits: int = quantity(24, "Bits of the converter; 0 = no rounding.", minimum=0, maximum=32)
    tacho_shaft: str = quantity("output", "Shaft with a tacho; empty = none.", choices=("", *names.SHAFTS))
    tacho_pulses: int = quantity(1, "Pulses of the tacho in a turn.", minimum=1, maximum=10000)
    sensor_seed: int = quantity(1, "Seed of the accelerometers' noise.", minimum=0, maximum=2**31 - 1)
