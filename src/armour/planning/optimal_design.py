"""Optimal design of experiments: which of n candidate tests to make, given the information that each gives.

A test gives the information f f' of k parameters, f one of the rows (n, k).  The information M of several tests is the
sum, with that of a base, from tests made before or a prior.  The criterion is to be minimised: for D, minus the
logarithm of the determinant of M; for I, the logarithm of the mean of c' M^-1 c over the targets c, (t, k).
"""

from collections.abc import Sequence
from math import exp, log
from typing import NamedTuple

import numpy as np
from scipy.linalg import qr

from armour.analysis.variants import Floats, Ints

# Part of the greatest singular value, of scaled rows, below which a direction is not determined; the derivatives are
# accurate to a tenth of it.
SINGULAR = 1e-3
# Relative difference below which two sets are equally good; the first candidate is then chosen.
TIE = 1e-9
# Accuracy of the efficiency of the continuous design, and most steps towards it.
GAP, MAX_STEPS = 1e-4, 20_000
# Exchanges after which a search ends in any case; each makes the set better.
MAX_EXCHANGES = 1000


class Task(NamedTuple):
    """What to choose from."""

    base: Floats  # information that there is, (k, k)
    rows: Floats  # of the candidates, (n, k)
    costs: Floats  # (n,)
    targets: Floats | None  # of criterion I, (t, k); None for D

    def information(self, chosen: Sequence[int] | Ints) -> Floats:
        """Return the information of a set of candidates with the base, (k, k)."""
        rows = self.rows[np.asarray(chosen, dtype=int)]
        return self.base + rows.T @ rows

    def loss(self, information: Floats) -> Floats:
        """Return the criterion of matrices, (..., k, k): less is better, inf for singular ones."""
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
        """Return how fast the criterion falls when information is added in the direction of each candidate, (n,)."""
        inverse = np.linalg.inv(information)
        if self.targets is None:
            return np.einsum("nk,kl,nl->n", self.rows, inverse, self.rows)
        products = self.rows @ inverse @ self.targets.T
        return (products**2).sum(axis=1) / np.einsum("tk,kl,tl->", self.targets, inverse, self.targets)


def identified(base: Floats, rows: Floats) -> Floats:
    """Return the directions, orthonormal columns (k, r), of which base and rows together inform."""
    root = _root(base)
    every = np.vstack([root, rows])
    scale = np.linalg.norm(every, axis=0)
    scaled = every / np.where(scale > 0.0, scale, 1.0)
    _, values, directions = np.linalg.svd(scaled, full_matrices=False)
    kept = directions[values > SINGULAR * values.max(initial=1e-300)] * scale
    return np.linalg.qr(kept.T)[0]


def _root(information: Floats) -> Floats:
    """Return rows whose information is that of a matrix, (k, k)."""
    values, vectors = np.linalg.eigh(information)
    return np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T


def missing(base: Floats, rows: Floats) -> int:
    """Return the least number of candidates that make the matrix of the base regular."""
    return int(rows.shape[1]) - int(np.linalg.matrix_rank(_scaled(base, rows)[0], tol=SINGULAR))


def _scaled(base: Floats, rows: Floats) -> tuple[Floats, Floats]:
    """Return roots of the base and the rows in coordinates in which all of them together inform alike."""
    root = _root(base)
    every = np.vstack([root, rows])
    triangle = np.linalg.qr(every, mode="r")
    scaled = np.linalg.solve(np.asarray(triangle).T, every.T).T
    # A base alone has lengths up to 1; one candidate of many has little of the whole.
    scaled /= max(np.linalg.norm(scaled[len(root) :], axis=1).max(), 1e-150)
    return scaled[: len(root)], scaled[len(root) :]


def best_set(task: Task, number: int) -> list[int]:
    """Return a good set of candidates, repeats allowed, in the order in which they are best made.

    The first tests, up to a regular matrix, are chosen together, each further one by its gain per cost; then
    candidates are exchanged while that improves the set without raising its cost [Fedorov1972].
    """
    start = _sequence(task, np.arange(len(task.rows)), number)
    if number < missing(task.base, task.rows):
        return start
    return ordered(task, _exchanged(task, start, float(task.costs[start].sum())))


def ordered(task: Task, chosen: Sequence[int]) -> list[int]:
    """Return a set in the order in which its tests are best made."""
    return _sequence(task, np.array(sorted(chosen)), len(chosen), repeats=False)


