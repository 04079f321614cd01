"""Answers on one armour: an impact, its ballistic limit, and the probability that it stops a shot."""

from collections.abc import Sequence
from typing import NamedTuple

from armour.analysis.ballistic_limit import ConfidenceResult, LimitResult
from armour.analysis.impact import History, ImpactResult
from armour.analysis.results import EachResult
from armour.reporting import words as phrases
from armour.reporting.by_result import by_result, in_a_line, line_of, tables_of
from armour.reporting.table import Column, Source, Table, VerdictLine, between
from armour.validation.tested import limits_measured


class StageWords(NamedTuple):
    """A stage of an impact in words: the event that begins it, and its description."""

    begins: str
    words: str


STAGES = {
    "i": StageWords("impact", "tile intact, penetrator erodes"),
    "ii.1": StageWords("tile fragments", "tile in fragments, penetrator erodes"),
    "ii.2": StageWords("front held", "dwell on the tile, penetrator erodes"),
    "ii.3": StageWords("erosion ends", "tile, penetrator rigid"),
    "iii.1": StageWords("penetrator erodes", "plate, penetrator erodes"),
    "iii.2": StageWords("front held", "dwell on the plate, penetrator erodes"),
    "iii.3": StageWords("erosion ends", "plate, penetrator rigid"),
    "iii.4": StageWords("plug moves along", "plate carried along"),
    "iii.5": StageWords("tile moves along", "fragments carried along"),
}


@tables_of.register
def tables_of_each(result: EachResult) -> list[Table | str]:
    """Return a line for each result and, with `every_row` in the question, its tables; then what has no answer."""
    shown, every_row = list[Table | str](), result.question.get("every_row")
    for name, part in result.results.items():
        part.of(every_row=every_row)
        line, *rest = by_result(tables_of, part)(part)
        shown += [VerdictLine(f"{name}: {line}", good=getattr(line, "good", None)), *(rest if every_row else ())]
    return [*shown, *(f"{name}: {reason}" for name, reason in result.unanswered.items())]


@tables_of.register
def tables_of_impact(result: ImpactResult) -> list[Table | str]:
    """Return the outcome of an impact, the limit, what is left of the penetrator, and the stages.

    With `every_row` in the question, return also the armour, and what the probability rests on.
    """
    unknown = _reasons_unknown(result)
    confidence: ConfidenceResult | None = result.question.get("confidence")
    left = [f"{result.residual_length_mm:.1f} mm and {result.residual_mass_g:.2f} g"]
    left += [f"plug {result.plug_velocity_m_s:.0f} m/s"] if result.plug_velocity_m_s else []
    left += [f"bulge {result.bulge_height_mm:.1f} mm, after {result.duration_us:.0f} µs"]
    facts = {"by the model": _by_model(result)} if unknown else {}
    facts["limit"] = "" if confidence is None else _limit_words(confidence, result.outcome)
    facts["left"] = "; ".join(left)
    caveats = [caveat for caveat in phrases.said_of(result.notes) if caveat not in unknown]
    shown: list[Table | str] = [VerdictLine(in_a_line(result), good=False if unknown else None)]
    far = [] if unknown else phrases.far_line(result.far_from_tests)
    shown += [Table.of_facts(facts), *far, *caveats, stage_table(result)]
    if not result.question.get("every_row"):
        return shown
    depth = f"{result.penetration_depth_mm:.1f} mm below the front face"
    shown.append(Table.of_facts({"armour": armour_words(result), "depth": depth}))
    if confidence is not None:
        shown += [*phrases.basis_notes(confidence), *phrases.v50_notes(confidence, result.impact_velocity_m_s)]
    return shown


def armour_words(result: ImpactResult | LimitResult) -> str:
    """Return armour, round and areal density, also that with a back plate that exists already, which it leaves out."""
    words, together = f"{result.areal_density_kg_m2:.1f} kg/m²", result.whole_areal_density_kg_m2
    if together not in (0.0, result.areal_density_kg_m2):
        words += f" ({together:.1f} kg/m² with the existing plate)"
    return ", ".join(filter(None, (result.subject(), words)))


def _limit_words(found: ConfidenceResult, outcome: str) -> str:
    """Return the limits of an armour by the model and as expected, and the probability that it stops a shot.

    The word "but" marks an expectation that contradicts the `outcome` by the model.
    """
    limit = "none found" if found.ballistic_limit_m_s is None else f"{found.ballistic_limit_m_s:.0f} m/s by the model"
    reason = "" if phrases.said_of(found.notes, "not known") else found.reason
    if (probability := found.probability_of_stopping) is None:
        return "; ".join(filter(None, (limit, reason)))
    stops = f"stops a shot with {phrases.chance(probability, found.model_error)}"
    if found.expected_limit_m_s is None:
        return f"{limit}; {stops}"
    joint = ";" if (probability >= 0.5) == (outcome == "stopped") else ", but"
    return f"{limit}{joint} {found.expected_limit_m_s:.0f} m/s expected, {stops}"


@line_of.register
def impact_in_a_line(result: ImpactResult) -> str:
    """Return the outcome of an impact by the model or, if it is not known, the reason."""
    reasons = _reasons_unknown(result)
    return f"not known: {'; '.join(reasons)}" if reasons else _by_model(result).replace(":", " by the model:", 1)


def _reasons_unknown(result: ImpactResult) -> list[str]:
    """Return the reasons why the outcome is not known though the model gives one; none if it is known."""
    return phrases.said_of(result.notes, "not known", *(["too low"] if result.outcome == "perforated" else []))


