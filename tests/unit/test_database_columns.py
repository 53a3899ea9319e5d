"""Columns of numbers come back bit by bit, and damage is found."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clerestory import ClerestoryError
from clerestory.measure.database.columns import pack, unpack


def back(column) -> np.ndarray:
    column = np.asarray(column, dtype=np.float64)
    (found,) = unpack(pack([column]))
    assert found.tobytes() == column.tobytes()
    return found


@given(st.lists(st.floats(width=64)))
def test_any_number_comes_back(numbers):
    back(numbers)


@given(st.lists(st.decimals(-999, 999, places=3).map(float), min_size=1))
def test_decimals_come_back(numbers):
    back(numbers)


@pytest.mark.parametrize("decimals", range(10))
def test_decimals_are_the_numbers_that_a_text_means(decimals):
    integers = np.random.default_rng(decimals).integers(-(2**31) + 1, 2**31, 20000)
    texts = [f"{k}e-{decimals}" for k in integers]
    back([float(text) for text in texts])


@pytest.mark.parametrize(
    "column",
    [
        [0.0, -0.0],
        [np.nan, 1.0],
        [np.inf, -np.inf, 1.0],
        [1e300, 5e-324],
        [2.0**31, 1.0],
        [-(2.0**31), 0.5],
        np.float32(np.random.default_rng(1).normal(size=100)).astype(float),
        # decimals at the head, and a number without end later
        [*np.arange(100.0), 1.0 / 3.0],
    ],
)
def test_what_is_awkward(column):
    back(column)


def test_decimals_take_half_of_the_room_or_less():
    numbers = np.random.default_rng(1)
    angles = np.round(numbers.uniform(0.0, 90.0, 65536), 3)
    assert len(pack([angles])) < 0.35 * angles.nbytes


def test_no_columns_and_no_points():
    assert unpack(pack([])) == []
    assert [len(c) for c in unpack(pack([np.empty(0), np.empty(0)]))] == [0, 0]


@pytest.mark.parametrize("at", [0, 1, 7, 40, -1])
def test_a_byte_that_has_changed_is_an_error(at):
    data = bytearray(pack([np.random.default_rng(2).normal(size=300)]))
    data[at] ^= 0x55
    with pytest.raises(ClerestoryError, match=r"\(.*\)$"):
        unpack(bytes(data))


def test_what_is_cut_off_is_an_error():
    data = pack([np.random.default_rng(2).normal(size=300)])
    for length in (0, 3, 10, len(data) // 2, len(data) - 1):
        with pytest.raises(ClerestoryError, match="damaged"):
            unpack(data[:length])
