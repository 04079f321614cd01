"""Where a function changes sign."""

from collections.abc import Callable
from math import atan, exp

import pytest

from armour.core.roots import MOST_TRIALS, bracket, narrowed, next_point


def found(function: Callable[[float], float], low: float, high: float, width: float) -> tuple[float, float, int]:
    b = bracket(high, function(high), low, function(low))
    for trials in range(MOST_TRIALS):
        if abs(b.x2 - b.x1) <= width:
            return min(b.x1, b.x2), max(b.x1, b.x2), trials
        x = next_point(b, 0.95 * width)
        assert min(b.x1, b.x2) < x < max(b.x1, b.x2)
        b = narrowed(b, x, function(x))
    raise AssertionError("does not end")


@pytest.mark.parametrize(
    ("function", "root"),
    [
        (lambda x: x - 0.3, 0.3),
        (lambda x: exp(5.0 * x) - exp(1.0), 0.2),
        (lambda x: (x - 0.7) ** 3, 0.7),
        (lambda x: atan(1e3 * (x - 0.111)), 0.111),
        (lambda x: 1.0 if x > 0.456 else -1e-6, 0.456),
        (lambda x: -1.0 if x < 1e-7 else 1e9, 1e-7),
    ],
)
def test_the_change_of_sign_is_within_the_width_and_takes_no_more_than_bisection_twice(
    function: Callable[[float], float], root: float
):
    low, high, trials = found(function, 0.0, 1.0, 1e-9)
    assert low <= root <= high
    assert high - low <= 1e-9
    assert trials <= 62


def test_a_smooth_function_takes_few_trials():
    assert found(lambda x: x * x - 0.5, 0.0, 1.0, 1e-9)[2] <= 9
