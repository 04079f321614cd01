"""Optimal design of experiments: which of n candidate tests to make, given the information from each.

Each candidate has a row f, (k,): a test of it gives the information f f' about k parameters.  The information M of
several tests is the sum of theirs, plus the base: the information from earlier tests or a prior.  A set of tests is
best if its loss is least.  By criterion D, the loss is minus the logarithm of the determinant of M; by criterion I, it
is the logarithm of the mean variance c' M^-1 c of t quantities, whose gradients by the parameters are targets c, (k,).
"""

from collections.abc import Sequence
from math import exp, log
from typing import NamedTuple

import numpy as np
from scipy.linalg import qr

from armour.analysis.variants import Floats, Ints

# A direction is not determined if its singular value, of scaled rows, is below this fraction of the greatest one.  The
# derivatives are accurate to a tenth of this fraction.
SINGULAR = 1e-3
# Sets whose losses differ by less than this, relatively, are equally good: then the first candidate is chosen.
TIE = 1e-9
# Accuracy of the efficiency of the continuous design.
OPTIMALITY_GAP = 1e-4


class Task(NamedTuple):
    """Candidates to choose tests from, and the criterion."""

    base: Floats  # information before the tests, (k, k)
    rows: Floats  # of the candidates, (n, k)
    costs: Floats  # of a test of each candidate, (n,)
    targets: Floats | None  # for criterion I, (t, k); None for D

    def information(self, chosen: Sequence[int] | Ints) -> Floats:
        """Return the information from the base and from tests of the candidates at the indices `chosen`, (k, k)."""
        rows = self.rows[np.asarray(chosen, dtype=int)]
        return self.base + rows.T @ rows

    def loss(self, information: Floats) -> Floats:
        """Return the loss of each information matrix in an array, (..., k, k); inf for a singular one."""
        sign, logarithm = np.linalg.slogdet(information)
        regular = (sign > 0) & np.isfinite(logarithm)
        if self.targets is None:
            return np.where(regular, -logarithm, np.inf)
        safe = np.where(regular[..., None, None], information, np.eye(information.shape[-1]))
        variances = np.einsum("tk,...kl,tl->...", self.targets, np.linalg.inv(safe), self.targets) / len(self.targets)
        with np.errstate(all="ignore"):
            losses: Floats = np.where(regular & (variances > 0.0), np.log(variances), np.inf)
        return losses

    def sensitivities(self, information: Floats) -> Floats:
        """Return the rates, (n,), at which the loss falls as each candidate adds to the information, (k, k)."""
        inverse = np.linalg.inv(information)
        if self.targets is None:
            return np.einsum("nk,kl,nl->n", self.rows, inverse, self.rows)
        products = self.rows @ inverse @ self.targets.T
        return (products**2).sum(axis=1) / np.einsum("tk,kl,tl->", self.targets, inverse, self.targets)


def identified(base: Floats, rows: Floats) -> Floats:
    """Return the r orthonormal directions of the parameters, (k, r), that the base and tests with `rows` determine."""
    root = _root(base)
    stacked = np.vstack([root, rows])
    scale = np.linalg.norm(stacked, axis=0)
    scaled = stacked / np.where(scale > 0.0, scale, 1.0)
    _, values, directions = np.linalg.svd(scaled, full_matrices=False)
    determined = directions[values > SINGULAR * values.max(initial=1e-300)] * scale
    return np.linalg.qr(determined.T)[0]


def _root(information: Floats) -> Floats:
    """Return k rows, (k, k), whose information is a given matrix, (k, k)."""
    values, vectors = np.linalg.eigh(information)
    return np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T


def missing_tests(base: Floats, rows: Floats) -> int:
    """Return the least number of tests, with rows out of `rows`, that make the information regular, given the base."""
    return int(rows.shape[1]) - int(np.linalg.matrix_rank(_scaled(base, rows)[0], tol=SINGULAR))


def _scaled(base: Floats, rows: Floats) -> tuple[Floats, Floats]:
    """Return a root of the base, (k, k), and `rows`, both scaled so that all directions have like total information."""
    root = _root(base)
    stacked = np.vstack([root, rows])
    triangle = np.linalg.qr(stacked, mode="r")
    scaled = np.linalg.solve(np.asarray(triangle).T, stacked.T).T
    # Make the longest row of a candidate 1: with many candidates, each has only a small part of the total.
    scaled /= max(np.linalg.norm(scaled[len(root) :], axis=1).max(), 1e-150)
    return scaled[: len(root)], scaled[len(root) :]


def best_set(task: Task, number: int) -> list[int]:
    """Choose a number of tests; return the indices of their candidates, possibly repeated, in the best order.

    The first tests, which make the information regular, are chosen together, and each further test by its gain per
    cost.  Then candidates are exchanged while this lowers the loss without raising the cost [Fedorov1972].
    """
    start = _sequence(task, np.arange(len(task.rows)), number)
    if number < missing_tests(task.base, task.rows):
        return start
    return ordered(task, _exchanged(task, start, float(task.costs[start].sum())))


