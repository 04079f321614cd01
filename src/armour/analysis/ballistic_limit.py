"""Ballistic limit of an armour, found by a scan of impact velocities, and the confidence in an armour.

The confidence is the probability that the armour stops its threat, given the model error.  For a ceramic without tests,
the model error is not known; this module then computes the flow stress that the ceramic needs to stop the threat.
"""

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from armour.analysis.impact import ImpactResult, impact_at, unresolved_error
from armour.analysis.results import OnProgress, Result, ignore_progress
from armour.analysis.variants import Variants, ballistic_limits, row_of, variants_of
from armour.core import search
from armour.core.state import Outcome
from armour.engine import batch
from armour.errors import InputError, NoLimitError, Note
from armour.evidence.caveats import is_long_rod, is_no_metal
from armour.evidence.fit import fits
from armour.evidence.mixture import Floats, Mixture
from armour.evidence.model_error import ModelError, error_of, other_settings, scatter_of
from armour.evidence.tests import far_from_tests, is_untested, materials_of, scenario_warnings
from armour.scenario.checked import checked
from armour.scenario.inputs import FLOW_STRESS, OBLIQUITY
from armour.scenario.scenario import ANY_VELOCITY, Scenario
from armour.scenario.schema import FASTEST_M_S, SLOWEST_M_S

# Range of flow stresses that is searched, GPa; number of values in a grid, and number of grids.  Each grid divides an
# interval of the grid before; two neighbours in the last grid differ by less than 0.01 %.
RANGE_GPA, POINTS, GRIDS = (0.1, 100.0), 64, 3
# Probability that is used if the scenario requires none.
USUAL_PROBABILITY = 0.9
# Number of intervals above the limit in a plotted curve.
CURVE_POINTS = 60
# Probability above which a lower bound is reported as the probability.
SURE = 0.995


@dataclass(frozen=True)
class NeededFlowStress:
    """Flow stress with which a ceramic without tests stops a threat, and the ballistic limits over its sources.

    Attributes
    ----------
    ceramic : str
    needed_GPa : float or None
        Flow stress above which the ballistic limit by the model is always at least the velocity required, GPa; None
        if 100 GPa is too little.
    probability : float
        Probability of stopping the threat that is required.
    needed_for_probability_GPa : float or None
        Flow stress above which, moreover, the probability of stopping the threat is always at least `probability`,
        with the model error of AD85 with a constant flow stress and the scatter of shots, GPa; None if 100 GPa is too
        little.
    sources_GPa : tuple of float
        Least and greatest flow stress that sources give, GPa, or one number, or none.
    limits_m_s : tuple of float
        Ballistic limits by the model with these flow stresses, m/s.
    """

    ceramic: str
    needed_GPa: float | None
    probability: float
    needed_for_probability_GPa: float | None
    sources_GPa: tuple[float, ...]
    limits_m_s: tuple[float, ...]


def needed_flow_stress(
    scenario: Scenario, required_m_s: float, probability: float | None = None
) -> NeededFlowStress | None:
    """Return what flow stress a ceramic without tests needs for a required limit, and for a required probability.

    Return None if the scenario has no such ceramic, or if tests say nothing about it: with a back plate that may be
    no metal, an interlayer, a long rod, or settings of the model other than those used to compute the tests.

    Parameters
    ----------
    scenario : Scenario
    required_m_s : float
        Least ballistic limit, m/s.
    probability : float, optional
        Required probability of stopping a shot at the impact velocity; by default 0.9.
    """
    ceramic = scenario.entry_of("ceramic")
    if ceramic is None or not scenario.armour.ceramic_thickness_mm or not is_untested(ceramic) or scenario.interlayers:
        return None
    core = scenario.core_armour()
    if is_no_metal(core.rho_B) or is_long_rod(core) or other_settings(scenario):
        return None
    probability, sources = probability or USUAL_PROBABILITY, ceramic.flow_stress_sources_GPa
    percent, _ = scatter_of(scenario, materials_of(scenario), bare=False)
    # Measured over computed limits of AD85 with a constant flow stress, without a trend.
    fit = fits()["constant"]
    scale = np.sqrt(fit.variance + fit.covariance[:, 0])
    error = Mixture(np.ones(1), fit.coefficients, scale, np.array([fit.degrees_of_freedom]))
    shots = error.of_shots(percent / 100.0)
    likely_m_s = scenario.impact.velocity_m_s / float(shots.quantile(1.0 - probability))
    return NeededFlowStress(
        ceramic.name,
        _least_flow_stress(scenario, required_m_s),
        probability,
        _least_flow_stress(scenario, max(required_m_s, likely_m_s)),
        sources,
        tuple(limits_over(scenario, np.array(sources)).tolist()),
    )


