"""Benchmark of the classifier of signals of unknown origin: systems, their true states, cases, measurement."""
