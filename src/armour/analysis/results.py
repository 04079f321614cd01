"""Base class of results."""

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class Result:
    """Result of a computation."""

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data."""
        return asdict(self)
