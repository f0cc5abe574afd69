"""What takes part in a mode: energies by body and element, effective masses, and a name for the mode.

A mode x(t) = Re(vector exp(lambda t)) has, averaged over its period, the kinetic energy sum m |x'|^2 / 4; shares of it
are shares of m |vector|^2. Shares of strain energy are those of k |row . vector|^2 over all elements. The effective
mass towards a rigid motion r is |vector^H M r|^2 over sum m |vector|^2; over all undamped modes it adds up to r^T M r,
with damping to a few per cent of that, since the shapes of neighbours then aren't quite orthogonal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.elements import GROUPS, Element
from nw_gear_sim.layout import RING_MOTIONS, Layout
from nw_gear_sim.linear import Complex, Shapes

KINDS = ("rotational", "translational", "axial", "ring in plane", "ring axial")
"""Kinds of modes: the gears turn, they (and the rigid ring) move in the plane, or along the axis; the ring deforms."""

WORDS = {
    "s": "sun",
    "h1": "herringbone 1",
    "h2": "herringbone 2",
    "p1": "planets (stage I)",
    "p2": "planets (stage II)",
}


@dataclass(frozen=True)
class Participation:
    """What takes part in one mode; shares add up to 1 within each mapping, small ones included.

    Attributes:
        kind: the one of KINDS with the most kinetic energy; name: in words; harmonic: of the ring, -1 where kind isn't
            one of the ring.
        kinds: share of kinetic energy of each kind.
        kinetic: by body: `ring`, then each gear and bearing of the layout.
        strain: by element, as `elements.find_elements` names them; strain_groups: by elements.GROUPS.
        ring_harmonics: share of kinetic energy of the ring's in-plane motion, by harmonic, from 0.
        planets_in_phase: share of the planets' kinetic energy in which all three move alike, each seen from its own
            axis; the rest runs around them.
        effective: effective mass over whole mass by rigid motion (`x`, `y`, `z`, `rotation`).
    """

    kind: str
    name: str
    harmonic: int
    kinds: dict[str, float]
    kinetic: dict[str, float]
    strain: dict[str, float]
    strain_groups: dict[str, float]
    ring_harmonics: tuple[float, ...]
    planets_in_phase: float
    effective: dict[str, float]


def participations(
    shapes: Shapes, mass: Array, layout: Layout, elements: Sequence[Element], rigid: dict[str, Array]
) -> list[Participation]:
    """Find what takes part in each mode.

    Args:
        shapes: normalised to modal mass 1 kg; mass: kg, (dof,); layout: of their entries.
        elements, rigid: as `elements.find_elements` and `elements.rigid_motions` return them.
    """
    energy = mass[:, None] * np.abs(shapes.vectors) ** 2
    bodies = _by_body(energy, layout)
    strain = {element.name: element.energy(shapes.vectors) for element in elements}
    total = np.maximum(np.sum(list(strain.values()), axis=0), np.finfo(float).tiny)
    groups = {group: sum((strain[e.name] for e in elements if e.group == group), 0 * total) for group in GROUPS}
    plane, axial, breathing = _ring_harmonics(shapes.vectors, mass, layout)
    kinds = _by_kind(energy, layout, plane, axial, breathing)
    together = _planets_in_phase(shapes.vectors, mass, layout)
    towards = {name: np.abs(shapes.vectors.conj().T @ (mass * r)) ** 2 / (mass @ r**2) for name, r in rigid.items()}
    out = []
    for k in range(energy.shape[1]):
        shares = {name: float(value[k]) for name, value in kinds.items()}
        kinetic = {name: float(value[k]) for name, value in bodies.items()}
        kind, name, harmonic = _name(shares, kinetic, plane[:, k], axial[:, k])
        out.append(
            Participation(
                kind=kind,
                name=name,
                harmonic=harmonic,
                kinds=shares,
                kinetic=kinetic,
                strain={name: float(value[k] / total[k]) for name, value in strain.items()},
                strain_groups={name: float(value[k] / total[k]) for name, value in groups.items()},
                ring_harmonics=tuple(map(float, plane[:, k])),
                planets_in_phase=float(together[k]),
                effective={name: float(value[k]) for name, value in towards.items()},
            )
        )
    return out


def _by_body(energy: Array, layout: Layout) -> dict[str, Array]:
    bodies = {"ring": energy[: 4 * layout.segments].sum(axis=0)}
    for node in layout.nodes.values():
        places = [place for place in (node.u, node.x, node.y, node.z) if place >= 0]
        bodies[node.name] = energy[places].sum(axis=0)
    return bodies


def _ring_harmonics(vectors: Complex, mass: Array, layout: Layout) -> tuple[Array, Array, Array]:
    """Kinetic energy of the ring by harmonic of its angle: in plane (w, v, p), axial, each (M/2 + 1, modes); breathing.

    Breathing is the radial motion alike all around, (modes,), a part of the first.
    """
    count = layout.segments
    found = []
    for motion in RING_MOTIONS:
        wave = np.fft.fft(vectors[layout.ring(motion)], axis=0) / np.sqrt(count)
        power = mass[layout.ring(motion)][0] * np.abs(wave) ** 2
        folded = power[: count // 2 + 1].copy()
        mirrored = power[: count // 2 : -1]
        folded[1 : 1 + len(mirrored)] += mirrored
        found.append(folded)
    return found[0] + found[1] + found[2], found[3], found[0][0]


def _by_kind(energy: Array, layout: Layout, plane: Array, axial: Array, breathing: Array) -> dict[str, Array]:
    nodes = layout.nodes.values()
    return {
        "rotational": energy[[n.u for n in nodes if n.u >= 0]].sum(axis=0) + plane[0] - breathing,
        "translational": energy[[k for n in nodes for k in (n.x, n.y)]].sum(axis=0) + plane[1],
        "axial": energy[[n.z for n in nodes if n.z >= 0]].sum(axis=0) + axial[0],
        "ring in plane": plane[2:].sum(axis=0) + breathing,
        "ring axial": axial[1:].sum(axis=0),
    }


def _planets_in_phase(vectors: Complex, mass: Array, layout: Layout) -> Array:
    together = np.zeros(vectors.shape[1])
    total = np.full(vectors.shape[1], np.finfo(float).tiny)
    angles = 2 * np.pi / 3 * np.arange(3)
    for part in ("p1", "p2"):
        nodes = [layout.planet(part, j) for j in range(3)]
        x, y, u, z = (vectors[[getattr(n, axis) for n in nodes]] for axis in "xyuz")
        cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
        for place, motion in (
            (nodes[0].x, cos * x + sin * y), (nodes[0].x, cos * y - sin * x), (nodes[0].u, u), (nodes[0].z, z),
        ):  # fmt: skip
            together += mass[place] * 3 * np.abs(motion.mean(axis=0)) ** 2
            total += mass[place] * np.sum(np.abs(motion) ** 2, axis=0)
    return np.asarray(together / total)


def _name(kinds: dict[str, float], kinetic: dict[str, float], plane: Array, axial: Array) -> tuple[str, str, int]:
    kind = max(kinds, key=lambda name: kinds[name])
    if kind == "ring in plane":
        order = int(np.argmax(np.concatenate([plane[:1], [0.0], plane[2:]])))
        return kind, f"ring n = {order}", order
    if kind == "ring axial":
        order = 1 + int(np.argmax(axial[1:]))
        return kind, f"ring n = {order}, axial", order
    groups: dict[str, float] = {}
    for body, share in kinetic.items():
        part = body.partition("_")[0]
        word = WORDS.get(part, "ring" if part == "ring" else "bearings")
        groups[word] = groups.get(word, 0.0) + share
    first, second = sorted(groups, key=lambda word: -groups[word])[:2]
    leading = first if groups[second] < 0.5 * groups[first] else f"{first} and {second}"
    return kind, f"{kind}: {leading}", -1


def strongest(shares: dict[str, float], count: int) -> list[tuple[str, float]]:
    """Return the largest shares with their names, largest first."""
    return sorted(shares.items(), key=lambda item: -item[1])[:count]


def complexity(shapes: Shapes, mass: Array) -> npt.NDArray[np.float64]:
    """Share of each mode's kinetic energy that is out of phase with the rest; 0 for a real mode, (modes,)."""
    return np.asarray(mass @ shapes.vectors.imag**2)
