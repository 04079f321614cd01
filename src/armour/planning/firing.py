"""Plan the next shot of a V50 firing."""

from dataclasses import dataclass
from math import inf
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from armour.analysis.ballistic_limit import LimitResult, ballistic_limit
from armour.analysis.estimates import CONFIDENCE, Confidence
from armour.analysis.results import OnProgress, Result, ignore_progress
from armour.errors import Note, Problem, mistake, refuse
from armour.evidence.model_error import SCATTER_FACTOR, SCATTER_PERCENT, ModelError
from armour.planning import procedures
from armour.planning.procedures import OperatingPoint, ShotSettings
from armour.scenario.checked import checked
from armour.scenario.scenario import ANY_VELOCITY, Scenario
from armour.statistics import v50
from armour.statistics.curves import FittedCurve
from armour.statistics.posterior import FiringEstimate, FiringPrior, Posterior, expected, learned, posterior_of
from armour.statistics.v50 import Fraction, MeanV50, Shots, Velocity

Procedure = Literal["bayesian", "neyer", "langlie", "up-and-down"]
# Procedures that start from limits of V50 and have no requirement.
LIMITED = ("langlie", "neyer")
HALF_WIDTH_M_S = 15.0
# Without a model error, V50 is expected within the fraction WIDE of the model's limit or of the middle of the shots,
# with a probability of 95 %; WITHIN is the normal quantile for this probability, and NORMAL are degrees of
# freedom at which Student's t distribution is practically normal.
WIDE, WITHIN, NORMAL = 0.3, 1.96, 1e6


@dataclass(frozen=True)
class PlanCurve:
    """Prior and posterior of V50 over velocity, for a chart."""

    velocity_m_s: tuple[float, ...]
    prior: tuple[float, ...]  # probability density of V50, s/m
    posterior: tuple[float, ...]  # probability density of V50, s/m
    probability: tuple[float, ...]  # of complete penetration, by the posterior


@dataclass(frozen=True, repr=False)
class ShotPlan(Result):
    """Plan of a V50 firing.

    Attributes
    ----------
    procedure : {"bayesian", "neyer", "langlie", "up-and-down"}
    fired : Shots
        The shots so far.
    next_velocity_m_s : float or None
        Velocity of the next shot, m/s; None if the firing has ended.
    reason : str
        Reason for the next velocity.
    stopped : str
        Reason why the firing has ended; empty while it continues.
    expected_shots : float or None
        Median number of further shots in simulated continuations by the Bayesian procedure; None if it exceeds 100,
        and for the other procedures.
    confidence : float
        Confidence level of the intervals and of the requirement.
    half_width_m_s : float or None
        Half width of the interval of V50 at which the firing ends, m/s.
    requirement_m_s : float or None
        Required velocity, m/s.
    requirement_fraction : float
        Fraction of shots that may perforate at the required velocity.
    probability_met : float or None
        Probability that the requirement is met, by the posterior.
    decision : {"met", "not met", "not decided", ""}
        Whether the requirement is met; "not decided" if the firing has ended without a decision; empty without a
        requirement, and while it is undecided.
    consumers_risk, producers_risk : float or None
        Greatest probability that armour which does not meet the requirement is accepted, and that armour which meets it
        is rejected: 1 minus the confidence.  None without a requirement.
    evidence_met, evidence_not_met : float or None
        Evidence for and against the requirement.  ``evidence_met`` is the likelihood of the shots averaged over curves
        that meet the requirement, divided by the greatest likelihood of a curve that does not; ``evidence_not_met`` is
        the reverse.  The decision is made once either is at least the inverse of the risk.
    operating_characteristic : tuple of OperatingPoint
        Outcomes of simulated firings at armours around the requirement, with a V50 ``v50_m_s`` and a scatter
        ``scatter_m_s``, m/s: the fractions of firings that end with the requirement ``met`` and ``not_met``, and the
        median number of ``shots``, None above 100.  Empty once a shot has been fired.
    scatter_percent, scatter_factor : float
        Expected scatter, per cent of V50, and the factor by which it may differ.
    limits_m_s : tuple of float or None
        Limits of V50 that Langlie's and Neyer's procedures start from, m/s.
    prior, posterior : FiringEstimate
        V50 and the scatter without and with the shots.
    prior_share : float
        Share of the prior in the precision of V50: its posterior variance divided by its prior variance.
    expected_from : str
        Source of the prior of V50: tests of such armours, limits, or shots.
    recommended : FittedCurve or None
        Probit curve of the shots alone that `armour.v50` recommends; None without one, and for the Bayesian procedure.
    mean : MeanV50 or None
        Mean of MIL-STD-662F of three shots of each kind, for the up-and-down rule; None without such shots
        within its span.
    model_ballistic_limit_m_s : float or None
        Ballistic limit by the model, m/s; None without a scenario.
    model_error : ModelError or None
        Relative error of the model's limit.
    curve : PlanCurve
        Over ``velocity_m_s``, m/s: the densities of V50, ``prior`` and ``posterior``, s/m, and by the posterior the
        ``probability`` of complete penetration.
    contradicts_prior : bool
        Whether the posterior median of V50 or of the scatter lies outside its 99 % interval by the prior.
    notes : tuple of Note
        Shots far from the others or contradicting the prior, and ways in which the scenario differs from what the model
        was compared with.
    """

    procedure: str
    fired: Shots
    next_velocity_m_s: float | None
    reason: str
    stopped: str
    expected_shots: float | None
    confidence: float
    half_width_m_s: float | None
    requirement_m_s: float | None
    requirement_fraction: float
    probability_met: float | None
    limits_m_s: tuple[float, float] | None
    prior: FiringEstimate
    posterior: FiringEstimate
    prior_share: float
    recommended: FittedCurve | None
    mean: MeanV50 | None
    model_ballistic_limit_m_s: float | None
    model_error: ModelError | None
    expected_from: str
    curve: PlanCurve
    contradicts_prior: bool = False
    decision: str = ""
    consumers_risk: float | None = None
    producers_risk: float | None = None
    evidence_met: float | None = None
    evidence_not_met: float | None = None
    operating_characteristic: tuple[OperatingPoint, ...] = ()
    scatter_percent: float = SCATTER_PERCENT
    scatter_factor: float = SCATTER_FACTOR
    notes: tuple[Note, ...] = ()


