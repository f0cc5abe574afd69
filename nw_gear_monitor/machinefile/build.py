"""From the entries of a file to a machine: speeds of shafts and meshes, orders of bearings, and whether all fit."""

from __future__ import annotations

import math
from collections.abc import Iterable

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.bearing_orders import BearingOrders, from_cage, from_geometry
from nw_gear_monitor.machine import Bearing, Channel, Machine, Shaft, Stage
from nw_gear_monitor.machinefile.entries import BearingEntry, ChannelEntry, Entries, Gear, StageEntry

MOST_STAGES = 6
SAME = 1e-6
"""Speeds that follow from the file in two ways may differ by this share."""
GEOMETRY = ("rollers", "roller_diameter", "pitch_diameter")
ORDERS = ("outer", "inner", "cage")


def build(entries: Entries) -> Machine:
    """Derive the machine.

    Raises:
        InputError: names that occur twice or aren't known, a speed that doesn't follow or follows in two ways, a
            bearing without orders, a stage without channels, two units in a stage.
    """
    _check_names(entries)
    speeds, cycles = _speeds(entries)
    stages = tuple(_stage(entries, stage, cycles[stage.name]) for stage in entries.stages)
    shafts = tuple(_shaft(entries, name, speed, cycles) for name, speed in speeds.items())
    bearings = tuple(_bearing(b, entries.places[f"bearings[{i}]"], speeds) for i, b in enumerate(entries.bearings))
    return Machine(entries.name, stages, _channels(entries), shafts, bearings, entries.sidebands)


def _check_names(entries: Entries) -> None:
    if not 1 <= len(entries.stages) <= MOST_STAGES:
        place = entries.places.get(f"stages[{MOST_STAGES}]", "stages")
        raise InputError(place, f"1 to {MOST_STAGES} stages", str(len(entries.stages)))
    _once(entries, [("stages", i, s.name) for i, s in enumerate(entries.stages)], "stages")
    _once(entries, [("shafts", i, s.name) for i, s in enumerate(entries.shafts)], "shafts")
    heard = [("channels", i, c.name) for i, c in enumerate(entries.channels)]
    heard += [("bearings", i, b.name) for i, b in enumerate(entries.bearings)]
    _once(entries, heard, "channels and bearings, which share the topics indicators/<name>")
    known = [stage.name for stage in entries.stages]
    for i, channel in enumerate(entries.channels):
        if channel.stage not in known:
            place = entries.places[f"channels[{i}]"]
            raise InputError(f"{place}.stage", "one of " + ", ".join(known), channel.stage)
    for i, stage in enumerate(entries.stages):
        units = {channel.unit for channel in entries.channels if channel.stage == stage.name}
        if len(units) != 1:
            got = ", ".join(sorted(units)) or "none"
            raise InputError(entries.places[f"stages[{i}]"], "channels of this stage, all in one unit", got)


def _once(entries: Entries, heard: Iterable[tuple[str, int, str]], what: str) -> None:
    seen: set[str] = set()
    for key, number, name in heard:
        if name in seen:
            raise InputError(entries.places[f"{key}[{number}]"], f"different names of {what}", f"{name} twice")
        seen.add(name)


def _speeds(entries: Entries) -> tuple[dict[str, float], dict[str, float]]:
    """Turns of every shaft, and mesh cycles of every stage, per turn of the reference shaft."""
    speeds = {entries.reference.shaft: 1.0}
    for i, shaft in enumerate(entries.shafts):
        _agree(speeds, shaft.name, shaft.ratio, entries.places[f"shafts[{i}]"])
    cycles: dict[str, float] = {}
    left = dict(enumerate(entries.stages))
    while left:
        ready = {i: found for i, stage in left.items() if (found := _cycles(stage, speeds)) is not None}
        if not ready:
            i, stage = next(iter(left.items()))
            expected = "teeth on a shaft whose speed is known, or `cycles`"
            raise InputError(entries.places[f"stages[{i}]"], expected, f"neither for stage {stage.name}")
        for i, found in ready.items():
            stage = left.pop(i)
            cycles[stage.name] = found
            for gear in (stage.driver, stage.driven):
                if gear is not None:
                    _agree(speeds, gear.shaft, found / gear.teeth, entries.places[f"stages[{i}]"])
    return speeds, cycles


