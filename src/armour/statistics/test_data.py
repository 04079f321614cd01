"""Tests for a calibration: a table of inputs and measurements, read from CSV."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from armour.analysis.variants import Floats, Ints
from armour.errors import InputError, Problem
from armour.scenario.loading import Scenario
from armour.scenario.parameters import INPUTS, NAMES, VELOCITY, check_names, check_ranges, inputs_of
from armour.statistics.csv_table import CsvRow, read_rows

LIMIT, RESIDUAL, MASS, OUTCOME = "ballistic_limit_m_s", "residual_velocity_m_s", "residual_mass_g", "outcome"
# Quantities that a test can measure, and the columns of their uncertainties (one standard deviation).
MEASURED = {
    LIMIT: "ballistic_limit_uncertainty_m_s",
    RESIDUAL: "residual_velocity_uncertainty_m_s",
    MASS: "residual_mass_uncertainty_g",
}
# Range of measurements and uncertainties, in any unit.
MIN_MEASURED, MAX_MEASURED = 1e-3, 1e6


class Measurement(NamedTuple):
    """A measurement of a test; of an outcome alone, a bound on the ballistic limit (a censored observation)."""

    test: int
    quantity: str
    value: float  # the impact velocity where only the outcome is known
    scale: float  # divides the deviation
    side: int  # 0; +1 where the limit is at least the value, -1 where it is at most the value


class MaterialGroup(NamedTuple):
    """Tests with the same projectile and materials."""

    scenario: Scenario
    where: Ints  # indices of the tests
    columns: dict[str, Floats]  # inputs that the table gives

    def column(self, name: str) -> Floats:
        """Return the values of an input; 0 where the scenario does not have it."""
        own = inputs_of(self.scenario).get(name, 0.0)
        return self.columns.get(name, np.full(len(self.where), own))


class Tests(NamedTuple):
    """A table of tests."""

    file: str
    names: tuple[str, ...]
    groups: tuple[MaterialGroup, ...]
    measurements: tuple[Measurement, ...]
    weighted: bool  # by uncertainties; else by the measured values
    cells: tuple[Mapping[str, float | str], ...]


def read_tests(path: Path, scenario: Scenario) -> Tests:
    """Read a table of tests: inputs that differ from test to test, and measurements.

    Parameters
    ----------
    path : Path
        CSV file.  Its columns are inputs of the scenario, names of projectiles and materials, measured quantities and
        their uncertainties, ``outcome``, and ``test``, the name of the test.
    scenario : Scenario
        Inputs that the tests have in common.

    Raises
    ------
    InputError
        With every mistake in the file.
    """
    numbers = (*INPUTS, *MEASURED, *MEASURED.values())
    rows = read_rows(path, numbers=numbers, texts=("test", OUTCOME, *NAMES.values()), needed=())
    names = [str(row["test"] or row.place) for row in rows]
    problems = [problem for row in rows for problem in _row_problems(row, names, str(path))]
    # Whether an uncertainty is missing: it must be so for all measurements and outcomes, or for none.
    missing = {row[width] is None for row in rows for name, width in MEASURED.items() if row[name] is not None}
    censored = [row for row in rows if row[OUTCOME] is not None and all(row[name] is None for name in MEASURED)]
    missing |= {row[MEASURED[LIMIT]] is None for row in censored}
    if len(missing) == 2:
        message = "uncertainties must be given for every measurement and outcome, or for none"
        problems.append(Problem(str(path), "", message))
    if problems:
        raise InputError(problems)
    by_names: dict[tuple[Any, ...], list[int]] = {}
    for i, row in enumerate(rows):
        by_names.setdefault(tuple(row[name] for name in NAMES.values()), []).append(i)
    groups = []
    for where in by_names.values():
        try:
            groups.append(_group(rows, where, scenario, str(path)))
        except InputError as error:
            place = rows[where[0]].place
            problems += (Problem(str(path), place, f"{problem.key}: {problem.message}") for problem in error.problems)
    if problems:
        raise InputError(problems)
    measurements = tuple(m for i, row in enumerate(rows) for m in _measurements(i, row))
    cells = tuple(
        {name: cell for name, cell in row.cells.items() if cell is not None and name not in MEASURED.values()}
        for row in rows
    )
    return Tests(str(path), tuple(names), tuple(groups), measurements, missing == {False}, cells)


def _group(rows: Sequence[CsvRow], where: Sequence[int], scenario: Scenario, file: str) -> MaterialGroup:
    """Group of tests with the same projectile and materials.

    Raises
    ------
    InputError
        If the scenario does not allow a name or a value.
    """
    names = {name: rows[where[0]][name] for name in NAMES.values() if rows[where[0]][name] is not None}
    changed = scenario.replaced(names) if names else scenario
    own = inputs_of(changed)
    given = [name for name in INPUTS if any(rows[i][name] is not None for i in where)]
    check_names(given, changed, file)
    columns = {
        name: np.array([own[name] if rows[i][name] is None else rows[i][name] for i in where], dtype=np.float64)
        for name in given
    }
    check_ranges(changed, columns)
    return MaterialGroup(changed, np.array(where), columns)


def _row_problems(row: CsvRow, names: Sequence[str], file: str) -> list[Problem]:
    """Mistakes in a row."""
    problems = []

    def add(name: str, message: str) -> None:
        problems.append(Problem(file, f"{row.place}: {name}" if name else row.place, message))

    if row["test"] is not None and names.count(str(row["test"])) > 1:
        add("test", f'must name one test, found "{row["test"]}" on several lines')
    found = [name for name in (*MEASURED, OUTCOME) if row[name] is not None]
    if not found:
        add("", f"must have one of {', '.join((*MEASURED, OUTCOME))}")
    if row[OUTCOME] is not None and row[OUTCOME] not in ("defeated", "perforated"):
        add(OUTCOME, f'must be "defeated" or "perforated", found "{row[OUTCOME]}"')
    if row[OUTCOME] == "defeated" and row[RESIDUAL] is not None:
        add(OUTCOME, "must not be defeated where there is a residual velocity")
    if row[OUTCOME] is not None and row[VELOCITY] is None:
        add(VELOCITY, "is missing and must be given with an outcome")
    for name in (*MEASURED, *MEASURED.values()):
        value = row[name]
        if isinstance(value, float) and not MIN_MEASURED <= value <= MAX_MEASURED:
            hint = '; a projectile that is stopped is an outcome, "defeated"' if name == RESIDUAL else ""
            add(name, f"must be at least {MIN_MEASURED:g} and at most {MAX_MEASURED:g}, found {value:g}{hint}")
    return problems


def _measurements(test: int, row: CsvRow) -> list[Measurement]:
    """Measurements in a row; the outcome counts where there is no other."""
    found = []
    for name, uncertainty in MEASURED.items():
        value, width = row[name], row[uncertainty]
        if isinstance(value, float):
            found.append(Measurement(test, name, value, width if isinstance(width, float) else value, 0))
    if row[OUTCOME] is not None and not found:
        velocity, width = row[VELOCITY], row[MEASURED[LIMIT]]
        assert isinstance(velocity, float)
        side = 1 if row[OUTCOME] == "defeated" else -1
        found.append(Measurement(test, LIMIT, velocity, width if isinstance(width, float) else velocity, side))
    return found
