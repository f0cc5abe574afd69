"""Lines of the meshing displacements, and the same motions by the paper's own method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim import config
from nw_gear_sim.batch.batch import Batch
from nw_gear_sim.equilibrium import NoEquilibrium
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Divergence, Simulation
from nw_gear_sim.studies.bifurcation import period_of
from nw_gear_sim.studies.section4.evaluate import MESHES, PLAN, at

SAMPLES_PER_PERIOD = 24
MULTIPLES = (1 / 3, 40 / 131, 1 / 2, 1.0, 2.0, 3.0)
"""Of a stage's mesh frequency: what the paper names, and 40/131, where stage II's own line lies in stage III."""
WIDTH = 4
"""Bins of a Hann window's main line, and of the mean, that are left out beside a line."""
RK4_RATE = 81920.0
"""Samples, and steps at least: twice as many as the base configuration needs, for stiffer draws."""


@dataclass(frozen=True, eq=False)
class Spectra:
    """Frequencies whose spectra are wanted: configuration, excitation `tied` or `kinematic`, frequencies."""

    configuration: Configuration
    excitation: str
    omega_e: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Integrated:
    """A motion that is wanted by classical Runge-Kutta from zero displacements, all meshes at one frequency.

    Attributes:
        configuration: all but the frequency; omega_e: it; transient, record: periods.
    """

    configuration: Configuration
    omega_e: float
    transient: int = PLAN.transient
    record: int = PLAN.record


def spectra(piece: Spectra) -> dict[str, Array]:
    """Compute spectra of the recorded periods.

    Returns:
        `omega_e` (points,); `lines` (points, 3, MULTIPLES), amplitudes, m; `dominant` (points, 3), the strongest line
        as a multiple of the stage's mesh frequency; `others` (points, 3), the strongest line but that at the mesh
        frequency, as a share of it.
    """
    points = at(piece.configuration, piece.omega_e)
    stages = names.STAGES if piece.excitation == "kinematic" else ("II", "II", "II")
    meshing = np.array([[derive(c).mesh_frequency_hz(s, derive(c).ring_speed) for s in stages] for c in points])
    step = PLAN.step
    rate = 1.0 / step / max(1, round(1.0 / step / (SAMPLES_PER_PERIOD * float(meshing.max()))))
    options: dict[str, Any] = {"excitation": piece.excitation, "ring": PLAN.ring, "step": step, "sample_rate": rate}
    try:
        batch = Batch(points, **options, threads=1)
    except NoEquilibrium:
        batch = Batch(points, **options, start="zero", threads=1)
    batch.advance(periods=PLAN.transient)
    x = batch.advance(periods=PLAN.record).x[:, :, list(MESHES)]
    found = [[lines(x[p, :, s], rate, float(meshing[p, s])) for s in range(len(MESHES))] for p in range(len(points))]
    return {
        "omega_e": np.array(piece.omega_e),
        "lines": np.array([[line[0] for line in row] for row in found]),
        "dominant": np.array([[line[1] for line in row] for row in found]),
        "others": np.array([[line[2] for line in row] for row in found]),
    }


def lines(x: Array, rate: float, meshing: float) -> tuple[Array, float, float]:
    """Return amplitudes at MULTIPLES of a mesh frequency, where the strongest line is, and the strongest other one.

    Args:
        x: signal, (n,); rate: its samples per second; meshing: mesh frequency, Hz.

    Returns:
        amplitudes in the unit of x, by a Hann window; frequency of the strongest line over the mesh frequency; the
        strongest line elsewhere as a share of that at the mesh frequency.
    """
    window = np.hanning(len(x))
    weighted = window * (x - np.average(x, weights=window))
    time = np.arange(len(x)) / rate
    turns = np.exp(-2j * np.pi * meshing * np.outer(MULTIPLES, time))
    amplitudes = 2.0 * np.abs(turns @ weighted) / window.sum()
    spectrum = 2.0 * np.abs(np.fft.rfft(weighted, 4 * len(x))) / window.sum()
    orders = np.fft.rfftfreq(4 * len(x), 1 / rate) / meshing
    spectrum[orders * meshing < WIDTH * rate / len(x)] = 0.0
    dominant = float(orders[np.argmax(spectrum)])
    elsewhere = np.abs(orders - 1.0) * meshing > WIDTH * rate / len(x)
    return amplitudes, dominant, float(spectrum[elsewhere].max() / amplitudes[MULTIPLES.index(1.0)])


def integrated(piece: Integrated) -> dict[str, Array]:
    """Compute one motion by RK4.

    Returns:
        `period`, `deviation` (3,) of MESHES, as `evaluate.label` has them, and `x` (3, n), their sections; periods and
        deviations 0 where the motion diverges.
    """
    values = {"numerics.integrator": "rk4", "numerics.step": None, "excitation.omega_e": piece.omega_e}
    configuration = config.with_values(values, piece.configuration)
    kinematics = derive(configuration)
    speed, torque = kinematics.ring_speed, kinematics.input_torque
    drive = Drive(speed, speed, torque, torque)
    simulation = Simulation(configuration, drive, start="zero", excitation="tied", sample_rate=RK4_RATE)
    samples = RK4_RATE / kinematics.mesh_frequency_hz("II", speed)
    try:
        simulation.advance(round(piece.transient * samples), drive)
        block = simulation.advance(round(piece.record * samples), drive)
    except Divergence:
        return {"period": np.zeros(3), "deviation": np.zeros(3), "x": np.full((3, 1), np.nan)}
    phase = block.phase[:, names.STAGES.index("II")] / (2.0 * np.pi)
    turns = np.arange(np.ceil(phase[0]), phase[-1])
    found: dict[str, list[Array | float]] = {"period": [], "deviation": [], "x": []}
    for mesh in MESHES:
        x, v = (np.interp(turns, phase, signal[:, mesh]) for signal in (block.x, block.v))
        scale = float(block.x[:, mesh].std()), float(block.v[:, mesh].std())
        found["period"].append(period_of(x, v, scale))
        found["deviation"].append(scale[0])
        found["x"].append(x)
    return {name: np.array(values) for name, values in found.items()}
