"""A report: what its HTML and Markdown versions show."""

import sys
from dataclasses import dataclass
from importlib.metadata import version
from typing import NamedTuple

from armour import MODEL_VERSION, __version__
from armour.reporting.chart import Chart
from armour.reporting.table import Column, Table

ORIGIN = (
    "The model is that of the published paper “Modeling penetration of ceramic/metal lightweight armours by small and "
    "medium caliber projectiles”. Do not rely on this report alone for anyone's protection."
)
# Packages whose versions the results can depend on.
PACKAGES = ("numpy", "scipy", "numba", "llvmlite")


class Card(NamedTuple):
    """A statement of the answer: its subject, the statement and what goes with it."""

    subject: str
    statement: str
    detail: str


class CrossSection(NamedTuple):
    """Penetrator and layers of the armour, for a drawing to scale; lengths in mm."""

    rod: str
    rod_length: float
    rod_diameter: float
    ceramic: str
    ceramic_thickness: float
    backing: str
    backing_thickness: float


@dataclass(frozen=True)
class Section:
    """A heading with paragraphs, the text of a file or a command, tables, and notes on named things, in this order."""

    heading: str
    paragraphs: tuple[str, ...] = ()
    code: str = ""
    language: str = ""
    tables: tuple[Table, ...] = ()
    notes: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Report:
    """A report: a question or a verdict, the answer, and sections; cross-section and charts are in HTML only."""

    title: str
    lead: str  # the question or the verdict
    sections: tuple[Section, ...]
    charts: tuple[Chart, ...]
    cards: tuple[Card, ...] = ()
    warnings: tuple[str, ...] = ()
    cross_section: CrossSection | None = None
    passed: bool | None = None  # of a suite
    byline: tuple[tuple[str, str], ...] = ()  # such as the author: what it is, and its text
    remarks: tuple[str, ...] = ()  # on the armour that is reported, after the lead


def origin_section(command: str) -> Section:
    """Return the section on the command that makes a report and the programs that its results depend on."""
    versions = [("armour", __version__), ("model", MODEL_VERSION), ("Python", sys.version.split()[0])]
    versions += [(name, version(name)) for name in PACKAGES]
    table = Table((Column("program"), Column("version")), tuple(versions))
    return Section("Origin", (ORIGIN, "Made by:"), command, "console", (table,))
