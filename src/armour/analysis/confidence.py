"""Confidence in an answer: the probability that an armour defeats its threat, given the error of the model."""

from dataclasses import dataclass

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.progress import OnProgress, ignore_progress
from armour.analysis.results import Result
from armour.errors import NoLimitError
from armour.scenario.checked import checked
from armour.scenario.evidence import ModelError
from armour.scenario.scenario import Scenario

NO_TEST = "the model was compared with no test of such an armour"
# Probability above which a lower bound is given as the probability.
SURE = 0.995
EXCLUDED = "uncertainty.model says not to include the error of the model"


@dataclass(frozen=True, repr=False)
class ConfidenceResult(Result):
    """Probability that an armour defeats its threat.

    Attributes
    ----------
    probability_of_defeat : float or None
        Probability that the ballistic limit of the armour exceeds the impact velocity; None where it is not known.
        Where no velocity of the search perforates, it is a lower bound, given if it exceeds 0.995.
    ballistic_limit_m_s : float or None
        By the model, m/s; None where there is none in the range of the search.
    model_error : ModelError or None
        Relative error of the ballistic limit by the model.
    reason : str
        Why the probability is not known.
    warnings : tuple of str
        Ways in which the scenario is unlike what the model was compared with.
    """

    probability_of_defeat: float | None
    ballistic_limit_m_s: float | None
    model_error: ModelError | None
    reason: str = ""
    warnings: tuple[str, ...] = ()

    def _words(self) -> str:
        if self.probability_of_defeat is None:
            return "probability of defeat not known"
        return f"probability of defeat {self.probability_of_defeat:.3f}"


@checked
def confidence(scenario: Scenario, *, on_progress: OnProgress = ignore_progress) -> ConfidenceResult:
    """Compute the probability that the armour of a scenario defeats its threat, the projectile at its impact velocity.

    The inputs are taken as exact; `armour.uncertainty` includes their distributions too.

    Parameters
    ----------
    scenario : Scenario
        Its section ``uncertainty.model`` gives the error of the model; by default it is that of tests of such armours.
    on_progress : callable, optional
        Called with the number of impacts computed since the last call, and None, as their total is not known.

    Returns
    -------
    ConfidenceResult

    Raises
    ------
    InputError
        If a run does not end within the maximum number of steps.
    """
    try:
        limit = ballistic_limit(scenario, on_progress=on_progress).ballistic_limit_m_s
    except NoLimitError as error:
        found = without_limit(scenario, str(error), above=error.above)
    else:
        found = of_limit(scenario, limit, scenario.impact.velocity_m_s)
    return found._of(scenario.subject(), scenario=scenario)


def without_limit(scenario: Scenario, reason: str, *, above: bool) -> ConfidenceResult:
    """Return the confidence in an armour whose limit is not in the range searched, for a reason, or is above it."""
    error, velocity = scenario.model_error(), scenario.impact.velocity_m_s
    warnings = scenario.warnings(velocity)
    if error is not None and above:
        least = float(error.probability_of_defeat(scenario.ballistic_limit.velocity_max_m_s, velocity))
        if least > SURE:
            return ConfidenceResult(least, None, error, warnings=warnings)
    return ConfidenceResult(None, None, error, reason, warnings)


def of_limit(scenario: Scenario, limit_m_s: float, velocity_m_s: float) -> ConfidenceResult:
    """Return the confidence that a scenario's armour defeats a velocity, given its ballistic limit by the model."""
    error, warnings = scenario.model_error(), scenario.warnings(velocity_m_s)
    if error is None:
        return ConfidenceResult(None, limit_m_s, None, EXCLUDED if scenario.excludes_error() else NO_TEST, warnings)
    probability = float(error.probability_of_defeat(limit_m_s, velocity_m_s))
    return ConfidenceResult(probability, limit_m_s, error, warnings=warnings)
