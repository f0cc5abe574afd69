"""`gear_sim_node`: integrates the gearbox and publishes what it does.

The executor's thread answers subscriptions, services and signals; a second thread compiles, finds the equilibrium,
integrates (without the GIL) and publishes. Simulated time is never skipped: where the machine can't keep pace the lag
is reported in `/diagnostics` and in the log.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path

from geometry_msgs.msg import Vector3Stamped
from rclpy.node import Node
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger

from nw_gear_common import names
from nw_gear_common.diagnostics import ERROR, OK, WARN
from nw_gear_common.errors import InputError, NwGearError
from nw_gear_common.ros import Stop, declare_parameters, latched_qos, leave_now, make_node, run, to_seconds, was_set
from nw_gear_sim import config
from nw_gear_sim.checkpoints import read_checkpoint, write_checkpoint
from nw_gear_sim.drives import SPEED, TORQUE, WIND
from nw_gear_sim.faults.injection import same_settings
from nw_gear_sim.kinematics import derive
from nw_gear_sim.nodes.compiling import compile_with_notice
from nw_gear_sim.nodes.inflow import Inflows
from nw_gear_sim.nodes.inputs import make_source, ring_sample
from nw_gear_sim.nodes.pacing import Busy, Pace
from nw_gear_sim.nodes.progress import Progress
from nw_gear_sim.nodes.publishing import Reports, Views, Waveform
from nw_gear_sim.nodes.sensing import Sensing, wanted
from nw_gear_sim.nodes.session import Session
from nw_gear_sim.nodes.sim_settings import Settings
from nw_gear_sim.params.faults import FaultSettings
from nw_gear_sim.remarks import remarks

POLL = 0.02
"""Seconds between two looks at something that is waited for."""
JOIN_WITHIN = 4.0
INPUT_TOPIC = {WIND: names.WIND_SPEED, SPEED: names.DRIVE, TORQUE: names.DRIVE}


class GearSimNode(Node):
    """The simulator as a ROS node."""

    def __init__(self, name: str, stop: Stop, **kwargs: object) -> None:
        super().__init__(name, **kwargs)
        self._stop = stop
        self._settings = declare_parameters(self, Settings, self._change)
        self._configuration = config.load(self._settings.config or None)
        self._resolved = config.to_yaml(self._configuration)
        self.declare_parameter("resolved_config", self._resolved)
        settings = self._settings
        self._clocked = settings.publish_clock if was_set(self, "publish_clock") else settings.real_time_factor != 1.0
        self._session = Session(
            self._configuration,
            make_source(settings, self._configuration),
            settings.excitation or self._configuration.excitation.mode,
            settings.start,
            settings.sample_rate,
            every_step=wanted(settings),
        )
        self._session.inject(same_settings(settings))
        needs = self._session.source.needs
        self._input = INPUT_TOPIC[needs[0]] if needs else ""
        self._inflows = Inflows(needs, in_step=self._clocked)
        self._progress = Progress(self._input, waits=self._clocked)
        self._ticking, self._paused, self._reset = threading.Lock(), threading.Event(), threading.Event()
        self._waveform = Waveform(self, self._session.rows, settings.waveform_bearings)
        self._sensing = Sensing(self, settings, self._configuration, self._session.fine_rate)
        self._views = Views(self, settings.view_rate)
        self._reports = Reports(self, self._clocked)
        qos: QoSProfile = latched_qos()
        qos.depth = 20
        self.create_subscription(Vector3Stamped, names.WIND_SPEED, self._on_wind, qos)
        self.create_subscription(JointState, names.DRIVE, self._on_drive, qos)
        self.create_service(SetBool, "~/pause", self._on_pause)
        self.create_service(Trigger, "~/reset", self._on_reset)
        self.create_service(Trigger, "~/checkpoint", self._on_checkpoint)
        for remark in (*self._session.source.remarks, *remarks(self._configuration, derive(self._configuration))):
            self.get_logger().warning(remark)
        self._origin = self._next_report = 0.0
        self._refused = 0
        self._resumed = self._starved = self._warned = False
        self._held: float | None = None
        self._pace = Pace(settings.real_time_factor, time.monotonic(), 0.0)
        self._busy = Busy(time.monotonic())
        self._thread = threading.Thread(target=self._work, name="integration", daemon=True)
        self._thread.start()

    # --- the executor's thread --------------------------------------------------------------------------------------

    def _on_wind(self, message: Vector3Stamped) -> None:
        sample = {WIND: message.vector.x} if math.isfinite(message.vector.x) else None
        self._take(names.WIND_SPEED, message.header.stamp, sample)

    def _on_drive(self, message: JointState) -> None:
        sample = ring_sample(message.name, message.velocity, message.effort)
        self._take(names.DRIVE, message.header.stamp, sample)

    def _take(self, topic: str, stamp: object, sample: dict[str, float] | None) -> None:
        if sample is None:
            self._refused += 1
            return
        self._inflows.add(to_seconds(stamp), **sample)
        if topic == self._input:
            self._progress.heard(time.monotonic())

    def _change(self, settings: Settings) -> None:
        """Live parameters were set. Faults that weren't touched stay, also where a checkpoint brought them."""
        factor = settings.real_time_factor
        paced = factor != self._settings.real_time_factor
        if paced and not self._clocked:
            raise InputError(
                "parameter real_time_factor", "1, as this run's time is the wall's (see publish_clock)", f"{factor:g}"
            )
        changed = {
            field.name: getattr(settings, field.name)
            for field in fields(FaultSettings)
            if getattr(settings, field.name) != getattr(self._settings, field.name)
        }
        with self._ticking:  # between two ticks
            self._session.inject(replace(self._session.faults, **changed))
            if paced and self._session.begun:
                self._pace = Pace(factor, time.monotonic(), self._session.time)
        self._settings = settings

    def _on_checkpoint(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        path = self._settings.checkpoint
        try:
            if not path:
                raise InputError("parameter checkpoint", "a file name", "nothing")
            with self._ticking:  # between two ticks
                if not self._session.begun:
                    raise InputError("checkpoint", "a run that has begun", "none yet")
                values = self._session.checkpoint() | self._waveform.pending(self._origin) | self._sensing.checkpoint()
            write_checkpoint(Path(path), self._resolved, values)
            response.success, response.message = True, path
        except InputError as error:
            response.success, response.message = False, str(error)
        return response

    def _on_pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        (self._paused.set if request.data else self._paused.clear)()
        response.success, response.message = True, "paused" if request.data else "running"
        return response

    def _on_reset(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._reset.set()
        response.success, response.message = True, "starting again from the initial state"
        return response

    def close(self) -> None:
        """End the second thread; a compiler that is still busy there is not waited for."""
        self._stop.event.set()
        self._thread.join(JOIN_WITHIN)
        if self._thread.is_alive():
            leave_now(0 if self._stop.error is None else self._stop.error.exit_code)

    # --- the thread that integrates -----------------------------------------------------------------------------------

    def _work(self) -> None:
        try:
            self._report(OK, "compiling")
            compile_with_notice(self._configuration.numerics.integrator, self.get_logger().info)
            self._sensing.compile()
            while not self._stop and self._run_epoch():
                self.get_logger().info("reset: a new epoch begins")
            if not self._stop and not (self._waveform.flush() and self._sensing.flush()):
                self.get_logger().warning("the last blocks were not acknowledged by every subscriber")
            self._stop()
        except NwGearError as error:
            self._report(ERROR, str(error))
            self._stop(error)
        except Exception as error:  # a thread that dies in silence would leave a node that does nothing
            self._stop(NwGearError(f"{type(error).__name__}: {error}"))
            raise

    def _run_epoch(self) -> bool:
        """Run from the initial state until a reset (True) or the end (False)."""
        self._reset.clear()
        self._waveform.drop()
        self._sensing.drop()
        self._session.forget()
        self._resume()
        began = self._session.time if self._session.begun else 0.0
        if not self._wait_for_company(began):
            return not self._stop
        if not self._session.begun:
            self._origin = 0.0 if self._clocked else self._wall_time()
            self._session.begin(self._inflows.at(self._origin))
        self._origin = 0.0 if self._clocked else self._wall_time() - began  # finding the equilibrium took time
        self._waveform.move(self._origin)
        self._held = None
        self._pace, self._busy = Pace(self._settings.real_time_factor, time.monotonic(), began), Busy(time.monotonic())
        self.get_logger().info(f"integrating {self._session.description}")
        limit = self._settings.duration
        while not self._stop and not self._reset.is_set():
            if (limit and self._session.time >= limit - 1e-9) or self._session.source.over():
                self._report_progress()
                return False
            if self._may_advance():
                self._advance()
            if time.monotonic() >= self._next_report:
                self._next_report = time.monotonic() + 1.0
                self._report_progress()
        return not self._stop

    def _resume(self) -> None:
        """Go on from a checkpoint, once; a reset begins at the beginning."""
        if self._settings.resume and not self._resumed:
            self._resumed = True
            values = read_checkpoint(Path(self._settings.resume), self._resolved)
            self._session.resume(values)
            self._waveform.restore(values)
            self._sensing.restore(values)

    def _wait_for_company(self, moment: float) -> bool:
        """Wait for subscribers and for the first input; False when stopped or reset meanwhile.

        The clock is said again and again: a wind node that starts later has to hear it too, and a jump back makes the
        wind begin again (until then what is known of it stays valid).
        """
        while not self._stop and not self._reset.is_set():
            self._reports.clock(moment)
            subscribers = self._waveform.subscribers()
            missing = []
            if subscribers < self._settings.wait_for:
                missing.append(f"{self._settings.wait_for} subscribers of {names.WAVEFORM} (now {subscribers})")
            if not self._inflows.ready(moment):
                what = f"{self._input} from {moment:g} s on" if self._clocked else f"a first message on {self._input}"
                missing.append(what)
            if not missing:
                return True
            if time.monotonic() >= self._next_report:
                self._next_report = time.monotonic() + 1.0
                self._report(OK, "waiting for " + " and ".join(missing))
            self._stop.event.wait(POLL)
        return False

    def _on_hold(self) -> bool:
        """Whether the run is paused; then wait a little. Time goes on from where it was left."""
        now = time.monotonic()
        if self._paused.is_set():
            self._held = now if self._held is None else self._held
            self._stop.event.wait(POLL)
            return True
        if self._held is not None:
            self._origin += 0.0 if self._clocked else now - self._held
            self._pace = Pace(self._settings.real_time_factor, now, self._session.time)
            self._held = None
        return False

    def _may_advance(self) -> bool:
        """Whether the next tick is due, and wait a little where it isn't."""
        if self._on_hold():
            return False
        wait = self._pace.wait(time.monotonic(), self._session.time + self._session.tick)
        if wait > 0.0:
            self._stop.event.wait(min(wait, POLL))
            return wait <= POLL
        self._starved = not self._inflows.cover(self._session.time, self._session.time + self._session.tick)
        if self._starved:
            self._reports.clock(self._session.time)
            self._stop.event.wait(POLL / 10)
            return False
        return True

    def _advance(self) -> None:
        end = self._session.time + self._session.tick
        inputs = self._inflows.at(self._origin + end)
        began = time.thread_time()
        with self._ticking:
            block = self._session.advance(inputs)
            self._busy.note(time.thread_time() - began)
            self._waveform.add(block, self._origin)
            self._sensing.add(self._session.fine, self._origin)
        self._views.offer(block, self._origin)
        self._reports.clock(self._session.time)
        self._pace.note(time.monotonic(), self._session.time)

    def _wall_time(self) -> float:
        return float(self.get_clock().now().nanoseconds) * 1e-9

    # --- what it says about itself ------------------------------------------------------------------------------------

    def _report_progress(self) -> None:
        moment, simulated = time.monotonic(), self._session.time
        wrong, message = self._progress.report(
            self._pace, moment, simulated, paused=self._paused.is_set(), starved=self._starved
        )
        if wrong and not self._warned:
            self.get_logger().warning(message)
        self._warned = wrong
        values = {
            "real_time_factor reached (1)": f"{self._pace.reached():.4g}",
            "real_time_factor wanted (1)": f"{self._settings.real_time_factor:g}",
            "lag (s)": f"{max(0.0, self._pace.lag(moment, simulated)):.3f}",
            "simulated (s)": f"{simulated:.3f}",
            "integration (share of a core)": f"{self._busy.share(moment):.3f}",
            **self._session.values(),
            **({"input samples refused (1)": str(self._refused)} if self._refused else {}),
        }
        self._report(WARN if wrong or self._refused else OK, message, values)
        faults = self._session.fault_names()
        self._reports.truth(", ".join(faults) or "no fault injected", self._session.truth())

    def _report(self, level: bytes, message: str, values: dict[str, str] | None = None) -> None:
        now = self._origin + self._session.time if self._clocked else self._wall_time()
        self._reports.diagnostics(now, level, message, values or {})
        self._sensing.report(now)


def main(argv: Sequence[str]) -> int:
    """Run the node until it is asked to stop, `duration` is over or the integration fails."""
    return run("gear_sim_node", lambda stop: make_node(GearSimNode, "gear_sim_node", stop=stop), argv)
