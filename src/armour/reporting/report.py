"""A report: what its HTML and Markdown versions show, and its Markdown."""

import re
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

from armour import MODEL_VERSION, __version__
from armour.analysis.results import installed
from armour.errors import in_two_lines
from armour.files import printable, read_toml, shipped
from armour.reporting.table import Column, Table
from armour.reporting.text import printable_lines
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
    drawn: bool = False  # whether the pictures show what is in the tables, which HTML then leaves out


@dataclass(frozen=True)
class Report:
    """A report: a verdict, the answer, and sections; cross-section and pictures are in HTML only."""

    title: str
    lead: str  # the verdict, if there is one
    sections: tuple[ReportSection, ...]
    cards: tuple[Card, ...] = ()
    warnings: tuple[str, ...] = ()
    cross_section: Scenario | None = None  # of the armour that is drawn to scale
    passed: bool | None = None  # None where nothing was asked for
    byline: tuple[tuple[str, str], ...] = ()  # such as the author: what it is, and its text
    text: str = ""  # after the verdict

    @property
    def in_short(self) -> str:
        """The first lines of the warnings, which are folded."""
        return in_two_lines(self.warnings, "below")[0]


def origin_section(command: str, words: str = "", scenario: Scenario | None = None) -> ReportSection:
    """Return the section on the command that makes a report, the scenario and the programs it depends on."""
    versions = [("armour", __version__), ("model", MODEL_VERSION), ("Python", sys.version.split()[0])]
    versions += installed(PACKAGES)
    table = Table((Column("program"), Column("version")), tuple(versions))
    content = f"SHA-256 of the scenario's content: {scenario.digest()}" if scenario else ""
    paragraphs = (*filter(None, (words, content)), "Made by:")
    return ReportSection("Command and versions", paragraphs, command, "console", tables=(table,), folded=True)


def reference_notes(texts: Iterable[str]) -> tuple[tuple[str, str], ...]:
    """Return the sources of the bibliography that texts cite by their keys in brackets, in this order."""
    known = read_toml(shipped("configs") / "references.toml")
    keys = dict.fromkeys(key for text in texts for key in re.findall(r"\[(\w+)\]", text) if key in known)
    return tuple((key, _cited(known[key])) for key in keys)


def _cited(source: dict[str, str]) -> str:
    parts = [source[part] for part in ("authors", "title", "where", "year") if part in source]
    return ", ".join(parts) + (f", doi {source['doi']}" if "doi" in source else "")


def markdown_table(table: Table) -> str:
    """Format a table as Markdown, without its title."""
    lines = [
        [markdown_text(heading) for heading in table.headings()],
        ["---:" if column.numeric else "---" for column in table.columns],
        *([markdown_text(text) for text in texts] for texts in table.texts()),
    ]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def markdown_text(text: str) -> str:
    """Escape the markup and the control characters of a text, and join its lines."""
    text = re.sub(r"[\\|*_<>`\[~$&]", r"\\\g<0>", printable(" ".join(text.split())))
    # What begins a heading, a list or a rule at the start of a line.
    return re.sub(r"^(#{0,5}|\d{0,9})([#+\-.)])(?=[ -]|$)", r"\1\\\2", text)


def markdown_report(report: Report) -> str:
    """Format a report as Markdown, without its pictures."""
    parts = [f"# {markdown_text(report.title)}"]
    if report.byline:
        parts.append(", ".join(markdown_text(f"{name}: {text}") for name, text in report.byline))
    if report.cards:
        cards = ([markdown_text(text) for text in card] for card in report.cards)
        parts.append(
            "\n".join(
                f"* {subject}: **{words}**" + (f"; {detail}" if detail else "") for subject, words, detail in cards
            )
        )
    parts += (markdown_text(words) for words in (report.lead, report.text) if words)
    parts += (f"Warning: {markdown_text(warning)}" for warning in report.warnings)
    for section in report.sections:
        parts += _section(section)
    return "\n\n".join(parts) + "\n"


def _section(section: ReportSection) -> list[str]:
    parts = [f"## {markdown_text(section.heading)}", *(markdown_text(words) for words in section.paragraphs)]
    if section.code:
        parts.append(_fenced(section.code, section.language))
    for table in section.tables:
        if len(section.tables) > 1 and table.title:
            parts.append(f"### {markdown_text(table.title)}")
        parts.append(markdown_table(table))
    if section.notes:
        parts.append("\n".join(f"* {markdown_text(name)}: {markdown_text(note)}." for name, note in section.notes))
    return parts if len(parts) > 1 else []


def _fenced(text: str, language: str) -> str:
    """Return text within a fence longer than any in it."""
    text = printable_lines(text)
    fence = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    return f"{fence}{language}\n{text.rstrip()}\n{fence}"
