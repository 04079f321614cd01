"""Probabilities that designs are perforated, by sampling the uncertain inputs."""

from functools import lru_cache
from math import ceil, log, log1p

from armour.analysis.estimates import INTERVAL_TAIL, Estimate, proportion
from armour.analysis.perforation import is_sampled, points_within, probability_of_perforation
from armour.analysis.results import OnProgress, ignore_progress
from armour.analysis.samples import section_of
from armour.design.catalogue import NO_BOUND, CandidateDesigns, Catalogue
from armour.errors import Problem, refuse
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.schema import MAX_SAMPLES, Uncertainty

# Scenarios of pairs of materials and threats that are kept.
MOST_SCENARIOS = 1000


class Reliability:
    """Probabilities of perforation of the designs of a catalogue, with the samples to estimate them."""

    def __init__(self, catalogue: Catalogue, on_progress: OnProgress = ignore_progress) -> None:
        self.catalogue, self.on_progress = catalogue, on_progress
        # Many designs have the same materials, and making a scenario is slow.
        self.against = lru_cache(MOST_SCENARIOS)(catalogue.against)
        _check(catalogue, section_of(self.against(0, 0)))
        self.points = points_within(catalogue.scenario.uncertainty or Uncertainty())

    def probabilities(self, candidates: CandidateDesigns, place: int, *, quick: bool) -> dict[str, Estimate]:
        """Estimate the probabilities of perforation of a design, by threat that bounds it, where they are known."""
        thicknesses = {CERAMIC: float(candidates.ceramic_mm[place]), BACKING: float(candidates.backing_mm[place])}
        estimates = {}
        for threat, (title, bound) in enumerate(zip(self.catalogue.titles, self.catalogue.bounds, strict=True)):
            if bound < NO_BOUND:
                scenario = self.against(int(candidates.pair[place]), threat)
                layers = {key: thicknesses[key] for key in thicknesses if key in scenario.inputs()}
                if is_sampled(scenario, layers):
                    estimates[title] = probability_of_perforation(
                        scenario, float(bound), layers, self.points, self.on_progress, quick=quick
                    )
        return estimates


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
    if catalogue.scenario.excludes_error() and proportion(0, section.samples).high > bound:
        # Without a perforation, the upper end of the Clopper-Pearson interval is 1 - (tail)^(1/n).
        needed = ceil(log(INTERVAL_TAIL) / log1p(-bound))
        message = f"must be at least {needed} to show a probability of perforation of {bound:g}"
        too_many = f" (at most {MAX_SAMPLES} are allowed: raise the bound)" if needed > MAX_SAMPLES else ""
        problems.append(Problem(file, "uncertainty.samples", f"{message}{too_many}, found {section.samples}"))
    refuse(problems)
