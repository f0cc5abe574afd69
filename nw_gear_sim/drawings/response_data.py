"""What the page of responses shows of each point, thinned out to what a screen resolves; the tables have everything."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_common.wavelets import wavelet_map
from nw_gear_sim.studies.response import Response

DETAILED = 11
"""Points that can be chosen one by one."""
LINES = 81
"""Points in the surfaces."""
COLUMNS = 401
"""Points in the maps."""
HISTORY_PERIODS, PHASE_PERIODS, SURFACE_PERIODS = 24, 40, 5
"""Mesh periods shown, the last ones of the record."""
HIGHEST_ORDER = 6.0
"""Top of the spectra, over the mesh frequency."""
BINS, SURFACE_BINS = 600, 240
MAP_LINES, MAP_COLUMNS = 64, 160
LOWEST_ORDER = 0.1
"""Bottom of the wavelet maps, over the mesh frequency."""
DECADES = 4.0
MOST_DOTS = 600

Small = npt.NDArray[np.float32]


class Collector:
    """Takes responses as they are read, and keeps what is shown, in units of b, 1 / omega_n and their combinations.

    Args:
        values: of the axis, ascending; meshes: those shown.

    Attributes:
        details: value -> mesh -> what is shown of it; phases: mesh -> (value, x, v) of the surface; spectra: mesh ->
            (value, amplitudes), with the frequencies up to `top[mesh]`, over omega_n; scales: of the last response.
    """

    def __init__(self, values: Array, meshes: Sequence[str]) -> None:
        self.values, self.meshes = values, tuple(meshes)
        self._detailed = set(_spread(values, DETAILED))
        self._lines = set(_spread(values, LINES))
        self._columns = set(_spread(values, COLUMNS))
        self.details: dict[float, dict[str, dict[str, Any]]] = {}
        self.phases: dict[str, list[tuple[float, Small, Small]]] = {mesh: [] for mesh in meshes}
        self._spectra: dict[str, list[tuple[float, Array, Array]]] = {mesh: [] for mesh in meshes}
        self.orders: dict[str, list[tuple[float, float]]] = {mesh: [] for mesh in meshes}

    def add(self, found: Iterable[Response]) -> None:
        """Take what is shown of responses; motions out of bounds are left out."""
        for response in found:
            if not response.whole:
                continue
            if response.value in self._detailed:
                self.details.setdefault(response.value, {})[response.mesh] = detail(response)
            if response.value in self._lines:
                x, v = _last(response, SURFACE_PERIODS)
                self.phases[response.mesh].append((response.value, x, v))
            if response.value in self._columns:
                frequency, amplitude = response.spectrum()
                scale = response.scales
                fm = _over(response)
                keep = frequency <= HIGHEST_ORDER * response.mesh_frequency
                part = (2.0 * np.pi / scale.frequency * frequency[keep], amplitude[keep] / scale.length)
                self._spectra[response.mesh].append((response.value, *part))
                self.orders[response.mesh].append((response.value, fm))

    @property
    def ranged(self) -> bool:
        """Whether there are enough points for surfaces."""
        return all(len(lines) > 2 for lines in self.phases.values())

    def spectra(self, mesh: str) -> tuple[Array, list[tuple[float, Array]]]:
        """Return edges of bins over omega_n, (bins + 1,), and values with the largest amplitudes in them, over b."""
        own = self._spectra[mesh]
        top = max(float(frequency[-1]) for _, frequency, _ in own)
        edges = np.linspace(0.0, top, SURFACE_BINS + 1)
        return edges, [(value, pooled(frequency, amplitude, edges)) for value, frequency, amplitude in own]

    def drawn(self, value: float) -> bool:
        """Whether a value has a line in the surfaces."""
        return value in self._lines


def detail(response: Response) -> dict[str, Any]:
    """Return what is shown of one mesh at one point."""
    scale = response.scales
    frequency, amplitude = response.spectrum()
    frequency = 2.0 * np.pi * frequency / scale.frequency
    edges = np.linspace(0.0, HIGHEST_ORDER * _over(response), BINS + 1)
    rate = response.rate
    count = min(len(response.time), round(HISTORY_PERIODS * rate / response.mesh_frequency) + 1)
    phase = _last(response, PHASE_PERIODS)
    dots = slice(None, None, 1 + len(response.section_x) // MOST_DOTS)
    return {
        "t": _small(response.time[-count:] * scale.frequency),
        "x": _small(response.x[-count:] / scale.length),
        "f": _small(0.5 * (edges[1:] + edges[:-1])),
        "a": _small(pooled(frequency, amplitude / scale.length, edges)),
        "px": phase[0],
        "pv": phase[1],
        "sx": _small(response.section_x[dots] / scale.length),
        "sv": _small(response.section_v[dots] / scale.velocity),
        "fm": _over(response),
        "fm_hz": response.mesh_frequency,
        "b": scale.length,
        "wn": scale.frequency,
        **_map(response),
    }


def pooled(frequency: Array, amplitude: Array, edges: Array) -> Array:
    """Return the largest amplitude between neighbouring edges; between lines of the spectrum, that of the nearest one.

    Args:
        frequency: ascending, (n,); amplitude: (n,); edges: ascending, (bins + 1,).
    """
    middles = 0.5 * (edges[1:] + edges[:-1])
    after = np.clip(np.searchsorted(frequency, middles), 1, len(frequency) - 1)
    nearer = np.where(middles - frequency[after - 1] < frequency[after] - middles, after - 1, after)
    out = np.where(middles <= frequency[-1] + (edges[1] - edges[0]), amplitude[nearer], np.nan)
    place = np.searchsorted(edges, frequency, side="right") - 1
    inside = (place >= 0) & (place < len(middles))
    largest = np.full(len(middles), -np.inf)
    np.maximum.at(largest, place[inside], amplitude[inside])
    return np.where(np.isfinite(largest), largest, out)


def levels(amplitude: Array, top: float) -> npt.NDArray[np.uint8]:
    """Return amplitudes as 256 colours, logarithmic, DECADES below 10^top."""
    share = (np.log10(np.maximum(np.nan_to_num(amplitude), 1e-30)) - (top - DECADES)) / DECADES
    return np.round(255.0 * np.clip(share, 0.0, 1.0)).astype(np.uint8)


def _map(response: Response) -> dict[str, Any]:
    high = min(HIGHEST_ORDER * response.mesh_frequency, 0.45 * response.rate)
    low = LOWEST_ORDER * response.mesh_frequency
    x = response.x - response.x.mean()
    found = wavelet_map(x, response.rate, low=low, high=high, lines=MAP_LINES, columns=MAP_COLUMNS)
    top = float(np.ceil(np.log10(max(float(found.amplitude.max()) / response.scales.length, 1e-12))))
    length = float(response.time[-1] - response.time[0])
    edge = np.minimum(found.edge, 0.5 * length)
    scale = response.scales
    return {
        "image": levels(found.amplitude / scale.length, top),
        "top": top,
        "low": 2.0 * np.pi * low / scale.frequency,
        "high": 2.0 * np.pi * high / scale.frequency,
        "length": length * scale.frequency,
        "edge": _small(edge * scale.frequency),
        "line": _small(2.0 * np.pi * found.frequency / scale.frequency),
    }


def _last(response: Response, periods: int) -> tuple[Small, Small]:
    count = min(len(response.x), round(periods * response.rate / response.mesh_frequency) + 1)
    scale = response.scales
    return _small(response.x[-count:] / scale.length), _small(response.v[-count:] / scale.velocity)


def _over(response: Response) -> float:
    return 2.0 * np.pi * response.mesh_frequency / response.scales.frequency


def _spread(values: Array, most: int) -> list[float]:
    chosen = np.unique(np.linspace(0, len(values) - 1, min(most, len(values))).round().astype(int))
    return [float(v) for v in values[chosen]]


def _small(values: Array) -> Small:
    return np.asarray(values, dtype=np.float32)
