"""The documentation names every guess of the configuration, and every file of tests that it speaks of exists."""

import fnmatch
import re
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[3]


def leaves(node: dict, prefix: str = ""):
    for key, value in node.items():
        if "value" in value:
            yield f"{prefix}{key}", value.get("source", "")
        else:
            yield from leaves(value, f"{prefix}{key}.")


def test_every_guess_is_named() -> None:
    configuration = yaml.safe_load((ROOT / "config/gearbox.yaml").read_text(encoding="utf-8"))
    text = (ROOT / "docs/model.md").read_text(encoding="utf-8")
    section = text[text.index("Every guess by its key") : text.index("Guesses about the equations")]
    named = re.findall(r"`([\w.*]+)`", section)
    guessed = [key for key, source in leaves(configuration) if "guess" in source]
    assert len(guessed) > 50
    assert [key for key in guessed if not any(fnmatch.fnmatch(key, pattern) for pattern in named)] == []
    assert [pattern for pattern in named if not fnmatch.filter(guessed, pattern)] == []


def test_the_tests_it_names_exist() -> None:
    text = (ROOT / "docs/verification.md").read_text(encoding="utf-8")
    here, above = Path(__file__).parent, Path(__file__).parents[1]
    for name in set(re.findall(r"`(?:test/sim/)?(test_\w+\.py)`", text)):
        assert (here / name).is_file() or (above / name).is_file(), name
