#!/usr/bin/env python3
"""Make the picture of the live page for the documentation: the real nodes, real Chromium, a fault injected on the page.

Usage: picture_of_dashboard.py PICTURE.png [--height 2275] [--seconds 12] [--whole EVERYTHING.png]
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from test.system.chromium import Chromium, find_chromium
from test.system.live_suite import live_suite

COLOURS = 256
WIDTH = 1400
PATIENCE = 180.0
STATES = "model('states').renderers[0].data_source.data"


def main() -> int:
    """Read the arguments, take the picture, return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--height", type=int, default=2275, help="what of the page is shown, pixels")
    parser.add_argument("--seconds", type=float, default=12.0, help="time to watch the fault before the picture")
    parser.add_argument("--whole", type=Path, help="picture of the whole page as well")
    arguments = parser.parse_args()
    if find_chromium() is None:
        print("picture_of_dashboard.py: there is no program chromium (apt-get install chromium)", file=sys.stderr)
        return 2
    with live_suite(wind=["seed:=3"], dashboard=["update_rate:=5.0"]) as suite, Chromium((WIDTH, 1000)) as browser:
        browser.open(suite.url)
        browser.wait_for("words().includes('period-1')", PATIENCE, suite.report)
        browser.enter("Gear", "pinion")
        browser.enter("Loss of stiffness (1)", 0.9)
        browser.press("Inject fault")
        browser.wait_for("words().includes('fault cracked tooth')", PATIENCE, suite.report)
        browser.wait_for(f"{STATES}.state.some(s => !['period-1', 'unknown'].includes(s))", PATIENCE, suite.report)
        time.sleep(arguments.seconds)
        take(browser, arguments.picture, arguments.height)
        if arguments.whole:
            take(browser, arguments.whole, int(browser.read("document.documentElement.scrollHeight")))
    return 0


def take(browser: Chromium, picture: Path, height: int) -> None:
    """Photograph the page in few colours: a small file."""
    with tempfile.TemporaryDirectory() as folder:
        shot = Path(folder) / "shot.png"
        browser.photograph(shot, height)
        picture.parent.mkdir(parents=True, exist_ok=True)
        Image.open(shot).convert("RGB").quantize(COLOURS).save(picture, optimize=True)


if __name__ == "__main__":
    sys.exit(main())
