"""The measured wind behind a run that was driven by a file, read again to be shown beside what was drawn from it."""

from __future__ import annotations

from dataclasses import dataclass

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.review.rundata import RunData
from nw_gear_monitor.review.summary import parameters
from nw_gear_sim import windfile


@dataclass(frozen=True, eq=False)
class Measured:
    """What the file says.

    Attributes:
        times: seconds after the start of the run; begin of each interval where there are deviations.
        speeds: m/s, means where there are deviations.
        deviations: standard deviations (m/s), None for a time series.
        interval: seconds between rows.
        text: where it comes from, in words.
    """

    times: Array
    speeds: Array
    deviations: Array | None
    interval: float
    text: str


def find(run: RunData) -> tuple[Measured | None, str]:
    """The measured wind of a run, and a remark for the reader, empty where the wind wasn't from a file.

    The file is read from where the wind node read it; where it is gone or can't be read any more, the remark says so.
    """
    values = parameters(run, "wind_node")
    if values.get("source") != "file" or run.wind is None:
        return None, ""
    try:
        columns = (values.get(key, "") for key in ("time_column", "speed_column", "deviation_column"))
        data = windfile.read(values.get("file", ""), *columns)
        offset = float(values.get("start_offset", "0"))
    except (InputError, ValueError) as error:
        return None, f"The measured wind isn't shown: {error}."
    begin = float(run.wind.time[0]) - 0.5 * run.wind.width - run.start
    kind = "time series" if data.deviations is None else f"means and standard deviations over {data.interval:g} s"
    text = f"Measured: {kind}, {len(data.times)} rows from {data.origin} on, starting {offset:g} s into the file."
    return Measured(data.times - offset + begin, data.speeds, data.deviations, data.interval, text), text
