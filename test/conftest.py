"""What every test runs under: a ROS domain of its own on the loopback interface, and no home needed for logs."""

import os
import tempfile
from pathlib import Path

import hypothesis

DOMAINS = range(1, 90)
"""Domains whose ports lie below those that Linux hands out by itself; the highest are left to tests with a second."""

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the executables do
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ.setdefault("ROS_DOMAIN_ID", str(DOMAINS[os.getpid() % len(DOMAINS)]))
os.environ.setdefault("ROS_LOG_DIR", str(Path(tempfile.gettempdir()) / "nw_gear_test_logs"))

# Examples are the same in every run, and a slow machine is no reason to fail.
hypothesis.settings.register_profile("nw_gear", derandomize=True, deadline=None, database=None)
hypothesis.settings.load_profile("nw_gear")
