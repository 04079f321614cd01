"""Texts of tables."""

from collections.abc import Iterable

from armour.reporting.table import Table


def headings(table: Table) -> list[str]:
    """Headings of the columns."""
    return [column.heading for column in table.columns]


def quantities(table: Table) -> dict[str, str]:
    """Texts of a record by heading."""
    [texts] = table.texts()
    return dict(zip(headings(table), texts, strict=True))


def facts(shown: Iterable[Table | str]) -> dict[str, str]:
    """Texts of the first record of an answer by label."""
    return quantities(next(item for item in shown if isinstance(item, Table) and item.record))
