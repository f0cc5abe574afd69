"""Mode shapes as a page: one picks a mode and sees the ring, the gears and the energies, moving or still."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.layouts import column, row
from bokeh.models import (
    Button,
    ColumnDataSource,
    CustomJS,
    Div,
    FactorRange,
    Model,
    Select,
    Slider,
    Span,
    Toggle,
)
from bokeh.plotting import figure

from nw_gear_common.tables import Array
from nw_gear_sim.assembly import GEARS, SENSE
from nw_gear_sim.drawings.page import BLACK, BLUE, GREEN, GREY, ORANGE, PINK, SKY, VERMILION, render
from nw_gear_sim.drawings.shapes_script import SCRIPT
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import PLANET_ANGLES, SHAFT_OF_BEARING, bearing_kind
from nw_gear_sim.linear import Shapes
from nw_gear_sim.participation import WORDS, Participation, strongest

SHAFTS = {"p1": "planet", "p2": "planet", "s": "sun", "h1": "sun", "h2": "output"} | SHAFT_OF_BEARING
COLOURS = {"p1": BLUE, "p2": SKY, "s": VERMILION, "h1": ORANGE, "h2": GREEN}
SHOWN = 10
"""Bars of the energies."""
DIGITS = 5
"""Digits of the amplitudes on the page."""


def shapes_page(
    gearbox: Gearbox, shapes: Shapes, modes: Sequence[Participation], conditions: str, angle: float = 0.0
) -> str:
    """Draw the shapes of modes.

    Args:
        gearbox, shapes, modes: what belongs together.
        conditions: says at which load and angle they hold.
        angle: of the ring, rad.
    """
    intro = (
        conditions,
        "Front view: the gears' pitch circles and the ring's outer edge, at rest in grey, moved in colour; "
        "spokes show rotations. The largest motion of the mode is drawn as long as the slider says, in m; where "
        "it is an axial one, little moves here, and the diagrams on the right show more.",
    )
    return render("Mode shapes", intro, [("", "", _layout(gearbox, shapes, modes, angle))])


def _layout(gearbox: Gearbox, shapes: Shapes, modes: Sequence[Participation], angle: float) -> Model:
    data = _data(gearbox, shapes, modes, angle)
    sources = {
        "rest": ColumnDataSource({"xs": [], "ys": []}),
        "moved": ColumnDataSource({"xs": [], "ys": [], "colour": [], "width": []}),
        "ring": ColumnDataSource(
            {"angle": np.degrees(data["ring_angle"]), **{k: 0 * data["ring_angle"] for k in "wvz"}}
        ),
        "bodies": ColumnDataSource({"body": data["bodies"], "axial": [0.0] * len(data["bodies"])}),
        "kinetic": ColumnDataSource({"name": [""], "share": [0.0]}),
        "strain": ColumnDataSource({"name": [""], "share": [0.0]}),
    }
    front = _front(sources)
    kinetic, strain = (_bars(sources[k], f"Share of {k} energy") for k in ("kinetic", "strain"))
    facts = Div(text="", width=560, height=95)
    select = Select(
        title="Mode",
        value="0",
        width=420,
        options=[(str(k), f"{k + 1}: {f:.2f} Hz, {mode.name}") for k, (f, mode) in enumerate(_pairs(shapes, modes))],
    )
    size = Slider(title="Largest motion (m)", start=0.02, end=0.3, step=0.01, value=0.12, width=200)
    moving = Toggle(label="Move", width=80)
    before, after = Button(label="Previous", width=80), Button(label="Next", width=80)
    arguments = {"data": data, "select": select, "size": size, "moving": moving, "facts": facts, **sources}
    arguments |= {"kinetic_range": kinetic.y_range, "strain_range": strain.y_range}
    draw = CustomJS(args=arguments, code=SCRIPT)
    for widget, event in ((select, "value"), (size, "value"), (moving, "active")):
        widget.js_on_change(event, draw)
    for button, step in ((before, -1), (after, 1)):
        code = "select.value = String((Number(select.value) + step + select.options.length) % select.options.length)"
        button.js_on_click(CustomJS(args={"select": select, "step": step}, code=code))
    front.js_on_change("inner_width", draw)  # the first drawing
    controls = row(select, column(Div(text="", height=14), row(before, after, moving)), size)
    right = column(facts, kinetic, strain, _ring_motion(sources), _axial_motion(sources, data["bodies"]))
    return column(controls, row(front, right))


def _pairs(shapes: Shapes, modes: Sequence[Participation]) -> list[tuple[float, Participation]]:
    return list(zip(shapes.frequencies_hz.tolist(), modes, strict=True))


def _front(sources: dict[str, ColumnDataSource]) -> figure:
    reach = 1.75
    plot = figure(
        width=760,
        height=760,
        match_aspect=True,
        x_range=(-reach, reach),
        y_range=(-reach, reach),
        x_axis_label="x (m)",
        y_axis_label="y (m)",
        tools="pan,box_zoom,reset,save",
        title="Front view",
    )
    plot.toolbar.logo = None
    plot.multi_line("xs", "ys", source=sources["rest"], color="#D0D3D8", line_width=1)
    plot.multi_line("xs", "ys", source=sources["moved"], color="colour", line_width="width")
    for kind, colour in COLOURS.items():
        plot.line([9, 9], [9, 9], color=colour, line_width=2, legend_label=WORDS[kind])
    plot.legend.location = "top_right"
    plot.legend.label_text_font_size = "11px"
    plot.legend.spacing = 0
    plot.legend.background_fill_alpha = 0.8
    return plot


def _bars(source: ColumnDataSource, title: str) -> figure:
    names = FactorRange(factors=[""])
    plot = figure(width=560, height=215, y_range=names, x_range=(0, 1), title=title, tools="", toolbar_location=None)
    plot.hbar(y="name", right="share", height=0.7, source=source, color=BLUE if "kinetic" in title else PINK)
    plot.ygrid.visible = False
    return plot


def _ring_motion(sources: dict[str, ColumnDataSource]) -> figure:
    plot = figure(
        width=560,
        height=215,
        x_range=(0, 360),
        y_range=(-1.05, 1.05),
        title="Motion of the ring (largest motion of the mode = 1)",
        x_axis_label="Angle on the ring (deg)",
        tools="",
        toolbar_location=None,
    )
    for k, (name, colour) in {"w": ("radial", BLUE), "v": ("tangential", VERMILION), "z": ("axial", GREEN)}.items():
        plot.line("angle", k, source=sources["ring"], color=colour, line_width=2, legend_label=name)
    plot.legend.orientation = "horizontal"
    plot.legend.label_text_font_size = "11px"
    plot.legend.padding = 2
    plot.legend.background_fill_alpha = 0.7
    return plot


def _axial_motion(sources: dict[str, ColumnDataSource], bodies: list[str]) -> figure:
    plot = figure(
        width=560,
        height=215,
        x_range=FactorRange(factors=bodies),
        y_range=(-1.05, 1.05),
        title="Axial motion (largest motion of the mode = 1)",
        tools="",
        toolbar_location=None,
    )
    plot.vbar(x="body", top="axial", width=0.6, source=sources["bodies"], color=GREEN)
    plot.add_layout(Span(location=0, dimension="width", line_color=GREY))
    plot.xaxis.major_label_orientation = math.pi / 4
    plot.xgrid.visible = False
    return plot


def _data(gearbox: Gearbox, shapes: Shapes, modes: Sequence[Participation], angle: float) -> dict[str, Any]:
    """Everything that the page's script needs: places at rest, and real and imaginary parts of the motions."""
    layout, kinematics = gearbox.layout, gearbox.kinematics
    axial = [n for n in layout.nodes.values() if n.z >= 0]
    largest = np.max(np.abs(shapes.vectors), axis=0)
    vectors = shapes.vectors / largest
    ring = kinematics.ring
    teeth = kinematics.stages[0].pair.driver
    return {
        "ring_angle": angle + ring.pitch * np.arange(ring.count),
        "ring_radii": [teeth.pitch_radius, 2 * ring.radius - teeth.reference_radius],
        "ring": {k: _parts(vectors[layout.ring(k)]) for k in ("w", "v", "z")},
        "gears": _gears(gearbox, vectors),
        "bodies": ["ring", *(node.name for node in axial)],
        "axial": _parts(np.vstack([vectors[layout.ring("z")].mean(axis=0), vectors[[n.z for n in axial]]])),
        "facts": [_facts(k, shapes, mode) for k, mode in enumerate(modes)],
        "kinetic": [_top(mode.kinetic) for mode in modes],
        "strain": [_top(mode.strain) for mode in modes],
        "black": BLACK,
    }


