"""The documentation builds without a warning."""

import subprocess
import sys

import pytest

from test.system.installing import ROOT


@pytest.mark.slow
def test_the_documentation_becomes_html(tmp_path):
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "-b", "html", str(ROOT / "docs"), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    for page in ("index", "model", "indicators", "contributing", "changelog"):
        assert (tmp_path / f"{page}.html").is_file()
