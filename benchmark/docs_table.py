"""Puts tables that scripts measured into pages of the documentation."""

from __future__ import annotations

from pathlib import Path

from nw_gear_common.errors import InputError


def write_between(path: Path, name: str, text: str) -> None:
    """Replace what stands between `<!-- begin name -->` and `<!-- end name -->` in a page.

    Raises:
        InputError: the page has no such pair of marks.
    """
    page = path.read_text(encoding="utf-8")
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    before, found, rest = page.partition(begin)
    _old, closed, after = rest.partition(end)
    if not (found and closed):
        raise InputError(str(path), f"{begin} and {end}", "no such marks")
    path.write_text(f"{before}{begin}\n\n{text.strip()}\n\n{end}{after}", encoding="utf-8")
