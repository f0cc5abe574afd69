"""One self-contained HTML page around Bokeh figures: it loads nothing from elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

import jinja2
from bokeh.embed import components
from bokeh.models import Model
from bokeh.resources import Resources
from markupsafe import Markup

import nw_gear_common

# Okabe and Ito, "Color Universal Design" (2008).
BLUE, VERMILION, GREEN, PINK, ORANGE, SKY, BLACK = (
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#222222",
)  # fmt: skip
GREY = "#8A8F98"
STAGE_COLOURS = {"I": BLUE, "II": VERMILION, "III": GREEN}

_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{{ title }}</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; color: #222; margin: 0 auto; max-width: 1360px; padding: 1rem; }
h1 { font-size: 1.5rem; margin: 0.2rem 0; }
h2 { font-size: 1.1rem; margin: 1.6rem 0 0.4rem; }
p { margin: 0.2rem 0 0.6rem; max-width: 62rem; }
footer { color: #666; margin-top: 2rem; font-size: 0.85rem; }
</style>
{{ resources }}
</head>
<body>
<h1>{{ title }}</h1>
{% for line in intro %}
<p>{{ line }}</p>
{% endfor %}
{% for heading, text, div in parts %}
{% if heading %}<h2>{{ heading }}</h2>{% endif %}
{% if text %}<p>{{ text }}</p>{% endif %}
{{ div }}
{% endfor %}
<footer>Made by nw_gear {{ version }}.</footer>
{{ script }}
</body>
</html>
"""


def render(title: str, intro: Sequence[str], parts: Sequence[tuple[str, str, Model]], *, widgets: bool = True) -> str:
    """Put figures on a page.

    Args:
        title: of the page; intro: paragraphs under it.
        parts: (heading, text, figure or layout) from top to bottom; empty heading and text are left out.
        widgets: whether the parts use tables, buttons or sliders.
    """
    script, divs = components([model for _, _, model in parts], wrap_script=True)
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, undefined=jinja2.StrictUndefined)
    known = ["bokeh", "bokeh-widgets", "bokeh-tables"] if widgets else ["bokeh"]
    return environment.from_string(_PAGE).render(
        title=title,
        intro=list(intro),
        parts=[(heading, text, Markup(div)) for (heading, text, _), div in zip(parts, divs, strict=True)],
        resources=Markup(Resources(mode="inline", components=known).render()),
        script=Markup(script),
        version=nw_gear_common.__version__,
    )
