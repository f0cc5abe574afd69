"""The gear pair of the paper's Sec. 5 as one oscillator with a cubic restoring force and delayed feedback."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

from nw_gear_common.errors import InputError

STAGES = ("I", "II", "III")
PARAMETERS = ("zeta", "g_d", "g_v", "tau_d", "tau_v", "force", "mean_force")
"""What a family of curves may be drawn over, besides the frequency."""


@dataclass(frozen=True)
class GearPair:
    """Numbers of the equation, all dimensionless.

        x'' + w0^2 x + eps [2 c zeta x' + q w0 x^3 - g_d x(t - tau_d) - g_v x'(t - tau_v)] = f0 + f cos(nu t)

    which is the paper's Eq. (63), (64) or (65) without fluctuation of the mesh stiffness, with the backlash replaced by
    its cubic fit (Eq. 66): w0^2 = c k_m delta_1, eps q w0 = c k_m delta_2.

    Attributes:
        stage: I, II or III.
        eps: size of everything in the brackets.
        w0: frequency of the linear part.
        q: c delta_2 / w0, the cubic part.
        c: n cos(alpha_n) cos(beta), the share of damping and mesh force along the coordinate, n pairs in mesh.
        zeta: damping; force, mean_force: f and f0 of the excitation.
        g_d, g_v: gains of the feedback of displacement and velocity; tau_d, tau_v: their delays.
    """

    stage: str
    eps: float
    w0: float
    q: float
    c: float
    zeta: float
    force: float
    mean_force: float
    g_d: float
    g_v: float
    tau_d: float
    tau_v: float

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name != "stage" and not math.isfinite(value):
                raise InputError(f"gear pair: {field.name}", "a finite number", str(value))
        for name in ("eps", "w0"):
            if getattr(self, name) <= 0.0:
                raise InputError(f"gear pair: {name}", "above 0", f"{getattr(self, name):g}")
        for name in ("tau_d", "tau_v"):
            if getattr(self, name) < 0.0:
                raise InputError(f"gear pair: {name}", "at least 0", f"{getattr(self, name):g}")

    def having(self, **values: float) -> GearPair:
        """Return the pair with some parameters changed.

        Raises:
            InputError: no parameter of that name.
        """
        for name in values:
            if name not in PARAMETERS:
                raise InputError(f"parameter {name}", "one of " + ", ".join(PARAMETERS), name)
        return replace(self, **values)  # type: ignore[arg-type]  # the texts are excluded above


def gear_pair(stage: str) -> GearPair:
    """Return the pair of a stage with the base values of the paper's Sec. 5.2.

    Printed there: f, f0, zeta, g_d, g_v and tau = T/9. Not printed, and fitted so that the resonances lie where the
    figures have them: eps, w0, q; T is taken as 2 pi / w0. Angles from the paper's Table of gear data.

    Raises:
        InputError: no such stage.
    """
    if stage not in STAGES:
        raise InputError("stage", "one of " + ", ".join(STAGES), stage)
    pairs, pressure, helix, eps, w0, q = {
        "I": (3, 20.0, 4.0, 0.010, 0.461348, 0.059382),
        "II": (3, 20.0, 7.2, 0.010, 0.981832, 0.030452),
        "III": (1, 15.0, 32.0, 0.0309, 1.063919, 0.024392),
    }[stage]
    zeta, force, mean, g_d, g_v = {
        "I": (0.06, 1.0, 0.2, 0.1, 0.1),
        "II": (0.05, 4.0, 0.5, -0.1, -0.05),
        "III": (0.05, 4.0, 0.5, 0.2, 0.1),
    }[stage]
    c = pairs * math.cos(math.radians(pressure)) * math.cos(math.radians(helix))
    tau = 2.0 * math.pi / w0 / 9.0
    return GearPair(stage, eps, w0, q, c, zeta, force, mean, g_d, g_v, tau, tau)
