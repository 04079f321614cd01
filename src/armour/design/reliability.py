"""Bounds on the probability that a design is perforated, by sampling the uncertain inputs."""

from functools import lru_cache
from math import ceil, log, log1p

import numpy as np

from armour.analysis.estimates import TAIL, Estimate, proportion
from armour.analysis.results import OnProgress, ignore_progress
from armour.analysis.samples import columns_of, own_errors, own_values, points_of, sampled, section_at, section_of
from armour.analysis.variants import perforated
from armour.design.catalogue import NO_BOUND, CandidateDesigns, Catalogue
from armour.errors import Problem, refuse
from armour.evidence.model_error import Errors
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.scenario import Scenario
from armour.scenario.schema import MAX_SAMPLES, Uncertainty

# Number of samples after which a design is first checked for whether it can still pass.
FIRST_SAMPLES = 64
# Sampling stops early if the number of perforations would be less probable than this were the bound to hold.
IMPROBABLE = 1e-9
# Samples that are computed at a time at most, which bounds the memory.
MOST_SAMPLES = 2**15
# Scenarios of pairs of materials and threats that are kept.
MOST_SCENARIOS = 1000


class Reliability:
    """Bounds of the threats of a catalogue on the probability of perforation, with the samples to estimate it."""

    def __init__(self, catalogue: Catalogue, on_progress: OnProgress = ignore_progress) -> None:
        self.catalogue, self.on_progress = catalogue, on_progress
        # Many designs have the same materials, and making a scenario is slow.
        self.against = lru_cache(MOST_SCENARIOS)(catalogue.against)
        section = section_of(self.against(0, 0))
        _check(catalogue, section)
        # Points of the unit cube, (samples, inputs), the model error included.
        self.points = points_of(section.with_error())

    def probabilities(self, candidates: CandidateDesigns, place: int) -> dict[str, Estimate] | None:
        """Estimate the probabilities of perforation of a design, see `Search.probabilities`."""
        thicknesses = {CERAMIC: float(candidates.ceramic_mm[place]), BACKING: float(candidates.backing_mm[place])}
        estimates = {}
        for i, threat in enumerate(self.catalogue.threats):
            bound = float(self.catalogue.bounds[i])
            if bound < NO_BOUND:
                scenario = self.against(int(candidates.pair[place]), i)
                layers = {key: thicknesses[key] for key in thicknesses if key in scenario.inputs()}
                errors = own_errors(scenario, layers)
                is_known = scenario.excludes_error() or errors.known.all()
                if self.catalogue.lenient and not is_known:
                    continue
                estimate = self.within(bound, scenario, layers, errors) if is_known else None
                if estimate is None:
                    return None
                estimates[threat.title] = estimate
        return estimates

    def within(self, bound: float, scenario: Scenario, layers: dict[str, float], errors: Errors) -> Estimate | None:
        """Estimate the probability of perforation of a design; None if its interval exceeds a bound.

        The layers are their thicknesses, by input.  A model error that is not known is left out.  Samples are taken in
        growing parts, until these show that the bound is exceeded.
        """
        from scipy.special import bdtrc  # slow to import

        values = own_values(scenario) | layers
        section = section_at(scenario, values, with_error=bool(errors.known.all()))
        points = self.points[:, : len(section.inputs())]
        hits, start, end = 0, 0, FIRST_SAMPLES
        while start < len(points):
            part = points[start:end]
            columns = columns_of(section, values, part)
            if layers.get(CERAMIC) == 0.0:
                columns.pop(CERAMIC, None)  # an absent layer has no thickness to vary
            columns = {**{name: np.full(len(part), value) for name, value in layers.items()}, **columns}
            hits += int(perforated(sampled(scenario, columns, len(part), errors).variants).sum())
            estimate = proportion(hits, len(points))
            self.on_progress(len(part), None)
            if estimate.high > bound or bdtrc(hits - 1, end, bound) < IMPROBABLE:
                return None
            start, end = end, end + min(end, MOST_SAMPLES)
        return estimate


def _check(catalogue: Catalogue, section: Uncertainty) -> None:
    """Check that the distributions apply to every design, material and threat, and that there are enough samples."""
    file = catalogue.scenario.file
    problems = []
    for name, distribution in section.inputs().items():
        if distribution.placed and name in catalogue.varying:
            message = (
                "must be centred on the value of each design or threat: normal or lognormal, without mean, min and "
                'max, such as { distribution = "normal", standard_deviation_percent = 1.0 }'
            )
            problems.append(Problem(file, f"uncertainty.{name}", message))
    bound = float(catalogue.bounds.min())
    if proportion(0, section.samples).high > bound:
        # Without a perforation, the upper end of the Clopper-Pearson interval is 1 - (tail)^(1/n).
        needed = ceil(log(TAIL) / log1p(-bound))
        message = f"must be at least {needed} to show a probability of perforation of {bound:g}"
        too_many = f" (at most {MAX_SAMPLES} are allowed: raise the bound)" if needed > MAX_SAMPLES else ""
        problems.append(Problem(file, "uncertainty.samples", f"{message}{too_many}, found {section.samples}"))
    refuse(problems)
