"""Time stepping with the ring in modes, by the method of Gautschi or by exponential Runge-Kutta, with samples."""

from __future__ import annotations

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused, kernel, summing
from nw_gear_sim.integrator import etdrk4, gautschi
from nw_gear_sim.modal.forces import (
    ModalInstants,
    ModalWork,
    accelerate,
    mesh_rates,
    set_modal_instant,
    start_wheels,
    turn_wheels,
)
from nw_gear_sim.modal.laws import ModalLaws
from nw_gear_sim.model import Interval
from nw_gear_sim.physics.mesh import Indices
from nw_gear_sim.stepping import Course, count_contacts, record_forces


@summing
def advance_gautschi(
    laws: ModalLaws,
    oscillators: gautschi.Coefficients,
    start: Array,
    end: Array,
    interval: Interval,
    torque_before: float,
    steps_per_sample: int,
    limit: float,
    x: Array,
    u: Array,
    before: Array,
    instants: ModalInstants,
    work: ModalWork,
    course: Course,
) -> int:
    """Integrate over the interval and record; the state before a step is its sample.

    Args:
        laws: of the gearbox; oscillators: of the integrator, for this step.
        start, end: friction tables at the interval's ends; interval: its drive.
        torque_before: input torque at the end of the last interval, N m; at a jump the mean of both sides counts,
            without which the method would be of order 1.
        steps_per_sample: steps between samples.
        limit: of a displacement, m.
        x, u, before: state of the integrator, changed in place, (n,).
        instants, work, course: memory.

    Returns:
        steps done: all, or fewer where a displacement left +-limit or stopped being a number.
    """
    steps = len(course.x) * steps_per_sample
    start_wheels(laws.wheel_ratio, interval, oscillators.step, instants.wheel)
    gautschi.extrapolate(u, before, work.v)
    for step in range(steps):
        set_modal_instant(laws, start, end, interval, step * oscillators.step, instants, 0)
        if step == 0:
            instants.torque[0] = 0.5 * (torque_before + interval.torque_start)
        accelerate(laws, instants, 0, x, work.v, work, work.slopes[0])
        count_contacts(laws.mesh.backlash, work.contact.x, course.open, course.back)
        sampled = step % steps_per_sample == 0
        if sampled:
            _copy(x, work.x)
        gautschi.proceed(oscillators, work.slopes[0], x, u, before, work.v)
        if sampled:
            gautschi.centre(u, before, work.slopes[1])
            mesh_rates(laws, instants, 0, work.x, work.slopes[1], work)
            _record(step // steps_per_sample, laws.turn, laws.probes, work.x, work.slopes[1], work, course)
            if lost(laws.reach, x, limit) >= 0:
                return step + 1
        turn_wheels(instants.wheel)
    return steps


@summing
def advance_etdrk4(
    laws: ModalLaws,
    oscillators: etdrk4.Coefficients,
    start: Array,
    end: Array,
    interval: Interval,
    steps_per_sample: int,
    limit: float,
    x: Array,
    v: Array,
    instants: ModalInstants,
    work: ModalWork,
    course: Course,
) -> int:
    """Do the same by the exponential Runge-Kutta method, with state x, v."""
    steps = len(course.x) * steps_per_sample
    h = interval.duration / steps
    start_wheels(laws.wheel_ratio, interval, 0.5 * h, instants.wheel)
    now, middle, then = 0, 1, 2
    for step in range(steps):
        for half in range(0 if step == 0 else 1, 3):
            slot = now if half == 0 else (middle if half == 1 else then)
            if half > 0:
                turn_wheels(instants.wheel)
            set_modal_instant(laws, start, end, interval, (step + 0.5 * half) * h, instants, slot)
        _copy(x, work.x)
        _copy(v, work.v)
        for stage in range(4):
            slot = now if stage == 0 else (then if stage == 3 else middle)
            accelerate(laws, instants, slot, work.x, work.v, work, work.slopes[stage])
            if stage == 0:
                count_contacts(laws.mesh.backlash, work.contact.x, course.open, course.back)
                if step % steps_per_sample == 0:
                    mesh_rates(laws, instants, now, x, v, work)
                    _record(step // steps_per_sample, laws.turn, laws.probes, x, v, work, course)
                    if lost(laws.reach, x, limit) >= 0:
                        return step
            etdrk4.proceed(stage, oscillators, work.slopes, x, v, work.x, work.v)
        now, then = then, now
    return steps


@kernel
def lost(reach: Array, x: Array, limit: float) -> int:
    """Return the first motion that moves something by more than `limit` (m), or isn't a number; -1 where none does."""
    for i in range(len(x)):
        if not abs(x[i]) <= limit * reach[i]:
            return i
    return -1


@fused
def _copy(source: Array, target: Array) -> None:
    for i in range(len(source)):
        target[i] = source[i]


@kernel
def _record(sample: int, turn: Array, probes: Indices, x: Array, v: Array, work: ModalWork, course: Course) -> None:
    record_forces(sample, work.contact, work.housing, course)
    _twist(turn, probes, x, course.twist[sample])
    _twist(turn, probes, v, course.twist_rate[sample])


@summing
def _twist(turn: Array, probes: Indices, x: Array, out: Array) -> None:
    total = 0.0
    for i in range(len(turn)):
        total += turn[i] * x[i]
    out[0] = total
    for k in range(len(probes)):
        out[1 + k] = x[probes[k]]


@kernel
def evaluate(
    laws: ModalLaws,
    start: Array,
    end: Array,
    interval: Interval,
    x: Array,
    v: Array,
    instants: ModalInstants,
    work: ModalWork,
    out: Array,
) -> None:
    """Set the forces per mass at the start of an interval, without each oscillator's own, for callers outside."""
    start_wheels(laws.wheel_ratio, interval, 0.0, instants.wheel)
    set_modal_instant(laws, start, end, interval, 0.0, instants, 0)
    accelerate(laws, instants, 0, x, v, work, out)


@kernel
def difference(
    laws: ModalLaws,
    instants: ModalInstants,
    x: Array,
    v: Array,
    work: ModalWork,
    gain: Array,
    rate_gain: float,
    out: Array,
) -> None:
    """Set -d(forces per mass)/dx (1/s^2) and /dv (1/s) by central differences at the instant in slot 0.

    Args:
        laws, instants, work: of the gearbox.
        x, v: where to differentiate; they are changed and put back.
        gain: steps in x, (n,); rate_gain: step in v.
        out: set here, (2, n, n).
    """
    above, below = work.slopes[0], work.slopes[1]
    for by_v in range(2):
        varied = v if by_v == 1 else x
        for k in range(len(x)):
            kept, step = varied[k], rate_gain if by_v == 1 else gain[k]
            for side in range(2):
                varied[k] = kept + step if side == 0 else kept - step
                for mesh in range(3):
                    work.contact.force[mesh] = 0.0  # the planets' influence on each other is left out
                accelerate(laws, instants, 0, x, v, work, work.slopes[side])
            varied[k] = kept
            for i in range(len(x)):
                out[by_v, i, k] = (below[i] - above[i]) / (2.0 * step)
