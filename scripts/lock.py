"""Write requirements/lock.txt: every distribution that the direct requirements bring, by name and version alone."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent / "requirements"
DIRECT = ("runtime.txt", "development.txt")
HEADER = "# Made by `make lock` from runtime.txt and development.txt. Don't edit.\n"


def resolve() -> list[tuple[str, str]]:
    """Let pip resolve the direct requirements without installing anything; sorted (name, version)."""
    wanted = [part for name in DIRECT for part in ("-r", str(FOLDER / name))]
    with tempfile.NamedTemporaryFile(suffix=".json") as report:
        options = ["--quiet", "--dry-run", "--ignore-installed", "--report", report.name]
        subprocess.run([sys.executable, "-m", "pip", "install", *options, *wanted], check=True)
        resolved = json.loads(Path(report.name).read_text(encoding="utf-8"))
    found = {(i["metadata"]["name"].lower().replace("_", "-"), i["metadata"]["version"]) for i in resolved["install"]}
    return sorted(found)


def main() -> None:
    """Write the lock file."""
    lines = [f"{name}=={version}\n" for name, version in resolve()]
    (FOLDER / "lock.txt").write_text(HEADER + "".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
