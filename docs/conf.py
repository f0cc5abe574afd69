"""How Sphinx turns docs/ into HTML."""

import nw_gear_common

project = "nw_gear"
author = "nw_gear maintainers"
copyright = author
version = release = nw_gear_common.__version__

extensions = ["myst_parser"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
exclude_patterns = ["pictures"]
suppress_warnings = ["myst.xref_missing"]  # links of the README into the source tree

html_theme = "furo"
html_title = f"nw_gear {release}"
