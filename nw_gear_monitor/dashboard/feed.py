"""Everything that the page shows, as it comes in; written by the thread that listens, read by the one that serves."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.dashboard.buffers import Ring
from nw_gear_monitor.dashboard.presence import Register
from nw_gear_monitor.dashboard.states import Said, States
from nw_gear_monitor.dashboard.waves import BACKWARD, Waves

OPERATION_ROWS = 4000
WIND_ROWS = 2000
SECTION_ROWS = 1500
INDICATOR_ROWS = 900
MOST_ANSWERS = 6
NODES = ("wind_node", "gear_sim_node", "gear_monitor_node")
"""Nodes that are listed although they were never heard."""
WAVEFORM = "waveform"


@dataclass(frozen=True)
class Answer:
    """What came of a request.

    Attributes:
        asked: what was asked for, in words.
        accepted: whether the node did it.
        text: what the node said.
        number: of the request, counted from 1.
    """

    asked: str
    accepted: bool
    text: str
    number: int


@dataclass(frozen=True, eq=False)
class Spectra:
    """The newest message of `spectrum` or `orders`, with a number that tells it from the one before."""

    table: Table
    number: int


class Feed:
    """Buffers of fixed size behind the page. Every method may be called by any thread.

    Args:
        history: seconds that the scrolling figures show.
        stale_after: seconds of silence after which a node or the waveform is stale.

    Attributes:
        lock: held while the buffers are written; readers hold it for as long as they need them to stay as they are.
        epoch: changes when a new run begins; who reads the buffers has to begin anew then.
        origin: time zero of the page (s of ROS time).
    """

    def __init__(self, history: float, stale_after: float) -> None:
        self.lock = threading.RLock()
        self.history = history
        self.epoch, self.origin = 0, 0.0
        self.waves: Waves | None = None
        self.operation, self.wind = Ring(3, OPERATION_ROWS), Ring(2, WIND_ROWS)
        self.sections = {stage: Ring(len(names.SECTION_COLUMNS), SECTION_ROWS) for stage in names.STAGES}
        self.indicators: dict[str, tuple[tuple[str, ...], Ring]] = {}
        self.spectra: dict[str, Spectra] = {}
        self.states = States()
        self.truth: Said | None = None
        self.parameters: dict[str, dict[str, Any]] = {}
        self.answers: deque[Answer] = deque(maxlen=MOST_ANSWERS)
        self.nodes = Register(NODES, stale_after)
        self.topics = Register((WAVEFORM,), stale_after)
        self.refused = ""
        self._begun = False
        self._asked = 0

    @property
    def last(self) -> float:
        """Time of the newest sample (s of ROS time), NaN before the first."""
        return float("nan") if self.waves is None or np.isinf(self.waves.last) else self.waves.last

    # --- what comes in ----------------------------------------------------------------------------------------------

    def add_waveform(self, table: Table, now: float) -> None:
        """Take a block of `waveform`; `now` is the wall time here and below (s, monotonic)."""
        if "time" not in table.columns:
            raise InputError(f"{WAVEFORM}: columns", "one named time", ", ".join(table.columns[:4]))
        if not len(table.data):
            return
        with self.lock:
            self.topics.heard(WAVEFORM, now)
            begin = float(table.column("time")[0])
            if self.waves is None or self.waves.columns != table.columns or self.waves.goes_back(table):
                self._begin(begin)
                self.waves = Waves(table.columns, self.history, begin)
            self.waves.add(table)

    def _begin(self, origin: float) -> None:
        """A new run: what was shown of another one goes; what came just ahead of the first samples stays."""
        self.epoch += 1
        self.origin, self._begun = origin, True
        for ring in (self.operation, self.wind):
            rows = ring.everything()
            ring.clear()
            ring.add(rows[(rows[:, 0] >= origin - BACKWARD) & (rows[:, 0] < origin + self.history)])
        for ring in self.sections.values():
            ring.clear()
        self.indicators.clear()
        self.spectra.clear()
        self.states.begin()

    def add_operation(self, time: float, speed: float, torque: float) -> None:
        """Take speed (rad/s) and torque (N m) of the ring at a time (s)."""
        self._add(self.operation, [time, speed, torque])

    def add_wind(self, time: float, speed: float) -> None:
        """Take the wind speed (m/s) at a time (s)."""
        self._add(self.wind, [time, speed])

    def _add(self, ring: Ring, row: list[float]) -> None:
        with self.lock:
            if not self._begun:
                self.origin, self._begun = row[0], True
                self.epoch += 1
            last = ring.last
            if last is not None and row[0] < last[0] - BACKWARD:
                ring.clear()
                self.epoch += 1
            elif last is not None and row[0] <= last[0]:
                return
            ring.add(np.array([row]))

    def add_spectra(self, topic: str, table: Table) -> None:
        """Take a message of `spectrum` or `orders`."""
        with self.lock:
            before = self.spectra.get(topic)
            self.spectra[topic] = Spectra(table, 1 if before is None else before.number + 1)

    def add_section(self, stage: str, table: Table) -> None:
        """Take new Poincaré points of a stage."""
        points: Array = table.select(names.SECTION_COLUMNS)
        with self.lock:
            self.sections[stage].add(points[np.argsort(points[:, 0], kind="stable")])

    def add_indicators(self, place: str, table: Table) -> None:
        """Take a row of indicators of a mesh or bearing."""
        with self.lock:
            known = self.indicators.get(place)
            if known is None or known[0] != table.columns:
                known = self.indicators[place] = (table.columns, Ring(len(table.columns), INDICATOR_ROWS))
            known[1].add(table.data)

    def add_status(self, name: str, level: int, message: str, values: Mapping[str, str], now: float) -> None:
        """Take one entry of `/diagnostics`."""
        said = Said(name, level, message, dict(values), now)
        with self.lock:
            self.nodes.heard(said.node, now)
            self.states.add(said, self.last)

    def add_truth(self, message: str, values: Mapping[str, str], now: float) -> None:
        """Take what the simulator knows."""
        with self.lock:
            self.truth = Said("truth", 0, message, dict(values), now)

    def add_parameters(self, node: str, values: Mapping[str, Any]) -> None:
        """Take values of a node's parameters."""
        with self.lock:
            self.parameters.setdefault(node, {}).update(values)

    def answer(self, asked: str, accepted: bool, text: str) -> None:
        """Note what came of a request."""
        with self.lock:
            self._asked += 1
            self.answers.append(Answer(asked, accepted, text, self._asked))
