"""Declared numbers: what passes, what is refused, and how the refusal reads."""

import math
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nw_gear_common.errors import InputError
from nw_gear_common.quantities import check_value, quantities, quantity


@dataclass(frozen=True)
class Example:
    rate: float = quantity(5120.0, "Rate.", "Hz", minimum=20.0, maximum=40960.0)
    count: int = quantity(3, "Count.", minimum=0)
    loop: bool = quantity(False, "Loop.")
    source: str = quantity("weibull", "Source.", choices=("weibull", "gust"))
    names: tuple[str, ...] = quantity(("a",), "Names.", choices=("a", "b"))
    mass: float | None = quantity(None, "Mass.", "kg", minimum=0.0)
    undeclared: int = 0


DECLARED = {name: (kind, text) for name, kind, _default, text in quantities(Example)}


def refuse(name, value):
    with pytest.raises(InputError) as refused:
        check_value(f"node: {name}", value, *DECLARED[name])
    assert "\n" not in str(refused.value)
    return refused.value


def test_only_declared_fields_are_quantities():
    assert list(DECLARED) == ["rate", "count", "loop", "source", "names", "mass"]


@pytest.mark.parametrize("name", DECLARED)
def test_defaults_pass(name):
    default = getattr(Example(), name)
    assert check_value(name, default, *DECLARED[name]) == default


@given(st.floats(20.0, 40960.0))
def test_every_number_within_the_bounds_passes_unchanged(value):
    assert check_value("rate", value, *DECLARED["rate"]) == value


@given(st.floats().filter(lambda x: not 20.0 <= x <= 40960.0))
def test_every_number_outside_the_bounds_is_refused(value):
    refuse("rate", value)


@given(st.integers(20, 40960))
def test_a_whole_number_does_for_a_float(value):
    passed = check_value("rate", value, *DECLARED["rate"])
    assert isinstance(passed, float)
    assert passed == value


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("rate", "fast"),
        ("rate", True),
        ("rate", math.nan),
        ("rate", math.inf),
        ("rate", 10**400),
        ("rate", None),
        ("count", 2.0),
        ("count", True),
        ("count", -1),
        ("loop", 1),
        ("source", "storm"),
        ("source", 3),
        ("names", "a"),
        ("names", ["a", "c"]),
        ("mass", -1.0),
    ],
)
def test_what_is_not_declared_is_refused(name, value):
    assert refuse(name, value).place.startswith(f"node: {name}")


def test_the_message_says_place_expected_and_got():
    error = refuse("rate", 10)
    assert str(error) == "node: rate: expected a number in Hz >= 20 and <= 40960, got 10"
    assert str(refuse("source", "storm")) == "node: source: expected one of weibull, gust, got 'storm'"


def test_a_list_names_the_entry_that_is_wrong():
    assert refuse("names", ["a", "c"]).place == "node: names[1]"


def test_none_passes_where_it_is_declared():
    assert check_value("mass", None, *DECLARED["mass"]) is None


def test_the_error_names_the_place():
    assert str(refuse("count", -1)).startswith("node: count: ")
