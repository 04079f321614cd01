"""Prior knowledge of fitted inputs: the normal and lognormal distributions of a scenario's section [uncertainty]."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from armour.analysis.variants import Bools, Floats, Ints
from armour.errors import InputError, Problem, refuse
from armour.scenario.distributions import Uncertainty, correlation_matrix
from armour.scenario.sampling import centre_and_width
from armour.scenario.scenario import Scenario


class Prior(NamedTuple):
    """Distributions of q of k inputs, normal in the inputs or in their logarithms."""

    where: Ints  # indices of the inputs, (q,)
    logs: Bools  # whether the logarithm is normal, (q,)
    centres: Floats  # of inputs in their units, or of their logarithms, (q,)
    widths: Floats
    root: Floats  # of the inverse of the correlation matrix, (q, q): its transpose times itself

    def scores(self, x: Floats) -> Floats:
        """Return independent standard normal scores of inputs in their units, (q,)."""
        some = x[self.where]
        found: Floats = self.root @ ((np.where(self.logs, np.log(np.abs(some)), some) - self.centres) / self.widths)
        return found

    def rows(self, x: Floats) -> Floats:
        """Return the derivatives of the scores by the inputs, (q, k)."""
        found = np.zeros((len(self.where), len(x)))
        found[:, self.where] = self.root / self.deviations(x)
        return found

    def deviations(self, x: Floats) -> Floats:
        """Return the standard deviations of the inputs near a point, (q,)."""
        found: Floats = self.widths * np.where(self.logs, x[self.where], 1.0)
        return found

    def centred(self, x: Floats) -> Floats:
        """Return a point with the inputs that have a distribution at its centre."""
        found = x.copy()
        found[self.where] = np.where(self.logs, np.exp(self.centres), self.centres)
        return found


NO_PRIOR = Prior(np.empty(0, dtype=int), np.empty(0, dtype=bool), np.empty(0), np.empty(0), np.empty((0, 0)))


def prior_of(scenario: Scenario, names: Sequence[str], units: Floats) -> Prior:
    """Return the distributions that a scenario has of fitted inputs, which must be at least one."""
    section, own = scenario.uncertainty or Uncertainty(), scenario.inputs()
    known = {name: found for name, found in section.inputs().items() if name in names}
    if not known:
        message = f"is missing and must be given for a prior: the distribution of {' or '.join(names)}"
        raise InputError([Problem(scenario.file, "uncertainty", message)])
    problems = []
    for name, found in known.items():
        message = found.mean_problem(own[name])
        if found.distribution == "uniform" or (found.min, found.max) != (None, None):
            message = "must be normal or lognormal, without min and max, to be a prior"
        if message:
            problems.append(Problem(scenario.file, f"uncertainty.{name}", message))
    refuse(problems)
    where = np.array([names.index(name) for name in known])
    logs = np.array([found.distribution == "lognormal" for found in known.values()])
    centres, widths = np.array([centre_and_width(found, own[name]) for name, found in known.items()]).T
    scale = units[where]
    pairs = [pair for pair in section.correlation if {*pair.between} <= {*known}]
    root = np.linalg.inv(np.linalg.cholesky(correlation_matrix([*known], pairs)))
    centres, widths = np.where(logs, (centres - np.log(scale), widths), (centres / scale, widths / scale))
    return Prior(where, logs, centres, widths, root)
