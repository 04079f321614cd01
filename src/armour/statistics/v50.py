"""V50 from firing results: the mean of MIL-STD-662F [DoD1997], maximum likelihood and penalised likelihood."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import comb, inf
from pathlib import Path
from statistics import median
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from armour import csv_files
from armour.analysis.ballistic_limit import LimitResult, ballistic_limit, no_error
from armour.analysis.estimates import CONFIDENCE, Confidence
from armour.analysis.results import EachResult, OnProgress, TableResult, by_column, ignore_progress
from armour.columns import GROUPS, YES_MEANS, column_of, columns_of, perforates
from armour.csv_files import Source, TableRead
from armour.errors import NoAnswerError, Note, Problem, mistake, refuse
from armour.foreign import items
from armour.scenario.checked import FloatOrArray, Names, Table, checked
from armour.scenario.keys import describe
from armour.scenario.scenario import ANY_VELOCITY, Scenario
from armour.statistics import curves
from armour.statistics.curves import FittedCurve, Interval, ShotLikelihood
from armour.statistics.lots import V50Difference, difference_of
from armour.statistics.posterior import FiringEstimate, FiringPrior, learned, posterior_of
from armour.units import feet_note

# Usual span of the velocities in the mean, m/s, by the number of shots of each kind: 125, 90 and 60 ft/s.
# MIL-STD-662F leaves the span to the specification.
SPANS_M_S = {5: 38.1, 3: 27.432, 2: 18.288}
SpanRule = Literal["usual span", "given span", "no usual rule"]
# Lower confidence levels to try if the interval at the requested one is not bounded.
LOWER_LEVELS = (0.9, 0.8, 0.5)
# Number of velocities tried for a further shot: from the range of the shots below the slowest to as much above the
# fastest.
FURTHER = 19
# Greatest value of this range, as a multiple of the median distance of the shots from their median.
WIDEST = 10.0
Decision = Literal["met", "not met", "not decided", ""]
# Range of velocities, m/s; it catches values in a wrong unit.
MIN_VELOCITY_M_S, MAX_VELOCITY_M_S = 10.0, 1e4
Velocity = Annotated[float, Field(ge=MIN_VELOCITY_M_S, le=MAX_VELOCITY_M_S)]
# Column in which `plan shots` keeps what the shots are fired at.
TARGET = "armour and round"
SHOTS = csv_files.TableKind(
    "shot", ("velocity_m_s",), ("shot", "result", TARGET), needed=("velocity_m_s", "result"), exact=(TARGET,)
)
SHOT_COLUMNS = (*SHOTS.keys, *YES_MEANS, *GROUPS)
Fraction = Annotated[float, Field(ge=0.001, le=0.999)]
# With at least this number of possible orders of the results, it is no chance if all complete penetrations are slower
# than the partial ones.
SWAPPED = 20


def _is_result(value: object) -> bool:
    """Return whether a value is true or false, or 1 or 0."""
    return isinstance(value, int | float) and value in (True, False)


@dataclass(frozen=True, init=False)
class Shots:
    """Firing results; velocities, results and names may be given as any sequences, arrays or columns.

    Attributes
    ----------
    velocities_m_s : tuple of float
        Impact velocities, m/s.
    complete : tuple of bool
        Whether each was a complete penetration.
    file : str
        Name of their file, for messages and titles.
    names : tuple of str
        Their names, if they have any.
    read : TableRead or None
        How the shots were read from a table: in ``words``, and whether it was ``plain``, with nothing converted or left
        out; the places of rows ``left_out``, columns ``ignored``, the ``sha256`` of the file, or of the rows given,
        ``warnings`` with the remarks in columns that were not read, the lines above the header as ``title``, the rows
        ``not_used``, and the columns by which rows were ``chosen``, each with its value.
    target : str
        Armour and round that they were fired at, if the table says so.
    """

    velocities_m_s: tuple[float, ...]
    complete: tuple[bool, ...]
    file: str
    names: tuple[str, ...]
    read: TableRead | None = field(compare=False)
    target: str = field(compare=False)

    def __init__(
        self,
        velocities_m_s: Iterable[float],
        complete: Iterable[bool],
        file: str = "shots",
        names: Iterable[str] = (),
        read: TableRead | None = None,
        target: str = "",
    ) -> None:
        columns = {"velocities_m_s": velocities_m_s, "complete": complete, "names": names}
        with_items: dict[str, Any] = {}
        for key, column in columns.items():
            try:
                with_items[key] = (*items(column),)
            except TypeError:
                raise mistake(file, key, f"must be a sequence, found {describe(column)}") from None
        results = tuple(bool(value) if _is_result(value) else value for value in with_items["complete"])
        # What is wrong with a value is told where the shots are used.
        vars(self).update(with_items, complete=results, file=file, read=read, target=target)

    def of(self, *, complete: bool) -> list[float]:
        """Return the velocities of the complete or of the partial penetrations, m/s, in ascending order."""
        pairs = zip(self.velocities_m_s, self.complete, strict=True)
        return sorted(velocity for velocity, result in pairs if result == complete)


@dataclass(frozen=True)
class MeanV50:
    """V50 as the mean velocity of equal numbers of highest partial and lowest complete penetrations.

    Attributes
    ----------
    v50_m_s : float
        Mean velocity, m/s.
    pairs : int
        Number of shots of each kind.
    span_m_s : float
        Difference between the fastest and the slowest of these shots, m/s.
    span_allowed_m_s : float
        Greatest span allowed, m/s.
    rule : {"usual span", "given span", "no usual rule"}
        Origin of the span allowed; "no usual rule" for other numbers of shots than 2, 3 and 5.
    """

    v50_m_s: float
    pairs: int
    span_m_s: float
    span_allowed_m_s: float
    rule: SpanRule

    @property
    def is_allowed(self) -> bool:
        """Whether the span is at most the one allowed."""
        return self.span_m_s <= self.span_allowed_m_s + 1e-9


@dataclass(frozen=True)
class ProbabilityAt:
    """Probability of complete penetration at a velocity, by the recommended curve."""

    velocity_m_s: float
    probability: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class VelocityOf:
    """Velocity at which a fraction of the shots perforate, by the recommended curve; None for an end not bounded."""

    fraction: float
    velocity_m_s: float | None
    interval_m_s: Interval
    lower_m_s: float | None


@dataclass(frozen=True)
class FurtherShot:
    """The one further result that would bound V50 best, with the interval of V50 then and its confidence level."""

    velocity_m_s: float
    complete: bool
    confidence: float | None
    interval_m_s: tuple[float, float] | None


@dataclass(frozen=True, repr=False)
class FiringResult(TableResult):
    """V50 estimated from firing results.

    With few shots the intervals of maximum likelihood are too short, and separated shots have no curve; those of the
    penalised likelihood have close to their nominal coverage.

    Attributes
    ----------
    shots, complete : int
        Number of shots and of complete penetrations.
    highest_partial_m_s, lowest_complete_m_s : float or None
        Highest velocity of a partial and lowest velocity of a complete penetration, m/s; None if there is none.
    zone_of_mixed_results_m_s : float or None
        Width of the zone of mixed results, m/s: the highest partial minus the lowest complete penetration, 0 if all
        complete penetrations were faster; None if one kind is missing.
    separated : bool
        Whether every complete penetration was faster than every partial one.
    mean : MeanV50 or None
        None if the shots do not meet the rule.
    means : tuple of MeanV50
        The means that were tried: those of shots whose span exceeds the one allowed, and ``mean``, if there is one.
    fits : tuple of FittedCurve
        Curves of maximum likelihood; with a prior, empty if the shots have none.
    penalised_fits : tuple of FittedCurve
        Curves of Firth's penalised likelihood; without those that do not rise, and empty if none does.
    recommended : FittedCurve or None
        The first of the penalised curves: the probit one, if it rises.
    confidence : float
        Confidence level of the intervals.
    model_ballistic_limit_m_s : float or None
        Ballistic limit of the scenario, m/s, where one is given.  The model is deterministic: the limit has no scatter.
    expected_limit_m_s : float or None
        Ballistic limit that the armour exceeds with a probability of 50 %, given tests of such armours but not these
        shots, m/s; None if the model error is not known.
    model_interval_m_s : tuple of float or None
        Interval of the armour's limit with a probability of 95 %, m/s; None if the model error is not known.
    notes : tuple of Note
        Shots far from the others or from the model's limit, or contradicting the prior, and ways in which the scenario
        is unlike what the model was compared with.
    prior, posterior : FiringEstimate or None
        V50 and the scatter by the model with its error, without and with the shots; None unless requested.
    prior_share : float or None
        Share of the prior in the precision of V50: its posterior variance divided by its prior variance.
    bounded_confidence : float or None
        Greatest level at which the recommended interval of V50 is bounded: the confidence level or, below it, 0.9, 0.8
        or 0.5; None if it is bounded at none of them.
    bounded_interval_m_s : tuple of float or None
        The interval of V50 at this level, m/s.
    extrapolated : bool
        Whether V50 by the recommended curve lies beyond all shots and its interval is bounded at none of these levels.
    further : FurtherShot or None
        The one further result that would bound V50 best, where the shots do not bound it at the confidence level: its
        ``velocity_m_s``, and whether ``complete``.  The ``interval_m_s`` of V50 with this result is given at the
        greatest of these levels at which it is bounded, ``confidence``; both are None if there is no such level.
    at : ProbabilityAt or None
        At a ``velocity_m_s`` asked for, the ``probability`` of complete penetration and its ``interval``.
    velocity_of : VelocityOf or None
        For a ``fraction`` asked for, the ``velocity_m_s`` at which this fraction of the shots perforate, the
        ``interval_m_s`` of this velocity, and its one-sided lower bound, ``lower_m_s``.
    requirement_m_s : float or None
        Required velocity, m/s.
    requirement_fraction : float
        Fraction of shots that may perforate at the required velocity.
    decision : {"met", "not met", "not decided", ""}
        Whether the requirement is met, by the shots alone; empty without one.
    consumers_risk, producers_risk : float or None
        Risk of accepting armour that does not meet the requirement, and of rejecting armour that does, by these shots:
        1 minus the confidence at which a one-sided bound lies at the required velocity.  The requirement is decided
        once either risk is at most 1 minus the confidence asked for.  None without a requirement or recommended curve.
    fired : Shots
        The shots, and how they were read.
    """

    shots: int
    complete: int
    highest_partial_m_s: float | None
    lowest_complete_m_s: float | None
    separated: bool
    mean: MeanV50 | None
    fits: tuple[FittedCurve, ...]
    penalised_fits: tuple[FittedCurve, ...]
    recommended: FittedCurve | None
    confidence: float
    model_ballistic_limit_m_s: float | None
    model_interval_m_s: tuple[float, float] | None = None
    notes: tuple[Note, ...] = ()
    prior: FiringEstimate | None = None
    posterior: FiringEstimate | None = None
    prior_share: float | None = None
    zone_of_mixed_results_m_s: float | None = None
    bounded_confidence: float | None = None
    bounded_interval_m_s: tuple[float, float] | None = None
    extrapolated: bool = False
    further: FurtherShot | None = None
    at: ProbabilityAt | None = None
    velocity_of: VelocityOf | None = None
    requirement_m_s: float | None = None
    requirement_fraction: float = 0.5
    decision: Decision = ""
    consumers_risk: float | None = None
    producers_risk: float | None = None
    fired: Shots | None = None
    expected_limit_m_s: float | None = None
    means: tuple[MeanV50, ...] = ()

    def difference(self, second: "FiringResult", confidence: Confidence | None = None) -> V50Difference:
        """Return the V50 of a second lot minus that of this one, if both lots have one scatter.

        Parameters
        ----------
        second : FiringResult
            V50 of the other lot.
        confidence : float, optional
            Confidence level of the interval, by default that of this result.

        Returns
        -------
        V50Difference

        Raises
        ------
        NoAnswerError
            If one of the two has no recommended curve.
        """
        if self.recommended is None or second.recommended is None:
            raise NoAnswerError("no difference: one of the lots has no recommended curve")
        lots = (lot.question["shots"] for lot in (self, second))
        first, other = (
            ShotLikelihood(shots.of(complete=False), shots.of(complete=True), "probit", penalised=True)
            for shots in lots
        )
        return difference_of(first, other, confidence or self.confidence)

    @checked
    def band(self, velocities_m_s: FloatOrArray | None = None) -> list[dict[str, Any]]:
        """Return the recommended curve with its pointwise confidence band, as rows.

        Parameters
        ----------
        velocities_m_s : sequence of float, optional
            0 to 10,000 m/s; by default 201 from the shots and half their range to either side.

        Returns
        -------
        list of dict
            With ``velocity_m_s``, ``probability`` of complete penetration and its ``probability_interval``.

        Raises
        ------
        InputError
            If no curve is recommended, or a velocity is out of range.
        """
        shots: Shots = self.question["shots"]
        if (curve := self.recommended) is None:
            raise mistake(shots.file, "", "must have a recommended curve for a band, and these shots have none")
        if velocities_m_s is None:
            slowest, fastest = min(shots.velocities_m_s), max(shots.velocities_m_s)
            margin = 0.5 * (fastest - slowest)
            ends = max(slowest - margin, MIN_VELOCITY_M_S), fastest + margin
            velocities_m_s = np.linspace(*ends, 201)
        velocities = np.ravel(velocities_m_s).tolist()
        if not velocities or not all(0.0 <= velocity <= MAX_VELOCITY_M_S for velocity in velocities):
            message = f"must be velocities of 0 to {MAX_VELOCITY_M_S:g} m/s, found {describe(velocities)}"
            raise mistake("band", "velocities_m_s", message)
        partial, complete = shots.of(complete=False), shots.of(complete=True)
        low, high = curves.penalised_band(partial, complete, curve.curve, velocities, self.confidence)
        return [
            {"velocity_m_s": velocity, "probability": curve.probability(velocity), "probability_interval": ends}
            for velocity, *ends in zip(velocities, low.tolist(), high.tolist(), strict=True)
        ]

    def _columns(self) -> dict[str, Any]:
        """Return the columns of the table: a fitted curve in each row."""
        return by_column(vars(fit) for fit in (*self.penalised_fits, *self.fits))


@dataclass(frozen=True, repr=False)
class LotResults(EachResult):
    """V50 of each of several lots, and the differences of every two of them.

    Attributes
    ----------
    differences : mapping of tuple of str to V50Difference
        By the names of both lots, ("lot B", "lot A") for the V50 of B minus that of A.  The intervals of all together
        have the confidence level of the results: of n differences, each interval is of the level at which n times fewer
        are wrong, and each p value is n times that of the two lots alone.
    """

    differences: Mapping[tuple[str, str], V50Difference]

    def to_dict(self) -> dict[str, Any]:
        """Return the results as plain data, by name, and the differences."""
        differences = {" minus ".join(lots): dict(vars(found)) for lots, found in self.differences.items()}
        return {**super().to_dict(), "differences": differences}


def compared(results: Mapping[str, FiringResult], unanswered: Mapping[str, str]) -> LotResults:
    """Return the results of lots, by name, with the differences of every two of them.

    `unanswered` says, by name, why other lots have no V50.
    """
    lots = {name: result for name, result in results.items() if result.recommended is not None}
    comparisons, differences = [*combinations(lots.items(), 2)], {}
    for (first, one), (second, other) in comparisons:
        found = one.difference(other, 1.0 - (1.0 - one.confidence) / len(comparisons))
        p_value = min(found.p_value * len(comparisons), 1.0)
        differences[second, first] = replace(found, p_value=p_value)
    return LotResults(results, unanswered, differences)


@checked
def read_shots(
    path: Table,
    *,
    one_kind: bool = False,
    where: Mapping[str, str] | None = None,
    sheet: str | None = None,
    ignore: Names = (),
) -> Shots:
    """Read firing results.

    Parameters
    ----------
    path : path-like, sequence of mappings, mapping of columns or data frame
        CSV file, workbook (.xlsx) or the name of a shipped table, ``"tests/shots"``; or the rows themselves, each a
        mapping by column, columns by name, or a data frame of pandas or polars.
        Its columns are ``velocity_m_s``, ``result`` ("partial" or "complete", "stopped" or "perforated", P or C,
        PP or CP, no or yes, in letters of any case), optionally ``shot`` and ``counts`` (yes or no); the page "Tables"
        has other names and units.  Another column must not divide the shots, as one of operators does, and a remark in
        it is a warning of `v50` and of `plan_shots`, which decide on no requirement over it.
    one_kind : bool
        Whether to accept shots of one kind only, all partial or all complete penetrations, or no shots yet; they are
        enough for a plan and for a posterior.
    where : mapping of str to str, optional
        Columns, such as ``panel``, and the values of the rows to read; others are left out.  It must be given if a
        column divides the shots into several firings.
    sheet : str, optional
        Sheet of a workbook, by default the only visible one with a table.
    ignore : str or sequence of str, optional
        Columns that are not read whatever they say of the shots; all shots count.

    Returns
    -------
    Shots

    Raises
    ------
    InputError
        With every mistake in the file.
    """
    return shots_of(csv_files.open_table(path, is_of_shots, sheet), one_kind=one_kind, where=where, ignore=ignore)


def is_of_shots(name: str) -> bool:
    """Return whether a text names a column of a table of shots."""
    return column_of(name, SHOT_COLUMNS).known


def shots_of(
    source: Source, *, one_kind: bool = False, where: Mapping[str, str] | None = None, ignore: Names = ()
) -> Shots:
    """Return the shots of an open table; arguments and errors are those of `read_shots`."""
    table = csv_files.read_rows(source, SHOTS, where, 0 if one_kind else 1, (*ignore,))
    rows = table.rows
    velocities = [row.numbers.get("velocity_m_s", MIN_VELOCITY_M_S) for row in rows]
    words = [row.texts.get("result", "") for row in rows]
    results = [perforates(text) for text in words]
    formula = "; if it is a formula, open the workbook and save it" * bool(source.sheet)
    keys = [column.key for column in columns_of(source.header, SHOTS.keys)]
    of_velocity, of_result = (source.title(keys.index(key)) for key in SHOTS.needed)
    told = dict[object, bool | None]()
    for row, velocity, result, text in zip(rows, velocities, results, words, strict=True):
        written = row.texts.get("velocity_m_s", "")
        if told.setdefault((row.texts.get("shot", row.place), velocity), result) is not result:
            source.wrong(row.place, "has the name and velocity of an earlier shot but another result: leave one out")
        if not written:
            source.wrong(f"{row.place}: {of_velocity}", f"is missing and must be given{formula}")
        elif not MIN_VELOCITY_M_S <= velocity <= MAX_VELOCITY_M_S:
            message = f"must be at least {MIN_VELOCITY_M_S:g} and at most {MAX_VELOCITY_M_S:g}, found {written}"
            source.wrong(f"{row.place}: {of_velocity}", f"{message}; is it in m/s?")
        if result is None:
            source.wrong(f"{row.place}: {of_result}", csv_files.wrong_result(text))
    for name, values in table.groups.items():
        if len({*values}) > 1 and csv_files.targets_of(source, table, name, results):
            source.divided(name, values, "shot")
    targets = [row.texts.get(TARGET, "") for row in rows]
    if len({*targets} - {""}) > 1:
        source.divided(TARGET, targets, "shot")
    source.refuse()
    names = tuple(row.texts.get("shot", "") for row in rows)
    names = names if any(names) else ()
    shots = Shots((*velocities,), (*map(bool, results),), source.file, names, table.read, max(targets, default=""))
    check_shots(shots, kinds=0 if one_kind else 2)
    return shots


def lots_of(
    path: Table, column: str, where: Mapping[str, str], sheet: str | None, ignore: Sequence[str]
) -> list[tuple[str, str]]:
    """Return the lots of a table of shots: the values that a column has in shots that count, each after its name.

    `column` may be any usual name of the column of lots; the other arguments are those of `read_shots`.
    """
    source = csv_files.open_table(path, is_of_shots, sheet)
    lines = [*source.lines]
    source.lines = iter(lines)
    places = {row.place for row in csv_files.read_rows(source, SHOTS, where, ignore=ignore, closed=False).rows}
    source.refuse()
    index = csv_files.places_of(source, columns_of(source.header, SHOTS.keys), column, "--each")[0]
    name, values = source.title(index), {place: cells[index] for place, cells in lines if place in places}
    refuse(csv_files.not_filled(source.file, name, [place for place, value in values.items() if not value]))
    return [(name, value) for value in dict.fromkeys(values.values())]


@checked
def v50(
    shots: Shots,
    scenario: Scenario | None = None,
    *,
    pairs: Annotated[int, Field(ge=1)] | None = None,
    span_m_s: Annotated[float, Field(ge=0.0, le=MAX_VELOCITY_M_S)] | None = None,
    confidence: Confidence = CONFIDENCE,
    prior: bool = False,
    at_m_s: Velocity | None = None,
    fraction: Fraction | None = None,
    requirement_m_s: Velocity | None = None,
    requirement_fraction: Fraction = 0.5,
    on_progress: OnProgress = ignore_progress,
) -> FiringResult:
    """Estimate V50 from firing results.

    Parameters
    ----------
    shots : Shots
        At least one partial and one complete penetration, or, with a prior, at least one of either.
    scenario : Scenario, optional
        Scenario with the same armour and projectile, for its ballistic limit.
    pairs : int, optional
        Number of shots of each kind in the MIL-STD-662F mean, at least 1; by default the greatest of 5, 3 and 2 whose
        span is allowed.
    span_m_s : float, optional
        Greatest span of their velocities, m/s, at most 10,000; by default the usual one for 5, 3 or 2 shots of each
        kind: 38.1, 27.432 or 18.288 (125, 90 or 60 ft/s).  Required for other numbers of shots.
    confidence : float, default 0.95
        Confidence level of the intervals, 0.5 to 0.9999.
    prior : bool
        Whether to add the posterior of V50, whose prior is the scenario's expected limit.
    at_m_s : float, optional
        Velocity, m/s, at which to give the probability of complete penetration.
    fraction : float, optional
        Fraction of shots, 0.001 to 0.999, for which to give the velocity at which it perforates; 0.01 gives V01.
    requirement_m_s : float, optional
        Required velocity, m/s.  Whether the armour's velocity exceeds it is decided by the shots alone, with a
        risk of about 1 minus the confidence.
    requirement_fraction : float
        Fraction of shots that may perforate at the required velocity, 0.001 to 0.999; 0.5 sets the requirement on V50.
    on_progress : callable, optional
        Called with the number of impacts computed since the last call, and None, as their total is not known.

    Returns
    -------
    FiringResult

    Raises
    ------
    InputError
        If a setting is out of its range, the shots are not of both kinds, or the model error is not known for a
        prior.
    NoAnswerError
        If the complete penetrations were no faster on average than the partial ones, unless there is a prior, or the
        scenario has no ballistic limit.
    """
    if span_m_s is None and pairs is not None and pairs not in SPANS_M_S:
        raise mistake("v50", "span_m_s", f"must be given for {pairs} pairs; a span is usual with 2, 3 and 5 only")
    check_shots(shots, kinds=1 if prior else 2, decides=requirement_m_s is not None)
    if prior and scenario is None:
        raise mistake("v50", "prior", "must be given with a scenario")
    if requirement_m_s is None and requirement_fraction != 0.5:
        raise mistake("v50", "requirement_fraction", "must not be given without a requirement")
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    # With a prior, shots that have no curve are informative too.
    have_curves = not prior or curves.has_curve(partial, complete)
    fits = _rising_curves(partial, complete, confidence, penalised=False) if have_curves else []
    penalised_fits = _rising_curves(partial, complete, confidence, penalised=True) if have_curves else []
    likelihood, recommended = penalised_fits[0] if penalised_fits else (None, None)
    level, interval = _bounded_v50(likelihood, confidence) if likelihood else (None, None)
    at, velocity_of = None, None
    if likelihood and recommended and at_m_s is not None:
        chances = likelihood.probability_interval(at_m_s, confidence)
        at = ProbabilityAt(at_m_s, recommended.probability(at_m_s), chances)
    if likelihood and recommended and fraction is not None:
        z = float(curves.INVERSE_CDFS[likelihood.link](fraction))
        velocity = curves.bounded(recommended.v50_m_s + z * recommended.scale_m_s)
        ends, lower = likelihood.velocity_interval(z, confidence), likelihood.lower_bound(z, confidence)
        velocity_of = VelocityOf(fraction, velocity, ends, lower)
    decision, accepting, rejecting = decided(likelihood, requirement_m_s, requirement_fraction, confidence)
    model = None if scenario is None else ballistic_limit(scenario, on_progress=on_progress)
    prior_estimate, posterior_estimate, share = None, None, None
    contradictions: tuple[str, ...] = ()
    if prior and scenario and model:
        if model.model_error is None:
            message = f"must give scale_percent, degrees_of_freedom and source for a prior: {no_error(scenario)}"
            raise mistake(scenario.file, "uncertainty.model", message)
        model_prior = FiringPrior(model.ballistic_limit_m_s, model.model_error)
        before = posterior_of(model_prior, (), ())
        after = posterior_of(model_prior, shots.velocities_m_s, shots.complete)
        prior_estimate, posterior_estimate, share, contradictions = learned(before, after, confidence)
    is_outside = recommended and not min(shots.velocities_m_s) <= recommended.v50_m_s <= max(shots.velocities_m_s)
    armour_and_round = f": {scenario.subject(ANY_VELOCITY)}" if scenario else ""
    return FiringResult(
        shots=len(shots.complete),
        complete=len(complete),
        highest_partial_m_s=partial[-1] if partial else None,
        lowest_complete_m_s=complete[0] if complete else None,
        separated=not partial or not complete or partial[-1] < complete[0],
        mean=mean_v50(partial, complete, pairs, span_m_s),
        means=means_of(partial, complete, pairs, span_m_s),
        fits=tuple(fit for _, fit in fits),
        penalised_fits=tuple(fit for _, fit in penalised_fits),
        recommended=recommended,
        confidence=confidence,
        model_ballistic_limit_m_s=model.ballistic_limit_m_s if model else None,
        model_interval_m_s=model.interval_m_s if model else None,
        notes=(
            *map(Note, doubts(shots, model)),
            *(Note(wrong, TARGET) for wrong in (of_another(shots, scenario) if scenario else ())),
            *(() if model is None else (*map(Note, (*_far_shots(shots, model), *contradictions)), *model.notes)),
        ),
        prior=prior_estimate,
        posterior=posterior_estimate,
        prior_share=share,
        zone_of_mixed_results_m_s=max(partial[-1] - complete[0], 0.0) if partial and complete else None,
        bounded_confidence=level,
        bounded_interval_m_s=interval,
        extrapolated=bool(is_outside and level is None),
        further=_further_shot(partial, complete, confidence) if likelihood and level != confidence else None,
        at=at,
        velocity_of=velocity_of,
        requirement_m_s=requirement_m_s,
        requirement_fraction=requirement_fraction,
        decision=decision,
        consumers_risk=accepting,
        producers_risk=rejecting,
        fired=shots,
        expected_limit_m_s=model.expected_limit_m_s if model else None,
    ).of(f"V50 of the shots in {Path(shots.file).name}{armour_and_round}", scenario=scenario, shots=shots)


def _rising_curves(
    partial: Sequence[float], complete: Sequence[float], confidence: float, *, penalised: bool
) -> list[tuple[ShotLikelihood, FittedCurve]]:
    """Return the likelihood and the likeliest curve by each link, probit and logit, without curves that do not rise.

    `partial` and `complete` are ascending velocities, m/s; the likelihoods are `penalised` or not, and `confidence` is
    the level of the intervals.
    """
    likelihoods = (ShotLikelihood(partial, complete, link, penalised=penalised) for link in curves.CDFS)
    return [(shots, curve) for shots in likelihoods if (curve := curves.curve_of(shots, confidence))]


def _bounded_v50(shots: ShotLikelihood, confidence: float) -> tuple[float, tuple[float, float]] | tuple[None, None]:
    """Return the highest confidence level at which V50 has a bounded interval, and this interval, m/s; None if none.

    The level is `confidence` or, below it, one of LOWER_LEVELS.
    """
    for level in (confidence, *(level for level in LOWER_LEVELS if level < confidence)):
        low, high = shots.velocity_interval(0.0, level)
        if low is not None and high is not None:
            return level, (low, high)
    return None, None


def _further_shot(partial: Sequence[float], complete: Sequence[float], confidence: float) -> FurtherShot:
    """Return the one further result, complete or partial, at a velocity near the shots, that would bound V50 best.

    It is the result that makes a constant probability least likely, compared with the likeliest curve.
    """
    velocities = np.sort([*partial, *complete])
    middle, best = median(velocities), None
    # Shots far from most others do not widen the range.
    reach = min(velocities[-1] - velocities[0], WIDEST * median(abs(velocities - middle)))
    near = velocities[abs(velocities - middle) <= reach]
    ends = max(near[0] - reach, MIN_VELOCITY_M_S), min(near[-1] + reach, MAX_VELOCITY_M_S)
    for velocity in np.linspace(*ends, FURTHER).round().tolist():
        for stopped, perforated in (([*partial, velocity], complete), (partial, [*complete, velocity])):
            if curves.has_curve(stopped, perforated):
                shots = ShotLikelihood(stopped, perforated, "probit", penalised=True)
                if best is None or shots.flat_deviance > best[0].flat_deviance:
                    best = shots, velocity, perforated is not complete
    assert best is not None  # the shots have a curve, and still have one with a further slow partial penetration
    shots, velocity, is_complete = best
    return FurtherShot(velocity, is_complete, *_bounded_v50(shots, confidence))


def decided(
    shots: ShotLikelihood | None, requirement_m_s: float | None, fraction: float, confidence: float
) -> tuple[Decision, float | None, float | None]:
    """Return the decision on a requirement, and the risks of accepting and of rejecting the armour now, 0 to 1.

    The requirement is that the velocity at which `fraction` of the shots perforate exceeds `requirement_m_s`.  A risk
    is 1 minus the confidence at which a one-sided bound by the recommended curve is the required velocity.
    """
    if requirement_m_s is None:
        return "", None, None
    if shots is None:
        return "not decided", None, None
    accepting = shots.chance_below(float(curves.INVERSE_CDFS[shots.link](fraction)), requirement_m_s)
    risk = 1.0 - confidence + 1e-12  # for rounding
    decision: Decision = "met" if accepting <= risk else "not met" if 1.0 - accepting <= risk else "not decided"
    return decision, accepting, 1.0 - accepting


def doubts(shots: Shots, model: LimitResult | None) -> Iterator[str]:
    """Yield warnings of shots that may be wrong: remarks in columns that are not read, velocities in ft/s, outliers.

    `model` has the limit by the model, with which the velocities are compared; None without one.
    """
    yield from shots.read.warnings if shots.read else ()
    if not shots.complete:
        return
    middle = median(shots.velocities_m_s)
    if model is not None and (note := feet_note(middle, model.ballistic_limit_m_s)):
        yield note
    for velocity in shots.velocities_m_s:
        if not 0.5 * middle < velocity < 2.0 * middle:
            yield (
                f"a shot at {velocity:g} m/s is far from the median of the shots, {middle:.0f} m/s; check its unit and "
                "its decimal point: one such shot can spoil the estimate"
            )


def of_another(shots: Shots, scenario: Scenario) -> Iterator[str]:
    """Yield the message that shots were fired at another armour, or with another round, than the scenario's, if so."""
    if shots.target not in ("", subject := scenario.subject(ANY_VELOCITY)):
        yield f"must be the scenario's, {subject}, found {shots.target}"


