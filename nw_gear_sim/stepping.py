"""Time stepping of the right-hand side by the classical Runge-Kutta method, with samples taken on the way."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import kernel
from nw_gear_sim.integrator import rk4
from nw_gear_sim.model import Instants, Interval, Laws, Work, accelerate, set_instant


class Course(NamedTuple):
    """What happened in the steps: arrays of shape (samples, ...) and counts of the steps, (7,).

    Attributes:
        x, rate, force: of the meshes; housing: (samples, bearings, 3).
        twist, twist_rate: of the ring's mean (rad) and of the probes (m), and their rates, (samples, 1 + probes).
        open, back: steps in which a mesh carried nothing, or carried on its back flanks.
    """

    x: Array
    rate: Array
    force: Array
    housing: Array
    twist: Array
    twist_rate: Array
    open: Array
    back: Array


def new_course(laws: Laws, samples: int) -> Course:
    """Return memory for the samples of an interval."""
    bearings, probes = len(laws.bearings.stiffness), 1 + len(laws.probes)
    return Course(
        x=np.zeros((samples, 7)),
        rate=np.zeros((samples, 7)),
        force=np.zeros((samples, 7)),
        housing=np.zeros((samples, bearings, 3)),
        twist=np.zeros((samples, probes)),
        twist_rate=np.zeros((samples, probes)),
        open=np.zeros(7),
        back=np.zeros(7),
    )


@kernel
def advance(
    laws: Laws,
    start: Array,
    end: Array,
    interval: Interval,
    steps_per_sample: int,
    limit: float,
    q: Array,
    v: Array,
    instants: Instants,
    work: Work,
    course: Course,
) -> int:
    """Integrate over the interval and record; the state before a step is its sample.

    Returns:
        steps done: all, or fewer where a displacement left +-limit (m) or stopped being a number.
    """
    steps = len(course.x) * steps_per_sample
    h = interval.duration / steps
    now, middle, then = 0, 1, 2
    a1, a2, a3, a4 = work.slopes[0], work.slopes[1], work.slopes[2], work.slopes[3]
    set_instant(laws, start, end, interval, 0.0, instants, now)
    for step in range(steps):
        set_instant(laws, start, end, interval, (step + 0.5) * h, instants, middle)
        set_instant(laws, start, end, interval, (step + 1) * h, instants, then)
        accelerate(laws, instants, now, q, v, work, a1)
        _record(laws, step, steps_per_sample, q, v, work, course)
        rk4.second(h, q, v, a1, work.q, work.v)
        accelerate(laws, instants, middle, work.q, work.v, work, a2)
        rk4.third(h, q, v, a1, a2, work.q, work.v)
        accelerate(laws, instants, middle, work.q, work.v, work, a3)
        rk4.fourth(h, q, v, a2, a3, work.q, work.v)
        accelerate(laws, instants, then, work.q, work.v, work, a4)
        rk4.finish(h, q, v, a1, a2, a3, a4)
        now, then = then, now
        if (step + 1) % steps_per_sample == 0 and out_of_bounds(q, limit) >= 0:
            return step + 1
    return steps


@kernel
def _record(laws: Laws, step: int, steps_per_sample: int, q: Array, v: Array, work: Work, course: Course) -> None:
    x = work.contact.x
    for mesh in range(7):
        backlash = laws.mesh.backlash[mesh]
        course.open[mesh] += abs(x[mesh]) <= backlash
        course.back[mesh] += x[mesh] < -backlash
    if step % steps_per_sample == 0:
        sample = step // steps_per_sample
        for mesh in range(7):
            course.x[sample, mesh] = x[mesh]
            course.rate[sample, mesh] = work.contact.rate[mesh]
            course.force[sample, mesh] = work.contact.force[mesh]
        for b in range(len(work.housing)):
            for axis in range(3):
                course.housing[sample, b, axis] = work.housing[b, axis]
        _twist(laws, q, course.twist[sample])
        _twist(laws, v, course.twist_rate[sample])


@kernel
def _twist(laws: Laws, q: Array, out: Array) -> None:
    n = len(laws.ring.cos)
    total = 0.0
    for i in range(n, 2 * n):
        total += q[i]
    out[0] = total * laws.ring.lever
    for k in range(len(laws.probes)):
        out[1 + k] = q[laws.probes[k]]


@kernel
def out_of_bounds(q: Array, limit: float) -> int:
    """Return the first entry that isn't within +-limit, or isn't a number; -1 where all are."""
    for i in range(len(q)):
        if not abs(q[i]) <= limit:
            return i
    return -1
