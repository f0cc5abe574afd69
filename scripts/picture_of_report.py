#!/usr/bin/env python3
"""Make a picture of a report for the documentation, with headless Chromium (Debian's package `chromium`).

Usage: picture_of_report.py REPORT.html PICTURE.png [--sections summary,states,phase] [--width 1400]
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageChops

TALLEST = 12000
COLOURS = 128
MARGIN = 16


def main() -> int:
    """Read the arguments, take the picture, return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("report", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--sections", default="summary,states,phase", help="anchors of what is shown")
    parser.add_argument("--width", type=int, default=1400, help="width of the window in pixels")
    arguments = parser.parse_args()
    browser = shutil.which("chromium")
    if browser is None or not arguments.report.is_file():
        missing = arguments.report if browser else "the program chromium (apt-get install chromium)"
        print(f"picture_of_report.py: there is no {missing}", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.html"
        text = arguments.report.read_text(encoding="utf-8")
        page.write_text(only(text, arguments.sections.split(",")), encoding="utf-8")
        shot = Path(folder) / "shot.png"
        photograph(browser, page, shot, arguments.width, Path(folder) / "profile")
        arguments.picture.parent.mkdir(parents=True, exist_ok=True)
        cropped(shot).save(arguments.picture, optimize=True)
    return 0


def only(page: str, sections: list[str]) -> str:
    """The page with nothing shown but its head and some sections."""
    others = "".join(f":not(#{anchor})" for anchor in sections)
    style = f"<style>section{others}, nav, footer {{ display: none; }} ::-webkit-scrollbar {{ display: none; }}</style>"
    return page.replace("</head>", style + "</head>", 1)


def photograph(browser: str, page: Path, picture: Path, width: int, profile: Path) -> None:
    """Let the browser draw a page into a picture of the greatest height."""
    subprocess.run(
        [
            browser,
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--hide-scrollbars",
            "--virtual-time-budget=30000",
            f"--user-data-dir={profile}",
            f"--window-size={width},{TALLEST}",
            f"--screenshot={picture}",
            page.absolute().as_uri(),
        ],
        check=True,
        stderr=subprocess.DEVNULL,
        timeout=180,
    )


def cropped(picture: Path) -> Image.Image:
    """The picture without the empty rest below, in few colours: a small file."""
    image = Image.open(picture).convert("RGB")
    box = ImageChops.difference(image, Image.new("RGB", image.size, "white")).getbbox()
    bottom = min(image.height, box[3] + MARGIN) if box else image.height
    return image.crop((0, 0, image.width, bottom)).quantize(COLOURS)


if __name__ == "__main__":
    sys.exit(main())
