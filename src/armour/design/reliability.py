"""Bounds on the probability that a design is perforated, by sampling the uncertain inputs."""

from math import inf

import numpy as np

from armour.analysis.estimates import Estimate, proportion
from armour.analysis.uncertain_inputs import check_samples, section_of
from armour.analysis.variants import Floats, perforated, variants_of
from armour.design.catalogue import Catalogue
from armour.errors import InputError, Problem
from armour.scenario.distributions import Uncertainty
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC, VELOCITY, inputs_of
from armour.scenario.sampling import columns_of, points_of

# Samples of a design after which it is first checked whether it can still pass.
FIRST_SAMPLES = 256


class Reliability:
    """Bounds of the threats of a catalogue on the probability of perforation.

    Raises
    ------
    InputError
        If there are no distributions, one has a value of its own where designs or threats differ, or there are too few
        samples to show so small a probability.
    """

    def __init__(self, catalogue: Catalogue) -> None:
        self.threats = catalogue.threats
        self.posed = [
            [catalogue.posed(pair, threat) for threat in range(len(self.threats))]
            for pair in range(len(catalogue.offers))
        ]
        section = section_of(self.posed[0][0])
        self._check(section, catalogue.scenario.file)
        self.points = points_of(section)

    def probabilities(self, pair: int, ceramic_mm: float, backing_mm: float) -> dict[str, Estimate] | None:
        """Estimate the probabilities of perforation of a design, by threat that bounds it; None where one is too high.

        Raises
        ------
        InputError
            If a distribution reaches values that are not allowed, or a run does not end.
        """
        found = {}
        for threat, posed in zip(self.threats, self.posed[pair], strict=True):
            if threat.probability_of_perforation is not None:
                bound = threat.probability_of_perforation
                estimate = probability_within(posed, self.points, ceramic_mm, backing_mm, bound)
                if estimate is None:
                    return None
                found[threat.title] = estimate
        return found

    def _check(self, section: Uncertainty, file: str) -> None:
        """Check that the distributions follow designs, materials and threats, and that the samples suffice."""
        owns = [inputs_of(scenario) for scenarios in self.posed for scenario in scenarios]
        problems = []
        for name, distribution in section.inputs().items():
            values = {own.get(name) for own in owns}
            if distribution.placed and (len(values) > 1 or name in (VELOCITY, CERAMIC, BACKING)):
                message = (
                    "must be about the value of each design or threat: normal or lognormal, without mean, min and max"
                )
                problems.append(Problem(file, f"uncertainty.{name}", message))
        bound = min(threat.probability_of_perforation or inf for threat in self.threats)
        if proportion(0, section.samples).high > bound:
            message = f"must be more to show a probability of perforation of {bound:g}, found {section.samples}"
            problems.append(Problem(file, "uncertainty.samples", message))
        if problems:
            raise InputError(problems)


def probability_within(
    scenario: Scenario, points: Floats, ceramic_mm: float, backing_mm: float, bound: float
) -> Estimate | None:
    """Estimate the probability of perforation of a design; None where its interval reaches beyond a bound.

    Samples are taken in growing parts, only as many as it takes to see that the bound is exceeded.

    Parameters
    ----------
    scenario : Scenario
        Materials of the design and the threat, with distributions.
    points : array, (samples, inputs)
        Points of the unit cube, see `armour.scenario.sampling.points_of`.
    ceramic_mm, backing_mm : float
        Thicknesses of the design, mm.
    bound : float
        Largest probability allowed.

    Raises
    ------
    InputError
        If a distribution reaches values that are not allowed, or a run does not end.
    """
    section = section_of(scenario)
    own = {**inputs_of(scenario), CERAMIC: ceramic_mm, BACKING: backing_mm}
    hits, start, end = 0, 0, FIRST_SAMPLES
    while start < len(points):
        part = points[start:end]
        columns = columns_of(section, own, part)
        if any(not np.isfinite(values).all() or values.min() <= 0.0 for values in columns.values()):
            check_samples(scenario, columns)
        for name in (CERAMIC, BACKING):
            columns.setdefault(name, np.full(len(part), own[name]))
        hits += int(perforated(variants_of(scenario, columns, len(part))).sum())
        estimate = proportion(hits, len(points))
        if estimate.high > bound:
            return None
        start, end = end, 2 * end
    return estimate
