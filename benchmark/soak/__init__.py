"""The whole suite left alone for hours, each node restarted once in the middle (see run.py)."""
