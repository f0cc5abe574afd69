"""`recorder_node`: records topics of any type to a rosbag2 folder with MCAP storage.

The log time of a message is when it arrived; with `use_sim_time` it is the simulated time then, that is the last
`/clock` that arrived before it, and messages that come before the first `/clock` wait for it. The publish time is the
publisher's own stamp, always in wall time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from std_srvs.srv import SetBool

from nw_gear_common import names
from nw_gear_common.diagnostics import OK, WARN, Diagnostics
from nw_gear_common.errors import InputError
from nw_gear_common.quantities import quantities, quantity
from nw_gear_common.ros import NodeFailure, Stop, declare_parameters, make_node, run
from nw_gear_monitor.nodes.discovery import Discovery
from nw_gear_monitor.nodes.ears import Ears
from nw_gear_monitor.nodes.intake import Intake
from nw_gear_monitor.nodes.parameter_survey import ParameterSurvey, as_text
from nw_gear_monitor.records.provenance import run_record
from nw_gear_monitor.records.schema import LOSS, NODE, RUN
from nw_gear_monitor.records.selection import Selection
from nw_gear_monitor.records.writer import COMPRESSIONS, Limits, RecordingWriter

TAKE_EVERY = 0.02
LOOK_EVERY = 0.1
"""Seconds between two looks at which topics there are."""

REPORT_EVERY = 1.0
UNANSWERED = "(unanswered)"
"""Key in the metadata of a node that was there but never told its parameters."""


@dataclass(frozen=True)
class Settings:
    """Parameters of `recorder_node`."""

    uri: str = quantity("", "Folder of the recording, required; it must not exist.")
    topics: tuple[str, ...] = quantity(
        (), "Names or regular expressions; empty = everything in the namespace, `/diagnostics` and `/clock`."
    )
    flush_period: float = quantity(0.5, "Longest time that a killed recorder loses.", "s", minimum=0.01, maximum=3600.0)
    fsync: bool = quantity(False, "Wait at every flush until all is on the disk: it survives a loss of power too.")
    max_file_size: int = quantity(
        0, "Size of a file, without its index, at which the recording goes on in another; 0 = any.", "B", minimum=0
    )
    max_file_duration: float = quantity(
        3600.0, "Recorded time in a file after which the recording goes on in another; 0 = any.", "s", minimum=0.0
    )
    compression: str = quantity("zstd", "Compression of the chunks.", choices=tuple(COMPRESSIONS))
    provenance: str = quantity("", "Text that is kept in the recording, for instance how the run was started.")


class RecorderNode(Node):
    """The recorder as a ROS node.

    Raises:
        InputError: a parameter can't be used, or the folder exists.
    """

    def __init__(self, name: str, stop: Stop, command_line: Sequence[str], **kwargs: Any) -> None:
        super().__init__(name, **kwargs)
        self._stop = stop
        self._settings = declare_parameters(self, Settings)
        if not self._settings.uri:
            raise InputError("parameter uri", "a new folder for the recording", "none")
        simulated = bool(self.get_parameter("use_sim_time").value)
        clock = self.resolve_topic_name(names.CLOCK)
        selected = Selection(self._settings.topics, self.get_namespace(), clock)
        self._diagnostics = Diagnostics(self)
        self._writer = _writer(self._settings)
        self._intake = Intake(self._writer, clock if simulated else None)
        self._ears = Ears(self)
        self._discovery = Discovery(
            self, self._ears, self._intake, selected, clock if simulated else None, self._take_all
        )
        self._survey = ParameterSurvey(self)
        self._announced = self._failed = False
        self._missing: dict[str, str] | None = None
        self._guarded(self._begin, command_line)
        self.create_service(SetBool, "~/pause", self._on_pause)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(TAKE_EVERY, partial(self._guarded, self._take), clock=steady)
        self.create_timer(LOOK_EVERY, partial(self._guarded, self._look), clock=steady)
        self.create_timer(self._settings.flush_period, partial(self._guarded, self._writer.flush), clock=steady)
        self.create_timer(REPORT_EVERY, partial(self._guarded, self._report), clock=steady)

    def close(self) -> None:
        """Write what has arrived and finish the recording.

        Raises:
            NodeFailure: it can't be written.
        """
        self._guarded(self._finish)
        self._ears.close()
        if self._failed:
            self._writer.abandon()

    # --- what is done again and again ---------------------------------------------------------------------------------

    def _guarded(self, work: Callable[..., None], *arguments: Any) -> None:
        """Do something that writes; where that fails the process ends."""
        if self._failed:
            return
        try:
            work(*arguments)
        except OSError as error:
            self._failed = True
            reason = error.strerror or str(error)
            remedy = "what was written before can be repaired with `nw_gear recover`"
            self._stop(NodeFailure(f"can't write to {self._writer.folder}: {reason}; {remedy}"))

    def _begin(self, command_line: Sequence[str]) -> None:
        self._writer.add_metadata(RUN, run_record(command_line, self._settings.provenance))
        own = {name: as_text(getattr(self._settings, name)) for name, *_rest in quantities(self._settings)}
        self._writer.add_metadata(NODE + self.get_name(), own)
        self._writer.flush()

    def _take(self) -> None:
        self._intake.take(self._ears.take())

    def _take_all(self) -> None:
        self._intake.take(self._ears.take(everything=True))

    def _look(self) -> None:
        self._discovery.look()
        if self._intake.topics and not self._announced:
            self._announced = True
            print(f"recording to {self._settings.uri}", flush=True)
        for node, parameters in self._survey.look().items():
            self._writer.add_metadata(NODE + self._inside(node), parameters)

    def _finish(self) -> None:
        self._take_all()
        self._intake.release()
        for node in self._survey.unanswered:
            self._writer.add_metadata(NODE + self._inside(node), {UNANSWERED: "its parameter services never answered"})
        self._keep_losses()
        self._writer.close()

    def _keep_losses(self) -> None:
        """Write down what is missing, if that has changed."""
        skipped = {topic: f"not recorded: {reason}" for topic, reason in self._discovery.skipped.items()}
        missing = {**skipped, **self._intake.missing()}
        if missing != self._missing:
            self._missing = missing
            self._writer.add_metadata(LOSS, missing)

    def _inside(self, node: str) -> str:
        """Name of a node inside the namespace."""
        return node.removeprefix(self.get_namespace().rstrip("/") + "/")

    # --- what it says and answers -------------------------------------------------------------------------------------

    def _on_pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self._guarded(self._take)
        self._intake.paused = bool(request.data)
        response.success, response.message = True, "paused" if request.data else "recording"
        return response

    def _report(self) -> None:
        self._keep_losses()
        intake, lost = self._intake, self._intake.lost
        remarks = [f"{count} messages lost on {topic}" for topic, count in lost.items()]
        remarks += [f"{topic} isn't recorded ({reason})" for topic, reason in self._discovery.skipped.items()]
        if intake.paused:
            remarks.insert(0, "paused")
        values = {
            "messages (1)": str(self._writer.messages),
            "bytes (1)": str(self._writer.size),
            "files (1)": str(self._writer.files),
            "topics (1)": str(len(intake.topics)),
            "lost messages (1)": str(sum(lost.values())),
            "left out while paused (1)": str(intake.left_out),
            "paused": str(intake.paused).lower(),
            "skipped topics": ", ".join(self._discovery.skipped),
            "no parameters yet from": ", ".join(self._survey.unanswered),
            "uri": self._settings.uri,
            **{f"missing on {topic}": counts for topic, counts in intake.missing().items()},
        }
        message = "; ".join(remarks) or "recording"
        self._diagnostics.publish([self._diagnostics.status("recording", WARN if remarks else OK, message, values)])


def _writer(settings: Settings) -> RecordingWriter:
    limits = Limits(settings.max_file_size, round(1e9 * settings.max_file_duration))
    return RecordingWriter(Path(settings.uri).absolute(), settings.compression, limits, settings.fsync)


def main(argv: Sequence[str]) -> int:
    """Record until asked to stop; returns the exit code."""
    return run(
        "recorder_node", lambda stop: make_node(RecorderNode, "recorder_node", stop=stop, command_line=argv), argv
    )
