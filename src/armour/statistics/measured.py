"""Read tables of tests: their inputs and measurements."""

import re
from collections import Counter
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from armour import csv_files
from armour.analysis.results import by_column, data_frame
from armour.analysis.variants import Floats, Ints, Variants, variants_of
from armour.columns import Column, column_of, perforates
from armour.csv_files import CsvRow, Source, TableRead
from armour.errors import InputError, counted, joined
from armour.scenario.checked import Names, Table, checked
from armour.scenario.inputs import CERAMIC, INPUTS, NAMES, VELOCITY
from armour.scenario.scenario import ANY_VELOCITY, Scenario

LIMIT, RESIDUAL, MASS, OUTCOME = "ballistic_limit_m_s", "residual_velocity_m_s", "residual_mass_g", "outcome"
# Quantities that a test can measure, and the columns of their uncertainties (one standard deviation).
MEASURED = {
    LIMIT: "ballistic_limit_uncertainty_m_s",
    RESIDUAL: "residual_velocity_uncertainty_m_s",
    MASS: "residual_mass_uncertainty_g",
}
# Columns that identify the series of a test, and all columns that say where and when it was made.
SERIES_COLUMNS = ("laboratory", "series")
ORIGINS = (*SERIES_COLUMNS, "date")
# Text of a limit that is only known to lie on one side of a velocity, such as "above 950".
BOUND = re.compile(r"(?:(>=?|≥|above|at least)|(<=?|≤|below|at most)) *(.+)")
# Columns of numbers.
NUMBERS = (*INPUTS, *MEASURED, *MEASURED.values())
# Columns of texts, the name of the test first.
TEXTS = ("test", OUTCOME, *NAMES.values(), *ORIGINS)
# Columns of most tables, in words.
USUAL = f"{', '.join((*MEASURED, OUTCOME))}, test, armour.ceramic_thickness_mm and other keys of a scenario"
# Range of measurements and of uncertainties, in any unit.
MIN_MEASURED, MAX_MEASURED = 1e-3, 1e6


class Measurement(NamedTuple):
    """A measurement of a test.  An outcome alone is a bound on the ballistic limit (a censored observation)."""

    test: int  # index of the test
    quantity: str
    value: float  # the impact velocity where only the outcome is known
    uncertainty: float | None
    side: int  # 0 for a measured value; +1 if the limit is at least the value, -1 if it is at most the value


class MaterialGroup(NamedTuple):
    """Tests with the same projectile and materials."""

    scenario: Scenario
    where: Ints  # indices of the tests
    columns: dict[str, Floats]  # inputs that the table gives, by name, (tests,) each

    def variants(self, inputs: Mapping[str, Floats] | None = None) -> Variants:
        """Return the tests as variants of their scenario; `inputs`, (tests,) each, replace values by name of input."""
        return variants_of(self.scenario, {**self.columns, **(inputs or {})}, len(self.where))


@dataclass(frozen=True, repr=False)
class Tests:
    """A table of tests; `read_tests` makes one.

    Iteration gives each test as a dictionary, so that ``pandas.DataFrame(tests)`` works.

    Attributes
    ----------
    file : str
    names : tuple of str
        Names of the tests.
    groups : tuple of MaterialGroup
        Tests with the same projectile and materials.
    measurements : tuple of Measurement
    weighted : bool
        Whether the measured values have uncertainties.
    cells : tuple of mapping
        Inputs and measurements of each test as they stand in the table, by column.
    scenario : Scenario
        Inputs that the tests have in common.
    places : tuple of str
        Lines of the tests in the file.
    read : TableRead or None
        How the file was read, as in Shots.
    """

    file: str
    names: tuple[str, ...]
    groups: tuple[MaterialGroup, ...] = field(compare=False)
    measurements: tuple[Measurement, ...]
    weighted: bool
    cells: tuple[Mapping[str, float | str], ...]
    scenario: Scenario
    places: tuple[str, ...]
    read: TableRead | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        tests, measurements = counted(len(self.names), "test"), counted(len(self.measurements), "measurement")
        return f"<Tests: {tests} of {self.file}, {measurements}>"

    def __iter__(self) -> Iterator[dict[str, float | str | None]]:
        columns = dict.fromkeys(column for cells in self.cells for column in cells)
        for name, cells in zip(self.names, self.cells, strict=True):
            yield {"test": name, **{column: cells.get(column) for column in columns if column != "test"}}

    def to_dataframe(self) -> Any:
        """Return the tests as a data frame of pandas: inputs and measurements by column."""
        return data_frame(by_column(self))


