"""Tables of impacts, of ballistic limits and of the probability that an armour stops its threat."""

from typing import NamedTuple

from armour.analysis.ballistic_limit import ConfidenceResult, LimitResult
from armour.analysis.impact import History, ImpactResult
from armour.analysis.results import EachResult
from armour.reporting import words as phrases
from armour.reporting.by_result import by_result, in_a_line, line_of, tables_of
from armour.reporting.table import Column, Source, Table, VerdictLine, interval, rows_csv


class StageWords(NamedTuple):
    """A stage of an impact in words: the event that begins it, its name, and its description."""

    begins: str
    name: str
    words: str


STAGES = {
    "i": StageWords("impact", "intact ceramic", "intact ceramic; penetrator erodes"),
    "ii.1": StageWords("ceramic fragments", "fragmented ceramic", "fragmented ceramic; penetrator erodes"),
    "ii.2": StageWords("front held", "ceramic carried or held", "ceramic carried or held (dwell); penetrator erodes"),
    "ii.3": StageWords("erosion ends", "ceramic, rigid penetrator", "ceramic; penetrator rigid"),
    "iii.1": StageWords("penetrator erodes", "plate, eroding penetrator", "plate; penetrator erodes"),
    "iii.2": StageWords("front held", "plate carried or held", "plate carried or held (dwell); penetrator erodes"),
    "iii.3": StageWords("erosion ends", "plate, rigid penetrator", "plate; penetrator rigid"),
    "iii.4": StageWords("plug moves along", "plug carried along", "plate carried; penetrator rigid"),
    "iii.5": StageWords("ceramic moves along", "ceramic carried along", "fragmented ceramic carried; penetrator rigid"),
}


@tables_of.register
def tables_of_each(result: EachResult) -> list[Table | str]:
    """Return the tables of several results, those of each below its name, and why there are no others."""
    shown: list[Table | str] = []
    for name, part in result.results.items():
        shown += [f"{name}: {part.heading()[0]}", *by_result(tables_of, part)(part)]
    return [*shown, *(f"{name}: {reason}" for name, reason in result.unanswered.items())]


@tables_of.register
def tables_of_impact(result: ImpactResult) -> list[Table | str]:
    """Return the outcome of an impact, its probability if computed, what remains of the projectile, and the stages."""
    is_good = result.outcome == "stopped" and not phrases.said_of(result.notes, "not known")
    parts: list[Table | str] = [VerdictLine(in_a_line(result), good=is_good)]
    if (confidence := result.question.get("confidence")) is not None:
        parts += tables_of_confidence(confidence)
        distributed = result.question["scenario"].uncertainty
        if confidence.model_error is None and distributed is not None and distributed.inputs():
            parts.append(f"{phrases.SAMPLED_ALONE}: armour uncertainty")
    before = map(Column.of, ("residual_length_mm", "residual_mass_g"))
    plug = Column.of("plug_velocity_m_s"), result.plug_velocity_m_s or None
    after = map(Column.of, ("penetration_depth_mm", "bulge_height_mm", "duration_us", "areal_density_kg_m2"))
    return [*parts, Table.of_one(result, *before, plug, *after, phrases.WHOLE), stage_table(result)]


@line_of.register
def impact_in_a_line(result: ImpactResult) -> str:
    """Return the outcome of an impact with the caveats of the model or, if it is not known, the reason."""
    stopped = result.outcome == "stopped"
    outcome = result.outcome + ("" if stopped else f", residual velocity {result.residual_velocity_m_s:.0f} m/s")
    unknown = phrases.said_of(result.notes, "not known", *(["too low"] if result.outcome == "perforated" else []))
    words = [f"not known: {result.outcome} by the model, but {reason}" for reason in unknown] or [outcome]
    return "; ".join([*words, *(caveat for caveat in phrases.said_of(result.notes) if caveat not in unknown)])


