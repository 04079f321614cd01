"""A report: what its HTML and Markdown versions show."""

import re
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

from armour import MODEL_VERSION, __version__
from armour.analysis.results import installed
from armour.files import read_toml, shipped
from armour.reporting.table import Column, Table
from armour.scenario.scenario import Scenario

# Packages whose versions the results can depend on.
PACKAGES = ("numpy", "scipy", "numba", "llvmlite")


class Card(NamedTuple):
    """A statement of the answer: its subject, the statement and what goes with it."""

    subject: str
    statement: str
    detail: str


@dataclass(frozen=True)
class ReportSection:
    """A heading with paragraphs, text of a file or a command, pictures, tables, and notes on named things, in order.

    Tables have their titles where there are several.  HTML has the pictures, and folds what only explains the answer.
    """

    heading: str
    paragraphs: tuple[str, ...] = ()
    code: str = ""
    language: str = ""
    pictures: tuple[Callable[[Any], Any], ...] = ()  # each is drawn on a sheet
    tables: tuple[Table, ...] = ()
    notes: tuple[tuple[str, str], ...] = ()
    folded: bool = False
    drawn: bool = False  # whether the pictures show the contents of the tables, which HTML then leaves out


@dataclass(frozen=True)
class Report:
    """A report: a verdict, the answer, and sections; cross-section and pictures are in HTML only."""

    title: str
    lead: str  # the verdict, if there is one
    sections: tuple[ReportSection, ...]
    cards: tuple[Card, ...] = ()
    warnings: tuple[str, ...] = ()
    cross_section: Scenario | None = None  # of the armour that is drawn to scale
    passed: bool | None = None  # None without requirements
    byline: tuple[tuple[str, str], ...] = ()  # such as the author: what it is, and its text
    text: str = ""  # after the verdict


def origin_section(command: str, words: str = "", scenario: Scenario | None = None) -> ReportSection:
    """Return the section with the command that makes a report, the scenario, and the versions it depends on."""
    versions = [("armour", __version__), ("model", MODEL_VERSION), ("Python", sys.version.split()[0])]
    versions += installed(PACKAGES)
    table = Table((Column("program"), Column("version")), tuple(versions))
    content = f"SHA-256 of the scenario's content: {scenario.digest()}" if scenario else ""
    paragraphs = (*filter(None, (words, content)), "Made by:")
    return ReportSection("Command and versions", paragraphs, command, "console", tables=(table,), folded=True)


def reference_notes(texts: Iterable[str]) -> tuple[tuple[str, str], ...]:
    """Return the sources of the bibliography that texts cite by keys in brackets, in the order of the citations."""
    sources = read_toml(shipped("configs") / "references.toml")
    keys = dict.fromkeys(key for text in texts for key in re.findall(r"\[(\w+)\]", text) if key in sources)
    return tuple((key, _citation(sources[key])) for key in keys)


def _citation(source: dict[str, str]) -> str:
    parts = [source[part] for part in ("authors", "title", "where", "year") if part in source]
    return ", ".join(parts) + (f", doi {source['doi']}" if "doi" in source else "")