def _by_model(result: ImpactResult) -> str:
    """Return the outcome by the model, with the residual velocity or the depth."""
    if result.outcome == "stopped":
        return f"stopped: {result.penetration_depth_mm:.1f} mm deep"
    return f"perforated: {result.residual_velocity_m_s:.0f} m/s left of {result.impact_velocity_m_s:g} m/s"


def stage_table(result: ImpactResult) -> Table:
    """Tabulate the stages of an impact: what happens, until when, and what the penetrator loses in each."""
    happens: Source = Column("what happens", prose=True), lambda record: STAGES[record.stage].words
    lost = Column("lost", "m/s", ".0f", key="velocity_lost_m_s"), Column("", "mm", ".1f", key="length_lost_mm")
    energy = Column("", "J", ".0f", key="energy_lost_J")
    return Table.of(result.stages, Column.of("stage"), happens, Column.of("end_us", ".1f", "until"), *lost, energy)


@line_of.register
def limit_in_a_line(result: LimitResult) -> str:
    """Return the ballistic limit by the model, and the expected one with its interval or why it is not known."""
    limit = f"{result.ballistic_limit_m_s:.0f} m/s by the model"
    if unknown := phrases.said_of(result.notes, "not known"):
        return f"not known: {'; '.join(unknown)}"
    if result.expected_limit_m_s is None or result.interval_m_s is None:
        return limit
    return f"{limit}; {result.expected_limit_m_s:.0f} m/s expected ({between(0.95, result.interval_m_s, '.0f')} m/s)"


@line_of.register
def history_in_a_line(result: History) -> str:
    """Return the number of instants of a history and their range, µs."""
    return f"{len(result.time_us)} instants from 0 to {result.time_us[-1]:.2f} µs"


@line_of.register
def confidence_in_a_line(result: ConfidenceResult) -> str:
    """Return the probability of stopping a shot or why it is not known."""
    if result.probability_of_stopping is None:
        return f"not known: {result.reason}"
    return f"stops a shot with {phrases.chance(result.probability_of_stopping, result.model_error)}"


@line_of.register
def each_in_a_line(result: EachResult) -> str:
    """Return the names of the results."""
    return ", ".join((*result.results, *result.unanswered))


@tables_of.register
def tables_of_limit(result: LimitResult) -> list[Table | str]:
    """Return the ballistic limit, the armour, the tests, and the changes of the outcome if there are several.

    With `every_row` in the question, return also the model error and the velocities scanned.
    """
    is_unknown = bool(phrases.said_of(result.notes, "not known"))
    shown: list[Table | str] = [VerdictLine(in_a_line(result), good=False if is_unknown else None)]
    limit = f"{result.ballistic_limit_m_s:.0f} m/s by the model" if is_unknown else ""
    tests = "" if is_unknown else tests_words(result)
    shown.append(Table.of_facts({"limit": limit, "armour": armour_words(result), "tests": tests}))
    far = [] if is_unknown else phrases.far_line(result.far_from_tests)
    shown += [*far, *phrases.said_of(result.notes), *crossings(result)]
    if result.question.get("every_row"):
        low, high = result.scanned_range_m_s
        below, above = result.bracket_m_s
        scanned = f"{result.scanned_velocities} velocities from {low:g} to {high:g} m/s were scanned"
        shown += [] if result.model_error is None else [phrases.model_error_words(result.model_error)]
        shown.append(f"{scanned}; bracket width {above - below:.1g} m/s")
    return shown


def crossings(result: LimitResult) -> list[Table | str]:
    """Tabulate the velocities at which the outcome changes, and the outcome above each; nothing if it changes once."""
    if result.monotonic:
        return []
    columns = Column("velocity", "m/s", ".1f"), Column("outcome above")
    table = Table(columns, tuple((crossing.bracket_m_s[1], crossing.above) for crossing in result.crossings))
    return [f"the outcome changes {len(result.crossings)} times", table]


def tests_words(result: LimitResult) -> str:
    """Return the tests from which the limit is expected, or why it is not known, and the tests of this very armour."""
    here = measured_here(result)
    source = f"not known: {result.reason}" if result.reason else ""
    source = result.model_error.source.replace(" tests of ", " of ", 1) if result.model_error else source
    measured = f"{len(here)} of this very armour: {limits_in_words(here)}" if here else ""
    return "; ".join(filter(None, (source, measured)))


def measured_here(result: LimitResult) -> list[float]:
    """Return the ballistic limits, m/s, that tests measured of this very armour against this round."""
    if result.model_error is not None and result.model_error.tests_here is not None:
        return [*result.model_error.tests_here.limits_m_s]
    return limits_measured(result.question["scenario"]) if "scenario" in result.question else []


def limits_in_words(limits_m_s: Sequence[float]) -> str:
    """Return velocities in words: at most three, or else their range."""
    if len(limits_m_s) > 3:
        return f"{min(limits_m_s):.0f} to {max(limits_m_s):.0f} m/s"
    return f"{', '.join(f'{limit:.0f}' for limit in limits_m_s)} m/s"


@tables_of.register
def tables_of_confidence(result: ConfidenceResult) -> list[Table | str]:
    """Return the probability of stopping a shot with the ballistic limit, and what it rests on."""
    limit = "" if result.ballistic_limit_m_s is None else f"{result.ballistic_limit_m_s:.0f} m/s by the model"
    if result.expected_limit_m_s is not None:
        limit += f"; {result.expected_limit_m_s:.0f} m/s expected"
    return [VerdictLine(in_a_line(result)), Table.of_facts({"limit": limit}), *phrases.basis_notes(result)]