@checked
def plan_shots(
    scenario: Scenario | None = None,
    shots: Shots | None = None,
    *,
    procedure: Procedure = "bayesian",
    half_width_m_s: Annotated[float, Field(ge=0.1, le=v50.MAX_VELOCITY_M_S)] | None = None,
    confidence: Confidence = CONFIDENCE,
    requirement_m_s: Velocity | None = None,
    requirement_fraction: Fraction = 0.5,
    scatter_percent: Annotated[float, Field(ge=0.01, le=50.0)] = SCATTER_PERCENT,
    scatter_factor: Annotated[float, Field(ge=1.01, le=10.0)] = SCATTER_FACTOR,
    limits_m_s: Annotated[tuple[Velocity, Velocity], Field(strict=False)] | None = None,
    on_progress: OnProgress = ignore_progress,
) -> ShotPlan:
    """Plan the next shot of a V50 firing.

    Parameters
    ----------
    scenario : Scenario, optional
        Armour and projectile; its ballistic limit by the model, with the model error, is the prior of V50.  Without
        a scenario, or if the error is not known, V50 is expected within ``limits_m_s`` or, without these, within 30 %
        of the model's limit or of the middle of the shots.
    shots : Shots, optional
        Shots so far, possibly all of one kind.
    procedure : {"bayesian", "neyer", "langlie", "up-and-down"}
        Rule for the next velocity: bayesian, neyer, langlie or up-and-down.
    half_width_m_s : float, optional
        Half width of the interval of V50 at which the firing ends, 0.1 to 10,000 m/s; by default 15.  The up-and-down
        rule ends by default as in MIL-STD-662F, with three shots of each kind within 27.432 m/s.
    confidence : float, default 0.95
        Confidence level of the interval, and of the requirement, 0.5 to 0.9999.
    requirement_m_s : float, optional
        Required velocity, m/s.  The Bayesian procedure then ends when the shots show that the requirement is met or not
        met, with the consumer's and the producer's risk each at most 1 minus the confidence; the up-and-down rule
        starts above it.
    requirement_fraction : float
        Fraction of shots that may perforate at the required velocity, 0.001 to 0.999; 0.5 sets the requirement on V50.
    scatter_percent : float, default 2.0
        Expected scatter, the standard deviation of the response curve, 0.01 to 50 % of V50: the median of its prior,
        and the initial guess of Neyer's procedure.
    scatter_factor : float, default 2.0
        Factor by which the scatter may differ from the expected one, 1.01 to 10: one standard deviation of its
        logarithm.
    limits_m_s : tuple of float, optional
        Limits of V50, m/s, that Langlie's and Neyer's procedures start from, by default the interval of the model's
        limit with a probability of 99 %.  For the other procedures, the range in which V50 is expected if the model
        error is not known.
    on_progress : callable, optional
        Called with the number of impacts computed since the last call, and None, as the total is not known.

    Returns
    -------
    ShotPlan

    Raises
    ------
    InputError
        If a setting is out of its range or has no effect, or there is no scenario, shot or limit to expect V50 from.
    NoLimitError
        If the scenario has no ballistic limit in the range of the search.

    Examples
    --------
    >>> import armour
    >>> plan = armour.plan_shots(armour.load_scenario("wilkins"))
    >>> round(plan.next_velocity_m_s, 1)
    726.8
    """
    shots = shots or Shots((), ())
    v50.check_shots(shots, kinds=0, decides=requirement_m_s is not None)
    refuse(Problem(shots.file, v50.TARGET, wrong) for wrong in (v50.of_another(shots, scenario) if scenario else ()))
    v50.check_not_swapped(shots)
    required, is_bayesian = requirement_m_s is not None, procedure == "bayesian"
    conflicts = {}
    if requirement_fraction != 0.5 and not required:
        conflicts["requirement_fraction"] = "must not be given without a requirement"
    if required and procedure in LIMITED:
        conflicts["requirement_m_s"] = f"must not be given with {procedure}, which cannot decide on a requirement"
    if half_width_m_s and required and is_bayesian:
        conflicts["half_width_m_s"] = "must not be given with a requirement, which ends the firing"
    if limits_m_s and limits_m_s[0] >= limits_m_s[1]:
        conflicts["limits_m_s"] = "the lower one must be less than the upper, found {:g} and {:g}".format(*limits_m_s)
    refuse(Problem("plan_shots", key, message) for key, message in conflicts.items())
    limit = None if scenario is None else ballistic_limit(scenario, on_progress=on_progress)
    model_error = limit.model_error if limit else None
    expectation = FiringPrior(*_expected_v50(limit, shots, limits_m_s), scatter_percent, scatter_factor)
    far = {far_from(expectation.limit_m_s, velocity): 0 for velocity in shots.velocities_m_s if limit or limits_m_s}
    refuse(Problem(shots.file, "velocity_m_s", message) for message in filter(None, far))
    if requirement_m_s is not None and (message := far_from(expectation.limit_m_s, requirement_m_s)):
        raise mistake("plan_shots", "requirement_m_s", message)
    if limits_m_s is not None and model_error is not None and procedure not in LIMITED:
        raise mistake("plan_shots", "limits_m_s", f"must not be given with {procedure} where the model error is known")
    limits = (limits_m_s or limits_of(expectation)) if procedure in LIMITED else None
    if half_width_m_s is None and requirement_m_s is None and procedure != "up-and-down":
        half_width_m_s = HALF_WIDTH_M_S
    settings = ShotSettings(
        expectation, limits or (-inf, inf), half_width_m_s, confidence, requirement_m_s, requirement_fraction
    )
    next_aim, why_ended = procedures.PROCEDURES[procedure]
    end_reason = why_ended(shots, settings)
    aim = None if end_reason else next_aim(shots, settings)
    prior_of_v50 = posterior_of(expectation, (), ())
    posterior_of_v50 = posterior_of(expectation, shots.velocities_m_s, shots.complete)
    prior_estimate, estimate, prior_share, contradictions = learned(prior_of_v50, posterior_of_v50, confidence)
    operates = is_bayesian and not shots.complete
    requirement = _requirement(shots, settings, posterior_of_v50, ended=bool(end_reason), operates=operates)
    if end_reason and required and not is_bayesian:
        end_reason += f"; the requirement is {requirement['decision']}"
    return ShotPlan(
        procedure=procedure,
        fired=shots,
        next_velocity_m_s=None if aim is None else aimed(aim.velocity_m_s),
        reason="" if aim is None else aim.why,
        stopped=end_reason,
        expected_shots=procedures.expected_shots(shots, settings) if is_bayesian and aim else None,
        confidence=confidence,
        half_width_m_s=half_width_m_s,
        requirement_m_s=requirement_m_s,
        requirement_fraction=requirement_fraction,
        limits_m_s=limits,
        prior=prior_estimate,
        posterior=estimate,
        prior_share=prior_share,
        recommended=None if is_bayesian else procedures.recommended_fit(shots, confidence),
        mean=procedures.mean_of(shots) if procedure == "up-and-down" else None,
        model_ballistic_limit_m_s=limit.ballistic_limit_m_s if limit else None,
        model_error=model_error,
        expected_from=expectation.error.source,
        curve=_curve(prior_of_v50, posterior_of_v50, shots),
        contradicts_prior=bool(contradictions),
        **requirement,
        scatter_percent=scatter_percent,
        scatter_factor=scatter_factor,
        notes=(*map(Note, (*v50.doubts(shots, limit), *contradictions)), *(limit.notes if limit else ())),
    ).of(scenario.subject(ANY_VELOCITY) if scenario else f"V50 of {shots.file}", scenario=scenario)


