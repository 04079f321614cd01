"""Optimal design of experiments: which of n candidate tests to make, given the information from each.

A test whose row is f, one of (n, k), gives the information f f' on k parameters.  The information M of several tests
is their sum plus a base, from earlier tests or a prior.  The loss to minimise is, for criterion D, minus the logarithm
of the determinant of M; for I, the logarithm of the mean of c' M^-1 c over the targets c, (t, k).
"""

from collections.abc import Sequence
from math import exp, log
from typing import NamedTuple

import numpy as np
from scipy.linalg import qr

from armour.analysis.variants import Floats, Ints

# A direction whose singular value, of scaled rows, is below this fraction of the greatest one is not determined; the
# derivatives are accurate to a tenth of it.
SINGULAR = 1e-3
# Two sets whose losses differ by less than this, relatively, are equally good; the first candidate is then chosen.
TIE = 1e-9
# Accuracy of the efficiency of the continuous design.
OPTIMALITY_GAP = 1e-4


class Task(NamedTuple):
    """Candidates to choose from, and the criterion."""

    base: Floats  # information without any test, (k, k)
    rows: Floats  # of the candidates, (n, k)
    costs: Floats  # (n,)
    targets: Floats | None  # of criterion I, (t, k); None for D

    def information(self, chosen: Sequence[int] | Ints) -> Floats:
        """Return the information of the base and a set of candidates, (k, k)."""
        rows = self.rows[np.asarray(chosen, dtype=int)]
        return self.base + rows.T @ rows

    def loss(self, information: Floats) -> Floats:
        """Return the losses of information matrices, (..., k, k); inf for singular ones."""
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
        """Return how fast the loss falls as information from each candidate is added, (n,)."""
        inverse = np.linalg.inv(information)
        if self.targets is None:
            return np.einsum("nk,kl,nl->n", self.rows, inverse, self.rows)
        products = self.rows @ inverse @ self.targets.T
        return (products**2).sum(axis=1) / np.einsum("tk,kl,tl->", self.targets, inverse, self.targets)


def identified(base: Floats, rows: Floats) -> Floats:
    """Return orthonormal directions, (k, r), that base and rows together determine."""
    root = _root(base)
    stacked = np.vstack([root, rows])
    scale = np.linalg.norm(stacked, axis=0)
    scaled = stacked / np.where(scale > 0.0, scale, 1.0)
    _, values, directions = np.linalg.svd(scaled, full_matrices=False)
    determined = directions[values > SINGULAR * values.max(initial=1e-300)] * scale
    return np.linalg.qr(determined.T)[0]


def _root(information: Floats) -> Floats:
    """Return rows whose information is a given matrix, (k, k)."""
    values, vectors = np.linalg.eigh(information)
    return np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T


def missing_tests(base: Floats, rows: Floats) -> int:
    """Return the least number of tests that make the information regular."""
    return int(rows.shape[1]) - int(np.linalg.matrix_rank(_scaled(base, rows)[0], tol=SINGULAR))


def _scaled(base: Floats, rows: Floats) -> tuple[Floats, Floats]:
    """Return a root of the base and the rows, scaled so that their total information is alike in all directions."""
    root = _root(base)
    stacked = np.vstack([root, rows])
    triangle = np.linalg.qr(stacked, mode="r")
    scaled = np.linalg.solve(np.asarray(triangle).T, stacked.T).T
    # The base alone has lengths up to 1, while one candidate of many has only a small part of the whole.
    scaled /= max(np.linalg.norm(scaled[len(root) :], axis=1).max(), 1e-150)
    return scaled[: len(root)], scaled[len(root) :]


def best_set(task: Task, number: int) -> list[int]:
    """Return a good set of candidates, possibly repeated, in the best order of their tests.

    The first tests, which make the information regular, are chosen together, and each further one by its gain per cost;
    then candidates are exchanged while that improves the set without raising its cost [Fedorov1972].
    """
    start = _sequence(task, np.arange(len(task.rows)), number)
    if number < missing_tests(task.base, task.rows):
        return start
    return ordered(task, _exchanged(task, start, float(task.costs[start].sum())))


