"""Alarms as the running monitor offers them: services, parameters, the baseline's file, lines in the log."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.quantities import quantity
from nw_gear_monitor.alarm_status import Learning, alarm_status, log_line, with_alarms
from nw_gear_monitor.alarms.center import ERROR, AlarmCenter, Transition
from nw_gear_monitor.alarms.features import LONG, SHORT, features
from nw_gear_monitor.alarms.identity import identity_of
from nw_gear_monitor.alarms.keeper import Keeper
from nw_gear_monitor.alarms.settings import AlarmSettings
from nw_gear_monitor.health import Status
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.pipeline import Hop, Windows


@dataclass(frozen=True)
class BaselineSettings(AlarmSettings):
    """What the node adds to the settings of alarms."""

    baseline_file: str = quantity("", "File of the learned baselines; empty = they end with the node.")
    export_file: str = quantity("", "File that the service `~/export_baseline` writes to.", live=True)
    learn: bool = quantity(True, "Whether steady windows are learned, unless the baselines are frozen.", live=True)


@dataclass(frozen=True)
class WatchSettings(BaselineSettings, Windows):
    """Everything that alarms depend on."""


class AlarmWatch:
    """Feeds the alarm centre and answers the services; used by two threads.

    Args:
        node: that offers the services.
        machine: what is watched.
        settings: parameters.
        publish: asks for `/diagnostics` at once.

    Raises:
        InputError: the baseline's file can't be used.
    """

    def __init__(self, node: Node, machine: Machine, settings: WatchSettings, publish: Callable[[], None]) -> None:
        self._logger = node.get_logger()
        self._machine = machine
        self._settings = settings
        self._publish = publish
        self._keeper = Keeper(settings.baseline_file, identity_of(machine, settings))
        windows = {SHORT: settings.spectrum_seconds, LONG: max(settings.label_seconds, settings.spectrum_seconds)}
        self._center = AlarmCenter(settings, windows, self._keeper.baseline)
        self._center.learn = settings.learn
        self._refused = ""
        self._lock = threading.Lock()
        node.create_service(Trigger, "~/acknowledge", self._on_acknowledge)
        node.create_service(Trigger, "~/reset_alarms", self._on_reset)
        node.create_service(SetBool, "~/freeze_baseline", self._on_freeze)
        node.create_service(Trigger, "~/export_baseline", self._on_export)
        if self._keeper.found:
            progress = self._center.baseline.progress(settings.least_windows)
            words = f"{progress.bins} bins, of which {progress.judging} judge"
            self._logger.info(f"baseline of {self._keeper.path}: {words}")

    def change(self, settings: WatchSettings) -> None:
        """Take over the parameters that may change while the node runs."""
        with self._lock:
            self._settings = settings
            self._center.learn = settings.learn

    def update(self, hop: Hop) -> None:
        """Take in one second; changes of level go to the log."""
        with self._lock:
            if hop.restarted or not hop.turning:
                self._center.interrupt()
            refused = self._keeper.admit(hop.rate)
            if refused and refused != self._refused:
                self._logger.warning(f"no alarms: {refused}")
            self._refused = refused
            transitions: list[Transition] = []
            if hop.turning and not refused:
                found = features(hop.indicators, hop.bearing_indicators)
                transitions = self._center.update(hop.time, hop.operating, found)
            self._keep()
        for transition in transitions:
            self._log(transition)

    def interrupt(self) -> None:
        """Windows begin anew; baselines and alarms stay."""
        with self._lock:
            self._center.interrupt()

    def entries(self, statuses: Sequence[Status]) -> list[Status]:
        """The statuses with their alarms, and the entry `alarms`."""
        silent = any(status.label == names.STALE for status in statuses)
        with self._lock:
            alarms = self._center.alarms
            entry = alarm_status(alarms, self._learning(), self._machine, silent)
        return [*with_alarms(statuses, alarms, self._machine), entry]

    def close(self) -> None:
        """Write the baselines to their file."""
        with self._lock:
            self._keeper.save()
        if self._keeper.trouble:
            self._logger.error(f"baseline not kept: {self._keeper.trouble}")

    def _keep(self) -> None:
        before = self._keeper.trouble
        self._keeper.keep(time.monotonic())
        if self._keeper.trouble and self._keeper.trouble != before:
            self._logger.error(f"baseline not kept: {self._keeper.trouble}")

    def _learning(self) -> Learning:
        center = self._center
        rests = "frozen" if center.baseline.frozen else "not learning: parameter learn is false"
        return Learning(
            progress=center.baseline.progress(self._settings.least_windows),
            doing="learning" if center.learning else rests,
            pause="; ".join(f"{window} windows: {why}" for window, why in center.pause.items() if why),
            file=str(self._keeper.path or ""),
            trouble="; ".join(part for part in (self._refused, self._keeper.trouble) if part),
        )

    def _log(self, transition: Transition) -> None:
        line = log_line(transition, self._machine)
        if transition.alarm.level <= transition.before:
            self._logger.info(line)
        elif transition.alarm.level == ERROR:
            self._logger.error(line)
        else:
            self._logger.warning(line)

    def _on_acknowledge(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        with self._lock:
            seen = self._center.acknowledge()
        self._publish()
        response.success, response.message = True, _listed("acknowledged", seen)
        return response

    def _on_reset(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        with self._lock:
            dropped = self._center.reset()
        self._publish()
        response.success, response.message = True, _listed("reset", dropped)
        return response

    def _on_freeze(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        with self._lock:
            self._center.baseline.frozen = bool(request.data)
            self._keeper.save()
            trouble = self._keeper.trouble
        self._publish()
        response.success = not trouble
        response.message = trouble or ("frozen" if request.data else "not frozen")
        return response

    def _on_export(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        try:
            with self._lock:
                response.message = self._keeper.export(self._settings.export_file)
            response.success = True
        except InputError as error:
            response.success, response.message = False, str(error)
        return response


def _listed(done: str, features: Sequence[str]) -> str:
    return f"{done}: {', '.join(features)}" if features else "no alarm"
