"""The fixed vocabulary of the public contract: meshes, bearings, topics, columns, state labels.

Other tools, layouts and recordings depend on these strings, so they are written down here and nowhere else.
"""

from __future__ import annotations

from collections.abc import Sequence

NAMESPACE = "/nw_gear"

STAGES = ("I", "II", "III")
MESHES = ("I_1", "I_2", "I_3", "II_1", "II_2", "II_3", "III")
BEARINGS = ("pb1_1", "pb1_2", "pb1_3", "pb2_1", "pb2_2", "pb2_3", "sb", "b1", "b21", "b22")
SHAFTS = ("ring", "planet", "sun", "output")
WAVEFORM_BEARINGS = ("pb1_1", "pb2_1", "sb", "b1", "b21", "b22")
"""Bearings whose forces are in `waveform` by default."""

STAGE_OF_MESH = {mesh: mesh.split("_")[0] for mesh in MESHES}
MESHES_OF_STAGE = {stage: tuple(m for m in MESHES if STAGE_OF_MESH[m] == stage) for stage in STAGES}

# Topics, relative to the namespace.
WIND_SPEED = "wind_speed"
DRIVE = "drive"
SHAFTS_TOPIC = "shafts"
MESH_TOPIC = "mesh"
WAVEFORM = "waveform"
ACCELERATION = "acceleration"
TACHO = "tacho"
TRUTH = "truth"
SPECTRUM = "spectrum"
ORDERS = "orders"
DIAGNOSTICS = "/diagnostics"
CLOCK = "/clock"

WAVEFORM_BLOCKS_PER_SECOND = 20

# Row meanings of the tables.
ROW_SAMPLE = "sample"
ROW_BIN = "bin"
ROW_ORDER = "order"
ROW_POINT = "point"
ROW_ROW = "row"
ROW_PULSE = "pulse"

SECTION_COLUMNS = ("time", "planet", "x", "v")
TACHO_COLUMNS = ("time",)

PERIODS = tuple(f"period-{n}" for n in range(1, 17))
QUASI_PERIODIC = "quasi-periodic"
CHAOTIC = "chaotic"
TRANSIENT = "transient"
STALE = "stale"
UNKNOWN = "unknown"
STATES = (*PERIODS, QUASI_PERIODIC, CHAOTIC, TRANSIENT, STALE, UNKNOWN)

WIND_SOURCES = ("weibull", "constant", "step", "gust", "file")
PRESETS = ("rated", "rattling", "period2", "period4")


def bearing_topic(bearing: str) -> str:
    """Topic of one bearing's force."""
    return f"bearings/{bearing}"


def section_topic(stage: str) -> str:
    """Topic of one stage's Poincaré section."""
    return f"section/{stage}"


def indicators_topic(place: str) -> str:
    """Topic of the indicators of one mesh or bearing."""
    return f"indicators/{place}"


def waveform_columns(bearings: Sequence[str] = WAVEFORM_BEARINGS) -> tuple[str, ...]:
    """Columns of `waveform`: time (s), phases of planet 1 (rad), x (m) and v (m/s) of meshes, bearing forces (N)."""
    return (
        "time",
        *(f"phase_{stage}" for stage in STAGES),
        *(f"x_{mesh}" for mesh in MESHES),
        *(f"v_{mesh}" for mesh in MESHES),
        *(f"{axis}_{bearing}" for bearing in bearings for axis in ("fx", "fy")),
    )


def acceleration_columns(bearings: Sequence[str] = WAVEFORM_BEARINGS) -> tuple[str, ...]:
    """Columns of `acceleration`: time (s), accelerations of the housings in x and y at bearings (m/s^2)."""
    return ("time", *(f"{axis}_{bearing}" for bearing in bearings for axis in ("ax", "ay")))
