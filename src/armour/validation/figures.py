"""Read the descriptions of the paper's figures, and compute their curves by the model."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from armour.analysis.evaluate import evaluate
from armour.analysis.quantities import QUANTITIES
from armour.files import read_toml, shipped, shipped_suites
from armour.scenario.scenario import load_scenario
from armour.scenario.schema import Range
from armour.scenario.sections import Section, validated
from armour.validation.suite import load_suite
from armour.validation.validate import SuiteResult, validate

# Figures of computed over expected values: the suite of each, and a text that the names of its cases contain.
PARITIES = {"parity_table3": ("paper", "table 3"), "parity_plates": ("plates", "")}


class CurveSection(Section):
    """A curve of a figure: its label, and the changes that it makes to the scenario, by key."""

    label: str = ""
    set: dict[str, Any] = {}


class FigureMark(Section):
    """Points that the paper's text gives, in the colour of the curve whose label is ``of``.

    ``x_ends`` has the lowest and the highest x of each, if its x is a range.
    """

    label: str
    of: str = ""
    points: Annotated[list[list[float]], Field(min_length=1)]
    x_ends: list[Annotated[list[float], Field(min_length=2, max_length=2)]] = []


class FigureLine(Section):
    """A horizontal line of a figure: the value on the y axis at which the paper's text compares curves."""

    label: str
    value: float


class FigureSection(Section):
    """A figure, or one panel of a figure: quantities of a scenario over the values ``range`` of its keys ``over``.

    All these keys take the same value.  Sections with the same name are the panels of a figure.  ``add_to_x`` is added
    to the values on the x axis, and the quantities are divided by ``divide_by``.
    """

    name: str
    title: str
    scenario: str
    over: Annotated[list[str], Field(min_length=1)]
    range: Range
    quantities: Annotated[list[str], Field(min_length=1)]
    x_label: str
    y_label: str
    add_to_x: float = 0.0
    divide_by: Annotated[float, Field(gt=0.0)] = 1.0
    curve: list[CurveSection] = [CurveSection()]
    mark: list[FigureMark] = []
    level: list[FigureLine] = []


class FigureFile(Section):
    """The contents of a file that describes figures."""

    figure: list[FigureSection]


@dataclass(frozen=True)
class Figure:
    """Computed curves of a figure or of one of its panels, by label, over ``x``; None where a curve has no value."""

    section: FigureSection
    x: tuple[float, ...]
    curves: Mapping[str, tuple[float | None, ...]]


def paper_figures() -> Path:
    """Return the file that describes the paper's figures."""
    return shipped("configs") / "figures.toml"


def read_figures(path: Path) -> list[FigureSection]:
    """Read a file that describes figures; return a section for each figure or panel."""
    return validated(FigureFile, read_toml(path), str(path)).figure


def compute_figure(section: FigureSection, folder: Path) -> Figure:
    """Compute the curves of a figure by the model; the file of its scenario is in `folder`."""
    scenario = load_scenario(folder / section.scenario)
    x = section.range.values()
    columns = dict.fromkeys(section.over, np.array(x))
    curves = {}
    for curve in section.curve:
        computed = evaluate(scenario.replaced(curve.set), columns, section.quantities)
        for name in section.quantities:
            parts = [curve.label] if curve.label else []
            if len(section.quantities) > 1 or not parts:
                parts.append(QUANTITIES[name].label)
            scaled = computed[name] / section.divide_by
            curves[", ".join(parts)] = tuple(float(value) if np.isfinite(value) else None for value in scaled)
    # Rounded, so that sums have no spurious digits.
    return Figure(section, tuple(round(value + section.add_to_x, 9) for value in x), curves)


def parity(name: str) -> SuiteResult:
    """Compute the cases of a figure of computed over expected values, given its name in `PARITIES`."""
    suite, text = PARITIES[name]
    return validate(load_suite(shipped_suites()[suite]).only(text))
