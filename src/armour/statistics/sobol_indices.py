"""Sobol' indices: the shares of a variance that inputs explain, estimated from independent replicates of samples."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial.hermite_e import hermevander
from numpy.polynomial.legendre import legvander
from scipy.special import ndtri

from armour.analysis.estimates import Estimate, jackknife
from armour.analysis.variants import Floats
from armour.scenario.distributions import Uncertainty
from armour.scenario.sampling import REPLICATES, correlated, replicated_points

# Degree of the polynomials of one input.
DEGREE = 8


def first_order_indices(section: Uncertainty, points: Floats, values: Floats) -> list[Estimate]:
    """Estimate the first-order index of each input, correlated or not, from the values, (n,), at points, (n, inputs).

    It is the share of the variance that a polynomial of the input explains: of the uniform or normal score, in which a
    value as a function of the input is about a straight line.
    """
    uniform = [distribution.distribution == "uniform" for distribution in section.inputs().values()]
    replicates = zip(np.array_split(points, REPLICATES), np.array_split(_scaled(values), REPLICATES), strict=True)
    moments = [
        [_moments(_basis(*of_input), scaled) for of_input in zip(correlated(section, part).T, uniform, strict=True)]
        for part, scaled in replicates
    ]
    return [jackknife(_explained, of_input) for of_input in np.array(moments).swapaxes(0, 1)]


def _basis(chances: Floats, uniform: bool) -> Floats:
    """Return polynomials, (n, terms), of the uniform or normal score of an input."""
    found = legvander(2.0 * chances - 1.0, DEGREE) if uniform else hermevander(ndtri(chances), DEGREE)
    return np.asarray(found, dtype=np.float64)


def _moments(basis: Floats, values: Floats) -> Floats:
    """Return the sums of products of the columns of a basis, (n, terms), and values, (n,)."""
    columns = np.column_stack([basis, values])
    found: Floats = columns.T @ columns
    return found


def _explained(moments: Floats) -> Floats:
    """Return the share of the variance that a regression on a basis explains, from stacked moments."""
    basis, products, squares = moments[:, :-1, :-1], moments[:, :-1, -1], moments[:, -1, -1]
    fitted = np.einsum("ni,ni->n", products, np.linalg.solve(basis, products[..., None])[..., 0])
    mean = products[:, 0] ** 2 / basis[:, 0, 0]
    found: Floats = (fitted - mean) / (squares - mean)
    return found


def total_indices(
    function: Callable[[Floats], Floats], places: Sequence[int], inputs: int, samples: int, seed: int
) -> list[Estimate]:
    """Estimate the total index of some of the inputs, which are independent, by the estimator of [Jansen1999].

    The function maps points of the unit cube, (n, inputs), to values, (n,); the number of samples is a power of 2.
    """
    points, others = np.split(replicated_points("sobol", 2 * inputs, samples, seed), 2, axis=1)
    values = function(points)
    sums = [_sums(values**0), _sums(values - values[0]), _sums((values - values[0]) ** 2)]
    found = []
    for place in places:
        mixed = points.copy()
        mixed[:, place] = others[:, place]
        changes = _sums(0.5 * (function(mixed) - values) ** 2)
        found.append(jackknife(_changed, np.column_stack([*sums, changes])))
    return found


def _changed(sums: Floats) -> Floats:
    """Return the total index from stacked sums of 1, values, their squares and half the squares of their changes."""
    count, values, squares, changes = sums.T
    found: Floats = changes / (squares - values**2 / count)
    return found


def _sums(values: Floats) -> Floats:
    """Return the sum over each replicate."""
    return np.array([part.sum() for part in np.array_split(values, REPLICATES)])


def _scaled(values: Floats) -> Floats:
    """Return values with the mean 0 and the standard deviation 1."""
    found: Floats = (values - values.mean()) / values.std()
    return found