def limits_over(scenario: Scenario, flow_stresses_GPa: Floats) -> Floats:
    """Return the ballistic limit with each of n flow stresses of the ceramic, m/s, (n,), but 20 to 10,000 m/s."""
    rows = variants_of(scenario, {FLOW_STRESS: flow_stresses_GPa}, len(flow_stresses_GPa))
    return ballistic_limits(rows, (SLOWEST_M_S, FASTEST_M_S)).clip(SLOWEST_M_S, FASTEST_M_S)


def _least_flow_stress(scenario: Scenario, required_m_s: float) -> float | None:
    """Return the flow stress above which the ballistic limit is always at least `required_m_s`, GPa; None for none."""
    low, high = RANGE_GPA
    for _ in range(GRIDS):
        grid = np.geomspace(low, high, POINTS)
        short = np.flatnonzero(limits_over(scenario, grid) < required_m_s)
        if not len(short):
            return low
        if short[-1] == POINTS - 1:
            return None
        low, high = grid[short[-1] : short[-1] + 2].tolist()
    return high


@dataclass(frozen=True)
class Crossing:
    """A velocity at which the outcome of an impact changes.

    Attributes
    ----------
    bracket_m_s : tuple of float
        Velocities just below and just above the change, m/s.
    above : {"perforated", "stopped"}
        Outcome above the change.
    """

    bracket_m_s: tuple[float, float]
    above: Literal["perforated", "stopped"]


@dataclass(frozen=True, repr=False)
class LimitResult(Result):
    """Ballistic limit of an armour.

    Attributes
    ----------
    ballistic_limit_m_s : float
        Lowest velocity found to perforate, m/s: the upper end of the bracket.
    bracket_m_s : tuple of float
        Velocities just below the limit, stopped, and at it, perforated, m/s.  The lower one may follow from impacts
        nearby instead of one at that velocity.
    runs : int
        Number of impacts computed.
    areal_density_kg_m2, whole_areal_density_kg_m2 : float
        Areal density of the armour without and with a back plate that exists already, kg/m².
    monotonic : bool
        Whether every scanned velocity above the limit perforates.
    crossings : tuple of Crossing
        All changes of the outcome found by the scan; the first is the ballistic limit.
    scanned_velocities : int
        Number of velocities of the scan, evenly spaced on a logarithmic scale.
    scanned_range_m_s : tuple of float
        Lowest and highest scanned velocity, m/s.
    notes : tuple of Note
        Ways in which the armour, or its ballistic limit, is unlike what the model was compared with.
    model_error : ModelError or None
        Relative error of the ballistic limit by the model; None if it is not known.
    interval_m_s : tuple of float or None
        Interval in which the ballistic limit of the armour lies with a probability of 95 %, given this error, m/s.
    expected_limit_m_s : float or None
        Velocity at which the armour stops a shot with a probability of 50 %, given this error, m/s.
    reason : str
        Reason why the error is not known; empty if it is.
    far_from_tests : tuple of str
        What of the armour or the threat is far from the tests.
    """

    ballistic_limit_m_s: float
    bracket_m_s: tuple[float, float]
    runs: int
    areal_density_kg_m2: float
    monotonic: bool
    crossings: tuple[Crossing, ...]
    scanned_velocities: int
    scanned_range_m_s: tuple[float, float]
    notes: tuple[Note, ...]
    model_error: ModelError | None = None
    interval_m_s: tuple[float, float] | None = None
    expected_limit_m_s: float | None = None
    whole_areal_density_kg_m2: float = 0.0
    reason: str = ""
    far_from_tests: tuple[str, ...] = ()


