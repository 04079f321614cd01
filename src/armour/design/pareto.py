"""The Pareto front: designs that no other betters in one criterion without being worse in another."""

from collections.abc import Callable

import numpy as np

from armour.analysis.variants import Bools, Floats, Ints


def undominated(costs: Floats) -> Ints:
    """Return the rows that no other row dominates; of equal rows the first.

    A row dominates another if it is at most equal to it in every column and less in one.
    """
    left = np.lexsort(costs.T[::-1])
    front = []
    while len(left):
        front.append(int(left[0]))
        left = left[(costs[left] < costs[left[0]]).any(axis=1)]
    return np.array(front, dtype=np.int64)


def verified_front(costs: Floats, verify: Callable[[Ints], tuple[Bools, Floats]]) -> Ints:
    """Return the Pareto front of designs of which only the members of the front are verified.

    Parameters
    ----------
    costs : array, (n, criteria)
        Criteria to minimise; replaced by the verified ones in place.
    verify : callable
        Whether some designs count, and their verified criteria.
    """
    alive, checked = np.ones(len(costs), dtype=bool), np.zeros(len(costs), dtype=bool)
    while True:
        there = np.flatnonzero(alive)
        front = there[undominated(costs[there])]
        new = front[~checked[front]]
        if not len(new):
            return front
        alive[new], costs[new] = verify(new)
        checked[new] = True
