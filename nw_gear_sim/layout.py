"""Which entry of the state is which motion.

Displacements q, and velocities v in the same order: the ring's segments as [w | v | p | z], then 14 entries for each
planet, then sun, herringbone 1, their bearings, herringbone 2 and its bearings (the paper's Eq 36 with a copy of the
bearings for each planet). In the co-rotating frame of a ring segment w is radial, v tangential, z axial, and
p = psi r_b the rotation about its centroid on the base circle. u = rotation times base radius, positive in the
gear's own sense of rotation; x, y, z are fixed axes, z along the shafts.
"""

from __future__ import annotations

from dataclasses import dataclass

from nw_gear_common import names

RING_MOTIONS = ("w", "v", "p", "z")
PLANETS = 3

_Motions = tuple[str, ...]
_BEARING: _Motions = ("x", "y", "z")
_GEAR: _Motions = ("u", "x", "y", "z")
_PLANET: tuple[tuple[str, _Motions], ...] = (("pb1", _BEARING), ("p1", _GEAR), ("pb2", _BEARING), ("p2", _GEAR))
_CENTRE: tuple[tuple[str, _Motions], ...] = (
    ("s", _GEAR),
    ("sb", _BEARING),
    ("h1", _GEAR),
    ("b1", _BEARING),
    ("h2", ("u", "x", "y")),
    ("b21", ("x", "y")),
    ("b22", ("x", "y")),
)


@dataclass(frozen=True)
class Node:
    """The entries of one gear or bearing; an index is -1 where it has no such motion."""

    name: str
    u: int
    x: int
    y: int
    z: int


class Layout:
    """Places of all motions of a gearbox whose ring has `segments` segments.

    Attributes:
        segments: number M of ring segments.
        size: number of degrees of freedom, 4 M + 63.
        nodes: gears and bearings by name: `p1_1` .. `p2_3`, `s`, `h1`, `h2`, and the names of the bearings.
    """

    def __init__(self, segments: int) -> None:
        self.segments = segments
        self.nodes: dict[str, Node] = {}
        self._names = [f"ring {motion} {i}" for motion in RING_MOTIONS for i in range(segments)]
        for j in range(1, PLANETS + 1):
            for part, motions in _PLANET:
                self._add(f"{part}_{j}", motions)
        for part, motions in _CENTRE:
            self._add(part, motions)
        self.size = len(self._names)

    def ring(self, motion: str) -> slice:
        """Entries of one motion (w, v, p, z) of all segments."""
        start = RING_MOTIONS.index(motion) * self.segments
        return slice(start, start + self.segments)

    def planet(self, part: str, planet: int) -> Node:
        """Return a gear of a planet (`p1` or `p2`; planet 0, 1, 2)."""
        return self.nodes[f"{part}_{planet + 1}"]

    def bearings(self) -> tuple[Node, ...]:
        """All bearings in the order of the contract (names.BEARINGS)."""
        return tuple(self.nodes[bearing] for bearing in names.BEARINGS)

    def name(self, index: int) -> str:
        """Say which motion an entry is; entries from `size` on are the velocities."""
        return self._names[index] if index < self.size else f"velocity of {self._names[index - self.size]}"

    def _add(self, name: str, motions: tuple[str, ...]) -> None:
        first = len(self._names)
        places = [first + motions.index(axis) if axis in motions else -1 for axis in ("u", "x", "y", "z")]
        self.nodes[name] = Node(name, *places)
        self._names.extend(f"{name} {motion}" for motion in motions)
