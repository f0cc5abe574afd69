"""Figures of the report, one kind a file: each takes `RunData` and returns Bokeh models, or nothing where data are missing."""