def _gears(gearbox: Gearbox, vectors: Array) -> list[dict[str, Any]]:
    kinematics, layout = gearbox.kinematics, gearbox.layout
    first, second, third = (stage.pair for stage in kinematics.stages)
    radii = {
        "p1": first.driven.pitch_radius,
        "p2": second.driver.pitch_radius,
        "s": second.driven.pitch_radius,
        "h1": third.driver.pitch_radius,
        "h2": third.driven.pitch_radius,
    }
    gears = []
    for name, node in layout.nodes.items():
        kind = bearing_kind(name)
        if kind not in GEARS:
            continue
        distance, towards = 0.0, 0.0
        if kind in ("p1", "p2"):
            distance, towards = first.centre_distance, PLANET_ANGLES[int(name[-1]) - 1]
        elif kind == "h2":
            distance = third.centre_distance
        base = getattr(kinematics.bodies, GEARS[kind]).base_radius
        turn = SENSE[SHAFTS[kind]] * vectors[[node.u]] / base
        gears.append(
            {
                "x": distance * math.cos(towards),
                "y": distance * math.sin(towards),
                "radius": radii[kind],
                "colour": COLOURS[kind],
                "motion": _parts(np.vstack([vectors[[node.x, node.y]], turn])),
            }
        )
    return gears


def _parts(vectors: Any) -> list[list[list[float]]]:
    """Real and imaginary parts by mode: [mode][0 or 1][entry]."""
    return [[np.round(c.real, DIGITS).tolist(), np.round(c.imag, DIGITS).tolist()] for c in vectors.T]


def _top(shares: dict[str, float]) -> dict[str, Any]:
    top = [(name, share) for name, share in strongest(shares, SHOWN) if share >= 0.005]
    return {"name": [name for name, _ in top], "share": [round(share, 4) for _, share in top]}


def _facts(k: int, shapes: Shapes, mode: Participation) -> str:
    shares = ", ".join(f"{name} {share:.0%}" for name, share in strongest(mode.kinds, 3) if share >= 0.01)
    effective = ", ".join(f"{name} {share:.1%}" for name, share in mode.effective.items())
    return (
        f"<b>Mode {k + 1}: {mode.name}</b><br>{shapes.frequencies_hz[k]:.3f} Hz, "
        f"damping ratio {100 * shapes.damping_ratio[k]:.2f} %<br>Kinds of motion: {shares}<br>"
        f"Planets alike: {mode.planets_in_phase:.0%} of their kinetic energy<br>Effective mass towards {effective}"
    )
