"""Stiffness of a gear mesh and of a roller contact, from their geometry.

ISO 6336-1 method B for the mean, the contact-length Fourier series for its variation, Palmgren's law for rollers.
The standard's coefficients are quoted from memory, not checked against its text.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from nw_gear_sim.geometry import PairGeometry
from nw_gear_sim.params import Bearing, Mesh, Toothing

CORRECTION = 0.8
"""C_M: measured over theoretical stiffness (ISO 6336-1)."""
PALMGREN = 8.06e4
"""Line contact of steel rollers: Q = 8.06e4 l^(8/9) delta^(10/9), N and mm (Harris, Rolling Bearing Analysis)."""


@dataclass(frozen=True)
class MeshStiffness:
    """Stiffness of a mesh and what belongs to it.

    Attributes:
        transverse: mean K_m on the base-circle arc, N/m.
        normal: mean K along the normal elongation, transverse / cos^2 beta_b, N/m.
        variation: first harmonic over mean, signed.
        effective_mass: M_e of the pair on the base-circle arc, kg.
        damping: C along the normal elongation, N s/m.
        phase: K = K_m (1 + variation cos(mesh phase - phase)), tooth entry at mesh phase 0, rad.
    """

    transverse: float
    normal: float
    variation: float
    effective_mass: float
    damping: float
    phase: float


def tooth_stiffness(pair: PairGeometry, toothing: Toothing) -> float:
    """Return the single stiffness c' of a pair of steel teeth, N/(m m) (ISO 6336-1 method B).

    1/q' terms 0.04723 + 0.15551/z_n1 + 0.25791/z_n2 with z_n = z / cos^3 beta, infinite for a ring gear; the terms in
    the profile shifts are left out. c' = C_M C_R C_B cos(beta) / q' with C_R = 1 (solid discs) and
    C_B = (1 + 0.5 (1.2 - h_fP)) (1 - 0.02 (20 deg - alpha_n)). For steel and external or internal spur or helical
    gears with a line load above 100 N/mm.
    """
    pinion, wheel = sorted((pair.driver, pair.driven), key=lambda gear: gear.teeth)
    cube = math.cos(toothing.helix_angle) ** 3
    wheel_term = 0.0 if pair.internal else 0.25791 * cube / wheel.teeth
    flexibility = 0.04723 + 0.15551 * cube / pinion.teeth + wheel_term
    rack = (1 + 0.5 * (1.2 - toothing.dedendum)) * (1 - 0.02 * (20 - math.degrees(toothing.pressure_angle)))
    return CORRECTION * rack * math.cos(toothing.helix_angle) / flexibility * 1e9


def transverse_stiffness(pair: PairGeometry, toothing: Toothing) -> float:
    """Return the mean mesh stiffness K_m = c' (0.75 eps_alpha + 0.25) B in N/m (ISO 6336-1, eps_alpha >= 1.2)."""
    return tooth_stiffness(pair, toothing) * (0.75 * pair.contact_ratio + 0.25) * pair.face_width


def stiffness_variation(pair: PairGeometry) -> float:
    """Return the first harmonic of the contact length over its mean: 2 sinc(eps_alpha) sinc(eps_beta), signed.

    sinc(x) = sin(pi x) / (pi x). Holds where the stiffness per length of contact line is constant.
    """
    return 2 * _sinc(pair.contact_ratio) * _sinc(pair.overlap_ratio)


def mesh_stiffness(pair: PairGeometry, toothing: Toothing, mesh: Mesh, effective_mass: float) -> MeshStiffness:
    """Put the stiffness of a mesh together; values given in `mesh` stand before computed ones.

    C = 2 zeta sqrt(K_m M_e) on the base-circle arc, over cos^2 beta_b along the normal.
    """
    given, varied = mesh.stiffness, mesh.stiffness_variation
    transverse = transverse_stiffness(pair, toothing) if given is None else given
    square = math.cos(pair.base_helix) ** 2
    return MeshStiffness(
        transverse=transverse,
        normal=transverse / square,
        variation=stiffness_variation(pair) if varied is None else varied,
        effective_mass=effective_mass,
        damping=2 * mesh.damping_ratio * math.sqrt(transverse * effective_mass) / square,
        phase=math.pi * (pair.contact_ratio + pair.overlap_ratio),
    )


def roller_stiffness(bearing: Bearing, exponent: float) -> float:
    """Return the load constant K_b of Q = K_b delta^n of one roller between two raceways, N/m^n.

    Palmgren's K = 8.06e4 l^(8/9) N/mm^(10/9) for each contact, two contacts in series: K_b = K 2^(-n), n = 10/9.
    """
    if bearing.stiffness is not None:
        return bearing.stiffness
    contact = PALMGREN * math.pow(bearing.roller_length * 1e3, 8 / 9)
    return contact * math.pow(1e3 / 2, exponent)


def _sinc(x: float) -> float:
    return 1.0 if x == 0 else math.sin(math.pi * x) / (math.pi * x)
