"""Check of one armour against each of its threats, and against small changes of armour and threat."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any, overload

import numpy as np

from armour.analysis.ballistic_limit import (
    NeededFlowStress,
    confidence_in,
    needed_flow_stress,
    probability_by_tests,
    probability_of_stopping,
)
from armour.analysis.estimates import Estimate
from armour.analysis.evaluate import evaluate_groups, groups_of
from armour.analysis.quantities import VERDICT
from armour.analysis.results import OnProgress, TableResult, by_column, data_frame, ignore_progress
from armour.analysis.samples import is_sampled, misplaced, probability_of_perforation
from armour.analysis.variants import Variants, row_of
from armour.design.offers import Offer, read_offers
from armour.design.requirements import VERDICTS, Requirement, Standing, Verdict, against_threat, of_armour, verdict_of
from armour.errors import Note
from armour.evidence.model_error import ModelError, other_settings, why_by_settings
from armour.evidence.tests import armours_of, far_from_tests, threat_warnings
from armour.scenario.checked import Names, Table, checked
from armour.scenario.inputs import BACKING, CERAMIC, OBLIQUITY, VELOCITY
from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES, DesignSection, RequiredProbability, Threat

# Changes with which every armour is checked: factor of the impact velocity, and angles, degrees.
FASTER, ANGLES_DEG = 1.05, (0.0, 30.0)
# Probability of stopping up to the safe speed, where none is required.
USUAL_PROBABILITY = 0.95


@dataclass(frozen=True)
class WhatIf:
    """The answer of a check with one small change of the armour or the threat.

    Attributes
    ----------
    change : str
        In words, such as "tile 1 mm thinner".
    velocity_m_s : float
    ballistic_limit_m_s : float or None
        By the model, m/s; None if there is none in the range of the search.
    expected_limit_m_s : float or None
        Velocity at which the armour stops a shot with a probability of 50 %, given the tests, m/s; None if no tests
        tell.
    interval_m_s : tuple of float or None
        95 % interval of the ballistic limit with the model error, m/s; None if the model error is not known.
    probability_of_stopping : float or None
        Probability that the armour stops a shot; None if it is not known.
    """

    change: str
    velocity_m_s: float
    ballistic_limit_m_s: float | None
    expected_limit_m_s: float | None
    interval_m_s: tuple[float, float] | None
    probability_of_stopping: float | None


@dataclass(frozen=True)
class CheckedThreat:
    """The answer of a check for one threat: limits, probability, verdict, and the same after small changes.

    Attributes
    ----------
    threat : str
        Name of the threat, with its numbers.
    projectile : str
    velocity_m_s, obliquity_deg : float
    ballistic_limit_m_s : float or None
        By the model, m/s; None if there is none in the range of the search.
    expected_limit_m_s : float or None
        Velocity at which the armour stops a shot with a probability of 50 %, given the tests, m/s; None if no tests
        tell.
    safe_speed_m_s : float or None
        Velocity up to which a shot is stopped with the required probability, or 0.95 if none is required, m/s; None if
        no such probability is known or stated.
    interval_m_s : tuple of float or None
        95 % interval of the ballistic limit with the model error, m/s; None if the model error is not known.
    margin_m_s, required_margin_m_s : float
        Excess of the expected limit or, where no tests tell, of the limit by the model over the velocity, m/s, None
        without a limit; and the required excess.
    probability_of_stopping, required_probability : float or None
        Probability that the armour stops a shot, None if unknown; and the required one, None if there is none.
    reason : str
        Reason why the probability is not known.
    probability_at_normal_incidence : float or None
        Probability at 0 degrees, if an armour with a ceramic is hit at an angle and the probability there is not known.
    flow_stress : NeededFlowStress or None
        Flow stress with which a ceramic without tests stops the threat; None for other armours.
    model_error : ModelError or None
        Model error from which the probability is computed; None if it is not known.
    verdict : str
        One of `VERDICTS` of `armour.design.requirements`.
    what_ifs : tuple of WhatIf
        The armour with each change, for exact inputs.
    requirements : tuple of Requirement
        What is required against the threat, and what the armour has.
    sampled : Estimate or None
        Probability of perforation (1 minus that of stopping) from the distributions of the inputs, if a probability is
        required.
    far_from_tests : tuple of str
        In what the armour or the threat is far from the tests, such as "5083-H3 (tested on 6061-T6)".
    name : str
        Name of the threat without its numbers, as it stays if only these change.
    probability_v50_exceeds_velocity : float or None
        Probability that the ballistic limit of the armour, V50, exceeds the velocity, without the scatter of shots and
        for exact inputs; None if it is not known.
    """

    threat: str
    projectile: str
    velocity_m_s: float
    obliquity_deg: float
    ballistic_limit_m_s: float | None
    expected_limit_m_s: float | None
    safe_speed_m_s: float | None
    interval_m_s: tuple[float, float] | None
    margin_m_s: float | None
    required_margin_m_s: float
    probability_of_stopping: float | None
    required_probability: float | None
    reason: str
    probability_at_normal_incidence: float | None
    flow_stress: NeededFlowStress | None
    model_error: ModelError | None
    verdict: Verdict
    what_ifs: tuple[WhatIf, ...]
    requirements: tuple[Requirement, ...] = ()
    sampled: Estimate | None = None
    far_from_tests: tuple[str, ...] = ()
    name: str = ""
    probability_v50_exceeds_velocity: float | None = None

    def as_given(self) -> WhatIf:
        """Return the answer for the armour as it is, to list it above those with changes.

        As theirs, its probability of stopping is that with exact inputs.
        """
        limit, error, probability = self.ballistic_limit_m_s, self.model_error, self.probability_of_stopping
        if self.sampled is not None:
            probability = None
            if error is not None and limit is not None:
                probability = float(error.probability_of_stopping(limit, self.velocity_m_s))
        return WhatIf("as given", self.velocity_m_s, limit, self.expected_limit_m_s, self.interval_m_s, probability)


@dataclass(frozen=True, repr=False)
class CheckResult(TableResult):
    """The check of one armour: the answer for each of its threats, and the verdict on the armour.

    Attributes
    ----------
    threats : tuple of CheckedThreat
    verdict : str
        The worst of the verdicts against the threats and on the limits of the section ``design``: "fails", "perforated
        by the model", "not known", "stopped by the model", "expected to stop" or, the best, "passes".
    notes : tuple of Note
        Ways in which armour and threats are unlike what the model was compared with.
    requirements : tuple of Requirement
        What is required whatever the threat, and what the armour has.
    areal_density_kg_m2, thickness_mm : float
        Including layers without ballistic effect, without a back plate that exists already.
    cost_per_m2 : float or None
        Cost of these layers; None unless the section ``design`` gives the cost of each material and layer.
    whole_areal_density_kg_m2, whole_thickness_mm : float
        The same, including a back plate that exists already.
    basis : dict of str to str
        Hash of each part of the scenario on which the answer rests, by its key, besides tile, plate, threats and what
        is required: settings other than the defaults, layers, prices, and own entries of the library with their tests.
    """

    threats: tuple[CheckedThreat, ...]
    verdict: Verdict
    notes: tuple[Note, ...] = ()
    requirements: tuple[Requirement, ...] = ()
    areal_density_kg_m2: float = 0.0
    thickness_mm: float = 0.0
    cost_per_m2: float | None = None
    whole_areal_density_kg_m2: float = 0.0
    whole_thickness_mm: float = 0.0
    basis: dict[str, str] = field(default_factory=dict, hash=False)

    def _columns(self) -> dict[str, list[object]]:
        """Return for each threat a row for the armour as given, with its verdict, and one for each change, without."""
        rows: list[dict[str, object]] = []
        for threat in self.threats:
            verdict = verdict_of([threat.verdict, *(row.verdict for row in self.requirements)])
            judged = {"verdict": verdict, "probability_of_stopping": threat.probability_of_stopping}
            what_ifs = threat.as_given(), *threat.what_ifs
            given, *changed = ({"threat": threat.threat, "verdict": None, **vars(each)} for each in what_ifs)
            rows += [given | judged, *changed]
        return by_column(rows)


class CheckResults(tuple[CheckResult, ...]):
    """Checks of several armours, such as those on offer, in the order of their table; a tuple."""

    def to_dataframe(self) -> Any:
        """Return the checks as a data frame of pandas, an armour in each row; its columns are those of `rows`."""
        return data_frame(by_column(self.rows()))

    def rows(self) -> list[dict[str, object]]:
        """Return a mapping for each armour: its labels, layers, weight, cost, verdict, and what decides about it.

        Of several threats, limits and probability are those against the one that decides.
        """
        return [_offer_row(each) for each in self]


def _offer_row(result: CheckResult) -> dict[str, object]:
    """Return what a table of offers shows of one armour, by column; its labels come first."""
    threat, armour = deciding(result), result.question["scenario"].armour
    found = ("threat", "ballistic_limit_m_s", "expected_limit_m_s", "probability_of_stopping")
    row: dict[str, object] = {
        **armour.model_dump(exclude={"layer"}),
        "areal_density_kg_m2": result.areal_density_kg_m2,
        "cost_per_m2": result.cost_per_m2,
        **{key: getattr(threat, key) for key in found},
        "verdict": result.verdict,
        "far_from_tests": ", ".join(threat.far_from_tests),
    }
    labels: dict[str, str] = result.question.get("labels", {})
    return {**{name + " (offer)" * (name in row): label for name, label in labels.items()}, **row}


def shown_limit(by_model_m_s: float | None, expected_m_s: float | None) -> float | None:
    """Return the limit that answers show: the expected one or, where no tests tell, that by the model, m/s."""
    return by_model_m_s if expected_m_s is None else expected_m_s


def _order_of_decision(threat: CheckedThreat) -> tuple[int, float]:
    """Return a sort key, lowest for the threat that decides: that of the worst verdict.

    Of equal verdicts, it is that with the least left of the required probability or, if none is known, of the margin.
    """
    margin, chance = threat.margin_m_s, threat.probability_of_stopping
    slack = inf if margin is None else margin - threat.required_margin_m_s
    return VERDICTS.index(threat.verdict), slack if chance is None else chance - (threat.required_probability or 0.0)


def deciding(result: CheckResult) -> CheckedThreat:
    """Return the answer for the threat that decides the verdict on an armour: the worst one."""
    return min(result.threats, key=_order_of_decision)


def what_tells(result: CheckResult, own_tests: str) -> str:
    """Return in words what would tell a probability that is not known: other settings, or else `own_tests`."""
    scenario = result.question["scenario"]
    if scenario.excludes_error():
        return "leave out --by-model or uncertainty.model.included = false: tests may tell the probability"
    if deciding(result).model_error is not None:
        return own_tests
    settings = other_settings(scenario)
    return f"without {settings}, tests may tell" if settings else why_by_settings(scenario) or own_tests


@overload
def check(
    scenario: Scenario,
    *,
    probability: RequiredProbability | None = None,
    cases: None = None,
    keep: Names = (),
    on_progress: OnProgress = ignore_progress,
) -> CheckResult: ...
@overload
def check(
    scenario: Scenario,
    *,
    probability: RequiredProbability | None = None,
    cases: Table,
    keep: Names = (),
    on_progress: OnProgress = ignore_progress,
) -> CheckResults: ...
@checked
def check(
    scenario: Scenario,
    *,
    probability: RequiredProbability | None = None,
    cases: Table | None = None,
    keep: Names = (),
    on_progress: OnProgress = ignore_progress,
) -> CheckResult | CheckResults:
    """Check the armour of a scenario, or each of a table of offers, against every threat, and against small changes.

    If the scenario lists no threats, its impact is the threat.  The changes are: each layer thinner by the tolerance
    ``design.thickness_tolerance_mm``; the round 5 % faster; an angle of 0 or of 30 degrees instead of the threat's.
    Offers are checked without changes.

    Parameters
    ----------
    scenario : Scenario
        Its section ``design`` may give the probability that is required, ``probability_of_stopping``.
    probability : float, optional
        Least probability of stopping each threat, such as 0.95; a higher one that the scenario requires stays.
    cases : path-like, data frame, mapping of columns or sequence of mappings, optional
        Table of offers, with an armour in each row: ceramic and metal with their thicknesses, and a price per m².
    keep : str or sequence of str, optional
        Further columns of the table to keep as labels; the first names the offers.
    on_progress : callable, optional
        Called with the number of impacts computed since the last call, and None, as their total is not known; with
        offers, with their number and that of all.

    Returns
    -------
    CheckResult or CheckResults
        With offers, a tuple of their checks, in the order of the table.

    Examples
    --------
    >>> import armour
    >>> armour.check(armour.load_scenario("wilkins")).verdict
    'fails'
    """
    scenario = scenario.requiring(probability)
    if cases is None:
        return check_of(scenario, on_progress)
    results, offers = [], read_offers(scenario, cases, tuple(keep)).offers
    for offer in offers:
        results.append(check_of(offer.scenario, changes=False, needed=False, offer=offer))
        on_progress(1, len(offers))
    return CheckResults(results)


def check_of(
    scenario: Scenario,
    on_progress: OnProgress = ignore_progress,
    *,
    changes: bool = True,
    needed: bool = True,
    offer: Offer | None = None,
) -> CheckResult:
    """Check the armour of a scenario, as `check` does without offers.

    `changes` tells whether to check again after each small change for the worse, such as a thinner layer, a faster
    impact or another angle, and `needed` whether to search the flow stress that a ceramic
    without tests needs; both take time.  If the armour is an `offer`, this gives its cost, and its name for tables.
    """
    section = scenario.design or DesignSection()
    threats, distributions = scenario.threats(), scenario.distributions()
    impacts = [scenario.against(threat) for threat in threats]
    rows = [row_of(impact) for impact in impacts]
    wrongly_placed = [misplaced(distributions, scenario, impact) for impact in impacts]
    checked_threats = tuple(
        _checked_threat(
            row, threat, on_progress, sample=bool(distributions) and not misplacements, changes=changes, needed=needed
        )
        for row, threat, misplacements in zip(rows, threats, wrongly_placed, strict=True)
    )
    areal_density, thickness = scenario.areal_density_kg_m2(), scenario.thickness_mm()
    cost = scenario.cost_per_m2() if offer is None else offer.cost_per_m2
    limits = tuple(of_armour(section, dict(zip(OBJECTIVES, (areal_density, thickness, cost), strict=True))))
    verdicts = [*(threat.verdict for threat in checked_threats), *(limit.verdict for limit in limits)]
    requires = any(threat.required_probability is not None for threat in checked_threats)
    not_sampled = dict.fromkeys(note for each in wrongly_placed for note in each)
    is_known = any(threat.model_error is not None for threat in checked_threats)
    notes = (
        *scenario.unused_impact(),
        *threat_warnings(scenario, rows[0].armours if len(rows) == 1 else armours_of(*impacts)),
        *(not_sampled if requires else scenario.unused_distributions() * is_known),
    )
    title = scenario.subject(threats=scenario.threat)
    return CheckResult(
        checked_threats,
        verdict_of(verdicts),
        notes,
        requirements=limits,
        areal_density_kg_m2=areal_density,
        thickness_mm=thickness,
        cost_per_m2=cost,
        whole_areal_density_kg_m2=scenario.areal_density_kg_m2(whole=True),
        whole_thickness_mm=scenario.thickness_mm(whole=True),
        basis=scenario.basis(),
    ).of(title, scenario=scenario, **({} if offer is None else {"name": offer.name, "labels": offer.labels}))


def evaluated(
    scenario: Scenario, columns: Mapping[str, Any], quantities: Sequence[str], threads: int | None = None
) -> tuple[dict[str, Any], Counter[str]]:
    """Evaluate quantities for n rows of values, as `evaluate_groups` does, and also the verdict of `check`.

    `columns` has the values, (n,), by key.  Return the results, (n,), by name, and the number of rows of each warning.
    """
    found, warnings = evaluate_groups(groups_of(scenario, columns), quantities, threads)
    if VERDICT in quantities:
        rows = zip(*(values.tolist() for values in columns.values()), strict=True)
        scenarios = (scenario.replaced(dict(zip(columns, row, strict=True))) for row in rows)
        found[VERDICT] = np.array([check_of(each, changes=False, needed=False).verdict for each in scenarios])
    return {name: found[name] for name in quantities}, warnings


def _checked_threat(
    row: Variants, threat: Threat, on_progress: OnProgress, *, sample: bool, changes: bool, needed: bool
) -> CheckedThreat:
    """Return the answer of a check for one threat; `row` is the armour, a single row, with the impact of this threat.

    `sample` tells whether to sample the distributions of the inputs if a probability is required; `changes` and
    `needed` are those of `check_of`.
    """
    against, section = row.scenario, row.scenario.design or DesignSection()
    result = confidence_in(row, on_progress)
    limit, error, bound = result.ballistic_limit_m_s, result.model_error, section.bound(threat)
    probability, sampled = probability_by_tests(against, limit, error), None
    greatest_probability = 1.0 if error is None else error.greatest_probability
    if bound is not None and sample and is_sampled(against):
        sampled = probability_of_perforation(against, bound, on_progress=lambda count, _: on_progress(count, None))
        probability = 1.0 - sampled.value
    # If the limit is high enough, a denser scan looks for a lower one.
    lowest_limit = row.limits_anywhere() if limit is None else np.array([limit])
    if lowest_limit >= threat.required_m_s:
        lowest_limit = row.lowest_limits(lowest_limit)
    expected = expected_limit = result.expected_limit_m_s
    # The verdict is on the expected limit that belongs to the lowest one; the result shows that of the usual scan.
    if error is not None and lowest_limit[0] != limit:
        expected = float(row.shot_distributions(lowest_limit).quantile(0.5)[0])
    standing = Standing(
        float(lowest_limit[0]),
        expected,
        not row._replace(velocities=np.array([threat.required_m_s])).perforated()[0],
        probability,
        greatest_probability,
        sampled,
    )
    verdict, requirements = against_threat(against, threat, against.core_armour(), row.materials[0].ceramic, standing)
    what_ifs = []
    for change, values in _small_changes(against, section.thickness_tolerance_mm) if changes else ():
        changed = against.replaced(values)
        # The limit does not depend on the velocity.
        found = result if VELOCITY in values else confidence_in(row_of(changed), on_progress)
        limits = found.ballistic_limit_m_s, found.expected_limit_m_s, found.interval_m_s
        stopping = probability_of_stopping(changed, found.ballistic_limit_m_s, found.model_error)
        what_ifs.append(WhatIf(change, changed.impact.velocity_m_s, *limits, stopping))
    required, flow_stress, safe_speed = None if bound is None else 1.0 - bound, None, None
    if limit is not None and error is not None and greatest_probability >= (required or USUAL_PROBABILITY):
        safe_speed = limit * float(error.of_shots.quantile(1.0 - (required or USUAL_PROBABILITY)))
    shown = shown_limit(limit, expected_limit)
    if needed and probability is None:
        flow_stress = needed_flow_stress(against, threat.required_m_s, required)
    return CheckedThreat(
        threat=threat.title,
        projectile=threat.projectile,
        velocity_m_s=threat.velocity_m_s,
        obliquity_deg=threat.obliquity_deg,
        ballistic_limit_m_s=limit,
        expected_limit_m_s=expected_limit,
        safe_speed_m_s=safe_speed,
        interval_m_s=result.interval_m_s,
        margin_m_s=None if shown is None else shown - threat.velocity_m_s,
        required_margin_m_s=threat.margin_m_s,
        probability_of_stopping=None if probability is None else min(probability, greatest_probability),
        required_probability=required,
        reason=result.reason,
        probability_at_normal_incidence=result.probability_at_normal_incidence,
        flow_stress=flow_stress,
        model_error=error,
        verdict=verdict,
        what_ifs=tuple(what_ifs),
        requirements=requirements,
        sampled=sampled and sampled.at_least(1.0 - greatest_probability),
        far_from_tests=tuple(map(str, far_from_tests(against, row.armours))),
        name=threat.round_name,
        probability_v50_exceeds_velocity=result.probability_v50_exceeds_velocity,
    )


def _small_changes(scenario: Scenario, tolerance_mm: float) -> Iterator[tuple[str, dict[str, float]]]:
    """Yield the small changes of armour and impact to check, each in words and as the new value by key.

    `tolerance_mm` is that of the thicknesses; a layer that is no thicker stays.
    """
    for key, words in ((CERAMIC, "tile"), (BACKING, "plate")):
        thickness = getattr(scenario.armour, key.partition(".")[2])
        if thickness > tolerance_mm > 0.0:
            yield f"{words} {tolerance_mm:g} mm thinner", {key: thickness - tolerance_mm}
    yield f"{100.0 * FASTER - 100.0:.0f} % faster", {VELOCITY: FASTER * scenario.impact.velocity_m_s}
    for angle in ANGLES_DEG:
        if angle != scenario.impact.obliquity_deg:
            yield f"at {angle:g}°", {OBLIQUITY: angle}
