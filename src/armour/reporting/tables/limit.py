"""Tables of a ballistic limit."""

from typing import TYPE_CHECKING

from armour.reporting.table import Column, Table, column_of, listing, record
from armour.reporting.tables.impact import AREAL_DENSITY, BALLISTIC_LIMIT

if TYPE_CHECKING:
    from armour.analysis.ballistic_limit import LimitResult


def limit_table(result: "LimitResult") -> Table:
    """Return a ballistic limit, quantity by quantity."""
    return record(
        result,
        BALLISTIC_LIMIT,
        (Column("defeated at", "m/s", ".4f"), lambda limit: limit.bracket_m_s[0]),
        (Column("perforated at", "m/s", ".4f"), lambda limit: limit.bracket_m_s[1]),
        column_of("runs", "d"),
        AREAL_DENSITY,
    )


def crossing_table(result: "LimitResult") -> Table:
    """Return every change of the outcome with the velocity."""
    return listing(
        result.crossings,
        (Column("below", "m/s", ".4f"), lambda crossing: crossing.bracket_m_s[0]),
        (Column("above", "m/s", ".4f"), lambda crossing: crossing.bracket_m_s[1]),
        column_of("above", label="outcome above"),
    )


def limit_tables(result: "LimitResult") -> list[Table | str]:
    """Return all tables of a ballistic limit: the changes of the outcome only where there are several."""
    return [limit_table(result)] if result.monotonic else [limit_table(result), crossing_table(result)]
