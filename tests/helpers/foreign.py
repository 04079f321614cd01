"""What stands for values of libraries that the tests do not need: pandas and pint."""

from collections.abc import Iterator
from typing import Any


class NotAvailable:
    """Like pandas.NA, which is neither true nor false, and compares to nothing."""

    def __ne__(self, _other: object) -> "NotAvailable":  # type: ignore[override]
        return self

    def __bool__(self) -> bool:
        raise TypeError


class Column:
    """Like a column of pandas or a categorical: no sequence to Python."""

    def __init__(self, *values: Any) -> None:
        self.values = values
        self.shape = (len(values),)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.values)

    def __len__(self) -> int:
        return len(self.values)


class Quantity:
    """Like a quantity of pint or unyt: a number, or several, with a unit."""

    units = "inch"

    def __init__(self, value: Any) -> None:
        self.value = value

    def __float__(self) -> float:
        return float(self.value)

    def __str__(self) -> str:
        return f"{self.value} inch"

    def __iter__(self) -> Iterator["Quantity"]:
        return map(Quantity, self.value)

    def tolist(self) -> Any:
        return self.value
