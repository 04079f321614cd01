"""Tests of a CSV file that a table of a suite is made of, and the groups that they are summarised in."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from armour.csv_files import number
from armour.errors import InputError, Problem
from armour.scenario.keys import describe
from armour.scenario.scenario import Scenario
from armour.scenario.sections import Section
from armour.statistics.test_data import read_tests

Cells = Mapping[str, float | str]


@dataclass(frozen=True)
class Condition:
    """Condition on a cell: one of some texts and numbers, or a number from a least one to below a greatest one."""

    values: tuple[float | str, ...] = ()
    least: float = -inf
    below: float = inf

    def met(self, cell: float | str | None) -> bool:
        """Whether a cell, None where it is empty, meets the condition."""
        value = number(str(cell))
        if self.values:
            return cell in self.values or value in self.values
        return value is not None and self.least <= value < self.below


def _condition(value: object) -> Condition:
    if (
        isinstance(value, dict)
        and value
        and not value.keys() - {"min", "below"}
        and all(map(_is_number, value.values()))
    ):
        return Condition((), value.get("min", -inf), value.get("below", inf))
    values: list[Any] = value if isinstance(value, list) else [value]
    if values and all(isinstance(one, str) or _is_number(one) for one in values):
        return Condition(tuple(values))
    must = "must be a text, a number, a list of them, or a range such as { min = 3, below = 7 }"
    raise ValueError(f"{must}, found {describe(value)}")


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


Where = dict[str, Annotated[Any, BeforeValidator(_condition)]]
Percent = Annotated[float, Field(ge=0.0, le=1e6)]


class GroupSection(Section):
    """Rows of a table that are summarised together, with the bands of their relative deviations."""

    name: Annotated[str, Field(min_length=1)]
    where: Where = {}
    mean_percent: Annotated[float, Field(ge=-1e6, le=1e6)] = 0.0
    mean_band_percent: Percent | None = None
    rms_band_percent: Percent | None = None


def meets(cells: Cells, where: Mapping[str, Condition]) -> bool:
    """Whether the cells of a row meet every condition."""
    return all(condition.met(cells.get(column)) for column, condition in where.items())


def selected(
    path: Path, scenario: Scenario, quantity: str, notes: list[str], where: Mapping[str, Condition]
) -> Iterator[tuple[str, Cells, Scenario]]:
    """Yield name, cells and scenario of the tests of a file that measure a quantity and meet the conditions.

    The scenario has the names of the projectile and of the materials, but not the numbers in the cells.
    """
    tests = read_tests(path, scenario, notes)
    of_test = {int(index): group.scenario for group in tests.groups for index in group.where}
    chosen = [i for i, cells in enumerate(tests.cells) if quantity in cells and meets(cells, where)]
    if not chosen:
        message = f"must have tests with {' and '.join((quantity, *where))} as the suite selects them, found none"
        raise InputError([Problem(str(path), "", message)])
    for i in chosen:
        yield tests.names[i], tests.cells[i], of_test[i]
