"""The controls of the page: widgets that ask the nodes for something and show what the nodes' parameters are now."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from bokeh.layouts import column, row
from bokeh.models import Button, Column, Div, InlineStyleSheet, Model, NumericInput, Row, Select, Spinner

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_monitor.dashboard import controls, text
from nw_gear_monitor.dashboard.controls import MONITOR, RECORDER, REPLAY, SIM, WIND, Field, Request
from nw_gear_monitor.dashboard.feed import Feed
from nw_gear_monitor.dashboard.presence import LIVE

WIDTH = 150
Ask = Callable[[Request], None]


def _widget(field: Field) -> Select | NumericInput:
    if field.choices:
        return Select(title=field.label, value=str(field.shown), options=list(field.choices), width=WIDTH)
    mode = "int" if field.kind is int else "float"
    return NumericInput(
        title=field.label, value=field.shown, low=field.low, high=field.high, mode=mode, width=WIDTH, name=field.name
    )


class Controls:
    """All controls.

    Args:
        ask: hands a request on; its answer comes back through the feed.
        refuse: notes a request that never gets as far as a node: words, reason.
    """

    def __init__(self, ask: Ask, refuse: Callable[[str, str], None]) -> None:
        self._ask, self._refuse = ask, refuse
        self._known: dict[tuple[str, str], Any] = {}
        self._answers = Div(text="", stylesheets=[InlineStyleSheet(css=text.CSS)], sizing_mode="stretch_width")
        self._shown_answers = ""
        self._by_node: dict[str, list[Model]] = {}
        self.roots: dict[str, Model] = {
            "run": self._run(),
            "wind_controls": self._wind(),
            "fault_controls": self._faults(),
            "alarm_controls": self._alarms(),
            "answers": self._answers,
        }

    # --- building ---------------------------------------------------------------------------------------------------

    def _button(self, node: str, label: str, make: Callable[[], Request], kind: str = "default") -> Button:
        button = Button(label=label, button_type=kind, name=label, align="end", width_policy="min")

        def pressed() -> None:
            try:
                self._ask(make())
            except InputError as error:
                self._refuse(label, str(error))

        button.on_click(pressed)
        self._by_node.setdefault(node, []).append(button)
        return button

    def _run(self) -> Column:
        self._pace = NumericInput(
            title="Speed (× real time, 0 = fastest)", value=1.0, low=0.0, high=1000.0, mode="float", width=200
        )
        first = row(
            self._button(SIM, "Pause", lambda: controls.pause(SIM, True), "primary"),
            self._button(SIM, "Go on", lambda: controls.pause(SIM, False)),
            self._button(SIM, "Begin anew", lambda: controls.trigger(SIM, "reset", "begin anew")),
        )
        second = row(self._pace, self._button(SIM, "Set speed", lambda: controls.set_pace(self._pace.value)))
        recorder = row(
            self._button(RECORDER, "Pause recording", lambda: controls.pause(RECORDER, True)),
            self._button(RECORDER, "Go on recording", lambda: controls.pause(RECORDER, False)),
        )
        replay = row(
            self._button(REPLAY, "Pause replay", lambda: controls.pause(REPLAY, True)),
            self._button(REPLAY, "Go on replaying", lambda: controls.pause(REPLAY, False)),
        )
        self._optional: dict[str, Row] = {RECORDER: recorder, REPLAY: replay}
        for part in self._optional.values():
            part.visible = False
        return column(first, second, recorder, replay)

    def _wind(self) -> Column:
        self._source = Select(title="Source", value="weibull", options=list(names.WIND_SOURCES), width=WIDTH)
        self._speed = Spinner(
            title="Wind speed (m/s, constant)", value=11.5, low=0.0, high=100.0, step=0.5, mode="float", width=200
        )
        return column(
            row(self._source, self._button(WIND, "Set source", lambda: controls.set_wind(self._source.value, None))),
            row(self._speed, self._button(WIND, "Set wind speed", lambda: controls.set_wind(None, self._speed.value))),
        )

    def _faults(self) -> Column:
        options = [(kind, controls.FAULT_WORDS[kind]) for kind in controls.KINDS]
        self._kind = Select(title="Fault", value=controls.KINDS[0], options=options, width=WIDTH, name="fault_kind")
        self._fields = {
            kind: {field.name: _widget(field) for field in controls.fields_of(kind)} for kind in controls.KINDS
        }
        self._ramp = _widget(controls.FIELDS["fault_ramp"])
        self._groups = {
            kind: row(*widgets.values(), visible=kind == self._kind.value) for kind, widgets in self._fields.items()
        }
        self._kind.on_change("value", self._choose)
        buttons = row(
            self._ramp,
            self._button(SIM, "Inject fault", self._injection, "warning"),
            self._button(SIM, "End fault", lambda: controls.heal(self._kind.value, self._ramp.value or 0.0)),
        )
        return column(row(self._kind, *self._groups.values()), buttons)

    def _choose(self, _attribute: str, _old: str, new: str) -> None:
        for kind, group in self._groups.items():
            group.visible = kind == new

    def _injection(self) -> Request:
        kind = str(self._kind.value)
        shown = {name: widget.value for name, widget in self._fields[kind].items()}
        return controls.inject(kind, {**shown, "fault_ramp": self._ramp.value})

    def _alarms(self) -> Row:
        return row(
            self._button(
                MONITOR, "Acknowledge", lambda: controls.trigger(MONITOR, "acknowledge", "acknowledge alarms")
            ),
            self._button(MONITOR, "Drop alarms", lambda: controls.trigger(MONITOR, "reset_alarms", "drop alarms")),
            self._button(MONITOR, "Freeze baselines", lambda: controls.freeze(True)),
            self._button(MONITOR, "Learn baselines", lambda: controls.freeze(False)),
            self._button(MONITOR, "Flush windows", lambda: controls.trigger(MONITOR, "reset", "flush windows")),
        )

    # --- what is so now -----------------------------------------------------------------------------------------------

    def update(self, feed: Feed, now: float) -> None:
        """Show what the parameters are, enable the controls of nodes that are there, show the newest answers."""
        with feed.lock:
            parameters = {node: dict(values) for node, values in feed.parameters.items()}
            there = {part.name: part.state for part in feed.nodes.everyone(now)}
        for node, buttons in self._by_node.items():
            away = there.get(node) != LIVE
            for button in buttons:
                if button.disabled != away:
                    button.disabled = away
        for node, part in self._optional.items():
            if part.visible != (node in there):
                part.visible = node in there
        self._follow(parameters)
        answers = text.answers(feed)
        if answers != self._shown_answers:
            self._answers.text = self._shown_answers = answers

    def _follow(self, parameters: Mapping[str, Mapping[str, Any]]) -> None:
        """A widget follows its parameter when that changes, and else keeps what was typed."""
        followed: dict[tuple[str, str], Any] = {
            (WIND, "source"): self._source,
            (WIND, "speed"): self._speed,
            (SIM, "real_time_factor"): self._pace,
        }
        for (node, name), widget in followed.items():
            value = parameters.get(node, {}).get(name)
            if value is not None and self._known.get((node, name)) != value:
                self._known[node, name] = value
                widget.value = value
