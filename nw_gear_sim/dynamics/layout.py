"""Which entry of the state vector is which motion.

q holds first the ring, structure of arrays over its M segments in the frame that turns with it: w radial, v tangential,
p = psi r_b (centroid rotation times the base radius), z axial; then three planets of 14 entries, then the central and
the output shaft. 4 M + 63 degrees of freedom: 463 at M = 100 (the paper's Eq 36 counts the planet bearings once; there
are three of each).
"""

from __future__ import annotations

from collections.abc import Iterator

PER_PLANET = 14
CENTRE = 21
RIGID = 3 * PER_PLANET + CENTRE
"""Degrees of freedom besides those of the ring."""

RING_MOTIONS = ("w", "v", "p", "z")

PLANET_PARTS = (("pb1", "xyz"), ("p1", "uxyz"), ("pb2", "xyz"), ("p2", "uxyz"))
CENTRE_PARTS = (("s", "uxyz"), ("sb", "xyz"), ("h1", "uxyz"), ("b1", "xyz"), ("h2", "uxy"), ("b21", "xy"), ("b22", "xy"))

# Offsets within a planet, and behind the planets.
PB1, P1, PB2, P2 = 0, 3, 7, 10
SUN, SB, H1, B1, H2, B21, B22 = 0, 4, 7, 11, 14, 17, 19


def degrees_of_freedom(segments: int) -> int:
    """Number of entries of q."""
    return 4 * segments + RIGID


def planet(segments: int, j: int) -> int:
    """First entry of planet j = 0, 1, 2."""
    return 4 * segments + PER_PLANET * j


def centre(segments: int) -> int:
    """First entry of the central shaft."""
    return 4 * segments + 3 * PER_PLANET


def motions(segments: int) -> Iterator[str]:
    """Names of the entries of q in order, for instance `ring w[17]`, `p1_2 u`, `h1 x`."""
    for motion in RING_MOTIONS:
        for i in range(segments):
            yield f"ring {motion}[{i}]"
    for j in (1, 2, 3):
        for part, axes in PLANET_PARTS:
            for axis in axes:
                yield f"{part}_{j} {axis}"
    for part, axes in CENTRE_PARTS:
        for axis in axes:
            yield f"{part} {axis}"
