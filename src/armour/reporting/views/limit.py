"""A ballistic limit."""

from armour.analysis.ballistic_limit import LimitResult
from armour.reporting.table import Column, Table, column_of, listing, record
from armour.reporting.words import BALLISTIC_LIMIT, error_note, with_error


def crossing_table(result: LimitResult) -> Table:
    """Return every change of the outcome with the velocity."""
    return listing(
        result.crossings,
        (Column("velocity", "m/s", ".1f"), lambda crossing: crossing.bracket_m_s[1]),
        (Column("outcome above"), lambda crossing: crossing.above),
    )


def tables(result: LimitResult) -> list[Table | str]:
    """Return all tables of a ballistic limit, and what was looked at; the changes of the outcome only where several."""
    low, high = result.scanned_range_m_s
    below, above = result.bracket_m_s
    scanned = f"{result.scanned_velocities} velocities from {low:g} to {high:g} m/s were scanned"
    width = f"bracket width {above - below:.1g} m/s"
    limits = BALLISTIC_LIMIT, with_error(result.median_m_s, result.interval_m_s)
    table = record(result, *limits, column_of("areal_density_kg_m2"))
    parts: list[Table | str] = [table, error_note(result.model_error, result.question.get("scenario"))]
    if result.monotonic:
        return [*parts, f"{scanned}, all above the limit perforate; {width}"]
    return [*parts, f"{scanned}, the outcome changes {len(result.crossings)} times; {width}", crossing_table(result)]
