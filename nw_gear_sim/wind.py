"""Chooses and builds the wind that was asked for: parameters in, a function of the sample's number out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.quantities import quantity
from nw_gear_sim import columnfile, params, windfile
from nw_gear_sim.physics.wind_deterministic import ConstantWind, StepWind
from nw_gear_sim.physics.wind_gust import DURATION, GustWind, gust_magnitude
from nw_gear_sim.physics.wind_series import SeriesWind
from nw_gear_sim.physics.wind_turbulence import SHORTEST_INTERVAL, TurbulentWind
from nw_gear_sim.physics.wind_weibull import WeibullWind

FASTEST = windfile.FASTEST_WIND


@dataclass(frozen=True)
class Settings:
    """Parameters of the wind. Those that say so take their value from the configuration file while they are 0."""

    source: str = quantity("weibull", "Where the wind comes from.", choices=names.WIND_SOURCES, live=True)
    seed: int = quantity(1, "Seed of all random numbers.", minimum=0)
    rate: float = quantity(10.0, "Samples per second.", "Hz", minimum=0.1, maximum=100.0)
    config: str = quantity("", "Configuration file or preset laid over the default one.")
    speed: float = quantity(
        11.5, "Wind speed where source is constant.", "m/s", minimum=0.0, maximum=FASTEST, live=True
    )
    weibull_shape: float = quantity(0.0, "Weibull shape k; 0 = as configured.", minimum=0.0, maximum=50.0)
    weibull_scale: float = quantity(0.0, "Weibull scale C; 0 = as configured.", "m/s", minimum=0.0, maximum=100.0)
    sampling_interval: float = quantity(
        0.0, "Time between two draws of the Weibull process; 0 = as configured.", "s", minimum=0.0, maximum=600.0
    )
    correlation_time: float = quantity(
        0.0,
        "Time in which the correlation falls to 1/e, Weibull process and turbulence; 0 = as configured.",
        "s",
        minimum=0.0,
        maximum=3600.0,
    )
    step_from: float = quantity(8.0, "Wind speed before the step.", "m/s", minimum=0.0, maximum=FASTEST)
    step_to: float = quantity(11.5, "Wind speed after the step.", "m/s", minimum=0.0, maximum=FASTEST)
    step_time: float = quantity(10.0, "Time of the step after the start.", "s", minimum=0.0)
    gust_mean: float = quantity(11.5, "Steady wind speed around the gust.", "m/s", minimum=0.0, maximum=50.0)
    gust_start: float = quantity(10.0, "Time of the first gust after the start.", "s", minimum=0.0)
    gust_period: float = quantity(0.0, "Time from gust to gust, at least 10.5 s; 0 = one gust.", "s", minimum=0.0)
    gust_reference_speed: float = quantity(
        50.0, "V_ref of the IEC class (I 50, II 42.5, III 37.5).", "m/s", minimum=1.0, maximum=100.0
    )
    gust_turbulence: float = quantity(
        0.14, "I_ref of the IEC class (A 0.16, B 0.14, C 0.12).", minimum=0.0, maximum=1.0
    )
    gust_diameter: float = quantity(0.0, "Rotor diameter; 0 = as configured.", "m", minimum=0.0, maximum=1000.0)
    gust_hub_height: float = quantity(110.0, "Height of the hub (a guess).", "m", minimum=1.0, maximum=1000.0)
    file: str = quantity("", "CSV file with the measured wind.")
    time_column: str = quantity("", "Column of the times; empty = time, timestamp or datetime.")
    speed_column: str = quantity("", "Column of wind speeds or their means; empty = wind_speed, wind_speed_mean.")
    deviation_column: str = quantity("", "Column of standard deviations; empty = wind_speed_std beside means.")
    gaps: str = quantity("bridge", "What to do with gaps in the file.", choices=("bridge", "refuse"))
    start_offset: float = quantity(0.0, "Where in the file to start.", "s", minimum=0.0)
    at_end: str = quantity(
        "hold",
        "At the end of the file: hold the last row (turbulence goes on), begin again, or stop the node.",
        choices=("hold", "loop", "stop"),
    )


class Wind(Protocol):
    """Wind speed as a function of time."""

    def at(self, time: float, /) -> float:
        """Wind speed (m/s) at a time >= 0 (s)."""


@dataclass(frozen=True)
class Source:
    """A wind with a sampling rate.

    Attributes:
        wind: what is sampled.
        rate: samples per second.
        description: one line for the log.
        values: what is worth knowing, text by name, units in the names.
        gaps: of the file, bridged by straight lines.
        start: time of `wind` at sample 0, s.
        end: seconds after sample 0 at which the file ends; infinite where there is none.
        at_end: what happens then: hold, loop or stop.
    """

    wind: Wind
    rate: float
    description: str
    values: dict[str, str]
    gaps: tuple[columnfile.Gap, ...] = ()
    start: float = 0.0
    end: float = math.inf
    at_end: str = "hold"

    def sample(self, index: int) -> float:
        """Wind speed (m/s) of sample `index` >= 0, a function of parameters, seed and index alone."""
        return self.wind.at(self.start + index / self.rate)

    def is_over(self, index: int) -> bool:
        """Whether sample `index` lies behind the end of the file."""
        return index / self.rate > self.end

    @property
    def exceeded(self) -> int:
        """Number of intervals drawn so far with more deviation than the file gives (see `TurbulentWind`)."""
        return self.wind.exceeded if isinstance(self.wind, TurbulentWind) else 0

    @property
    def bridged(self) -> float:
        """Seconds of the file without good rows."""
        return sum(gap.seconds for gap in self.gaps)


def make_source(settings: Settings, wind: params.Wind, turbine: params.Turbine) -> Source:
    """Build the source that the settings name.

    Args:
        settings: parameters, each within its bounds.
        wind, turbine: sections of the configuration, which hold what the settings leave at 0.

    Raises:
        InputError: a wind file can't be used, or parameters contradict each other.
    """
    if settings.source == "file":
        return _from_file(settings, wind)
    make = {"weibull": _weibull, "gust": _gust, "step": _step, "constant": _constant}[settings.source]
    chosen, description, values = make(settings, wind, turbine)
    return Source(chosen, settings.rate, description, values)


_Made = tuple[Wind, str, dict[str, str]]


def _constant(settings: Settings, _wind: params.Wind, _turbine: params.Turbine) -> _Made:
    return ConstantWind(settings.speed), f"constant {settings.speed:g} m/s", {}


def _step(settings: Settings, _wind: params.Wind, _turbine: params.Turbine) -> _Made:
    step = StepWind(settings.step_from, settings.step_to, settings.step_time)
    return step, f"step from {step.before:g} to {step.after:g} m/s at {step.time:g} s", {}


def _weibull(settings: Settings, wind: params.Wind, _turbine: params.Turbine) -> _Made:
    shape = settings.weibull_shape or wind.weibull_shape
    scale = settings.weibull_scale or wind.weibull_scale
    interval = settings.sampling_interval or wind.sampling_interval
    time = settings.correlation_time or wind.correlation_time
    made = WeibullWind(shape, scale, interval, time, settings.seed)
    description = f"Weibull process, shape {shape:g}, scale {scale:g} m/s, a draw every {interval:g} s, "
    values = {
        "Weibull shape (1)": f"{shape:g}",
        "Weibull scale (m/s)": f"{scale:g}",
        "sampling interval (s)": f"{interval:g}",
        "correlation time (s)": f"{time:g}",
    }
    return made, description + f"correlation time {time:g} s, seed {settings.seed}", values


def _gust(settings: Settings, _wind: params.Wind, turbine: params.Turbine) -> _Made:
    if 0.0 < settings.gust_period < DURATION:
        raise InputError("parameter gust_period", f"0 or at least {DURATION:g} s", f"{settings.gust_period:g} s")
    diameter = settings.gust_diameter or turbine.blade_diameter
    mean = settings.gust_mean
    size = gust_magnitude(
        mean, settings.gust_reference_speed, settings.gust_turbulence, diameter, settings.gust_hub_height
    )
    made = GustWind(mean, size, settings.gust_start, settings.gust_period)
    description = f"extreme operating gust of {size:.2f} m/s on {mean:g} m/s at {settings.gust_start:g} s"
    again = f", every {settings.gust_period:g} s" if settings.gust_period else ""
    return made, description + again, {"gust magnitude (m/s)": f"{size:.4g}"}


def _from_file(settings: Settings, wind: params.Wind) -> Source:
    if not settings.file:
        raise InputError("parameter file", "the CSV file of the wind, since source is file", "nothing")
    data = windfile.read(settings.file, settings.time_column, settings.speed_column, settings.deviation_column)
    if data.gaps and settings.gaps == "refuse":
        first = data.gaps[0]
        got = f"{len(data.gaps)} gaps, the first of {first.seconds:g} s after {first.label}"
        raise InputError(data.path, "a file without gaps (or the parameter gaps set to bridge)", got)
    loop = settings.at_end == "loop"
    made: Wind
    if data.deviations is None:
        made = SeriesWind(data.times, data.speeds, loop, data.interval)
        length = float(data.times[-1])
        kind = "time series"
    else:
        if data.interval < SHORTEST_INTERVAL:
            expected = f"means over at least {SHORTEST_INTERVAL:g} s"
            raise InputError(data.path, expected, f"rows every {data.interval:g} s")
        means, deviations = data.regular()
        time = settings.correlation_time or wind.correlation_time
        made = TurbulentWind(means, deviations, data.interval, time, settings.seed, loop)
        length = len(means) * data.interval
        kind = f"turbulence (correlation time {time:g} s, seed {settings.seed}) around means over {data.interval:g} s"
    if settings.start_offset >= length:
        expected = f"less than the {length:g} s of {data.path}"
        raise InputError("parameter start_offset", expected, f"{settings.start_offset:g} s")
    return Source(
        wind=made,
        rate=settings.rate,
        description=f"{kind}, {len(data.times)} rows of {data.path} from {data.origin} on",
        values={"file": data.path, "rows (1)": str(len(data.times)), "rows with empty cells (1)": str(data.empty_rows)},
        gaps=data.gaps,
        start=settings.start_offset,
        end=length - settings.start_offset,
        at_end=settings.at_end,
    )
