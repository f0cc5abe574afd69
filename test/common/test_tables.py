"""Tables and their form as a ROS message."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Float64MultiArray

from nw_gear_common.errors import InputError
from nw_gear_common.ros import from_message, to_message
from nw_gear_common.tables import Table

DATA = np.arange(6.0).reshape(3, 2)
TABLE = Table("sample", ("time", "x"), DATA)


def test_a_column_is_a_view():
    assert np.shares_memory(TABLE.column("x"), DATA)
    assert TABLE.column("x").tolist() == [1.0, 3.0, 5.0]
    assert len(TABLE) == 3


def test_select_keeps_the_order_asked_for():
    assert TABLE.select(["x", "time"])[0].tolist() == [1.0, 0.0]


def test_an_unknown_column_is_refused_with_those_that_exist():
    with pytest.raises(InputError, match="expected one of time, x"):
        TABLE.column("y")


@pytest.mark.parametrize("shape", [(6,), (3, 3), (1, 3, 2)])
def test_data_of_another_shape_is_refused(shape):
    with pytest.raises(InputError):
        Table("sample", ("time", "x"), np.zeros(shape))


def test_the_message_has_the_layout_of_the_contract():
    message = to_message(TABLE)
    first, second = message.layout.dim
    assert (first.label, first.size, first.stride) == ("sample", 3, 6)
    assert (second.label, second.size, second.stride) == ("time,x", 2, 2)
    assert np.frombuffer(message.data).reshape(first.size, second.size).tolist() == DATA.tolist()


@given(arrays(np.float64, array_shapes(min_dims=2, max_dims=2, min_side=0, max_side=7), elements=st.floats()))
def test_every_table_survives_the_wire_bit_for_bit(data):
    columns = tuple(f"c{i}" for i in range(data.shape[1])) or ("c0",)
    table = Table("row", columns, data if data.shape[1] else data.reshape(0, 0).reshape(0, 1))
    message = deserialize_message(serialize_message(to_message(table)), Float64MultiArray)
    back = from_message(message, "topic")
    assert (back.row, back.columns) == (table.row, table.columns)
    assert back.data.tobytes() == table.data.tobytes()


def test_a_transposed_array_is_sent_row_by_row():
    table = Table("sample", ("a", "b", "c"), DATA.T)
    assert list(to_message(table).data) == [0.0, 2.0, 4.0, 1.0, 3.0, 5.0]


def test_a_message_without_layout_is_refused():
    with pytest.raises(InputError, match="waveform: layout"):
        from_message(Float64MultiArray(data=[1.0, 2.0]), "waveform")


def test_a_message_with_too_few_numbers_is_refused():
    message = to_message(TABLE)
    message.data = message.data[:-1]
    with pytest.raises(InputError, match="expected 3 x 2 numbers, got 5"):
        from_message(message, "waveform")
