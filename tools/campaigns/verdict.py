"""How a campaign ends: a line for the page of results, and an exit code."""

from collections.abc import Iterable
from math import sqrt

RESULT, WRONG = "result: ", 3


def verdict(found: str, *, right: bool) -> int:
    """Print what a campaign has found; return the exit code, 3 if it is not as it should be."""
    print(f"{RESULT}{found}", flush=True)
    return 0 if right else WRONG


def standard_error(samples: int) -> float:
    """Return the standard error of a share of 95 % of some samples, per cent."""
    return 100.0 * sqrt(0.95 * 0.05 / samples)


def coverage(shares: Iterable[float], samples: int, least: float) -> int:
    """Tell the shares of samples whose 95 % interval contains the truth, per cent, which must reach a least one."""
    shares = sorted(shares)
    text = f"{shares[0]:.1f} to {shares[-1]:.1f} % of {samples:,} samples in each of {len(shares)} intervals of 95 %"
    return verdict(f"{text}, standard error {standard_error(samples):.1f} %", right=shares[0] >= least)
