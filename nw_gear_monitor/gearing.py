"""What the monitor has to know of the gearbox it watches: frequency ratios, planet phases, rated speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration


@dataclass(frozen=True, eq=False)
class Gearing:
    """Numbers that follow from the configuration.

    Attributes:
        rated_frequency: (3,) mesh frequencies of the stages at rated speed, Hz.
        planet_phase: what the mesh phase of each mesh has more than that of its stage's planet 1, rad.
    """

    rated_frequency: Array
    planet_phase: dict[str, float]

    @property
    def ratios(self) -> Array:
        """Mesh frequencies over that of stage I, shape (3,)."""
        ratios: Array = self.rated_frequency / self.rated_frequency[0]
        return ratios


def gearing(configuration: Configuration) -> Gearing:
    """Derive the gearing from a configuration.

    Raises:
        InputError: the gearbox can't be assembled.
    """
    derived = derive(configuration)
    frequency = [derived.mesh_frequency_hz(stage, configuration.turbine.rated_speed) for stage in names.STAGES]
    phases = {
        mesh: derived.stage(stage).planet_phases[j]
        for stage in names.STAGES
        for j, mesh in enumerate(names.MESHES_OF_STAGE[stage])
    }
    return Gearing(np.array(frequency), phases)