def _sequence(task: Task, allowed: Ints, number: int, *, repeats: bool = True) -> list[int]:
    """Choose from the allowed candidates one after the other; without repeats each of them once."""
    chosen, left = _first(task, np.unique(allowed))[:number], allowed.tolist()
    if not repeats:
        for place in chosen:
            left.remove(place)
    while len(chosen) < number:
        places, information = np.unique(left), task.information(chosen)
        rows = task.rows[places]
        gains = task.loss(information) - task.loss(information + rows[:, :, None] * rows[:, None, :])
        chosen.append(int(places[_first_best(-gains / task.costs[places])]))
        if not repeats:
            left.remove(chosen[-1])
    return chosen


def _first(task: Task, allowed: Ints) -> list[int]:
    """Return as few candidates as make the matrix regular, those of the greatest determinant for their cost."""
    rows = task.rows[allowed]
    root, scaled = _scaled(task.base, rows)
    needed = missing(task.base, rows)
    if not needed:
        return []
    _, values, directions = np.linalg.svd(root, full_matrices=False)
    informed = directions[values > SINGULAR]
    pivots = qr((scaled - scaled @ informed.T @ informed).T, mode="r", pivoting=True)[1]
    # In these coordinates the determinant differs by a constant.
    inner = Task(root.T @ root, scaled, task.costs[allowed], None)
    start = [int(pivot) for pivot in pivots[:needed]]
    chosen = _exchanged(inner, start, None)
    # From the one that informs most for its cost on.
    lengths = (inner.rows[chosen] ** 2).sum(axis=1) / inner.costs[chosen]
    return [int(allowed[chosen[place]]) for place in np.lexsort((chosen, -np.round(lengths / lengths.max(), 9)))]


def _exchanged(task: Task, start: Sequence[int], cost: float | None) -> list[int]:
    """Exchange one candidate at a time for the one that makes the set best, at most at a cost.

    Without one, the determinant is compared for the same total cost.
    """
    chosen = [*start]
    products = task.rows[:, :, None] * task.rows[:, None, :]
    for _ in range(MAX_EXCHANGES):
        information, total = task.information(chosen), float(task.costs[chosen].sum())
        best, exchange = _worth(task, task.loss(information), np.array(total), cost), None
        for place in dict.fromkeys(chosen):
            losses = task.loss(information - products[place] + products)
            losses = _worth(task, losses, total - task.costs[place] + task.costs, cost)
            new = _first_best(losses)
            if losses[new] < best - TIE * max(1.0, abs(float(best))):
                best, exchange = losses[new], (place, new)
        if exchange is None:
            break
        chosen[chosen.index(exchange[0])] = exchange[1]
    return chosen


def _worth(task: Task, losses: Floats, totals: Floats, cost: float | None) -> Floats:
    """Return losses of sets, inf for those that cost too much; without a bound, losses for the same total cost."""
    if cost is None:
        losses, totals = losses + task.rows.shape[1] * np.log(totals), np.zeros_like(totals)
    return np.where(totals <= (cost or 0.0) * (1.0 + TIE), losses, np.inf)


def _first_best(losses: Floats) -> int:
    """Return the first of the least losses."""
    least = float(losses.min())
    return int(np.flatnonzero(losses <= least + TIE * max(1.0, abs(least)))[0]) if np.isfinite(least) else 0


def continuous(task: Task, cost: float) -> tuple[Floats, float]:
    """Distribute a cost over the candidates by multiplicative steps, each of which makes the distribution better.

    Return the shares of the cost, (n,), and what no distribution's loss falls below, by the equivalence theorem.
    """
    rows = task.rows * np.sqrt(cost / task.costs)[:, None]
    whole = task._replace(rows=rows)
    shares = np.full(len(rows), 1.0 / len(rows))
    power = 1.0 if task.targets is None else 0.5
    for _ in range(MAX_STEPS):
        information = task.base + (rows * shares[:, None]).T @ rows
        slopes = whole.sensitivities(information)
        gap = float(slopes.max()) - float(shares @ slopes)
        if gap < GAP:
            break
        better = shares * slopes**power
        shares = better / better.sum()
    # The logarithm of the variance is no convex function: the bound is that of the variance.
    bound = gap if task.targets is None else -log(max(1.0 - gap, 1e-300))
    return shares, float(task.loss(information)) - bound


def efficiency(task: Task, chosen: Sequence[int]) -> float:
    """Return the efficiency of a set, 0 to 1: optimal tests would need at least this part of the cost."""
    least = continuous(task, float(task.costs[chosen].sum()))[1]
    worse = float(task.loss(task.information(chosen))) - least
    return min(exp(-worse / (task.rows.shape[1] if task.targets is None else 1)), 1.0)