@checked
def ballistic_limit(scenario: Scenario, *, on_progress: OnProgress = ignore_progress) -> LimitResult:
    """Compute the ballistic limit of a scenario's armour: the lowest change of the outcome that a scan finds.

    The scan has 33 velocities, evenly spaced on a logarithmic scale, or 1,025 if the armour is far from all tests that
    the model was compared with.  Velocities at which the projectile lacks the energy to perforate are not computed.

    Parameters
    ----------
    scenario : Scenario
        Its section ``ballistic_limit`` gives the range of velocities and the tolerance; its impact velocity is not
        used.
    on_progress : callable, optional
        Called with the number of impacts computed since the last call, and None, as their total is not known.

    Returns
    -------
    LimitResult

    Raises
    ------
    NoLimitError
        If no velocity of the range is found to perforate, or if its lowest velocity does.
    InputError
        If a run does not end within the maximum number of steps.
    """
    section, row = scenario.ballistic_limit, row_of(scenario)
    low, high = section.velocity_min_m_s, section.velocity_max_m_s
    points = search.DENSE_SCAN_POINTS if row.is_unusual().all() else search.SCAN_POINTS
    crossings, runs, lowest_perforates = find_crossings(row, points, on_progress)
    if lowest_perforates or not crossings:
        raise NoLimitError(_no_limit(crossings, lowest_perforates, points, low, high), above=not lowest_perforates)
    limit = crossings[0].bracket_m_s[1]
    error = model_error(row, limit)
    return LimitResult(
        ballistic_limit_m_s=limit,
        bracket_m_s=crossings[0].bracket_m_s,
        runs=runs,
        areal_density_kg_m2=scenario.areal_density_kg_m2(),
        whole_areal_density_kg_m2=scenario.areal_density_kg_m2(whole=True),
        monotonic=len(crossings) == 1,
        crossings=crossings,
        scanned_velocities=points,
        scanned_range_m_s=(low, high),
        notes=(*scenario_warnings(scenario, row.armours, said=True), *scenario.unused_distributions() * bool(error)),
        model_error=error,
        interval_m_s=None if error is None else error.interval(limit),
        expected_limit_m_s=None if error is None else error.median(limit),
        reason="" if error is not None else row.why_error_unknown(),
        far_from_tests=tuple(map(str, far_from_tests(scenario, row.armours))),
    ).of(scenario.subject(ANY_VELOCITY), scenario=scenario)


def model_error(row: Variants, limit_m_s: float) -> ModelError | None:
    """Return the model error of a single row, given its limit by the model, m/s; None if it is unknown or excluded.

    The section ``uncertainty.model`` gives the error, or else tests of similar armours.  These tests are described by
    several laws of the ceramic's flow stress; the limits by the laws other than the scenario's are computed here.
    """
    errors = row.errors
    # The ratio by its own law is exactly 1.
    ratio = errors.ratio.times(row.limits_by_law(errors, np.array([limit_m_s])) / limit_m_s).one()
    return error_of(row.scenario, ratio, row.armours, limit_m_s)


def not_monotonic(limit: LimitResult) -> tuple[Note, ...]:
    """Return a warning, in a tuple, if the outcome changes again above the ballistic limit; otherwise nothing."""
    changes = ", ".join(f"{crossing.above} above {crossing.bracket_m_s[1]:.2f} m/s" for crossing in limit.crossings)
    return () if limit.monotonic else (Note(f"the outcome is not monotonic: {changes}"),)


def _outcomes_at(row: Variants, velocities: list[float]) -> Any:
    """Return the outcome, as in `Outcome`, of a single row at each velocity, m/s."""
    return batch.impacts(row.parameters.repeat(len(velocities), axis=0), np.array(velocities), row.settings).outcome


def find_crossings(row: Variants, points: int, on_progress: OnProgress) -> tuple[tuple[Crossing, ...], int, bool]:
    """Find the velocities at which the outcome of a single row changes, by a scan of `points` velocities.

    Return the changes, the number of impacts computed, and whether the lowest scanned velocity perforates.
    """
    section, armour, settings = row.scenario.ballistic_limit, row.scenario.core_armour(), row.settings
    low, high, tolerance = section.velocity_min_m_s, section.velocity_max_m_s, section.tolerance_m_s
    velocities = search.scan(low, high, points)
    scanned = velocities[search.first_scanned(armour, velocities) :]
    outcomes = _outcomes_at(row, scanned)
    runs = len(scanned)
    if runs < points and outcomes[0] == Outcome.PERFORATED:  # as in `search.scanned_limit`
        scanned = velocities
        outcomes = _outcomes_at(row, scanned)
        runs += points
    on_progress(runs, None)
    unresolved = np.flatnonzero(outcomes == Outcome.UNRESOLVED)
    if len(unresolved):
        raise unresolved_error(row.scenario, scanned[unresolved[0]])
    perforated = outcomes == Outcome.PERFORATED
    crossings: list[Crossing] = []
    for i in np.flatnonzero(perforated[:-1] != perforated[1:]):
        if not crossings and perforated[i + 1]:
            # The limit equals the engine's to the last bit.
            brackets = batch.ballistic_limits(row.parameters, scanned[i], scanned[i + 1], tolerance, settings, 2)
            change = search.SearchResult._make(column.item() for column in brackets)
        else:
            below, above = (search.impact(armour, velocity, settings) for velocity in scanned[i : i + 2])
            change = search.narrowed_change(armour, below, above, tolerance, settings)
        runs += change.runs
        on_progress(change.runs, None)
        if not change.resolved:
            raise unresolved_error(row.scenario, change.high)
        crossings.append(Crossing((change.low, change.high), "perforated" if perforated[i + 1] else "stopped"))
    return tuple(crossings), runs, bool(perforated[0])