def _far_shots(shots: Shots, model: LimitResult) -> Iterator[str]:
    """Yield a warning if all shots lie on one side of the model's 95 % interval of the limit, unless in ft/s."""
    low, high = model.interval_m_s or (-inf, inf)
    slowest, fastest = min(shots.velocities_m_s), max(shots.velocities_m_s)
    if (slowest > high or fastest < low) and not feet_note(median(shots.velocities_m_s), model.ballistic_limit_m_s):
        yield (
            f"all shots, at {slowest:g} to {fastest:g} m/s, lie outside the model's 95 % interval of the limit, "
            f"{low:.0f} to {high:.0f} m/s; check that they were fired at this armour with this projectile"
        )


def check_shots(shots: Shots, *, kinds: int, decides: bool = False) -> None:
    """Raise an InputError unless the velocities and results of shots, from a file or not, can be used.

    At least `kinds` of the two kinds, partial and complete, must be present.  If the shots decide on a requirement, as
    `decides` tells, no column that is not read may have remarks on them.
    """
    velocities = shots.velocities_m_s
    count, message = len(shots.complete), ""
    wrong: list[object] = [value for value in velocities if not isinstance(value, int | float)]
    wrong += [value for value in shots.complete if not _is_result(value)]
    if len(velocities) != count:
        message = f"must have as many velocities as results, found {len(velocities)} and {count}"
    elif wrong:
        message = "must be velocities as numbers, and True for each complete penetration, False for each partial one"
        message += f", found {describe(wrong[0])}"
    elif outliers := [value for value in velocities if not MIN_VELOCITY_M_S <= value <= MAX_VELOCITY_M_S]:
        message = f"must be at least {MIN_VELOCITY_M_S:g} and at most {MAX_VELOCITY_M_S:g} m/s, found {outliers[0]:g}"
    elif len(set(shots.complete)) < kinds:
        present = f"only {'complete' if shots.complete[0] else 'partial'} ones" if count else "none"
        least = "partial and one complete penetration" if kinds == 2 else "shot"
        message = f"must have at least one {least}, found {present}"
        message += "; armour plan shots gives the next velocity, and decides with results of one kind" * (count > 0)
    if message:
        raise mistake(shots.file, "", message)
    remarks = shots.read.warnings if shots.read and decides else ()
    remedy = 'for a requirement, a column "counts" with "no" leaves shots out; or --ignore this one'
    refuse(Problem(shots.file, "", f"{remark}; {remedy}") for remark in remarks)


