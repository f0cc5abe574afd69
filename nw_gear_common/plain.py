"""Text that somebody else made, before it is shown: one line, nothing that a terminal takes for a command."""

from __future__ import annotations


def one_line(text: str) -> str:
    """The text with everything escaped that isn't printed as a character."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
