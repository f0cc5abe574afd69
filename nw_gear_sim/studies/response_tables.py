"""Responses as tidy tables: time histories, spectra and Poincare points, one row for every sample."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.studies.response import Response

Table = dict[str, Any]


def histories(found: Sequence[Response], key: str) -> Table:
    """Return the displacements over time: axis, mesh, time_s, x_m, v_m_per_s."""
    return _table(found, key, ("time_s", "x_m", "v_m_per_s"), lambda r: (r.time, r.x, r.v))


def spectra(found: Sequence[Response], key: str) -> Table:
    """Return the spectra: axis, mesh, frequency_hz, amplitude_m."""
    return _table(found, key, ("frequency_hz", "amplitude_m"), Response.spectrum)


def sections(found: Sequence[Response], key: str) -> Table:
    """Return the Poincare points: axis, mesh, time_s, x_m, v_m_per_s."""
    return _table(found, key, ("time_s", "x_m", "v_m_per_s"), lambda r: (r.section_time, r.section_x, r.section_v))


def _table(
    found: Sequence[Response], key: str, columns: Sequence[str], read: Callable[[Response], tuple[Array, ...]]
) -> Table:
    parts = [read(response) for response in found]
    lengths = [len(part[0]) for part in parts]
    table: Table = {
        key: np.repeat([response.value for response in found], lengths),
        "mesh": np.repeat([response.mesh for response in found], lengths),
    }
    return table | {name: np.concatenate([part[k] for part in parts]) for k, name in enumerate(columns)}
