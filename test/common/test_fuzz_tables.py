"""The block decoder under random messages: a table that fits its layout, or an InputError."""

import array

import numpy as np
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from std_msgs.msg import Float64MultiArray, MultiArrayDimension, MultiArrayLayout

from nw_gear_common.errors import InputError
from nw_gear_common.ros import from_message, to_message
from nw_gear_common.tables import Table

U32 = st.one_of(st.integers(0, 6), st.sampled_from((2**16, 2**31, 2**32 - 1)))
LABEL = st.one_of(
    st.sampled_from(("sample", "time", "time,x", "time,x,v", "", ",", ",,", "time,time", " time , x", "x\n,y", "a;b")),
    st.text(alphabet=st.characters(codec="utf-8"), max_size=12),
)
VALUES = st.lists(st.floats(allow_nan=True, allow_infinity=True), max_size=24)
DIMENSIONS = st.lists(st.tuples(LABEL, U32, U32), max_size=4)
relaxed = {"deadline": None, "suppress_health_check": list(HealthCheck)}


class Plain:
    """A message as libraries without ROS decode it: the same names, anything in them."""

    def __init__(self, dimensions, offset, data):
        self.layout = type("Layout", (), {})()
        self.layout.dim = [type("Dim", (), {"label": a, "size": b, "stride": c})() for a, b, c in dimensions]
        self.layout.data_offset = offset
        self.data = data


def check(message):
    try:
        table = from_message(message, "topic")
    except InputError as error:
        words = str(error)
    else:
        return checked(table, message)
    assert words.startswith("topic: ")
    assert "\n" not in words
    return None


def checked(table, message):
    assert table.data.shape == (len(table), len(table.columns))
    assert table.data.size == len(message.data)
    assert len(set(table.columns)) == len(table.columns)
    assert np.array_equal(table.data.reshape(-1), np.asarray(message.data, dtype=np.float64), equal_nan=True)
    return table


@settings(max_examples=300, **relaxed)
@example([("sample", 2, 4), ("time,x", 2, 2)], 0, [1.0, 2.0, 3.0, 4.0])
@example([("sample", 2**32 - 1, 4), ("time,x", 2, 2)], 0, [])
@example([("sample", 2, 99), ("time,x", 2, 2)], 0, [1.0, 2.0, 3.0, 4.0])
@example([("sample", 2, 4), ("time,x", 2, 2)], 2, [1.0, 2.0, 3.0, 4.0])
@example([("sample", 2, 4), ("x,x", 2, 2)], 0, [1.0, 2.0, 3.0, 4.0])
@given(DIMENSIONS, U32, VALUES)
def test_messages(dimensions, offset, values):
    dim = [MultiArrayDimension(label=label, size=size, stride=stride) for label, size, stride in dimensions]
    layout = MultiArrayLayout(dim=dim, data_offset=offset)
    check(Float64MultiArray(layout=layout, data=array.array("d", values)))


@settings(max_examples=200, **relaxed)
@example([("sample", -2, 0), ("time,x", 2, 2)], 0, [1.0, 2.0, 3.0, 4.0])
@example([("sample", -1, 0), ("", 1, 1)], 0, [])
@example([("sample", 10**12, 0), ("", 1, 1)], 0, [])
@given(st.lists(st.tuples(LABEL, st.integers(-3, 5), st.integers(-3, 30)), max_size=3), st.integers(-3, 3), VALUES)
def test_decoded_without_ros(dimensions, offset, values):
    check(Plain(dimensions, offset, np.array(values)))


@settings(max_examples=100, **relaxed)
@given(
    st.lists(st.text(alphabet="abcxyz_123", min_size=1, max_size=8), min_size=1, max_size=6, unique=True),
    st.integers(0, 20),
    st.randoms(use_true_random=False),
)
def test_there_and_back(columns, rows, random):
    data = np.array([random.gauss(0.0, 1e6) for _ in range(rows * len(columns))]).reshape(rows, len(columns))
    back = check(to_message(Table("sample", tuple(columns), data)))
    assert back is not None
    assert back.columns == tuple(columns)
    assert np.array_equal(back.data, data)
