"""Figures of the paper: what they show, and their curves computed by the model."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError, field_validator

from armour.analysis.evaluate import evaluate
from armour.analysis.quantities import QUANTITIES
from armour.errors import InputError
from armour.files import read_toml, shipped
from armour.scenario.loading import load_scenario
from armour.scenario.messages import Section, problems_of
from armour.scenario.schema import Range
from armour.validation.suite import load_suite
from armour.validation.validate import SuiteResult, paper_suite, validate

PARITY = "parity_table3"


class CurveSection(Section):
    """A curve: its label and the changes that it makes to the scenario."""

    label: str = ""
    set: dict[str, Any] = {}


class MarkSection(Section):
    """Numbers stated in the paper's text, drawn in the colour of the curve that ``of`` names."""

    label: str
    of: str = ""
    points: Annotated[list[list[float]], Field(min_length=1)]


class LevelSection(Section):
    """A value at which the paper's text compares curves."""

    label: str
    value: float


class FigureSection(Section):
    """A figure: quantities of a scenario over one or more of its keys, which take the same values."""

    name: str
    title: str
    scenario: str
    over: Annotated[list[str], Field(min_length=1)]
    range: Range
    quantities: Annotated[list[str], Field(min_length=1)]
    x_label: str
    y_label: str
    curve: list[CurveSection] = [CurveSection()]
    mark: list[MarkSection] = []
    level: list[LevelSection] = []

    @field_validator("quantities")
    @classmethod
    def _known(cls, names: list[str]) -> list[str]:
        unknown = [name for name in names if name not in QUANTITIES]
        if unknown:
            raise ValueError(f"must name quantities, found {', '.join(unknown)}")
        return names


class FigureFile(Section):
    """A file of figures."""

    figure: list[FigureSection]


@dataclass(frozen=True)
class FigureCurve:
    """A quantity over the abscissa; None where it has no value."""

    label: str
    values: tuple[float | None, ...]


@dataclass(frozen=True)
class FigureMark:
    """Points stated in the paper's text, and the label of the curve that they belong to."""

    label: str
    of: str
    points: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class FigureLevel:
    """A value of the ordinate at which the paper's text compares curves."""

    label: str
    value: float


@dataclass(frozen=True)
class Figure:
    """Computed data of a figure.

    Attributes
    ----------
    name, title : str
    x_label, y_label : str
        Headings of the axes, with the unit.
    x : tuple of float
        Abscissa of every curve.
    curves : tuple of FigureCurve
    marks : tuple of FigureMark
    levels : tuple of FigureLevel
    """

    name: str
    title: str
    x_label: str
    y_label: str
    x: tuple[float, ...]
    curves: tuple[FigureCurve, ...]
    marks: tuple[FigureMark, ...]
    levels: tuple[FigureLevel, ...]


def paper_figures() -> Path:
    """Return the file that describes the paper's figures."""
    return shipped("suites") / "figures.toml"


def read_figures(path: Path) -> list[FigureSection]:
    """Read a file of figures.

    Raises
    ------
    InputError
        With every mistake in it.
    """
    try:
        return FigureFile.model_validate(read_toml(path)).figure
    except ValidationError as error:
        raise InputError(problems_of(error, FigureFile, str(path))) from None


def compute_figure(section: FigureSection, folder: Path) -> Figure:
    """Compute the curves of a figure.

    Parameters
    ----------
    section : FigureSection
    folder : Path
        Folder that the path of its scenario is relative to.

    Raises
    ------
    InputError
        If the scenario does not allow a value, or a run does not end.
    """
    base = load_scenario(folder / section.scenario)
    x = section.range.values()
    curves = []
    for curve in section.curve:
        columns = dict.fromkeys(section.over, np.array(x))
        found = evaluate(base.replaced(curve.set), columns, section.quantities)
        for name in section.quantities:
            label = ", ".join(part for part in (curve.label, QUANTITIES[name].label) if part)
            shown = curve.label if len(section.quantities) == 1 and curve.label else label
            values = tuple(float(value) if np.isfinite(value) else None for value in found[name])
            curves.append(FigureCurve(shown, values))
    return Figure(
        name=section.name,
        title=section.title,
        x_label=section.x_label,
        y_label=section.y_label,
        x=x,
        curves=tuple(curves),
        marks=tuple(FigureMark(mark.label, mark.of, tuple((x, y) for x, y in mark.points)) for mark in section.mark),
        levels=tuple(FigureLevel(level.label, level.value) for level in section.level),
    )


def parity_of_table_3() -> SuiteResult:
    """Compute table 3 of the paper."""
    return validate(load_suite(paper_suite()).only("table 3"))