def with_scatter(tests: Tests, scatter: float) -> Tests:
    """Return the tests with an uncertainty of each measurement: `scatter`, a fraction, times its value."""
    measurements = tuple(m._replace(uncertainty=scatter * m.value) for m in tests.measurements)
    return replace(tests, measurements=measurements, weighted=True)


def subject_of(tests: Tests) -> str:
    """Return what the tests are of, such as "Tests of AD85 on 6061-T6 against 7.62 mm AP"."""
    names = {key: [group.scenario.name_of(role) for group in tests.groups] for role, key in NAMES.items()}
    inputs = dict.fromkeys((key for group in tests.groups for key in group.columns), ())
    return f"Tests of {tests.scenario.subject({**ANY_VELOCITY, **names, **inputs})}"


def common_of(scenario: Scenario) -> tuple[object, ...]:
    """Return what all tests that were read with a scenario share, to compare scenarios: its sections and inputs."""
    sections = scenario.impact, scenario.armour, scenario.model, scenario.solver, scenario.ballistic_limit
    return *sections, scenario.inputs()


@checked
def read_tests(
    path: Table,
    scenario: Scenario,
    notes: Names = (),
    *,
    where: Mapping[str, str] | None = None,
    sheet: str | None = None,
    ignore: Names = (),
) -> Tests:
    """Read a table of tests: inputs that differ from test to test, and measurements.

    Parameters
    ----------
    path : path-like, sequence of mappings or data frame
        CSV file or the name of a shipped table, such as ``"tests/wilkins"``; or the rows themselves, each a
        mapping by column, or a data frame of pandas or polars, where None and NaN are empty cells.
        Its columns are inputs of the scenario, names of projectiles and materials, measured quantities and their
        uncertainties, ``outcome``, ``test``, the name of the test, and ``laboratory``, ``series`` and ``date``; the
        page "Tables" has other names for them.  A limit that is "above 950" or "below 900" is the outcome of a shot at
        this velocity.  A table of shots, as `read_shots` reads it, has outcomes of the scenario's armour.
    scenario : Scenario
        Inputs that the tests have in common.
    notes : str or sequence of str, optional
        Further columns to keep as text.
    where : mapping of str to str, optional
        Columns, such as ``panel``, and the values of the rows to read; others are left out.
    sheet : str, optional
        Sheet of a workbook, by default the only visible one with a table.
    ignore : str or sequence of str, optional
        Columns that are not read whatever they say of the tests; all tests count.

    Returns
    -------
    Tests

    Raises
    ------
    InputError
        With every mistake in the table.

    Examples
    --------
    >>> import armour
    >>> scenario = armour.load_scenario("wilkins")
    >>> test = {"armour.ceramic_thickness_mm": 8.0, "ballistic_limit_m_s": 780.0}
    >>> armour.read_tests([test], scenario)
    <Tests: 1 test of rows, 1 measurement>
    """
    notes = tuple(notes)
    return read_open_tests(open_tests(path, notes, sheet), scenario, notes, where, (*ignore,))


