"""Measures the simulator: speed with the accuracy beside it, against the classical method and against scipy."""
