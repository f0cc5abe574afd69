"""YAML that somebody else wrote: plain data, never objects, and one kind of error."""

from __future__ import annotations

from typing import Any

import yaml

LONGEST = 4 * 1024 * 1024
"""Characters; the metadata of a recording with a thousand topics has a fifth of that."""

DEEPEST = 30
"""Levels of lists and dictionaries; the loader written in C ends the process at some ten thousand."""

_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def plain(text: str) -> Any:
    """Lists, dictionaries, texts and numbers out of a text.

    Raises:
        ValueError: it isn't YAML, or needs more than that.
    """
    if len(text) > LONGEST:
        raise ValueError(f"{len(text)} characters")
    try:
        depth = 0
        for event in yaml.parse(text, Loader=_Loader):
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth > DEEPEST:
                raise ValueError("more levels than anybody needs")
        return yaml.load(text, Loader=_Loader)
    except (yaml.YAMLError, RecursionError, TypeError, AttributeError, LookupError, OverflowError) as error:
        raise ValueError(str(error)) from None