def read_open_tests(
    source: Source,
    scenario: Scenario,
    notes: Sequence[str],
    where: Mapping[str, str] | None = None,
    ignore: Sequence[str] = (),
    *,
    closed: bool = True,
) -> Tests:
    """Return the tests of an open table of `open_tests`; other arguments, and errors, are those of `read_tests`.

    If the table is not ``closed``, columns that are not read may divide the tests.
    """
    source, bounds = _without_bounds(source)
    kind = csv_files.TableKind("test", NUMBERS, (*TEXTS, *notes), usual=USUAL)
    table = csv_files.read_rows(source, kind, where, ignore=ignore, closed=closed)
    file, rows = source.file, table.rows
    for row in (row for row in rows if row.place in bounds):
        if {VELOCITY, OUTCOME} & row.texts.keys():
            message = "must be a number beside a velocity or an outcome, found a bound"
            source.wrong(f"{row.place}: {LIMIT}", message)
        row.texts[VELOCITY], row.texts[OUTCOME] = row.texts.pop(LIMIT), bounds[row.place]
        if LIMIT in row.numbers:
            row.numbers[VELOCITY] = row.numbers.pop(LIMIT)
    names = tuple(row.texts.get("test", row.place) for row in rows)
    repeated_names = {name for name, count in Counter(names).items() if count > 1}
    # A shot needs its velocity, a limit has none.
    inputs, bare = {*INPUTS, *NAMES.values()} - {VELOCITY}, _bare_plates(rows)
    for name in dict.fromkeys(name for row in rows for name in row.texts if name in inputs):
        has_value = bare if "ceramic" in name else set()
        blank = [row.place for row in rows if name not in row.texts]
        source.problems += csv_files.not_filled(file, name, [place for place in blank if place not in has_value])
    for row in rows:
        for key, message in _mistakes(row, repeated_names):
            source.wrong(f"{row.place}: {key}" if key else row.place, message)
    measurements = [measurement for test, row in enumerate(rows) for measurement in _measurements(test, row)]
    uncertainties_given = {MEASURED[m.quantity] in rows[m.test].texts for m in measurements}
    if len(uncertainties_given) == 2:
        source.wrong("", "uncertainties must be given for every measurement and outcome, or for none")
    groups = _groups(rows, scenario, source)
    results = [perforates(row.texts.get(OUTCOME, "")) for row in rows]
    are_shots = all(LIMIT not in row.texts and OUTCOME in row.texts for row in rows)
    for name, values in table.groups.items() if closed else ():
        is_lot = column_of(name, ("lot",)).known
        if len({*values}) > 1 and (is_lot or (are_shots and csv_files.targets_of(source, table, name, results))):
            source.divided(name, values, "test")
    source.refuse()
    cells: list[dict[str, float | str]] = [{**row.texts, **row.numbers} for row in rows]
    places = tuple(row.place for row in rows)
    is_weighted = uncertainties_given == {True}
    read = replace(table.read, warnings=(*_unread_warnings(table.read.ignored), *table.read.warnings))
    return Tests(file, names, (*groups,), (*measurements,), is_weighted, (*cells,), scenario, places, read)


def _unread_warnings(ignored: Sequence[str]) -> Iterator[str]:
    """Yield a warning of the columns in `ignored` that may be inputs or uncertainties by their units, if any may."""
    units = "mm", "°", "m/s"
    names = [name for name in ignored if Column(name).key_unit in units and not column_of(name, NUMBERS).known]
    if names:
        yield f"not read: {joined(names)}; an input is named by its key, the uncertainty of a limit {MEASURED[LIMIT]}"


def open_tests(path: Table, notes: Sequence[str] = (), sheet: str | None = None) -> Source:
    """Open a table of tests for `read_open_tests`; `notes` are further columns that it may have."""
    return csv_files.open_table(path, lambda name: column_of(name, (*NUMBERS, *TEXTS, *notes)).known, sheet)


def _without_bounds(source: Source) -> tuple[Source, dict[str, str]]:
    """Return the table with numbers in place of limits such as "above 950", and by line the outcome that each means."""
    place = next((place for place, name in enumerate(source.header) if column_of(name, (LIMIT,)).known), None)
    if place is None:
        return source, {}
    lines, outcomes = [], dict[str, str]()
    for line, cells in source.lines:
        if len(cells) == len(source.header) and (bound := BOUND.fullmatch(cells[place].lower())):
            outcomes[line] = "stopped" if bound[1] else "perforated"
            cells = [*cells[:place], bound[3], *cells[place + 1 :]]
        lines.append((line, cells))
    return replace(source, lines=iter(lines)), outcomes


def _bare_plates(rows: Sequence[CsvRow]) -> set[str]:
    """Set the ceramic's thickness of tests of bare plates to 0 in their rows, and return the places of these rows.

    Their ceramic has no thickness or, where the table names ceramics, no name either; one with only one of them blank
    may lack it by mistake.  It counts as one of the first ceramic, as it has no effect.
    """
    key = NAMES["ceramic"]
    has_name, has_thickness = (any(name in row.texts for row in rows) for name in (key, CERAMIC))
    bare = [
        row
        for row in rows
        if row.numbers.get(CERAMIC) == 0.0
        or (CERAMIC not in row.texts and (key not in row.texts if has_name else has_thickness))
    ]
    places = {row.place for row in bare}
    names = [row.texts[key] for row in rows if key in row.texts and row.place not in places]
    for row in bare:
        row.numbers[CERAMIC] = 0.0
        if names:
            row.texts[key] = names[0]
    return places


