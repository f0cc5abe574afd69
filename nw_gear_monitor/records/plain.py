"""Text out of a file that somebody else made, before it is shown: one line, no control characters, not too long."""

from __future__ import annotations

LONGEST = 200


def one_line(text: str, longest: int = LONGEST) -> str:
    """The text with everything escaped that a terminal or a log would not print as a character, and cut."""
    shown = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text[: longest + 1])
    return shown if len(text) <= longest else f"{shown[:longest]}..."
