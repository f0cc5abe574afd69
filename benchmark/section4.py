"""Makes docs/results.md and benchmark/results/section4.json: `python -m benchmark.section4 FOLDER`.

FOLDER holds the study's store and is gone on from; an empty one costs some five minutes of a core.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

RESULTS = Path(__file__).parent / "results" / "section4.json"
PAGE = Path(__file__).parents[1] / "docs" / "results.md"


def main(folder: str) -> None:
    """Run the command, keep what it says of Sec. 4."""
    command = Path(sys.executable).parent / "nw_gear"
    arguments = ["study", "claims", "--section", "all", "-o", folder, "--markdown", str(PAGE), "--json"]
    done = subprocess.run([command, *arguments], check=True, stdout=subprocess.PIPE)
    RESULTS.write_text(json.dumps(json.loads(done.stdout)["section_4"], indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
