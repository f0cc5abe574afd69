"""The results as one self-contained page: what the signal looks like, its spectrum, its section, its envelope."""

from __future__ import annotations

from collections.abc import Sequence

import jinja2
import numpy as np
from bokeh.embed import components
from bokeh.layouts import column
from bokeh.models import Model
from bokeh.plotting import figure
from bokeh.resources import Resources
from markupsafe import Markup

import nw_gear_common
from nw_gear_common.tables import Array
from nw_gear_monitor.analyse.chaos import section
from nw_gear_monitor.analyse.lines import Line
from nw_gear_monitor.analyse.measure import Envelope, Result
from nw_gear_monitor.analyse.select import Signal
from nw_gear_monitor.analyse.table import cell, indicator_rows, state_line
from nw_gear_monitor.indicators.embedding import correlation_lag
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.template import STYLE
from nw_gear_monitor.signals.spectrum import amplitude_spectrum

MOST_POINTS = 8000
MOST_DOTS = 20_000

PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{{ title }}</title>
<style>{{ style }}</style>
{{ resources }}
</head>
<body>
<header class="page"><h1>{{ title }}</h1></header>
<main>
{% for channel in channels %}
<h2>{{ channel.name }}</h2>
<p class="headline" style="--band: {{ channel.colour }}">{{ channel.state }}</p>
{{ channel.figures }}
<div class="wide"><table>
<thead><tr><th>indicator</th><th class="n">value</th><th></th></tr></thead>
<tbody>
{% for name, value, note in channel.rows %}
<tr><td>{{ name }}</td><td class="n">{{ value }}</td><td class="soft">{{ note }}</td></tr>
{% endfor %}
</tbody>
</table></div>
{% endfor %}
<footer>Made by nw_gear {{ version }}.</footer>
</main>
{{ script }}
</body>
</html>
"""


def render(title: str, results: Sequence[Result]) -> str:
    """The page as one HTML text that loads nothing from elsewhere."""
    script, divs = components([_figures(result) for result in results], wrap_script=True)
    channels = [
        {
            "name": result.signal.name,
            "colour": style.state_colour(result.verdict.label),
            "state": state_line(result),
            "figures": Markup(div),
            "rows": [*indicator_rows(result), *_line_rows(result)],
        }
        for result, div in zip(results, divs, strict=True)
    ]
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, undefined=jinja2.StrictUndefined)
    return environment.from_string(PAGE).render(
        title=f"Signal {title}",
        style=Markup(STYLE),
        resources=Markup(Resources(mode="inline", components=["bokeh"]).render()),
        channels=channels,
        script=Markup(script),
        version=nw_gear_common.__version__,
    )


def _line_rows(result: Result) -> list[tuple[str, str, str]]:
    """Lines of the envelope, the bearing and the shaft as rows of the table."""
    found: list[tuple[str, Sequence[Line]]] = [("line of the shaft", result.shaft)]
    if result.envelope is not None:
        found = [
            ("line of the envelope", result.envelope.peaks),
            ("line of the bearing", result.envelope.bearing),
            *found,
        ]
    rows = []
    for name, lines in found:
        for line in lines:
            order = "" if line.order is None else f", order {line.order:.4g}"
            above = "" if np.isnan(line.prominence) else f"{line.prominence:.3g} times the floor"
            rows.append((f"{name}{order}, at {line.hz:.6g} Hz", cell(line.amplitude), above))
    return rows


def _figures(result: Result) -> Model:
    signal = result.signal
    parts = [_history(signal), _portrait(signal)]
    if signal.rate is not None:
        parts.insert(1, _spectrum(signal, signal.rate))
    if result.envelope is not None:
        parts.append(_envelope(result.envelope))
    return column(*parts, sizing_mode="stretch_width")


def _history(signal: Signal) -> figure:
    """Least and largest value of each of so many parts, joined up, so that no peak gets lost."""
    label = "Step" if signal.rate is None else "Time since start (s)"
    fig = style.make_figure("History", label, signal.name)
    x = signal.x
    at = np.arange(x.size)
    if x.size > MOST_POINTS:
        wide = -(-2 * x.size // MOST_POINTS)
        parts = x[: x.size // wide * wide].reshape(-1, wide)
        both = np.sort(np.stack([parts.argmin(axis=1), parts.argmax(axis=1)], axis=1), axis=1)
        at = (both + wide * np.arange(len(parts))[:, None]).reshape(-1)
    fig.line(at / (signal.rate or 1.0), x[at], line_color=style.BLUE, line_width=0.8)
    return fig


def _spectrum(signal: Signal, rate: float) -> figure:
    fig = style.make_figure("Amplitude spectrum", "Frequency (Hz)", signal.name, y_type="log")
    frequency, amplitude = amplitude_spectrum(signal.x[:, None], rate)
    _draw(fig, frequency[1:], amplitude[1:, 0])
    return fig


def _portrait(signal: Signal) -> figure:
    """Section over the derivative or the next strobe, where there is a strobe; else the phase portrait."""
    x, v = signal.x, signal.v
    if signal.rate is None or signal.phase is not None:
        points = x if signal.phase is None else section(signal.phase, x)
        if v is not None:
            across, name = points, "derivative"
            up = v if signal.phase is None else section(signal.phase, v)
        else:
            across, up, name = points[:-1], points[1:], "one step later"
        title = "Map" if signal.rate is None else "Section, once a strobe"
    else:
        lag = 0 if v is not None else _lag(x)
        across, up = (x, v) if v is not None else (x[: x.size - lag], x[lag:])
        name = "derivative" if v is not None else f"{lag} samples later"
        title = "Phase portrait"
    fig = style.make_figure(title, signal.name, f"{signal.name}, {name}", height=420, sizing="fixed", width=560)
    fig.scatter(across[:MOST_DOTS], up[:MOST_DOTS], size=2, color=style.BLUE, alpha=0.5)
    return fig


def _lag(x: Array) -> int:
    return min(correlation_lag(x), x.size // 2)


def _envelope(envelope: Envelope) -> figure:
    low, high = envelope.band
    title = f"Envelope spectrum of {low:.6g} to {high:.6g} Hz"
    fig = style.make_figure(title, "Frequency (Hz)", "Amplitude of the envelope")
    amplitude = envelope.spectrum.amplitude
    frequency: Array = envelope.spectrum.step * np.arange(amplitude.size, dtype=np.float64)
    marked = [line.hz for line in (*envelope.peaks[:5], *envelope.bearing)]
    last = min(3.0 * max(marked), float(frequency[-1])) if marked else float(frequency[-1])
    shown = (frequency > 0.0) & (frequency <= last)
    _draw(fig, frequency[shown], amplitude[shown])
    for line in envelope.bearing:
        style.mark(fig, line.hz, colour=style.VERMILION)
    if envelope.bearing:
        at, up = ([getattr(line, name) for line in envelope.bearing] for name in ("hz", "amplitude"))
        orders = [f"{line.order:.3f}" for line in envelope.bearing]
        dots = fig.scatter(at, up, size=6, color=style.VERMILION)
        fig.text(at, up, text=orders, text_font_size="10px", x_offset=4, text_color=style.INK)
        style.add_legend(fig, [("orders of the bearing, per turn of the shaft", [dots])])
    return fig


def _draw(fig: figure, frequency: Array, amplitude: Array) -> None:
    """A line over at most MOST_POINTS bins, the largest of each group."""
    wide = max(-(-amplitude.size // MOST_POINTS), 1)
    kept = amplitude.size // wide * wide
    groups = amplitude[:kept].reshape(-1, wide)
    largest = groups.argmax(axis=1) + wide * np.arange(len(groups))
    fig.line(frequency[largest], amplitude[largest], line_color=style.BLUE, line_width=0.8)