def _cycles(stage: StageEntry, speeds: dict[str, float]) -> float | None:
    if stage.cycles is not None:
        return stage.cycles
    known = [gear for gear in (stage.driver, stage.driven) if gear is not None and gear.shaft in speeds]
    return speeds[known[0].shaft] * known[0].teeth if known else None


def _agree(speeds: dict[str, float], shaft: str, speed: float, place: str) -> None:
    if not math.isclose(speeds.setdefault(shaft, speed), speed, rel_tol=SAME):
        expected = f"shaft {shaft} at {speeds[shaft]:.9g} times the speed of the reference, as elsewhere in the file"
        raise InputError(place, expected, f"{speed:.9g} times")


def _stage(entries: Entries, stage: StageEntry, cycles: float) -> Stage:
    frequency = cycles * entries.reference.speed / (2.0 * math.pi)
    phase, per_turn = (stage.phase, 1.0) if stage.phase else (entries.reference.phase, cycles)
    teeth = None if stage.driver is None or stage.driven is None else (stage.driver.teeth, stage.driven.teeth)
    return Stage(stage.name, phase, per_turn, frequency, teeth, stage.half_backlash)


def _shaft(entries: Entries, name: str, speed: float, cycles: dict[str, float]) -> Shaft:
    """A shaft by the mesh cycles per turn of a stage that has a gear on it, else of the first stage."""
    for stage in entries.stages:
        for gear in (stage.driver, stage.driven):
            if isinstance(gear, Gear) and gear.shaft == name:
                return Shaft(name, stage.name, float(gear.teeth))
    first = entries.stages[0].name
    return Shaft(name, first, cycles[first] / speed)


def _channels(entries: Entries) -> tuple[Channel, ...]:
    return tuple(_channel(channel) for channel in entries.channels)


def _channel(c: ChannelEntry) -> Channel:
    return Channel(c.name, c.stage, c.column, c.velocity or None, c.unit, c.planet, c.planet_phase, c.load)


def _bearing(entry: BearingEntry, place: str, speeds: dict[str, float]) -> Bearing:
    if entry.shaft not in speeds:
        raise InputError(f"{place}.shaft", "one of " + ", ".join(speeds), entry.shaft)
    if not 1 <= len(entry.columns) <= 2:
        raise InputError(f"{place}.columns", "one or two columns", str(len(entry.columns)))
    try:
        orders = _orders(entry)
    except InputError as error:
        raise InputError(f"{place}.{error.place}", error.expected, error.got) from error
    return Bearing(entry.name, entry.shaft, entry.columns, entry.unit, entry.rollers, orders)


def _orders(entry: BearingEntry) -> BearingOrders:
    given = [name for name in (*GEOMETRY[1:], "cage_factor", *ORDERS) if getattr(entry, name) is not None]
    if entry.roller_diameter is not None and entry.pitch_diameter is not None and entry.rollers is not None:
        _alone(given, GEOMETRY)
        return from_geometry(entry.rollers, entry.roller_diameter, entry.pitch_diameter, entry.contact_angle)
    if entry.cage_factor is not None and entry.rollers is not None:
        _alone(given, ("cage_factor",))
        return from_cage(entry.rollers, entry.cage_factor)
    if entry.outer is not None and entry.inner is not None and entry.cage is not None:
        _alone(given, ORDERS)
        return BearingOrders(entry.outer, entry.inner, entry.cage, entry.roller)
    ways = f"{', '.join(GEOMETRY)}; or rollers, cage_factor; or {', '.join(ORDERS)}"
    raise InputError("orders", ways, ", ".join(given) or "none of them")


def _alone(given: list[str], way: tuple[str, ...]) -> None:
    further = [name for name in given if name not in way]
    if further:
        raise InputError("orders", f"{', '.join(way)} alone, or another way", f"{', '.join(further)} too")
