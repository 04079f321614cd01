"""Count how often the intervals that the commands state contain the truth, in simulated tests.

    python -m tools.campaigns "coverage curves --samples 100"

runs an experiment; without a name, all.
"""

from collections.abc import Callable, Iterator
from functools import partial
from math import sqrt

from tools.campaigns import calibrations, curves, firings, uncertainties
from tools.campaigns.verdict import Share, asked, verdict

# Simulations that count shares, given the samples of a case and a seed, and their usual numbers of samples.
EXPERIMENTS: dict[str, tuple[Callable[[int, int], Iterator[Share]], int]] = {
    "curves": (partial(curves.shares, curves.CURVES), 1000),
    "wide_curves": (partial(curves.shares, curves.WIDE), 300),
    "lots": (curves.lots, 2000),
    "calibrations": (calibrations.shares, 300),
    "uncertainty": (uncertainties.shares, 200),
    "firings": (firings.shares, 250),
    "requirements": (firings.decisions, 250),
}


def run(name: str, samples: int, seed: int) -> int:
    """Run an experiment and print its shares; the exit code is 3 if one is less than it must be."""
    (shares, usual), judged = EXPERIMENTS[name], []
    for share in shares(samples or usual, seed):
        print(f"{share.case}: {share.name}: {share.percent:.1f} % of {share.samples:,}", flush=True)
        judged += [share] if share.least is not None else []
    percents = [share.percent for share in judged]
    error = 100.0 * sqrt(0.95 * 0.05 / min(share.samples for share in judged))
    text = f"{min(percents):.1f} to {max(percents):.1f} % in {len(judged)} cases, standard error {error:.1f} %"
    return verdict(text, right=all(share.percent >= (share.least or 0.0) for share in judged))


def main() -> int:
    """Run experiments; the exit code is 3 if a share is less than it must be."""
    options = asked(__doc__, samples=0, seed=1)
    return max(run(name, options.samples, options.seed) for name in options.words or EXPERIMENTS)
