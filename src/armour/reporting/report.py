"""The contents of a report, which `armour.reporting.formats` writes as HTML or as Markdown."""

import re
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from armour import MODEL_VERSION, __version__
from armour.analysis.results import installed
from armour.files import read_toml, shipped
from armour.reporting.table import Table
from armour.scenario.scenario import Scenario


@dataclass(frozen=True)
class ReportSection:
    """A section of a report: heading, paragraphs, code, pictures, tables and notes, shown in this order.

    Tables show their titles if there are several.  Only HTML shows the pictures, and only HTML can be folded.
    """

    heading: str
    paragraphs: tuple[str, ...] = ()
    code: str = ""  # text of a file, or a command
    language: str = ""  # of the code, such as "toml"
    pictures: tuple[Callable[[Any], Any], ...] = ()  # functions that draw on a sheet
    tables: tuple[Table, ...] = ()
    notes: tuple[tuple[str, str], ...] = ()  # names, each with a text
    folded: bool = False  # whether HTML shows the heading alone until a reader opens the section


@dataclass(frozen=True)
class Report:
    """A report, in the order shown: title, byline, lead, facts, text, warnings and sections.

    Only HTML shows the cross-section and the pictures.
    """

    title: str
    lead: str  # the verdict; empty if there is none
    sections: tuple[ReportSection, ...]
    facts: tuple[Table | str, ...] = ()  # what the lead rests on, in its box
    warnings: tuple[str, ...] = ()
    cross_section: Scenario | None = None  # its armour is drawn to scale
    passed: bool | None = None  # colours the lead; None for no colour
    byline: tuple[tuple[str, str], ...] = ()  # names and texts, such as ("author", "A. Smith")
    text: str = ""  # a paragraph after the lead
    signed: tuple[str, ...] = ()  # who signs at the end, such as "Fired by"
    pages: "tuple[Report, ...]" = ()  # further pages of the same file


def section_of(heading: str, lines: Sequence[Table | str], picture: Callable[..., Any] | None = None) -> ReportSection:
    """Return a section with the tables and lines of a result and the function that draws its picture, if any.

    A section with a picture is folded.
    """
    tables = tuple(line for line in lines if isinstance(line, Table))
    paragraphs = tuple(line for line in lines if not isinstance(line, Table))
    pictures = () if picture is None else (picture,)
    return ReportSection(heading, paragraphs, pictures=pictures, tables=tables, folded=picture is not None)


def origin_section(command: str, words: str = "", scenario: Scenario | None = None) -> ReportSection:
    """Return the section with the command that makes a report, the versions of the programs and the scenario's hash.

    `words`, if given, are its first paragraph.
    """
    versions = [("armour", __version__), ("model", MODEL_VERSION), ("Python", sys.version.split()[0])]
    versions += installed(("numpy", "scipy"))  # on which the results can depend
    content = f"SHA-256 of the scenario's content: {scenario.digest()}" if scenario else ""
    made_by = f"Made by {', '.join(f'{program} {version}' for program, version in versions)}:"
    paragraphs = (*filter(None, (words, content)), made_by)
    return ReportSection("Command and versions", paragraphs, command, "console", folded=True)


def reference_notes(texts: Iterable[str]) -> tuple[tuple[str, str], ...]:
    """Return key and citation of each source that the texts cite as "[key]", in the order of first citation.

    Keys that are not in references.toml are skipped.
    """
    sources = read_toml(shipped("configs") / "references.toml")
    keys = dict.fromkeys(key for text in texts for key in re.findall(r"\[(\w+)\]", text) if key in sources)
    return tuple((key, _citation(sources[key])) for key in keys)


def _citation(source: dict[str, str]) -> str:
    """Format an entry of references.toml."""
    parts = [source[part] for part in ("authors", "title", "where", "year") if part in source]
    return ", ".join(parts) + (f", doi {source['doi']}" if "doi" in source else "")
