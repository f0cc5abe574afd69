"""Constant rows of the meshes: which motions of which gears make their elongation, and where friction acts.

Senses: ring and planets turn counterclockwise about +z, sun and herringbone 1 clockwise, herringbone 2
counterclockwise. With r from the gearbox axis to the planet, t = z x r and the working transverse angle a, the
normal n (direction of the force on the driven gear) is

    I: -sin a r + cos a t      II: -sin a r - cos a t      III: sin a x - cos a y (herringbone 2 at angle 0)
    x_n = cos bb [u_driver - u_driven + n . (X_driver - X_driven)] + sin bb (z_driver - z_driven) + e

The herringbone's axial forces cancel, so that stage III has no z. The driven gear feels sigma G (z x n) of friction,
sigma = +1, -1, +1 for I, II, III, and the moment -m_b, the driver the opposite force and +m_a.
"""

from __future__ import annotations

import math

from nw_gear_sim.kinematics import PLANET_ANGLES, Kinematics, Stage
from nw_gear_sim.layout import Layout, Node
from nw_gear_sim.physics.mesh import Rows, empty_rows

SIGMA = (1.0, -1.0, 1.0)
RING_ENTRIES = 8
"""Entries of the internal meshes' rows that belong to ring segments; `physics.engagement` sets them."""


def contact_rows(kinematics: Kinematics, layout: Layout) -> Rows:
    """Return the rows of the seven meshes (names.MESHES), those of ring segments still empty."""
    rows = empty_rows()
    first, second, third = kinematics.stages
    for j, angle in enumerate(PLANET_ANGLES):
        radial, tangential = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))
        n = _normal(-math.sin(first.pair.working_angle), radial, math.cos(first.pair.working_angle), tangential)
        _fill(rows, j, RING_ENTRIES, first, layout.planet("p1", j), n, driver=False)
        n = _normal(-math.sin(second.pair.working_angle), radial, -math.cos(second.pair.working_angle), tangential)
        _fill(rows, 3 + j, 0, second, layout.planet("p2", j), n, driver=True)
        _fill(rows, 3 + j, 4, second, layout.nodes["s"], n, driver=False)
    n = (math.sin(third.pair.working_angle), -math.cos(third.pair.working_angle))
    _fill(rows, 6, 0, third, layout.nodes["h1"], n, driver=True)
    _fill(rows, 6, 3, third, layout.nodes["h2"], n, driver=False)
    return rows


def _normal(a: float, radial: tuple[float, float], b: float, tangential: tuple[float, float]) -> tuple[float, float]:
    return a * radial[0] + b * tangential[0], a * radial[1] + b * tangential[1]


def _fill(rows: Rows, mesh: int, entry: int, stage: Stage, node: Node, n: tuple[float, float], *, driver: bool) -> None:
    """Set the entries u, x, y (and z where the stage isn't a herringbone) of one gear.

    Moments of friction: m = rho_0 G +- G_1 with rho_0 = r_b tan a at the pitch point; with s the radius of curvature
    grows for an external driver and shrinks for an external driven gear and for both gears of an internal pair.
    """
    pair, sign = stage.pair, 1.0 if driver else -1.0
    cos, sin = math.cos(pair.base_helix), math.sin(pair.base_helix)
    sigma = SIGMA[("I", "II", "III").index(stage.name)]
    base_radius = (pair.driver if driver else pair.driven).base_radius
    grows = 1.0 if driver and not pair.internal else -1.0
    entries = [
        (node.u, cos, math.tan(pair.working_angle), grows / base_radius),
        (node.x, cos * n[0], sigma * n[1], 0.0),
        (node.y, cos * n[1], -sigma * n[0], 0.0),
    ]
    if pair.halves == 1:
        entries.append((node.z, sin, 0.0, 0.0))
    for k, (place, normal, slide, roll) in enumerate(entries, start=entry):
        rows.place[mesh, k] = place
        rows.normal[mesh, k] = sign * normal
        rows.slide[mesh, k] = sign * slide
        rows.roll[mesh, k] = sign * roll
