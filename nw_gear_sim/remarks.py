"""What a configuration can be assembled with but shouldn't: said in words, refused nowhere."""

from __future__ import annotations

from nw_gear_sim.kinematics import Kinematics
from nw_gear_sim.params import Configuration

FEW_SEGMENTS = 25
"""With these the twenty lowest natural frequencies are still within 2 % of those with 200 segments (measured)."""


def remarks(configuration: Configuration, kinematics: Kinematics) -> list[str]:
    """Return what is worth knowing before results are believed, one sentence each.

    Segments pass a planet M times a turn of the ring, and its teeth z times: where one is a multiple of the other, an
    effect of the ring's division looks like one of its teeth.
    """
    found = []
    count, teeth = configuration.ring.segments, configuration.gears.ring.teeth
    if count % teeth == 0:
        times = count // teeth
        what = "the mesh frequency of stage I" if times == 1 else f"{times} times the mesh frequency of stage I"
        found.append(f"ring.segments: {count} segments pass a planet at {what}; their effects can't be told apart")
    if count < FEW_SEGMENTS:
        found.append(f"ring.segments: {count} are few; the lowest natural frequencies are off by more than 2 %")
    for stage in kinematics.stages:
        if stage.pair.contact_ratio < 1.0:
            ratio = f"{stage.pair.contact_ratio:.3f}"
            found.append(f"stage {stage.name}: transverse contact ratio {ratio} is below 1; the flanks lose contact")
    return found
