"""What turns of the gears tell: sidebands beside the mesh lines, and FM0, FM4, NA4 of either gear's mean turn."""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.fm0 import fm0
from nw_gear_monitor.indicators.fm4 import fm4
from nw_gear_monitor.indicators.na4 import na4_after
from nw_gear_monitor.indicators.sidebands import LEAST_TURNS, sideband_energy_ratio, sidebands_of_cycles
from nw_gear_monitor.indicators.window import Column, Indicator, Memory, MeshWindow
from nw_gear_monitor.signals.average import LEAST_TURNS as LEAST_AVERAGED
from nw_gear_monitor.signals.average import separate
from nw_gear_monitor.signals.cycles import mean_turn

GEARS = ("driver", "driven")
WANTED_TURNS = 4
"""Turns of the gear with more teeth in the window, where that is no longer than what is kept; LEAST_TURNS at least."""
FLOOR_SHARE = 1e-3
"""A residual whose rms is a smaller share of the average's is taken to have this one: next to nothing isn't damage."""
NAN = math.nan


def wanted_seconds(frequency: float, teeth: tuple[int, int], least: int, most: int) -> int | None:
    """Length of the window of `gear_turns` in whole seconds.

    Args:
        frequency: of the mesh, Hz.
        teeth: of both gears.
        least, most: seconds that the window has at least, and that are kept.

    Returns:
        Enough for WANTED_TURNS of the gear with more teeth, and a second more for what is left over at the ends, within
        the limits; None where even `most` seconds don't hold LEAST_TURNS.
    """
    turn = max(teeth) / frequency
    if LEAST_TURNS * turn > most:
        return None
    return min(max(math.ceil(WANTED_TURNS * turn), least), most)


def _sidebands(window: MeshWindow) -> tuple[float, ...]:
    if window.turns is None:
        return (NAN,) * len(SIDEBANDS.columns)
    found = sidebands_of_cycles(window.turns.cycles, window.turns.teeth)
    values = []
    for gear in (found.driver, found.driven):
        values += [float(np.mean(gear[0, 0])), *sideband_energy_ratio(gear, found.mesh).tolist()]
    return tuple(values)


def _averages(window: MeshWindow) -> tuple[float, ...]:
    if window.turns is None:
        return (NAN,) * len(AVERAGES.columns)
    both = (_average(window.turns.cycles, z, window.memory, g) for g, z in zip(GEARS, window.turns.teeth, strict=True))
    return tuple(value for values in both for value in values)


def _average(cycles: Array, teeth: int, memory: Memory, gear: str) -> tuple[float, float, float]:
    """FM0, FM4 and NA4 of one gear; NaN for what isn't defined."""
    average, turns = mean_turn(cycles, teeth)
    if turns < LEAST_AVERAGED:
        return NAN, NAN, NAN
    try:
        parts, height = separate(average, teeth), fm0(average, teeth)
    except InputError:
        return NAN, NAN, NAN
    floor = (FLOOR_SHARE * float(np.std(average))) ** 2
    earlier, records = memory.sums.get(gear, (0.0, 0))
    memory.add(gear, float(np.var(parts.residual)))
    try:
        return height, fm4(parts.difference, parts.regular), na4_after(parts.residual, earlier, records, floor)
    except InputError:  # nothing beside the regular lines but rounding
        return height, NAN, NAN


def _gear_columns(gear: str) -> tuple[Column, ...]:
    return (
        Column(f"sideband_{gear}", "m", f"mean of the two first sidebands of the mesh line at the {gear} gear's speed"),
        *(
            Column(f"sideband_ratio_{gear}_{k}", "", f"sideband energy ratio at {k} x mesh frequency, {gear} gear")
            for k in (1, 2, 3)
        ),
    )


def _average_columns(gear: str) -> tuple[Column, ...]:
    return (
        Column(f"fm0_{gear}", "", f"FM0: peak-to-peak over mesh lines in the mean turn of the {gear} gear"),
        Column(f"fm4_{gear}", "", f"FM4: kurtosis of that mean turn without its regular lines, {gear} gear"),
        Column(f"na4_{gear}", "", f"NA4: the same with sidebands, over the mean variance until now, {gear} gear"),
    )


SIDEBANDS = Indicator(tuple(column for gear in GEARS for column in _gear_columns(gear)), _sidebands)
AVERAGES = Indicator(tuple(column for gear in GEARS for column in _average_columns(gear)), _averages)
