"""Bisection, by which tests find limits independently of the program's own search."""

from collections.abc import Callable


def bisect(holds: Callable[[float], bool], low: float, high: float, tolerance: float) -> tuple[float, float]:
    """Narrow a bracket to a tolerance; a condition holds at its upper end and not at its lower."""
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return low, high
