"""Tables of the library of projectiles and materials."""

from typing import TYPE_CHECKING

from armour.reporting.table import Column, Table
from armour.units import words_and_unit

if TYPE_CHECKING:
    from armour.scenario.library import Kind, Library, LibraryEntry


# Labels of the keys that are not spelt as words.
LABELS = {"caliber_mm": "calibre", "youngs_modulus_GPa": "Young's modulus"}


def library_table(library: "Library", kind: "Kind") -> Table:
    """Return the library's entries of a kind: name, numbers and description."""
    entries = library.entries[kind].values()
    keys = list(dict.fromkeys(key for entry in entries for key in entry.values))
    columns = (
        Column(kind, key="name"),
        *(_column(key) for key in keys),
        Column("description", prose=True, key="description"),
    )
    rows = tuple(
        (entry.name, *(entry[key] if key in entry.values else None for key in keys), entry.description)
        for entry in entries
    )
    return Table(columns, rows)


def _column(key: str) -> Column:
    words, unit = words_and_unit(key)
    return Column(LABELS.get(key, words), unit, "g", key=key)


def library_tables(library: "Library") -> list[Table | str]:
    """Return a table of every kind of entry."""
    return [library_table(library, kind) for kind in library.entries]


def entry_table(entry: "LibraryEntry") -> Table:
    """Return the values of an entry of the library, with status and source."""
    columns = (Column("key"), Column("value", spec="g"), Column("status"), Column("source", prose=True))
    return Table(columns, tuple((key, v.value, v.status, v.source) for key, v in entry.values.items()))


def entry_tables(entry: "LibraryEntry") -> list[Table | str]:
    """Return the description and the table of an entry."""
    return [*([entry.description] if entry.description else []), entry_table(entry)]
