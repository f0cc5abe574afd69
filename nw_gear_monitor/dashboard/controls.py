"""What can be asked of the running nodes from the page: parameters, services, faults with their places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from nw_gear_common.errors import InputError
from nw_gear_common.quantities import check_value, quantities
from nw_gear_sim.params.faults import PLACES, SEVERITIES, FaultSettings

WIND, SIM, MONITOR, RECORDER, REPLAY = "wind_node", "gear_sim_node", "gear_monitor_node", "recorder_node", "replay_node"
MICRO = 1e6
FAULT_WORDS = {
    "crack": "cracked tooth",
    "pitch": "pitch error",
    "eccentricity": "eccentric gear",
    "wear": "worn flanks",
    "clearance": "bearing clearance",
    "race": "defect of a race",
}
LABELS = {
    "fault_crack_gear": "Gear",
    "fault_crack_tooth": "Tooth",
    "fault_crack": "Loss of stiffness (1)",
    "fault_pitch_gear": "Gear",
    "fault_pitch_tooth": "Tooth",
    "fault_pitch": "Pitch error (µm)",
    "fault_eccentric_gear": "Gear",
    "fault_eccentricity": "Amplitude (µm)",
    "fault_wear_stage": "Stage",
    "fault_wear": "Growth of half the backlash (µm)",
    "fault_wear_stiffness": "Loss of stiffness (1)",
    "fault_clearance_bearing": "Bearing",
    "fault_clearance": "Growth of clearance (µm)",
    "fault_race_bearing": "Bearing",
    "fault_race": "Race",
    "fault_race_width": "Half width (rad)",
    "fault_race_angle": "Place (rad)",
    "fault_race_depth": "Depth (µm)",
    "fault_ramp": "Ramp (s of simulated time)",
}
EXAMPLES = {
    "fault_crack": 0.5,
    "fault_pitch": 50e-6,
    "fault_eccentricity": 100e-6,
    "fault_wear": 100e-6,
    "fault_clearance": 50e-6,
    "fault_race_depth": 20e-6,
}
"""Severities that the page proposes: large enough to be seen."""


@dataclass(frozen=True)
class Request:
    """Something to ask of a node.

    Attributes:
        node: name of it, relative to the namespace.
        words: what is asked, for people.
        parameters: to set, all or none of them.
        service: to call, relative to the node, where no parameters are given.
        flag: argument of a SetBool service, None for a Trigger.
    """

    node: str
    words: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    service: str = ""
    flag: bool | None = None


@dataclass(frozen=True)
class Field:
    """One parameter of a fault as the page shows it.

    Attributes:
        name: of the parameter.
        label: with the unit that is shown.
        kind: float, int or str.
        choices: of a text.
        scale: shown value over SI value.
        low, high: shown bounds.
        shown: value at first, as shown.
    """

    name: str
    label: str
    kind: type
    choices: tuple[str, ...]
    scale: float
    low: float | None
    high: float | None
    shown: Any

    def value(self, shown: Any) -> Any:
        """The parameter's value for what is shown."""
        if self.kind is float and shown is not None:
            return round(float(shown) / self.scale, 12)
        return shown


def _fields() -> dict[str, Field]:
    found = {}
    for name, kind, default, text in quantities(FaultSettings):
        scale = MICRO if text.unit == "m" else 1.0
        number = kind is not str
        first = EXAMPLES.get(name, default)
        found[name] = Field(
            name,
            LABELS[name],
            kind,
            text.choices or (),
            scale,
            None if text.minimum is None else scale * text.minimum,
            None if text.maximum is None else scale * text.maximum,
            scale * first if number and kind is float else first,
        )
    return found


FIELDS = _fields()
KINDS = tuple(SEVERITIES)


def fields_of(kind: str) -> tuple[Field, ...]:
    """Places, then severities of a kind of fault."""
    return tuple(FIELDS[name] for name in (*PLACES[kind], *SEVERITIES[kind]))


def inject(kind: str, shown: Mapping[str, Any]) -> Request:
    """Ask for a fault.

    Args:
        kind: of the fault.
        shown: values of its fields and of the ramp as the page shows them.

    Raises:
        InputError: a value is missing or out of its bounds.
    """
    values = {name: FIELDS[name].value(value) for name, value in shown.items()}
    for name, wanted, _default, text in quantities(FaultSettings):
        if name in values:
            check_value(LABELS[name], values[name], wanted, text)
    severity = [f"{FIELDS[name].label}: {shown[name]:g}" for name in SEVERITIES[kind]]
    place = ", ".join(f"{shown[name]}" for name in PLACES[kind])
    return Request(SIM, f"inject {FAULT_WORDS[kind]} ({place}; {', '.join(severity)})", values)


def heal(kind: str, ramp: float) -> Request:
    """Ask for the end of a fault."""
    values = dict.fromkeys(SEVERITIES[kind], 0.0)
    return Request(SIM, f"end {FAULT_WORDS[kind]}", {**values, "fault_ramp": float(ramp)})


def set_wind(source: str | None, speed: float | None) -> Request:
    """Ask for another wind.

    Raises:
        InputError: nothing is given.
    """
    given: dict[str, Any] = {"source": source} if source is not None else {}
    if speed is not None:
        given["speed"] = float(speed)
    if not given:
        raise InputError("wind", "a source or a speed", "nothing")
    return Request(WIND, ", ".join(f"{name} = {value}" for name, value in given.items()), given)


def set_pace(factor: float | None) -> Request:
    """Ask for another speed of the simulation.

    Raises:
        InputError: no number.
    """
    if factor is None:
        raise InputError("speed of simulation", "a number", "nothing")
    return Request(SIM, f"real_time_factor = {factor:g}", {"real_time_factor": float(factor)})


def pause(node: str, paused: bool) -> Request:
    """Ask a node to pause or to go on."""
    return Request(node, "pause" if paused else "go on", service="pause", flag=paused)


def trigger(node: str, service: str, words: str) -> Request:
    """Ask a node to do what a service without arguments does."""
    return Request(node, words, service=service)


def freeze(frozen: bool) -> Request:
    """End learning of baselines, or allow it."""
    return Request(MONITOR, "freeze baselines" if frozen else "learn baselines", service="freeze_baseline", flag=frozen)


POLLED: Mapping[str, tuple[str, ...]] = {
    WIND: ("source", "speed"),
    SIM: ("real_time_factor", *FIELDS),
}
"""Parameters whose present values the page shows."""
