"""The gearbox's equations a second time: slow, plain NumPy, and without any of the fast code; checks rest on it."""