def _mistakes(row: CsvRow, repeated_names: Container[str]) -> list[tuple[str, str]]:
    """Return the mistakes in a row, as pairs of column and message; no test may have one of `repeated_names`."""
    mistakes = []
    name, outcome = row.texts.get("test"), row.texts.get(OUTCOME)
    is_perforated = None if outcome is None else perforates(outcome)
    if name is not None and name in repeated_names:
        mistakes.append(("test", f'must name one test, found "{name}" on several lines'))
    if outcome is None and not any(column in row.texts for column in MEASURED):
        mistakes.append(("", f"must have one of {', '.join((*MEASURED, OUTCOME))}; leave out a test that was not made"))
    if outcome is not None and is_perforated is None:
        mistakes.append((OUTCOME, csv_files.wrong_result(outcome)))
    if is_perforated is False and RESIDUAL in row.texts:
        mistakes.append((OUTCOME, f"must not be {outcome} if there is a residual velocity"))
    limit, velocity = row.numbers.get(LIMIT), row.numbers.get(VELOCITY)
    if is_perforated is not None and limit and velocity is not None and (velocity > limit) != is_perforated:
        message = f"must agree with the ballistic limit in its row, found {outcome} at {velocity:g} m/s"
        mistakes.append((OUTCOME, message))
    if outcome is not None and VELOCITY not in row.texts:
        mistakes.append((VELOCITY, "is missing and must be given with an outcome"))
    for column in (*MEASURED, *MEASURED.values()):
        value = row.numbers.get(column, MIN_MEASURED)
        if not MIN_MEASURED <= value <= MAX_MEASURED:
            hint = '; a projectile that is stopped is an outcome, "stopped"' if column == RESIDUAL else ""
            must = f"must be at least {MIN_MEASURED:g} and at most {MAX_MEASURED:g}"
            mistakes.append((column, f"{must}, found {value:g}{hint}"))
    return mistakes


def _measurements(test: int, row: CsvRow) -> list[Measurement]:
    """Return the measurements in a row, given the index of its test; an outcome counts only if nothing is measured."""
    measurements = [
        Measurement(test, name, row.numbers[name], row.numbers.get(uncertainty), 0)
        for name, uncertainty in MEASURED.items()
        if name in row.numbers
    ]
    is_perforated = perforates(row.texts.get(OUTCOME, ""))
    if is_perforated is not None and VELOCITY in row.numbers and not measurements:
        uncertainty = row.numbers.get(MEASURED[LIMIT])
        measurements.append(Measurement(test, LIMIT, row.numbers[VELOCITY], uncertainty, -1 if is_perforated else 1))
    return measurements


def _groups(rows: Sequence[CsvRow], scenario: Scenario, source: Source) -> list[MaterialGroup]:
    """Group tests, a row each, by projectile and materials; what the scenario refuses is recorded in `source`."""
    by_names: dict[tuple[tuple[str, str], ...], list[int]] = {}
    for i, row in enumerate(rows):
        by_names.setdefault(tuple(_names_in(row).items()), []).append(i)
    groups: list[MaterialGroup] = []
    for names, where in by_names.items():
        try:
            changed = scenario.replaced(dict(names))
            values = changed.inputs()
            columns = {
                name: np.array([rows[i].numbers.get(name, values.get(name, 0.0)) for i in where])
                for name in INPUTS
                if any(name in rows[i].numbers for i in where)
            }
            changed.check_rows(columns)
            groups.append(MaterialGroup(changed, np.array(where), columns))
        except InputError:
            for row in (rows[i] for i in where):
                try:
                    values = {name: row.numbers[name] for name in INPUTS if name in row.numbers}
                    scenario.replaced(_names_in(row)).with_inputs(values)
                except InputError as error:
                    for problem in error.problems:
                        source.wrong(row.place, f"{problem.key}: {problem.message}")
    return groups


def _names_in(row: CsvRow) -> dict[str, str]:
    """Return the names of projectile and materials in a row, by key."""
    return {key: row.texts[key] for key in NAMES.values() if key in row.texts}
