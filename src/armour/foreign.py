"""Values of numpy, pandas, polars, pyarrow, xarray and pint as Python's own."""

from collections.abc import Iterable, Mapping
from math import nan
from typing import Any, Protocol


class Frame(Protocol):
    """A data frame of pandas or polars."""

    @property
    def columns(self) -> Any:
        """Names of the columns."""

    def __getitem__(self, name: Any, /) -> Any:
        """Return a column."""


# Rows given in Python: mappings by column, columns by name, or a data frame.
Rows = Iterable[Mapping[str, Any]] | Mapping[str, object] | Frame


def plain(value: Any) -> Any:
    """Return a single value as Python's own, NaN if it is masked or missing; anything else as it is.

    A number with a unit becomes a text, which nothing takes for a number: in another unit it is another one.
    """
    if value is None or type(value) in (str, float, int, bool):
        return value
    shape = getattr(value, "shape", None)
    if (shape == () or (shape is None and hasattr(value, "__float__"))) and _has_unit(value):
        return " ".join(str(value).split())
    if shape == ():
        # Of a masked value, numpy's `item` is 0; only `tolist` is None.
        inner = value.tolist() if hasattr(value, "tolist") else value.item()
        return nan if inner is None else plain(inner)
    if shape is None and hasattr(value, "as_py"):  # of pyarrow
        inner = value.as_py()
        return nan if inner is None else plain(inner)
    if not hasattr(value, "__len__"):
        try:
            bool(value)
        except TypeError:  # pandas.NA is neither true nor false
            return nan
    return value


def items(values: Any) -> list[Any]:
    """Return the values of a sequence, an array or a column, each as by `plain`; raise a TypeError for a text."""
    if isinstance(values, str | bytes | Mapping) or getattr(values, "shape", None) == ():
        raise TypeError
    listed = values.tolist() if hasattr(values, "tolist") and not _has_unit(values) else values
    return [plain(value) for value in listed]


def records(table: Any) -> list[dict[str, str]]:
    """Return rows given in Python, each as texts by column; raise a TypeError or ValueError if they are none."""
    columns = getattr(table, "columns", table if isinstance(table, Mapping) else None)
    rows = table if columns is None else zip(*(items(table[name]) for name in dict.fromkeys(columns)), strict=True)
    # If two names of columns are the same, a row has fewer cells than there are names.
    named = (dict(row) if columns is None else dict(zip(columns, row, strict=True)) for row in rows)
    return [{str(name): _text(value) for name, value in row.items()} for row in named]


def _text(value: object) -> str:
    """Return a value as a text, which is empty for one that is missing."""
    value = plain(value)
    return "" if value is None or (not hasattr(value, "__len__") and value != value) else str(value).strip()


def _has_unit(value: Any) -> bool:
    """Return whether a value is a quantity, as of pint or astropy, or has a unit of time."""
    is_time = getattr(getattr(value, "dtype", None), "kind", "") in ("m", "M")
    return is_time or hasattr(value, "units") or hasattr(value, "unit")