def check_not_swapped(shots: Shots) -> None:
    """Raise an InputError if every complete penetration was slower than every partial one: the results are swapped.

    Shots so few that this can happen by chance are accepted.
    """
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    if comb(len(shots.complete), len(complete)) >= SWAPPED and complete[-1] < partial[0]:
        message = (
            f"must have complete penetrations that are not all slower than the partial ones, found complete ones up to "
            f"{complete[-1]:g} m/s and partial ones from {partial[0]:g} m/s; are the results swapped?"
        )
        raise mistake(shots.file, "result", message)


def mean_v50(
    partial: Sequence[float], complete: Sequence[float], pairs: int | None = None, span_m_s: float | None = None
) -> MeanV50 | None:
    """Compute the mean of MIL-STD-662F from ascending velocities, m/s; None if too few lie within the span.

    The velocities are those of `partial` and of `complete` penetrations; `span_m_s` is the greatest span allowed.
    `pairs` is the number of shots of each kind, by default the first of 5, 3 and 2 that the span allows; for any other
    number the span must be given.
    """
    return next((mean for mean in means_of(partial, complete, pairs, span_m_s) if mean.is_allowed), None)


def means_of(
    partial: Sequence[float], complete: Sequence[float], pairs: int | None = None, span_m_s: float | None = None
) -> tuple[MeanV50, ...]:
    """Compute the means that `mean_v50` tries, in order: those of shots too far apart, and the allowed one, if any.

    The arguments are those of `mean_v50`.
    """
    means = []
    for count in SPANS_M_S if pairs is None else (pairs,):
        velocities = [*partial[-count:], *complete[:count]]
        if len(velocities) == 2 * count:
            span = max(velocities) - min(velocities)
            allowed = SPANS_M_S[count] if span_m_s is None else span_m_s
            usual = SPANS_M_S.get(count)
            rule: SpanRule = "no usual rule" if usual is None else "usual span" if allowed == usual else "given span"
            means.append(MeanV50(sum(velocities) / len(velocities), count, span, allowed, rule))
            if means[-1].is_allowed:
                break
    return tuple(means)
