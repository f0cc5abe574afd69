"""The soak in minutes: nothing is lost, and each node can be restarted under the others."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from test.system.processes import environment

SCRIPT = Path(__file__).resolve().parents[2] / "benchmark" / "soak" / "run.py"
HOURS = 0.03
LIMIT = 900.0


@pytest.mark.slow
def test_two_minutes_with_a_restart_of_each_node(tmp_path):
    command = [sys.executable, str(SCRIPT), "--hours", str(HOURS), "--folder", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, env=environment(), check=False)
    found = json.loads(done.stdout)
    assert found["problems"] == [], done.stderr
    assert done.returncode == 0
    assert found["missing_samples"] == 0
    assert {r["node"] for r in found["restarts"]} == {m["node"] for m in found["memory"]}
    assert found["samples"] > 0.5 * HOURS * 3600 * 5120
    assert [r["breaks"] for r in found["recordings"]] == [0, 1]  # the second one saw the simulator come back
