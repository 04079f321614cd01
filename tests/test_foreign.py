from datetime import date
from math import isnan
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from armour.foreign import items, plain
from tests.helpers.foreign import Column, NotAvailable, Quantity


@pytest.mark.parametrize(
    ("value", "own"),
    [
        (np.float32(4.5), 4.5),
        (np.float64(4.5), 4.5),
        (np.int64(4), 4),
        (np.bool_(True), True),
        (np.str_("AD85"), "AD85"),
        (np.array(4.5), 4.5),
        (pa.scalar(4.5), 4.5),
        (pa.scalar("AD85"), "AD85"),
        (Quantity(0.25), "0.25 inch"),
        (np.timedelta64(4, "s"), "4 seconds"),
        (np.datetime64("2020-01-01"), "2020-01-01"),
        (date(2020, 1, 1), date(2020, 1, 1)),
        (None, None),
    ],
)
def test_single_values(value: Any, own: object):
    assert plain(value) == own
    assert type(plain(value)) is type(own)


@pytest.mark.parametrize("value", [np.ma.masked, NotAvailable(), pa.scalar(None), np.array(None), float("nan")])
def test_missing_values(value: Any):
    assert isnan(plain(value))


@pytest.mark.parametrize(
    ("values", "own"),
    [
        ([4, np.float64(4.5)], [4, 4.5]),
        (np.array([4.0, 4.5]), [4.0, 4.5]),
        (np.ma.array([4.0, 500.0], mask=[False, True]), [4.0, None]),
        (np.ones((2, 1)), [[1.0], [1.0]]),
        (pa.array([4.0, None]), [4.0, None]),
        (pa.chunked_array([["a"], ["b"]]), ["a", "b"]),
        (Column("a", "b"), ["a", "b"]),
        (Quantity([0.25, 0.5]), ["0.25 inch", "0.5 inch"]),
        (range(2), [0, 1]),
    ],
)
def test_several_values(values: Any, own: list[Any]):
    assert items(values) == own


@pytest.mark.parametrize(
    "values", ["AD85", b"AD85", {"a": 1}, 4.0, None, np.array(4.0), np.array("AD85"), np.ma.masked]
)
def test_what_has_no_items(values: Any):
    with pytest.raises(TypeError):
        items(values)
