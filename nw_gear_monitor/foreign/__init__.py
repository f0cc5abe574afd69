"""Measurements of somebody else's machine made into a recording that replay and monitor understand."""
