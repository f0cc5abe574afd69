"""Which indicators raise alarms, why, and on which scale they are compared. A new one: a line here.

Compared is y = ln(x + offset): sizes of vibration are skewed to the right and spread in proportion to themselves, so
that their logarithm is nearer to a normal distribution than they are. The offset takes the weight from values that are
next to nothing: shares of 0.001 and 0.002 are the same to a person. Kurtosis and crest factor are never below 1, so
that 1 is taken off.

Left out on purpose: means (they are the load), peak-to-peak (rms and crest factor together), the third and higher mesh
harmonics (within one bin of speed they pass resonances: the third of stage II spreads by a factor of three and was most
of the false alarms of a month), NA4 (it compares with the beginning itself), what describes a state (K, tonal share).
"""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache

from nw_gear_common.tables import Table
from nw_gear_monitor.indicators import bearing_registry, registry

SHORT, LONG = "short", "long"
"""Windows: the one of time-domain indicators, and the one of labels, which nothing exceeds."""
BEARING = "bearing "
"""What names of bearings' features begin with."""


@dataclass(frozen=True)
class Rule:
    """Columns that raise alarms.

    Attributes:
        pattern: of columns, as in a shell.
        offset: added before the logarithm, in the unit of the column.
        window: SHORT or LONG.
        reason: what its growth means.
    """

    pattern: str
    offset: float
    window: str
    reason: str


MESH_RULES = (
    Rule("rms", 0.0, SHORT, "all vibration of the mesh: anything that grows"),
    Rule("crest_factor", -1.0, SHORT, "single impacts"),
    Rule("kurtosis", -1.0, SHORT, "repeated impacts"),
    Rule("harmonic_[12]", 0.0, SHORT, "mesh lines: stiffness, wear of the profile, load sharing"),
    Rule("subharmonic_2", 0.0, SHORT, "period doubling: play, contact lost every other tooth"),
    Rule("off_line_ratio", 0.05, SHORT, "energy outside the mesh lines: modulation, impacts, rattling"),
    Rule("residual_ratio", 0.05, LONG, "energy outside all lines of a regular gearbox: rattling, bearing faults"),
    Rule("open_share", 0.05, SHORT, "teeth apart"),
    Rule("back_flank_share", 0.05, SHORT, "teeth striking the back flanks"),
    Rule("sideband_ratio_*", 0.05, LONG, "modulation once a turn: eccentricity, pitch error, a weak tooth"),
    Rule("fm0_*", 0.0, LONG, "peaks in the mean turn of a gear: damage of one tooth, heavy wear"),
    Rule("fm4_*", -1.0, LONG, "one tooth differs from the others"),
)
BEARING_RULES = (
    Rule("rms", 0.0, SHORT, "all vibration of the bearing's force"),
    Rule("kurtosis", -1.0, SHORT, "repeated impacts"),
    Rule("shaft_rate", 0.0, SHORT, "imbalance, eccentricity, a bent shaft"),
    Rule("roller_pass", 0.0, SHORT, "clearance: fewer rollers carry the load"),
    Rule("bp[fi]*", 0.0, LONG, "race defects: lines in the envelope, and how far they stand out"),
    Rule("ftf*", 0.0, LONG, "cage: lines in the envelope, and how far they stand out"),
    Rule("spectral_kurtosis", 1.1, SHORT, "bursts"),
)
UNITS = {column.name: column.unit for column in registry.COLUMNS}
BEARING_UNITS = {column.name: column.unit for column in bearing_registry.COLUMNS}


@cache
def rule_of(name: str) -> Rule | None:
    """The rule of a feature such as `II_1/rms` or `bearing sb/bpfo`; None where it raises no alarm."""
    element, _, column = name.rpartition("/")
    rules = BEARING_RULES if element.startswith(BEARING) else MESH_RULES
    return next((rule for rule in rules if fnmatch.fnmatchcase(column, rule.pattern)), None)


def unit_of(name: str) -> str:
    """Unit of a feature, "" where it has none."""
    element, _, column = name.rpartition("/")
    return (BEARING_UNITS if element.startswith(BEARING) else UNITS).get(column, "")


def features(meshes: Mapping[str, Table], bearings: Mapping[str, Table]) -> dict[str, float]:
    """The features of one hop from its tables of one row; those without a value are left out."""
    found = dict(_features("", meshes.items()))
    found.update(_features(BEARING, bearings.items()))
    return found


def _features(prefix: str, tables: Iterable[tuple[str, Table]]) -> Iterable[tuple[str, float]]:
    for element, table in tables:
        for column, value in zip(table.columns, table.data[0], strict=True):
            name = f"{prefix}{element}/{column}"
            if rule_of(name) is not None and math.isfinite(value):
                yield name, float(value)