def ordered(task: Task, chosen: Sequence[int]) -> list[int]:
    """Return a set in the best order of its tests."""
    return _sequence(task, np.array(sorted(chosen)), len(chosen), repeats=False)


def _sequence(task: Task, allowed: Ints, number: int, *, repeats: bool = True) -> list[int]:
    """Choose from the allowed candidates one after the other; without repeats, each of them once."""
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
    """Return as few candidates as make the information regular, those of the greatest determinant for their cost."""
    rows = task.rows[allowed]
    root, scaled = _scaled(task.base, rows)
    count = missing_tests(task.base, rows)
    if not count:
        return []
    _, values, directions = np.linalg.svd(root, full_matrices=False)
    determined = directions[values > SINGULAR]
    pivots = qr((scaled - scaled @ determined.T @ determined).T, mode="r", pivoting=True)[1]
    # In these coordinates the determinant differs by a constant.
    scaled_task = Task(root.T @ root, scaled, task.costs[allowed], None)
    start = [int(pivot) for pivot in pivots[:count]]
    chosen = _exchanged(scaled_task, start, None)
    # The one with the most information for its cost comes first.
    lengths = (scaled_task.rows[chosen] ** 2).sum(axis=1) / scaled_task.costs[chosen]
    return [int(allowed[chosen[place]]) for place in np.lexsort((chosen, -np.round(lengths / lengths.max(), 9)))]


def _exchanged(task: Task, start: Sequence[int], cost: float | None) -> list[int]:
    """Exchange one candidate at a time for the best other one, up to a total cost.

    Without a bound on the cost, sets are compared by their determinants for the same total cost.
    """
    chosen = [*start]
    products = task.rows[:, :, None] * task.rows[:, None, :]
    for _ in range(1000):
        information, total = task.information(chosen), float(task.costs[chosen].sum())
        best, exchange = _bounded(task, task.loss(information), np.array(total), cost), None
        for place in dict.fromkeys(chosen):
            losses = task.loss(information - products[place] + products)
            losses = _bounded(task, losses, total - task.costs[place] + task.costs, cost)
            new = _first_best(losses)
            if losses[new] < best - TIE * max(1.0, abs(float(best))):
                best, exchange = losses[new], (place, new)
        if exchange is None:
            break
        chosen[chosen.index(exchange[0])] = exchange[1]
    return chosen


def _bounded(task: Task, losses: Floats, totals: Floats, cost: float | None) -> Floats:
    """Return the losses of sets, inf for those that cost too much; without a bound, losses for the same total cost."""
    if cost is None:
        losses, totals = losses + task.rows.shape[1] * np.log(totals), np.zeros_like(totals)
    return np.where(totals <= (cost or 0.0) * (1.0 + TIE), losses, np.inf)


def _first_best(losses: Floats) -> int:
    """Return the first of the least losses."""
    least = float(losses.min())
    return int(np.flatnonzero(losses <= least + TIE * max(1.0, abs(least)))[0]) if np.isfinite(least) else 0


def continuous_design(task: Task, cost: float) -> tuple[Floats, float]:
    """Distribute a cost over the candidates by multiplicative steps, each of which improves the distribution.

    Return the shares of the cost, (n,), and a lower bound on the loss of any distribution, by the equivalence theorem.
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
    # The logarithm of the variance is not convex, so the bound is that of the variance itself.
    bound = gap if task.targets is None else -log(max(1.0 - gap, 1e-300))
    return shares, float(task.loss(information)) - bound


def efficiency(task: Task, chosen: Sequence[int]) -> float:
    """Return the efficiency of a set, 0 to 1: optimal tests would cost at least this fraction as much."""
    least = continuous_design(task, float(task.costs[chosen].sum()))[1]
    excess = float(task.loss(task.information(chosen))) - least
    return min(exp(-excess / (task.rows.shape[1] if task.targets is None else 1)), 1.0)