def _expected_v50(
    limit: LimitResult | None, fired: Shots, limits_m_s: tuple[float, float] | None
) -> tuple[float, ModelError]:
    """Return the V50 that is expected before the shots, m/s, and its error, for the prior.

    They are the model's limit and the model error.  If this error is not known, they follow from the limits of V50
    given, m/s, else from the model's limit alone, else from the shots `fired`.
    """
    if limit is not None and limit.model_error is not None:
        return limit.ballistic_limit_m_s, limit.model_error
    if limits_m_s is not None:
        low, high = limits_m_s
        source = f"within the limits given, {low:g} to {high:g} m/s"
    elif limit is not None:
        low, high = ((1.0 + sign * WIDE) * limit.ballistic_limit_m_s for sign in (-1.0, 1.0))
        source = f"within {100.0 * WIDE:g} % of the limit by the model, whose error is not known"
    elif fired.complete:
        low, high = min(fired.velocities_m_s), max(fired.velocities_m_s)
        middle = 0.5 * (low + high)
        low, high = min(low, (1.0 - WIDE) * middle), max(high, (1.0 + WIDE) * middle)
        source = f"within {100.0 * WIDE:g} % of the middle of the shots"
    else:
        raise mistake("plan_shots", "scenario", "must be given, or a table of shots, or the limits of V50")
    middle = 0.5 * (low + high)
    return middle, ModelError(0.0, 100.0 * (high - low) / (2.0 * WITHIN * middle), NORMAL, source)


