"""Files of the superharmonic studies: one page, tables as CSV or Parquet."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from nw_gear_common import tidy
from nw_gear_common.errors import InputError
from nw_gear_sim.superharmonic.question import Question


def write(
    files: Sequence[Path],
    question: Question,
    study: str,
    page: Callable[[], str],
    table: Callable[[], Mapping[str, Any]],
) -> list[str]:
    """Write what was asked for, and return the names.

    Args:
        files: paths, by their suffix; question: kept in the metadata of a Parquet file; study: its name.
        page: makes the page; table: makes the columns.

    Raises:
        InputError: a file can't be written.
    """
    about = {"study": study, **{name: str(value) for name, value in question.as_object().items()}}
    for path in files:
        if path.suffix != ".html":
            tidy.write(path, table(), about)
            continue
        try:
            path.write_text(page(), encoding="utf-8")
        except OSError as error:
            raise InputError(f"-o {path}", "a file that can be written", error.strerror or str(error)) from None
    return [str(path) for path in files]