def residual_velocity_curve(
    scenario: Scenario, limit: LimitResult, on_progress: OnProgress = ignore_progress
) -> tuple[ImpactResult, ...]:
    """Compute impacts of a scenario at velocities below, at and well above its ballistic limit, to draw a curve.

    The velocities are dense just above the limit, where the residual velocity rises as a square root, and extend beyond
    the last crossing.
    """
    section = scenario.ballistic_limit
    ballistic_limit = limit.ballistic_limit_m_s
    low = max(section.velocity_min_m_s, 0.7 * ballistic_limit)
    high = min(section.velocity_max_m_s, max(1.6 * ballistic_limit, 1.1 * limit.crossings[-1].bracket_m_s[1]))
    rising = [ballistic_limit + (high - ballistic_limit) * (i / CURVE_POINTS) ** 2 for i in range(CURVE_POINTS + 1)]
    impacts = []
    for velocity in (low, limit.bracket_m_s[0], *rising):
        impacts.append(impact_at(scenario, velocity))
        on_progress(1, None)
    return tuple(impacts)


def _no_limit(crossings: tuple[Crossing, ...], lowest_perforates: bool, points: int, low: float, high: float) -> str:
    """Return the message that a scan of `points` velocities, from `low` to `high` m/s, contains no limit, and why."""
    scanned = f"{points} velocities from {low:g} to {high:g} m/s"
    if not lowest_perforates:
        return f"no ballistic limit: none of {scanned} perforates; raise ballistic_limit.velocity_max_m_s"
    perforating = f"the lowest of {scanned} perforates" if crossings else f"all of {scanned} perforate"
    return f"no ballistic limit: {perforating}; lower ballistic_limit.velocity_min_m_s"


@dataclass(frozen=True, repr=False)
class ConfidenceResult(Result):
    """Probability that an armour stops its threat.

    Attributes
    ----------
    probability_of_stopping : float or None
        Probability that the armour stops a shot at the impact velocity; None if it is not known.  Where no velocity
        perforates, it is a lower bound, given if it exceeds 0.995.
    ballistic_limit_m_s : float or None
        By the model, m/s; None if there is none from 20 to 10,000 m/s.
    model_error : ModelError or None
        Relative error of the ballistic limit by the model.
    reason : str
        Reason why the probability is not known.
    notes : tuple of Note
        Ways in which the scenario is unlike what the model was compared with.
    expected_limit_m_s : float or None
        Velocity at which the armour stops a shot with a probability of 50 %, given this error, m/s.
    interval_m_s : tuple of float or None
        Interval in which the ballistic limit of the armour lies with a probability of 95 %, m/s.
    probability_at_normal_incidence : float or None
        Probability at 0 degrees, if an armour with a ceramic is hit at an angle and the probability there is not known.
    flow_stress : NeededFlowStress or None
        Flow stress with which a ceramic without tests stops the threat; None for other armours.
    probability_v50_exceeds_velocity : float or None
        Probability that the ballistic limit of the armour, V50, exceeds the impact velocity: without the scatter of
        shots; None if this is not known.
    far_from_tests : tuple of str
        What of the armour or the threat is far from the tests.
    """

    probability_of_stopping: float | None
    ballistic_limit_m_s: float | None
    model_error: ModelError | None
    reason: str = ""
    notes: tuple[Note, ...] = ()
    expected_limit_m_s: float | None = None
    interval_m_s: tuple[float, float] | None = None
    probability_at_normal_incidence: float | None = None
    flow_stress: NeededFlowStress | None = None
    probability_v50_exceeds_velocity: float | None = None
    far_from_tests: tuple[str, ...] = ()


