"""Time stepping of the right-hand side by the classical Runge-Kutta method, with samples taken on the way."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import kernel
from nw_gear_sim.integrator import rk4
from nw_gear_sim.model import Instants, Interval, Laws, Work, accelerate, set_instant
from nw_gear_sim.physics.mesh import Contact, Indices


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
    for step in range(steps):
        for half in range(0 if step == 0 else 1, 3):  # loops, so that what is put in here is compiled once
            slot = now if half == 0 else (middle if half == 1 else then)
            set_instant(laws, start, end, interval, (step + 0.5 * half) * h, instants, slot)
        rk4.first(q, v, work.q, work.v)
        for stage in range(4):
            slot = now if stage == 0 else (then if stage == 3 else middle)
            accelerate(laws, instants, slot, work.q, work.v, work, work.slopes[stage])
            if stage == 0:
                count_contacts(laws.mesh.backlash, work.contact.x, course.open, course.back)
                if step % steps_per_sample == 0:
                    _record(step // steps_per_sample, laws.ring.lever, laws.probes, q, v, work, course)
            rk4.proceed(stage, h, q, v, work.slopes, work.q, work.v)
        now, then = then, now
        if (step + 1) % steps_per_sample == 0 and out_of_bounds(q, limit) >= 0:
            return step + 1
    return steps


@kernel
def count_contacts(backlash: Array, x: Array, opened: Array, back: Array) -> None:
    """Count a step in which meshes at elongations x carried nothing, or carried on their back flanks."""
    for mesh in range(len(x)):
        opened[mesh] += abs(x[mesh]) <= backlash[mesh]
        back[mesh] += x[mesh] < -backlash[mesh]


@kernel
def record_forces(sample: int, contact: Contact, housing: Array, course: Course) -> None:
    """Record what the meshes do and the forces on the housings."""
    for mesh in range(len(contact.x)):
        course.x[sample, mesh] = contact.x[mesh]
        course.rate[sample, mesh] = contact.rate[mesh]
        course.force[sample, mesh] = contact.force[mesh]
    for b in range(len(housing)):
        for axis in range(3):
            course.housing[sample, b, axis] = housing[b, axis]


@kernel
def _record(sample: int, lever: float, probes: Indices, q: Array, v: Array, work: Work, course: Course) -> None:
    record_forces(sample, work.contact, work.housing, course)
    segments = work.padded.shape[1] - 2
    _twist(segments, lever, probes, q, course.twist[sample])
    _twist(segments, lever, probes, v, course.twist_rate[sample])


@kernel
def _twist(segments: int, lever: float, probes: Indices, q: Array, out: Array) -> None:
    total = 0.0
    for i in range(segments, 2 * segments):
        total += q[i]
    out[0] = total * lever
    for k in range(len(probes)):
        out[1 + k] = q[probes[k]]


@kernel
def out_of_bounds(q: Array, limit: float) -> int:
    """Return the first entry that isn't within +-limit, or isn't a number; -1 where all are."""
    for i in range(len(q)):
        if not abs(q[i]) <= limit:
            return i
    return -1
