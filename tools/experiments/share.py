"""A share of simulated samples, which every experiment yields."""

from typing import NamedTuple


class Share(NamedTuple):
    """How many samples of a case have a property, such as an interval that contains the truth."""

    case: str
    name: str
    hits: int
    samples: int
    least: float | None = None  # per cent that must be reached, if the experiment judges the share

    @property
    def percent(self) -> float:
        """The share, per cent."""
        return 100.0 * self.hits / self.samples
