"""What a baseline belongs to: the machine, its columns, and how the features were made."""

from __future__ import annotations

from typing import Any

from nw_gear_monitor.alarms.features import BEARING, BEARING_RULES, MESH_RULES
from nw_gear_monitor.alarms.settings import LOAD_RATIO, SPEED_RATIO
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.pipeline import Windows


def identity_of(machine: Machine, windows: Windows) -> dict[str, Any]:
    """Everything that has to be the same for statistics to be compared; plain values by a name for people.

    Not in it: the sample rate, which only the waveform tells (see `Keeper.admit`), and what may change about one
    machine (errors of its teeth, loads): finding that is what baselines are for.
    """
    return {
        "machine": machine.name,
        "stages": list(machine.stage_names),
        "nominal mesh frequencies (Hz)": [float(stage.frequency) for stage in machine.stages],
        "teeth": [None if stage.teeth is None else list(stage.teeth) for stage in machine.stages],
        "half gaps (m)": [None if stage.half_gap is None else float(stage.half_gap) for stage in machine.stages],
        "columns": [column for channel in machine.channels for column in (channel.x, channel.v)],
        "bearings": [[bearing.name, *bearing.columns] for bearing in machine.bearings],
        "rollers": [bearing.rollers for bearing in machine.bearings],
        "windows (s)": [windows.spectrum_seconds, windows.label_seconds],
        "envelope (Hz)": [windows.envelope_low, windows.envelope_high],
        "ratios of bins": [SPEED_RATIO, LOAD_RATIO],
        "scales": [[rule.pattern, rule.offset, rule.window] for rule in MESH_RULES]
        + [[BEARING + rule.pattern, rule.offset, rule.window] for rule in BEARING_RULES],
    }