def caveat_lines(result: LimitResult) -> list[Table | str]:
    """Return a line for each caveat of the model on a ballistic limit."""
    unknown = phrases.said_of(result.notes, "not known")
    lines = [VerdictLine(f"not known: {words}", good=False) for words in unknown]
    return [*lines, *phrases.said_of(result.notes)]


def stage_table(result: ImpactResult) -> Table:
    """Tabulate the stages of an impact: times, and what the projectile loses of velocity, length and energy in each."""
    description: Source = Column("description", prose=True), lambda record: STAGES[record.stage].words
    numbers = Column.of_each(start_us=".1f", end_us=".1f", velocity_lost_m_s=".0f", length_lost_mm=".1f")
    energy = Column("energy lost", "J", ".0f", key="energy_lost_J")
    return Table.of(result.stages, Column.of("stage"), description, *numbers, energy)


def history_csv(result: ImpactResult) -> str | None:
    """Format the history of an impact as CSV; None if it was not kept."""
    if result.history is None:
        return None
    return rows_csv(result.history)


def crossing_table(result: LimitResult) -> Table:
    """Tabulate the velocities at which the outcome changes, and the outcome above each."""
    columns = Column("velocity", "m/s", ".1f"), Column("outcome above")
    return Table(columns, tuple((crossing.bracket_m_s[1], crossing.above) for crossing in result.crossings))


@line_of.register
def limit_in_a_line(result: LimitResult) -> str:
    """Return the ballistic limit with its interval and the caveats of the model."""
    ends = "" if result.interval_m_s is None else f", 95 % interval {interval(result.interval_m_s, '.0f')} m/s"
    return "; ".join([f"ballistic limit {result.ballistic_limit_m_s:.0f} m/s{ends}", *map(str, caveat_lines(result))])


@line_of.register
def history_in_a_line(result: History) -> str:
    """Return the number of instants and their range."""
    return f"{len(result.time_us)} instants from 0 to {result.time_us[-1]:.2f} µs"


@line_of.register
def confidence_in_a_line(result: ConfidenceResult) -> str:
    """Return the probability of stopping."""
    return f"{phrases.STOPPING.label} {phrases.chance(result.probability_of_stopping, result.model_error)}"


@line_of.register
def each_in_a_line(result: EachResult) -> str:
    """Return the names of the results."""
    return ", ".join((*result.results, *result.unanswered))


@tables_of.register
def tables_of_limit(result: LimitResult) -> list[Table | str]:
    """Return the ballistic limit, the model error and the velocities scanned.

    If the outcome changes more than once, a table of the changes follows.
    """
    low, high = result.scanned_range_m_s
    below, above = result.bracket_m_s
    scanned = f"{result.scanned_velocities} velocities from {low:g} to {high:g} m/s were scanned"
    width = f"bracket width {above - below:.1g} m/s"
    limits = phrases.BALLISTIC_LIMIT, phrases.with_error(result.expected_limit_m_s, result.interval_m_s)
    table = Table.of_one(result, *limits, Column.of("areal_density_kg_m2"), phrases.WHOLE)
    parts = [*caveat_lines(result), table, phrases.error_note(result.model_error, result.question.get("scenario"))]
    if result.monotonic:
        return [*parts, f"{scanned}, all above the limit perforate; {width}"]
    return [*parts, f"{scanned}, the outcome changes {len(result.crossings)} times; {width}", crossing_table(result)]


@tables_of.register
def tables_of_confidence(result: ConfidenceResult) -> list[Table | str]:
    """Return the probability of stopping with the ballistic limit, and what it rests on."""
    limit, probability = (
        phrases.with_error(result.expected_limit_m_s, result.interval_m_s),
        result.probability_of_stopping,
    )
    stopping = phrases.STOPPING, None if probability is None else phrases.chance(probability, result.model_error)
    return [Table.of_one(result, phrases.BALLISTIC_LIMIT, limit, stopping), *phrases.basis_notes(result)]
