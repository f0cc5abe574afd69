"""Faults that are put into the gearbox while it runs, with their truth."""
