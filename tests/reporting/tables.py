"""Texts of tables."""

from armour.reporting.table import Table


def headings(table: Table) -> list[str]:
    """Headings of the columns."""
    return [column.heading for column in table.columns]


def quantities(table: Table) -> dict[str, str]:
    """Texts of a record by heading."""
    [texts] = table.texts()
    return dict(zip(headings(table), texts, strict=True))
