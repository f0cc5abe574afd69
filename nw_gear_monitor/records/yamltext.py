"""YAML that somebody else wrote: plain data, never objects, and one kind of error."""

from __future__ import annotations

from typing import Any

import yaml

LONGEST = 4 * 1024 * 1024
"""Characters; the metadata of a recording with a thousand topics has a fifth of that."""

_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def plain(text: str) -> Any:
    """Lists, dictionaries, texts and numbers out of a text.

    Raises:
        ValueError: it isn't YAML, or needs more than that.
    """
    if len(text) > LONGEST:
        raise ValueError(f"{len(text)} characters")
    try:
        return yaml.load(text, Loader=_Loader)
    except (yaml.YAMLError, RecursionError, TypeError, AttributeError, LookupError, OverflowError) as error:
        raise ValueError(str(error)) from None
