"""The errors a user can meet. Each one states a place, what was expected there and what was got."""

from __future__ import annotations

from nw_gear_common.plain import one_line


class NwGearError(Exception):
    """Root of every error raised on purpose by this project.

    Attributes:
        exit_code: of a process that ends because of it.
    """

    exit_code = 1


class InputError(NwGearError):
    """Something a user gave (file, key, argument, parameter, recording) can't be used.

    Args:
        place: where it was met: a file and key, a parameter's name, an argument.
        expected: what would have been accepted.
        got: what was found instead.
    """

    exit_code = 2

    def __init__(self, place: str, expected: str, got: str) -> None:
        super().__init__(one_line(f"{place}: expected {expected}, got {got}"))
        self.place = place
        self.expected = expected
        self.got = got
