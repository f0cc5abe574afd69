"""Figures of the page, one kind a file: built empty, then told what is new."""
