"""Geometry of a pair of helical gears at its working centre distance.

Involute gears in the transverse plane (ISO 21771): profile shift follows from the centre distance, and every
projection of forces uses the working angle and the working pitch radii, not the reference ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from nw_gear_common.errors import InputError
from nw_gear_sim.params import Toothing


@dataclass(frozen=True)
class GearGeometry:
    """Radii of one gear in metres, and its profile shift coefficient.

    Attributes:
        reference_radius: z m_t / 2.
        base_radius: the circle which the involute starts from.
        pitch_radius: working pitch radius, base_radius / cos(working angle).
        tip_radius: without tip shortening.
        profile_shift: coefficient, in normal modules.
    """

    teeth: int
    reference_radius: float
    base_radius: float
    pitch_radius: float
    tip_radius: float
    profile_shift: float


@dataclass(frozen=True)
class PairGeometry:
    """A gear pair; lengths in metres, angles in rad.

    Attributes:
        driver, driven: radii in the direction of the power flow.
        internal: whether one of them is a ring gear.
        halves: 1 helical, 2 herringbone.
        face_width: whole face width.
        centre_distance, reference_centre_distance: working one, and the one without profile shift.
        transverse_angle: alpha_t; working_angle: alpha_wt, both transverse; base_helix: beta_b.
        base_pitch: transverse p_bt, one tooth along the line of action.
        contact_ratio: transverse eps_alpha at the working centre distance.
        overlap_ratio: eps_beta of one half.
        approach, recess: path of contact before and after the pitch point.
    """

    driver: GearGeometry
    driven: GearGeometry
    internal: bool
    halves: int
    face_width: float
    centre_distance: float
    reference_centre_distance: float
    transverse_angle: float
    working_angle: float
    base_helix: float
    base_pitch: float
    contact_ratio: float
    overlap_ratio: float
    approach: float
    recess: float

    @property
    def speed_ratio(self) -> float:
        """Speed of the driven gear over that of the driver, without sign."""
        return self.driver.teeth / self.driven.teeth


def involute(angle: float) -> float:
    """Involute function inv(angle) = tan(angle) - angle."""
    return math.tan(angle) - angle


def solve_pair(
    place: str, toothing: Toothing, teeth: tuple[int, int], centre_distance: float | None, *, ring: bool = False
) -> PairGeometry:
    """Find the working geometry of a pair with teeth (driver, driven); the driver is a ring gear if `ring` is true.

    cos(alpha_wt) = a cos(alpha_t) / a'; without a centre distance a' (m) the pair has its reference distance a. The
    profile shifts follow in `_shifts`. Tip circles are not shortened, and interference at the tips is not looked at.

    Raises:
        InputError: no working angle, or no path of contact, at this centre distance; `place` names the stage.
    """
    alpha_n, beta, module = toothing.pressure_angle, toothing.helix_angle, toothing.normal_module
    alpha_t = math.atan(math.tan(alpha_n) / math.cos(beta))
    reference = (teeth[0] - teeth[1] if ring else teeth[0] + teeth[1]) * module / math.cos(beta) / 2
    if reference <= 0:
        raise InputError(f"teeth of the ring in stage {place}", f"more than the planet's {teeth[1]}", str(teeth[0]))
    working = reference if centre_distance is None else centre_distance
    if working <= reference * math.cos(alpha_t):
        least = f"more than {reference * math.cos(alpha_t):.6g} m, below which the teeth have no working pressure angle"
        raise InputError(f"centre distance of stage {place}", least, f"{working:.6g} m")
    alpha_w = math.acos(reference * math.cos(alpha_t) / working)
    shifts = _shifts(toothing, teeth, involute(alpha_w) - involute(alpha_t), ring)
    driver = _gear(toothing, teeth[0], shifts[0], (alpha_t, alpha_w), internal=ring)
    driven = _gear(toothing, teeth[1], shifts[1], (alpha_t, alpha_w), internal=False)
    base_pitch = math.pi * module / math.cos(beta) * math.cos(alpha_t)
    approach = _path(place, driven, alpha_w)
    recess = -_path(place, driver, alpha_w) if ring else _path(place, driver, alpha_w)
    if min(approach, recess) <= 0:
        got = f"{approach:.4g} m before and {recess:.4g} m after it"
        raise InputError(f"teeth of stage {place}", "contact on both sides of the pitch point", got)
    return PairGeometry(
        driver=driver,
        driven=driven,
        internal=ring,
        halves=toothing.halves,
        face_width=toothing.face_width,
        centre_distance=working,
        reference_centre_distance=reference,
        transverse_angle=alpha_t,
        working_angle=alpha_w,
        base_helix=math.asin(math.sin(beta) * math.cos(alpha_n)),
        base_pitch=base_pitch,
        contact_ratio=(approach + recess) / base_pitch,
        overlap_ratio=toothing.face_width / toothing.halves * math.sin(beta) / (math.pi * module),
        approach=approach,
        recess=recess,
    )


def _shifts(toothing: Toothing, teeth: tuple[int, int], involutes: float, ring: bool) -> tuple[float, float]:
    """Profile shift coefficients of driver and driven gear; the pinion's is given, the wheel's closes the backlash.

    x2 + x1 = (z2 + z1) (inv alpha_wt - inv alpha_t) / (2 tan alpha_n) (ISO 21771), with minus signs on both sides
    for a ring gear; `involutes` is the difference of the involutes.
    """
    sign = -1 if ring else 1
    total = (teeth[0] + sign * teeth[1]) * involutes / (2 * math.tan(toothing.pressure_angle))
    if teeth[1] <= teeth[0]:
        return total - sign * toothing.pinion_shift, toothing.pinion_shift
    return toothing.pinion_shift, total - toothing.pinion_shift


def _gear(toothing: Toothing, teeth: int, shift: float, angles: tuple[float, float], *, internal: bool) -> GearGeometry:
    alpha_t, alpha_w = angles
    reference = teeth * toothing.normal_module / math.cos(toothing.helix_angle) / 2
    base = reference * math.cos(alpha_t)
    outward = shift - toothing.addendum if internal else shift + toothing.addendum
    tip = reference + toothing.normal_module * outward
    return GearGeometry(teeth, reference, base, base / math.cos(alpha_w), tip, shift)


def _path(place: str, gear: GearGeometry, alpha_w: float) -> float:
    """Length of the line of action from the pitch point outward to the gear's tip circle, in m."""
    if gear.tip_radius <= gear.base_radius:
        expected = f"the tip of the gear with {gear.teeth} teeth beyond its base radius {gear.base_radius:.6g} m"
        raise InputError(f"teeth of stage {place}", expected, f"{gear.tip_radius:.6g} m")
    return math.sqrt(gear.tip_radius**2 - gear.base_radius**2) - gear.base_radius * math.tan(alpha_w)
