"""How points fixed to a body move with its coordinates: all that the reference equations know of mechanics."""

from dataclasses import dataclass

import numpy as np

X, Y, Z = np.eye(3)

Movement = dict[str, np.ndarray]
"""How far a point moves (three components) per unit of each coordinate."""


def turned(vector: np.ndarray) -> np.ndarray:
    """Return z x vector: the velocity of a point there per unit of rotation about z."""
    return np.array([-vector[1], vector[0], 0 * vector[0]])


def polar(angle: complex) -> tuple[np.ndarray, np.ndarray]:
    """Radial and tangential unit vectors at an angle from the x axis."""
    radial = np.array([np.cos(angle), np.sin(angle), 0 * angle])
    return radial, turned(radial)


def along(direction: np.ndarray, movement: Movement) -> dict[str, complex]:
    """Return how far the point moves in a direction, per unit of each coordinate."""
    return {name: complex(direction @ vector) for name, vector in movement.items()}


def minus(first: Movement, second: Movement) -> Movement:
    """Return the movement of the first point as seen from the second; they share no coordinate."""
    return {**first, **{name: -vector for name, vector in second.items()}}


@dataclass(frozen=True)
class Gear:
    """A gear on a fixed axis: where it is, in which sense it turns (+1 counter-clockwise about z), its base radius."""

    name: str
    centre: np.ndarray
    sense: int
    base_radius: float
    axial: bool = True

    def movement(self, point: np.ndarray) -> Movement:
        """Movement of a point fixed to the gear."""
        out = {f"{self.name}.x": X, f"{self.name}.y": Y, f"{self.name}.z": Z}
        if not self.axial:
            del out[f"{self.name}.z"]
        out[f"{self.name}.u"] = self.sense / self.base_radius * turned(point - self.centre)
        return out