@checked
def confidence(scenario: Scenario, *, on_progress: OnProgress = ignore_progress) -> ConfidenceResult:
    """Compute the probability that the armour of a scenario stops its threat, the projectile at its impact velocity.

    The inputs are taken as exact; `armour.uncertainty` includes their distributions too.

    Parameters
    ----------
    scenario : Scenario
        Its section ``uncertainty.model`` gives the model error; by default, tests of similar armours do.
    on_progress : callable, optional
        Called with the number of impacts computed since the last call, and None, as their total is not known.

    Returns
    -------
    ConfidenceResult
        With the reason if no ballistic limit is found or a run does not end within the maximum number of steps.
    """
    row = row_of(scenario)
    result = confidence_in(row, on_progress)
    is_known = result.probability_of_stopping is not None
    required = scenario.design.probability_of_stopping if scenario.design else None
    flow_stress = None if is_known else needed_flow_stress(scenario, scenario.impact.velocity_m_s, required)
    far = tuple(map(str, far_from_tests(scenario, row.armours)))
    notes = (*scenario_warnings(scenario, row.armours, said=True), *scenario.unused_distributions() * is_known)
    return replace(result, notes=notes, flow_stress=flow_stress, far_from_tests=far).of(scenario=scenario)


def confidence_in(row: Variants, on_progress: OnProgress = ignore_progress) -> ConfidenceResult:
    """Return the result of `confidence` for the armour of a single row, without `notes` and `flow_stress`."""
    limit, error, reason = limit_and_error(row, on_progress)
    probability = probability_of_stopping(row.scenario, limit, error)
    if limit is None:
        return ConfidenceResult(probability, None, error, "" if probability else reason)
    if error is not None:
        return ConfidenceResult(
            probability,
            limit,
            error,
            expected_limit_m_s=error.median(limit),
            interval_m_s=error.interval(limit),
            probability_v50_exceeds_velocity=float(error.probability_v50_exceeds(limit, row.velocities[0])),
        )
    at_normal = None
    if row.scenario.impact.obliquity_deg and row.scenario.armour.ceramic_thickness_mm:
        at_normal = confidence_in(row_of(row.scenario.replaced({OBLIQUITY: 0.0}))).probability_of_stopping
    return ConfidenceResult(None, limit, None, row.why_error_unknown(), probability_at_normal_incidence=at_normal)


def limit_and_error(row: Variants, on_progress: OnProgress) -> tuple[float | None, ModelError | None, str]:
    """Return the ballistic limit of a single row, m/s, its model error, and the reason, in words, if there is no limit.

    Limit and error are None if they are not known.
    """
    try:
        [limit] = row.limits_anywhere(on_progress).tolist()
    except InputError as error:
        return None, None, str(error)
    if limit >= FASTEST_M_S:
        return None, model_error(row, FASTEST_M_S), f"no velocity up to {FASTEST_M_S:,.0f} m/s perforates"
    if limit <= min(row.scenario.ballistic_limit.velocity_min_m_s, SLOWEST_M_S):
        return None, None, f"every velocity from {limit:g} m/s perforates"
    return limit, model_error(row, limit), ""


def probability_of_stopping(scenario: Scenario, limit_m_s: float | None, error: ModelError | None) -> float | None:
    """Return the probability that an armour stops a shot at the scenario's impact velocity; None if it is not known.

    `limit_m_s` is the ballistic limit by the model, and `error` its model error.  An error without a limit means that
    no velocity up to 10,000 m/s perforates.  The probability for a limit of 10,000 m/s is then a lower bound, returned
    if it exceeds 0.995.
    """
    by_tests = probability_by_tests(scenario, limit_m_s, error)
    return by_tests if by_tests is None or error is None else min(by_tests, error.greatest_probability)


def probability_by_tests(scenario: Scenario, limit_m_s: float | None, error: ModelError | None) -> float | None:
    """Return `probability_of_stopping` without its upper bound, the `greatest_probability` of the model error."""
    if error is None:
        return None
    limit = FASTEST_M_S if limit_m_s is None else limit_m_s
    probability = float(error.of_shots.probability_above(scenario.impact.velocity_m_s / limit))
    return probability if limit_m_s is not None or probability > SURE else None


def no_error(scenario: Scenario) -> str:
    """Return why the model error of a scenario is not known or not included, in words."""
    return row_of(scenario).why_error_unknown()
