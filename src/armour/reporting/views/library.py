"""Tables of the library of projectiles and materials, and of the files shipped with the program."""

from collections.abc import Callable, Collection, Mapping
from typing import Any

from armour.files import read_toml, shipped_files, shipped_suites
from armour.reporting.table import Column, Table
from armour.scenario.inputs import Kind
from armour.scenario.library import DYNAMIC, KINDS, OPTIONAL, STATIC, LibraryEntry, NamedThreat

# Numerical attributes of a threat that its table shows.
VALUES = ("velocity_m_s", "tolerance_m_s", "obliquity_deg")
# Contents and use of the shipped tables of tests, which have no titles of their own.
TABLES_OF_TESTS = {
    "tests/plates": "ballistic limits of 1,084 bare plates, for armour validate plates",
    "tests/shots": "firing results on one armour, for armour v50",
    "tests/unknown_ceramic": "simulated ballistic limits of 4 armours, for armour calibrate",
    "tests/wilkins": "ballistic limits of 13 armours, for armour calibrate",
}


def library_table(kind: Kind, entries: Collection[LibraryEntry]) -> Table:
    """Tabulate entries of a kind: name, values to 4 digits, and description.

    A value that is derived in every entry has no column.
    """
    used_keys = {key for entry in entries for key in entry.values if key not in (*OPTIONAL, *entry.derived)} | {STATIC}
    keys = [key for key in KINDS[kind].model_fields if key in used_keys]
    return Table.of(
        entries,
        Column.of("name", label=kind),
        *((Column.of(key, "g"), lambda entry, key=key: _shown(entry, key)) for key in keys),
        (Column("sources give", "GPa"), lambda entry: " to ".join(map("{:g}".format, entry.flow_stress_sources_GPa))),
        (Column.of("description", prose=True), lambda entry: entry.description + " (doubtful)" * bool(entry.doubtful)),
    )


def _shown(entry: LibraryEntry, key: str) -> float | None:
    """Return a value of an entry to 4 digits; None if it is absent, or if only the static strength is known."""
    is_shown = key in entry.values and not (key == DYNAMIC and entry.is_static)
    return float(f"{entry[key]:.4g}") if is_shown else None


def threat_table(threats: Mapping[str, NamedThreat]) -> Table:
    """Tabulate the named threats: round, projectile, velocity with its tolerance, angle and status."""
    return Table.of(
        threats.items(),
        (Column("threat", prose=True), lambda item: item[0]),
        (Column("round", prose=True), lambda item: item[1].round),
        (Column("projectile", prose=True), lambda item: item[1].projectile),
        *((Column.of(key, "g"), lambda item, key=key: getattr(item[1], key)) for key in VALUES),
        (Column("status"), lambda item: item[1].status),
    )


def tables_by_kind(items: Mapping[Any, Mapping[str, Any]]) -> list[Table]:
    """Return a table for each kind of library entry, and for threats; `items` has them by kind and name."""
    return [
        threat_table(some) if kind == "threat" else library_table(kind, some.values()) for kind, some in items.items()
    ]


def shipped_tables() -> list[Table | str]:
    """Return a table for each kind of shipped file: scenarios, suites, tables of tests or shots, and notebooks."""
    titled = {"scenario": shipped_files("scenarios", ".toml"), "suite for armour validate": shipped_suites()}
    shown = {
        kind: {name: str(read_toml(path)["title"]) for name, path in some.items()} for kind, some in titled.items()
    }
    shown["scenario"]["template"] = "Every key with a comment: what armour init copies by default"
    shown["table of tests"] = TABLES_OF_TESTS
    shown["notebook"] = {"study.ipynb": "A study in Python, for Jupyter"}
    return [Table((Column(kind), Column("contents", prose=True)), tuple(rows.items())) for kind, rows in shown.items()]


KEY = Column("key")


def entry_table(entry: LibraryEntry, first: Column = KEY, words: Callable[[str], str] = str) -> Table:
    """Tabulate the values of a library entry, with status and source.

    `first` is the column of the keys, which `words` turns into text.
    """
    columns = (first, Column("value", spec="g"), Column("status"), Column("source", prose=True))
    return Table(columns, tuple((words(key), v.value, v.status, v.source) for key, v in entry.values.items()))


def entry_tables(entry: LibraryEntry) -> list[Table | str]:
    """Return the description of a library entry, its aliases, any doubt about it, and the table of its values."""
    aliases = f"also {', '.join(entry.aliases)}" if entry.aliases else ""
    doubtful = f"doubtful: {entry.doubtful}" if entry.doubtful else ""
    return [*filter(None, (entry.description, aliases, doubtful)), entry_table(entry)]
