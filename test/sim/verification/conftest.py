"""Figures found by the checks go into the test report, from where docs/verification.md has them.

`pytest -m "" test/sim/verification --junitxml=figures.xml` writes them as properties of the test cases.
"""

from collections.abc import Callable

import pytest


@pytest.fixture
def figure(request: pytest.FixtureRequest) -> Callable[[str, float], float]:
    """Record a figure under a name and hand it on to the assertion."""

    def record(name: str, value: float) -> float:
        request.node.user_properties.append((name, f"{value:.4g}"))
        return value

    return record
