"""Figures of the report, one kind a file: from `RunData` to a Bokeh figure, or None where data are missing."""
