"""What the page says in words: who runs, states with reasons, alarms, truth, answers. HTML, escaped throughout."""

from __future__ import annotations

from collections.abc import Mapping

from jinja2 import DictLoader, Environment

from nw_gear_common import names
from nw_gear_monitor.dashboard.feed import WAVEFORM, Feed
from nw_gear_monitor.dashboard.presence import LIVE, STALE, WAITING, Presence
from nw_gear_monitor.dashboard.states import Said
from nw_gear_monitor.review.figures.style import INK, state_colour
from nw_gear_monitor.review.rundata import LEVEL_WORDS, SILENT

LEVEL_COLOURS = {0: "#A8D8C2", 1: "#E69F00", 2: "#D55E00", 3: "#6B7078"}
PRESENCE_COLOURS = {LIVE: "#A8D8C2", STALE: "#6B7078", WAITING: "#E3E5E8"}
DARK = frozenset({"#D55E00", "#6B7078"})
OPEN, BACK = "open fraction ", "back-flank fraction "

TEMPLATES = {
    "chip": """{% macro chip(text, colour) -%}
<span class="chip" style="background:{{ colour }};color:{{ ink(colour) }}">{{ text }}</span>
{%- endmacro %}""",
    "banner": """{% from "chip" import chip %}
<p class="banner {{ kind }}">{{ words }}</p>
<p class="nodes">{% for part in parts %}{{ chip(part.text, part.colour) }}{% endfor %}</p>""",
    "states": """{% from "chip" import chip %}
<table><thead><tr><th>part</th><th>state</th><th>level</th><th>reason</th></tr></thead><tbody>
{% for row in rows %}<tr><td class="part">{{ row.part }}</td><td>{{ chip(row.state, row.colour) }}</td>
<td>{{ chip(row.level, row.level_colour) }}</td><td class="reason">{{ row.reason }}</td></tr>{% endfor %}
</tbody></table>{% if not rows %}<p class="soft">No monitor has said anything about a stage yet.</p>{% endif %}""",
    "alarms": """{% from "chip" import chip %}
{% if said %}<p>{{ chip(level, colour) }} {{ message }}</p>
<table><tbody>{% for key, value in values %}<tr><td>{{ key }}</td><td>{{ value }}</td></tr>{% endfor %}</tbody></table>
{% else %}<p class="soft">No monitor has said anything about alarms yet.</p>{% endif %}""",
    "truth": """{% if said %}<p><b>{{ message }}</b>{% if old %} <span class="soft">({{ old }})</span>{% endif %}</p>
<table><tbody>{% for key, value in values %}<tr><td>{{ key }}</td><td>{{ value }}</td></tr>{% endfor %}</tbody></table>
<table><thead><tr><th>share of the last second</th>{% for mesh in meshes %}<th>{{ mesh }}</th>{% endfor %}</tr></thead>
<tbody>{% for name, row in shares %}<tr><td>{{ name }}</td>
{% for value in row %}<td class="n">{{ value }}</td>{% endfor %}</tr>{% endfor %}
</tbody></table>{% else %}<p class="soft">No simulator tells the truth here.</p>{% endif %}""",
    "answers": """{% for answer in answers %}
<p class="{{ 'accepted' if answer.accepted else 'refused' }}">{{ answer.number }}. {{ answer.asked }}:
{{ answer.text }}</p>{% else %}<p class="soft">Nothing asked yet.</p>{% endfor %}""",
}
_ENVIRONMENT = Environment(loader=DictLoader(TEMPLATES), autoescape=True)
_ENVIRONMENT.globals["ink"] = lambda colour: "#fff" if colour in DARK else INK

CSS = """
:host { font: 14px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif;
  color: #2b2f36; width: 100%; }
p { margin: 2px 0 6px; }
.soft { color: #5b626d; }
table { border-collapse: collapse; margin: 2px 0 8px; font-size: 13.5px; }
th, td { text-align: left; padding: 3px 12px 3px 0; border-bottom: 1px solid #dfe2e6; vertical-align: top; }
th { font-weight: 600; color: #5b626d; white-space: nowrap; }
td.n { text-align: right; font-variant-numeric: tabular-nums; }
td.part { white-space: nowrap; }
td.reason { overflow-wrap: anywhere; }
.chip { display: inline-block; padding: 0 8px; margin: 0 6px 3px 0; border-radius: 9px;
  border: 1px solid #00000022; white-space: nowrap; }
.banner { font-size: 16px; font-weight: 600; margin: 4px 0 8px; padding: 8px 14px; background: #f5f6f8;
  border-left: 5px solid #009e73; }
.banner.waiting { border-color: #8a8f98; }
.banner.stale { border-color: #d55e00; background: #fdeee5; }
.accepted { border-left: 4px solid #009e73; padding-left: 8px; }
.refused { border-left: 4px solid #d55e00; padding-left: 8px; background: #fdeee5; }
"""