def ordered(task: Task, chosen: Sequence[int]) -> list[int]:
    """Return a set of tests in their best order: those that make the information regular, then the greatest gains."""
    return _sequence(task, np.array(sorted(chosen)), len(chosen), repeats=False)


def _sequence(task: Task, allowed: Ints, number: int, *, repeats: bool = True) -> list[int]:
    """Choose tests of allowed candidates, by index, one after the other; without `repeats`, use each index once."""
    chosen, remaining = _first(task, np.unique(allowed))[:number], allowed.tolist()
    if not repeats:
        for place in chosen:
            remaining.remove(place)
    while len(chosen) < number:
        places, information = np.unique(remaining), task.information(chosen)
        rows = task.rows[places]
        gains = task.loss(information) - task.loss(information + rows[:, :, None] * rows[:, None, :])
        chosen.append(int(places[_first_best(-gains / task.costs[places])]))
        if not repeats:
            remaining.remove(chosen[-1])
    return chosen


def _first(task: Task, allowed: Ints) -> list[int]:
    """Return the fewest allowed candidates that make the information regular.

    Of such sets, this one has the greatest determinant for its cost.
    """
    rows = task.rows[allowed]
    root, scaled = _scaled(task.base, rows)
    count = missing_tests(task.base, rows)
    if not count:
        return []
    _, values, directions = np.linalg.svd(root, full_matrices=False)
    determined = directions[values > SINGULAR]
    pivots = qr((scaled - scaled @ determined.T @ determined).T, mode="r", pivoting=True)[1]
    # With scaled rows, the determinant only differs by a constant factor.
    scaled_task = Task(root.T @ root, scaled, task.costs[allowed], None)
    start = [int(pivot) for pivot in pivots[:count]]
    chosen = _exchanged(scaled_task, start, None)
    # The candidate with the most information for its cost comes first.
    lengths = (scaled_task.rows[chosen] ** 2).sum(axis=1) / scaled_task.costs[chosen]
    return [int(allowed[chosen[place]]) for place in np.lexsort((chosen, -np.round(lengths / lengths.max(), 9)))]


def _exchanged(task: Task, start: Sequence[int], cost: float | None) -> list[int]:
    """Improve a set of candidates, given by index: exchange one at a time for the best other, up to a total `cost`.

    Without a bound on the cost, the losses of sets are compared as if all had the same cost.
    """
    chosen = [*start]
    informations = task.rows[:, :, None] * task.rows[:, None, :]
    for _ in range(1000):
        information, total = task.information(chosen), float(task.costs[chosen].sum())
        best, exchange = _bounded(task, task.loss(information), np.array(total), cost), None
        for place in dict.fromkeys(chosen):
            losses = task.loss(information - informations[place] + informations)
            losses = _bounded(task, losses, total - task.costs[place] + task.costs, cost)
            replacement = _first_best(losses)
            if losses[replacement] < best - TIE * max(1.0, abs(float(best))):
                best, exchange = losses[replacement], (place, replacement)
        if exchange is None:
            break
        chosen[chosen.index(exchange[0])] = exchange[1]
    return chosen


def _bounded(task: Task, losses: Floats, totals: Floats, cost: float | None) -> Floats:
    """Return the losses of sets, inf for those whose total cost exceeds `cost`; without it, losses at an equal cost."""
    if cost is None:
        losses, totals = losses + task.rows.shape[1] * np.log(totals), np.zeros_like(totals)
    return np.where(totals <= (cost or 0.0) * (1.0 + TIE), losses, np.inf)


def _first_best(losses: Floats) -> int:
    """Return the index of the first of the least losses; losses that are almost equal count as equal."""
    least = float(losses.min())
    return int(np.flatnonzero(losses <= least + TIE * max(1.0, abs(least)))[0]) if np.isfinite(least) else 0


def continuous_design(task: Task, cost: float) -> tuple[Floats, float]:
    """Return the best shares of a cost for the candidates, (n,), and a lower bound on the loss of any shares.

    The shares are improved by multiplicative steps; the bound follows from the equivalence theorem.
    """
    rows = task.rows * np.sqrt(cost / task.costs)[:, None]
    at_full_cost = task._replace(rows=rows)
    shares = np.full(len(rows), 1.0 / len(rows))
    power = 1.0 if task.targets is None else 0.5
    for _ in range(20_000):
        information = task.base + (rows * shares[:, None]).T @ rows
        slopes = at_full_cost.sensitivities(information)
        gap = float(slopes.max()) - float(shares @ slopes)
        if gap < OPTIMALITY_GAP:
            break
        shares = shares * slopes**power
        shares /= shares.sum()
    # The variance is convex and its logarithm is not, so the bound is derived from the variance itself.
    bound = gap if task.targets is None else -log(max(1.0 - gap, 1e-300))
    return shares, float(task.loss(information)) - bound


def efficiency(task: Task, chosen: Sequence[int]) -> float:
    """Return the efficiency of a set, 0 to 1: the best tests with the same loss would cost at least this fraction."""
    least = continuous_design(task, float(task.costs[chosen].sum()))[1]
    excess = float(task.loss(task.information(chosen))) - least
    return min(exp(-excess / (task.rows.shape[1] if task.targets is None else 1)), 1.0)
