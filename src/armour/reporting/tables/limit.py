"""Tables of a ballistic limit."""

from typing import TYPE_CHECKING

from armour.reporting.table import Column, Table, record
from armour.reporting.tables.impact import AREAL_DENSITY

if TYPE_CHECKING:
    from armour.analysis.ballistic_limit import LimitResult


def limit_table(result: "LimitResult") -> Table:
    """Return a ballistic limit, quantity by quantity."""
    low, high = result.bracket_m_s
    return record(
        (Column("ballistic limit", "m/s", ".2f"), result.ballistic_limit_m_s),
        (Column("defeated at", "m/s", ".4f"), low),
        (Column("perforated at", "m/s", ".4f"), high),
        (Column("runs", spec="d"), result.runs),
        (AREAL_DENSITY, result.areal_density_kg_m2),
    )


def crossing_table(result: "LimitResult") -> Table:
    """Return every change of the outcome with the velocity."""
    columns = (Column("below", "m/s", ".4f"), Column("above", "m/s", ".4f"), Column("outcome above"))
    return Table(columns, tuple((*crossing.bracket_m_s, crossing.above) for crossing in result.crossings))


def limit_tables(result: "LimitResult") -> list[Table | str]:
    """Return all tables of a ballistic limit: the changes of the outcome only where there are several."""
    return [limit_table(result)] if result.monotonic else [limit_table(result), crossing_table(result)]
