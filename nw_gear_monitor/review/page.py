"""Puts summary, figures and tables into one self-contained HTML page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import jinja2
from bokeh.document import Document
from bokeh.embed import components
from bokeh.models import Model
from bokeh.resources import Resources
from markupsafe import Markup

import nw_gear_common
from nw_gear_monitor.review import measured, sections, summary, template
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.output import name_of
from nw_gear_monitor.review.rundata import LEVEL_WORDS, RunData


@dataclass(frozen=True)
class Head:
    """What stands above the figures.

    Attributes:
        title, subtitle: of the page.
        headlines: colour and words.
        remarks: what a reader has to know about the data.
        facts: name and value.
        footer: last line of the page.
    """

    title: str
    subtitle: str
    headlines: Sequence[tuple[str, str]]
    remarks: Sequence[str]
    facts: Sequence[tuple[str, str]]
    footer: str


def render(run: RunData) -> str:
    """The report as one HTML text that loads nothing from elsewhere.

    Where the wind came from a file that is still there, the measured wind is read again and shown beside what was used.
    """
    numbers = summary.summarise(run)
    head = Head(
        title=f"Gearbox run {name_of(run.source)}",
        subtitle=f"{summary.when(run)} · {run.duration:.1f} s",
        headlines=[headline(run, numbers)],
        remarks=run.remarks,
        facts=facts(run, numbers),
        footer=f"Made by nw_gear {nw_gear_common.__version__} from {run.source.name}.",
    )
    return assemble(head, sections.build(run, numbers, *measured.find(run)))


def headline(run: RunData, numbers: summary.Summary) -> tuple[str, str]:
    """Colour and words of the worst that happened."""
    worst = numbers.worst
    return style.GREY if worst is None else style.state_colour(worst[1].state), summary.headline(run, numbers)


def assemble(head: Head, parts: Sequence[sections.Section]) -> str:
    """One HTML text of a head and sections, that loads nothing from elsewhere."""
    models = {name: model for part in parts for name, model in part.figures.items()}
    script, divs = _embed(models)
    environment = jinja2.Environment(
        autoescape=True,
        trim_blocks=True,
        undefined=jinja2.StrictUndefined,
        loader=jinja2.DictLoader({"page": template.PAGE, "summary": template.SUMMARY, "table": template.TABLE}),
    )
    return environment.get_template("page").render(
        **vars(head),
        style=Markup(template.STYLE),
        resources=Markup(Resources(mode="inline", components=["bokeh", "bokeh-widgets"]).render()),
        sections=parts,
        divs={name: Markup(text) for name, text in divs.items()},
        script=Markup(script),
    )


def _embed(models: dict[str, Model]) -> tuple[str, dict[str, str]]:
    """Script and divisions of the figures. They go into one document at once, since one by one costs n squared."""
    if not models:
        return "", {}
    document = Document()
    with document.models.freeze():
        for model in models.values():
            document.add_root(model)
    script, divs = components(models, wrap_script=True)
    return script, divs


def _count(number: int, word: str) -> str:
    return f"{number} {word}" + ("" if number == 1 else "s")


def _alarms(run: RunData, numbers: summary.Summary) -> str:
    if not run.spans:
        return "no diagnostics recorded"
    by_level = Counter(span.level for span in numbers.alarms)
    return ", ".join(_count(by_level[level], LEVEL_WORDS.get(level, "other")) for level in sorted(by_level)) or "none"


def facts(run: RunData, numbers: summary.Summary) -> list[tuple[str, str]]:
    """What ran, when and in which range, as pairs of words."""
    wave = run.waveform
    if wave is None:
        samples = "not recorded"
    else:
        missing = sum(gap.seconds for gap in wave.gaps)
        lost = f"{_count(len(wave.gaps), 'gap')}, {missing:.3f} s in all" if wave.gaps else "no gaps"
        samples = f"{wave.samples} at {wave.rate:.0f} Hz, {lost}"
    state = "complete" if run.complete else "damaged, read through a repaired copy"
    known = ", ".join(f"{key} {value}" for key, value in run.truth.items() if key in ("excitation", "faults"))
    return [
        ("Start", summary.when(run)),
        ("Duration", f"{run.duration:.2f} s"),
        ("Wind from", summary.wind_source(run)),
        ("Configuration", summary.configuration(run)),
        ("Wind speed", summary.in_words(numbers.wind, 1.0, "m/s") + ("" if run.wind_drove else "; it didn't drive")),
        ("Input speed", summary.in_words(numbers.speed, summary.RPM, "r/min")),
        ("Input torque", summary.in_words(numbers.torque, 1e-6, "MN m", 3)),
        ("Input power", summary.in_words(numbers.power, 1e-6, "MW", 3)),
        ("Samples", samples),
        ("Recording", state),
        ("Warnings", _alarms(run, numbers)),
        ("Truth", known or ("known, see below" if run.truth else "not recorded")),
        ("Software", ", ".join(f"{k} {v}" for k, v in list(summary.versions(run).items())[:4]) or "not recorded"),
        ("Command", summary.command(run)),
    ]