def _fill(template: str, **values: object) -> str:
    return _ENVIRONMENT.get_template(template).render(**values)


def banner(feed: Feed, topic: str, now: float) -> str:
    """What runs, and who was heard.

    Args:
        feed: what came in.
        topic: full name of the waveform's topic.
        now: wall time (s, monotonic).
    """
    with feed.lock:
        waveform = feed.topics.look(WAVEFORM, now)
        nodes = feed.nodes.everyone(now)
        integration = feed.states.entry("integration")
        foreign = "" if feed.waves is None else feed.waves.foreign
        last, origin, refused = feed.last, feed.origin, feed.refused
    kind, words = waveform.state, f"waiting for {topic}"
    if waveform.state == STALE:
        words = f"stale: nothing on {topic} for {waveform.silent:.0f} s"
    elif waveform.state == LIVE and foreign:
        words = f"live; {topic} is of another machine (no column {foreign}): only states and alarms are shown"
    elif waveform.state == LIVE:
        words = f"live: {last - origin:.1f} s since the run's begin"
    if integration is not None and nodes_state(nodes, integration.node) == LIVE:
        words += f"; {integration.node}: {integration.message}"
    elif integration is not None and waveform.state == STALE:
        words += f"; {integration.node} has gone quiet"
    if refused:
        words += f"; not understood: {refused}"
    parts = [{"text": _presence(part), "colour": PRESENCE_COLOURS[part.state]} for part in nodes]
    return _fill("banner", kind=kind, words=words, parts=parts)


def nodes_state(nodes: tuple[Presence, ...], name: str) -> str:
    """State of one node among all."""
    return next((part.state for part in nodes if part.name == name), WAITING)


def _presence(part: Presence) -> str:
    if part.state == WAITING:
        return f"{part.name}: not heard yet"
    return f"{part.name}: {part.state}" + (f" for {part.silent:.0f} s" if part.state == STALE else "")


def states(feed: Feed, now: float) -> str:
    """State, level and reason of each stage and bearing; stale where their monitor has gone quiet."""
    with feed.lock:
        found = (*feed.states.about("stage "), *feed.states.about("bearing "))
        quiet = {said.name: feed.nodes.look(said.node, now) for said in found}
    rows = []
    for said in found:
        gone = quiet[said.name].state == STALE
        state, level = (names.STALE, SILENT) if gone else (said.state or names.UNKNOWN, said.level)
        reason = f"nothing from {said.node} for {quiet[said.name].silent:.0f} s" if gone else said.reason
        rows.append(
            {
                "part": said.task,
                "state": state,
                "colour": state_colour(state),
                "level": LEVEL_WORDS.get(level, str(level)),
                "level_colour": LEVEL_COLOURS.get(level, LEVEL_COLOURS[SILENT]),
                "reason": reason,
            }
        )
    return _fill("states", rows=rows)


def alarms(feed: Feed, now: float) -> str:
    """The entry `alarms` of the monitor with everything that it lists."""
    with feed.lock:
        said = feed.states.entry("alarms")
        gone = said is not None and feed.nodes.look(said.node, now).state == STALE
    if said is None:
        return _fill("alarms", said=None)
    level = SILENT if gone else said.level
    message = f"held, as {said.node} has gone quiet: {said.message}" if gone else said.message
    values = [(key, value) for key, value in said.values.items() if value]
    colour = LEVEL_COLOURS.get(level, LEVEL_COLOURS[SILENT])
    return _fill("alarms", said=said, level=LEVEL_WORDS.get(level, ""), colour=colour, message=message, values=values)


def truth(feed: Feed, now: float, stale_after: float) -> str:
    """What the simulator knows: faults, excitation, how often meshes were open or on their back flank."""
    with feed.lock:
        said: Said | None = feed.truth
    if said is None:
        return _fill("truth", said=None)
    silent = now - said.heard
    rest = [(k, v) for k, v in said.values.items() if not k.startswith((OPEN, BACK))]
    shares = [("open", _shares(said.values, OPEN)), ("back flank", _shares(said.values, BACK))]
    old = f"stale, {silent:.0f} s old" if silent > stale_after else ""
    return _fill("truth", said=said, message=said.message, old=old, values=rest, meshes=names.MESHES, shares=shares)


def _shares(values: Mapping[str, str], begin: str) -> list[str]:
    return [f"{_number(values.get(f'{begin}{mesh} (1)', '')):.3f}" for mesh in names.MESHES]


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")


def answers(feed: Feed) -> str:
    """What came of the last requests, newest first."""
    with feed.lock:
        found = list(feed.answers)
    return _fill("answers", answers=reversed(found))
