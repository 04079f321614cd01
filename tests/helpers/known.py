"""Values of which a test knows that there are any."""

from typing import TypeVar

T = TypeVar("T")


def known(value: T | None) -> T:
    """A value that is not None."""
    assert value is not None
    return value
