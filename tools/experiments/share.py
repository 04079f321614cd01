"""A share of simulated samples, which every experiment yields, and what an interval contains."""

from typing import NamedTuple


def holds(interval: tuple[float | None, float | None], value: float) -> bool:
    """Return whether an interval, whose ends may be open, contains a value."""
    low, high = interval
    return (low is None or low <= value) and (high is None or value <= high)


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
