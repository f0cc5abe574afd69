"""What the paper leaves open and Sec. 4 depends on: ranges, and draws from them that fill them evenly."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from nw_gear_common.tables import Array
from nw_gear_sim import config
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration

VALUE, FACTOR, STIFFNESS = "value", "factor", "stiffness"
"""What a number of a draw is: the value itself, a factor on the base configuration's, or one on a mesh stiffness, which
the base configuration may leave to the geometry."""
BEARINGS = ("pb1", "pb2", "sb", "b1", "b21", "b22")
SPREAD = 0.1
"""Standard deviation of the draws around a good one, as a share of each range."""


@dataclass(frozen=True)
class Unknown:
    """One number that the paper doesn't give.

    Attributes:
        name: of it; keys: of the configuration that it sets; kind: VALUE, FACTOR or STIFFNESS.
        low, high: its range, in SI units; logarithmic: whether factors or differences count; why: the range's reason.
    """

    name: str
    keys: tuple[str, ...]
    kind: str
    low: float
    high: float
    logarithmic: bool
    why: str

    def at(self, share: float) -> float:
        """Return the number at a share, 0 to 1, of the range."""
        if self.logarithmic:
            return math.exp(math.log(self.low) + share * math.log(self.high / self.low))
        return self.low + share * (self.high - self.low)


_STAGES = ("I", "II", "III")


def _each(name: str, key: str, kind: str, low: float, high: float, logarithmic: bool, why: str) -> tuple[Unknown, ...]:
    """Return a number that every stage has of its own."""
    return tuple(Unknown(f"{name}_{s}", (f"mesh.{s}.{key}",), kind, low, high, logarithmic, why) for s in _STAGES)


_SHAFTS = tuple(f"shafts.{k}" for k in ("planet_radial", "planet_axial", "sun_radial", "sun_axial", "output_radial"))
_CLEARANCES, _DAMPERS = (tuple(f"bearings.{b}.{k}" for b in BEARINGS) for k in ("clearance", "damping"))
_DAMPING = tuple(f"mesh.{s}.damping_ratio" for s in _STAGES)
_SIGN = "Sec. 5.2 has 0.3 and 0.4; the sign is the phase to the transmission error"

SPACE: tuple[Unknown, ...] = (
    Unknown("load", ("operation.load",), VALUE, 0.02, 1.0, True, "Sec. 4 names no torque; chaos needs a low one"),
    *_each("error", "error_amplitude", VALUE, 2e-6, 60e-6, True, "from a fine grade to beyond the backlash"),
    *_each("variation", "stiffness_variation", VALUE, -0.4, 0.4, False, _SIGN),
    Unknown("damping", _DAMPING, VALUE, 0.02, 0.1, True, "usual values of meshes"),
    *_each("stiffness", "stiffness", STIFFNESS, 0.2, 2.0, True, "the values of Fig. 5 aren't in print"),
    *_each("backlash", "backlash", VALUE, 40e-6, 60e-6, False, "Table 2 has two rows, 45 to 55 um"),
    Unknown("clearance", _CLEARANCES, FACTOR, 0.5, 2.0, True, "Table 3 isn't in print"),
    Unknown("bearing_damping", _DAMPERS, FACTOR, 0.3, 3.0, True, "not given"),
    Unknown("shafts", _SHAFTS, FACTOR, 0.3, 3.0, True, "not given"),
    Unknown("generator", ("generator.stiffness",), FACTOR, 0.1, 10.0, True, "not given"),
)
"""All that is drawn. Factors are on the base configuration's numbers."""


def shares(draws: int, seed: int) -> Array:
    """Return draws as shares of the ranges, (draws, unknowns): scrambled Sobol points (Owen 1998).

    The first n of them are the same however many are asked for.
    """
    sobol = qmc.Sobol(len(SPACE), scramble=True, seed=seed)
    points = sobol.random_base2(max(draws - 1, 1).bit_length())
    return np.asarray(points[:draws], dtype=float)


def around(centre: Array, draws: int, seed: int) -> Array:
    """Return normally distributed draws around one, as shares of the ranges, clipped to them."""
    noise = np.random.default_rng(seed).standard_normal((draws, len(centre)))
    return np.clip(centre + SPREAD * noise, 0.0, 1.0)


def named(draw: Array) -> dict[str, float]:
    """Return name -> number of one draw."""
    return {unknown.name: unknown.at(float(share)) for unknown, share in zip(SPACE, draw, strict=True)}


def settings(numbers: Mapping[str, float], base: Configuration) -> dict[str, float]:
    """Return what a draw sets: key of the configuration -> value in SI units."""
    stages = dict(zip(_STAGES, derive(base).stages, strict=True))
    values: dict[str, float] = {}
    for unknown in SPACE:
        for key in unknown.keys:
            number = numbers[unknown.name]
            if unknown.kind == FACTOR:
                number *= _value(base, key)
            elif unknown.kind == STIFFNESS:
                number *= stages[key.split(".")[1]].stiffness.transverse
            values[key] = number
    return values


def configured(numbers: Mapping[str, float], base: Configuration) -> Configuration:
    """Return the base configuration with a draw's numbers and a fixed operating point."""
    return config.with_values({"operation.drive": "fixed", **settings(numbers, base)}, base)


def _value(base: Configuration, key: str) -> float:
    value: object = base
    for part in key.split("."):
        value = getattr(value, part)
    assert isinstance(value, float)
    return value
