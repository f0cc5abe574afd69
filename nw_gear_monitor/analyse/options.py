"""What the command is asked for, checked before a file is opened."""

from __future__ import annotations

from dataclasses import dataclass

from nw_gear_common.errors import InputError
from nw_gear_monitor.datafiles.source import printable
from nw_gear_monitor.signals import checked


@dataclass(frozen=True)
class Options:
    """How a file is to be understood, and what to look for in it.

    Attributes:
        rate: samples per second, Hz; None where the file tells it.
        strobe: frequency of the strobes, Hz; phase: column with an unwrapped phase, rad, one strobe every 2 pi.
        columns: channels; none for all. velocity: column of the derivative of the one channel.
        envelope: band of the envelope spectrum, Hz.
        shaft_rate: turns per second, Hz; bearing_orders: multiples of it to look for in the envelope spectrum.
        map: whether each row is one step of a map.
    """

    rate: float | None = None
    strobe: float | None = None
    phase: str | None = None
    columns: tuple[str, ...] = ()
    velocity: str | None = None
    envelope: tuple[float, float] | None = None
    shaft_rate: float | None = None
    bearing_orders: tuple[float, ...] = ()
    map: bool = False

    def __post_init__(self) -> None:
        for place, number in (("--rate", self.rate), ("--strobe", self.strobe), ("--shaft-rate", self.shaft_rate)):
            if number is not None:
                checked.positive(place, number)
        for order in self.bearing_orders:
            checked.positive("--bearing-orders", order)
        if self.bearing_orders and self.shaft_rate is None:
            raise InputError("--bearing-orders", "--shaft-rate as well", "none")
        if self.strobe is not None and self.phase is not None:
            raise InputError("--strobe", "--strobe or --phase", "both")
        timed = {
            "--rate": self.rate,
            "--strobe": self.strobe,
            "--phase": self.phase,
            "--envelope": self.envelope,
            "--shaft-rate": self.shaft_rate,
        }
        if self.map:
            for place, given in timed.items():
                if given is not None:
                    raise InputError(place, "nothing of it with --map (a map has steps, no time)", str(given))


def band(text: str | None) -> tuple[float, float] | None:
    """Read `LOW:HIGH` (Hz); raises InputError unless these are two numbers, 0 <= low < high."""
    if text is None:
        return None
    low, colon, high = text.partition(":")
    try:
        limits = float(low), float(high)
    except ValueError:
        limits = (1.0, 0.0)
    if not (colon and 0.0 <= limits[0] < limits[1] < float("inf")):
        raise InputError("--envelope", "LOW:HIGH in Hz, such as 2000:4000", repr(printable(text)))
    return limits


def numbers(text: str | None) -> tuple[float, ...]:
    """Read numbers with commas between them; raises InputError where one isn't a number."""
    try:
        return () if text is None else tuple(float(part) for part in text.split(","))
    except ValueError:
        raise InputError("--bearing-orders", "numbers such as 3.58,5.42", repr(printable(text or ""))) from None