def _requirement(
    fired: Shots, settings: ShotSettings, posterior_of_v50: Posterior, *, ended: bool, operates: bool
) -> dict[str, Any]:
    """Return the attributes of a `ShotPlan` that are about its requirement, by name.

    `ended` tells whether the firing has ended, so that no further shot will decide; `operates` adds the operating
    characteristic, which is simulated.
    """
    if (curves := settings.requirement_curves()) is None or settings.requirement_m_s is None:
        return {"probability_met": None}
    weights, risk = procedures.posterior(fired, settings).weights[None], 1.0 - settings.confidence
    [decision] = curves.decisions(weights, settings.confidence)
    [(met, not_met)] = curves.ratios(weights).tolist()
    return {
        "probability_met": posterior_of_v50.probability_above(settings.requirement_m_s, settings.requirement_fraction),
        "decision": ("not decided" if ended else "", "met", "not met")[decision],
        "operating_characteristic": procedures.operating_characteristic(settings) if operates else (),
        "evidence_met": met,
        "evidence_not_met": not_met,
        "consumers_risk": risk,
        "producers_risk": risk,
    }


def _curve(prior: Posterior, posterior: Posterior, fired: Shots) -> PlanCurve:
    """Return prior, posterior and response for a chart, over the prior's 99 % interval of V50 and the shots `fired`."""
    low, high = prior.grid.v50_quantiles(prior.weights, (0.005, 0.995))[0].tolist()
    shown = (low, high, *fired.velocities_m_s)
    velocities = np.linspace(min(shown), max(shown), 201)
    probability = expected(posterior.grid.response(velocities), posterior.weights)
    columns = (velocities, prior.density(velocities), posterior.density(velocities), probability)
    return PlanCurve(*(tuple(column.tolist()) for column in columns))


def limits_of(prior: FiringPrior) -> tuple[float, float]:
    """Return the interval in which the prior expects V50 with a probability of 99 %, m/s."""
    return prior.error.interval(prior.limit_m_s, 0.5 * (1.0 - 0.99))


def aimed(velocity_m_s: float) -> float:
    """Return a velocity to aim at, m/s: rounded to a tenth and moved into the range that is allowed."""
    return round(min(max(velocity_m_s, v50.MIN_VELOCITY_M_S), v50.MAX_VELOCITY_M_S), 1)


def far_from(limit_m_s: float, velocity_m_s: float) -> str:
    """Return the message that a velocity is too far from the expected V50, `limit_m_s`, to be right, else ""."""
    if limit_m_s / 3.0 <= velocity_m_s <= limit_m_s * 3.0:
        return ""
    near = f"must be between a third of the expected V50, {limit_m_s:.0f} m/s, and three times it"
    return f"{near}, found {velocity_m_s:g}; is it in m/s?"
