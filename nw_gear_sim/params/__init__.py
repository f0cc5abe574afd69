"""The parameters of the gearbox, its turbine and its operating point: a tree of frozen dataclasses in SI units.

Each leaf declares unit, bounds and text; the values with their sources are in `config/gearbox.yaml` (see `config`).
"""

from __future__ import annotations

from dataclasses import dataclass

from nw_gear_sim.params.gears import CentreDistance, Friction, Gear, Gears, Mesh, Meshes, Toothing, Toothings, Wheel
from nw_gear_sim.params.operation import Drivetrain, Excitation, Gravity, Numerics, Operation, Turbine, Wind
from nw_gear_sim.params.structure import Bearing, Bearings, Generator, Housing, Housings, Ring, Shafts, Torsion

__all__ = [
    "Bearing",
    "Bearings",
    "CentreDistance",
    "Configuration",
    "Drivetrain",
    "Excitation",
    "Friction",
    "Gear",
    "Gears",
    "Generator",
    "Gravity",
    "Housing",
    "Housings",
    "Mesh",
    "Meshes",
    "Numerics",
    "Operation",
    "Ring",
    "Shafts",
    "Toothing",
    "Toothings",
    "Torsion",
    "Turbine",
    "Wheel",
    "Wind",
]


@dataclass(frozen=True)
class Configuration:
    """Everything that determines a run of the simulator besides wind and seed."""

    gears: Gears
    toothing: Toothings
    centre_distance: CentreDistance
    mesh: Meshes
    friction: Friction
    bearings: Bearings
    shafts: Shafts
    torsion: Torsion
    ring: Ring
    generator: Generator
    housing: Housings
    turbine: Turbine
    drivetrain: Drivetrain
    wind: Wind
    operation: Operation
    excitation: Excitation
    gravity: Gravity
    numerics: Numerics
