"""Runs the reader on Node.js; skips where its modules aren't installed, except in CI."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parent
LIMIT = 60.0


def node_reader(file):
    """Everything in an MCAP file, as @mcap/core and @foxglove/rosmsg2-serialization read it."""
    missing = [
        what
        for what, there in (("node", shutil.which("node")), ("its modules", (FOLDER / "node_modules").is_dir()))
        if not there
    ]
    if missing and os.environ.get("CI") != "true":
        pytest.skip(f"{' and '.join(missing)} not installed: `npm ci` in test/node")
    command = ["node", str(FOLDER / "read.mjs"), str(file)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
