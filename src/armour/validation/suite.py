"""Read suites: cases with expected values, which are listed in the suite or in files of tests."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from os.path import exists
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationError

from armour.analysis.quantities import label_and_unit, with_round
from armour.columns import GROUPS, column_of
from armour.errors import InputError, Problem, counted, mistake, refuse
from armour.files import located, named, read_toml, shipped_files, shipped_tests, suite_file
from armour.scenario.checked import checked
from armour.scenario.effect import check_columns, check_effect
from armour.scenario.keys import KeyPath, canonical, key_name, parts_of, values_by_key
from armour.scenario.scenario import Scenario, files_of, parse_changed
from armour.scenario.sections import every_problem
from armour.statistics.measured import open_tests, read_open_tests
from armour.validation.questions import QUESTIONS, check_answerable
from armour.validation.suite_sections import (
    EXPECTED,
    MEASURED_COLUMN,
    CaseSection,
    Cells,
    SuiteSection,
    TableSection,
    is_regression,
    meets,
)


@dataclass(frozen=True)
class Case:
    """One comparison of a suite: a scenario, and the expected value of one quantity.

    Attributes
    ----------
    suite : SuiteSection
        The suite, as its file gives it.
    section : CaseSection or TableSection
        The case or, for a row of a table, the table, as the file gives it.
    name : str
    scenario : Scenario
    expected : float or str or None
        None for a regression value that has not been filled in yet.
    place : tuple of str and int
        Keys and indices of the expected value in the file.
    replacement : Scenario or None
        The scenario with one material replaced; only for a quantity that this saves.
    measured : float or None
        If given, the expected value is the magnitude of the relative difference from this, in per cent.
    cells : mapping of str to float or str
        Row of the CSV file from which the case is read: its inputs, measurements and notes.
    warnings : tuple of str
        Rows of the CSV file that give only a bound on the limit, and columns that probably should be read.
    """

    suite: SuiteSection
    section: CaseSection | TableSection
    name: str
    scenario: Scenario
    expected: float | str | None
    place: KeyPath
    replacement: Scenario | None = None
    measured: float | None = None
    cells: Cells = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    @property
    def scenarios(self) -> tuple[Scenario, ...]:
        """The scenario and, if there is one, the scenario with a material replaced."""
        return (self.scenario,) if self.replacement is None else (self.scenario, self.replacement)

    @property
    def group(self) -> str:
        """Name of the table to which the case belongs; empty for a case outside tables."""
        return self.section.name if isinstance(self.section, TableSection) else ""

    @property
    def full_name(self) -> str:
        """Name of the case, preceded by the name of its table, if it has one."""
        return f"{self.group}: {self.name}" if self.group else self.name

    @property
    def quantity(self) -> str:
        """Name of the quantity computed, one of `armour.validation.questions.QUESTIONS`."""
        return self.section.quantity

    @property
    def unit(self) -> str:
        """Unit of the expected value."""
        return label_and_unit(self.quantity)[1] if self.measured is None else "%"

    @property
    def band(self) -> float | None:
        """Largest deviation allowed, in the unit of the expected value; None if there is no band."""
        percent = self.section.band_percent
        if percent is None or self.expected is None:
            return self.section.band
        return percent / 100.0 * abs(float(self.expected))

    @property
    def reason(self) -> str:
        """Reason for the width of the band."""
        return self.section.reason

    @property
    def source(self) -> str:
        """Source of the expected value."""
        return self.section.source or self.suite.source

    @property
    def not_scored(self) -> str:
        """Reason why the case is shown but not scored; empty if it is scored."""
        return self.section.not_scored

    @property
    def regression(self) -> bool:
        """Whether the expected value is a result of this program, which an update replaces."""
        return is_regression(self.section, self.suite) and not self.cells

    def compared(self, value: float | str) -> float | str:
        """Return a computed value or, if `measured` is given, the magnitude of its relative difference from this, %."""
        if self.measured is None or isinstance(value, str):
            return value
        return 100.0 * abs(value / self.measured - 1.0)


# Message on a missing expected value.
MUST_BE_GIVEN = "is missing and must be given; --update fills in only a regression value without a source"


@dataclass(frozen=True, repr=False)
class Suite:
    """Cases to compare with the model, and the tables to which some of them belong.

    Attributes
    ----------
    title : str
    file : Path
    cases : tuple of Case
    tables : tuple of TableSection
    description : str
    """

    title: str
    file: Path
    cases: tuple[Case, ...]
    tables: tuple[TableSection, ...]
    description: str = ""

    def __repr__(self) -> str:
        return f"<Suite: {counted(len(self.cases), 'case')} of {self.file.name}>"

    @checked
    def only(self, text: str) -> "Suite":
        """Return the suite with only the cases whose name contains the text; raise InputError if there is none."""

        def is_chosen(case: Case) -> bool:
            return text.lower() in case.full_name.lower()

        cases = tuple(filter(is_chosen, self.cases))
        if not cases:
            raise mistake("only", "text", f'must be part of the name of a case, found "{text}"')
        names = {case.group for case in cases}
        # Bands of the mean and RMS of a table with a file are for all its rows, so drop them if some are left out.
        partial = {case.group for case in self.cases if case.cells and not is_chosen(case)}
        no_bands: dict[str, Any] = {"group": [], "rms_band_percent": None, "mean_band_percent": None}
        tables = (
            table.model_copy(update=no_bands if table.name in partial else None)
            for table in self.tables
            if table.name in names
        )
        return replace(self, cases=cases, tables=tuple(tables))


@checked
def load_suite(path: str | PathLike[str], changes: Mapping[str, object] | None = None) -> Suite:
    """Read a suite and all its scenarios.

    Parameters
    ----------
    path : path-like
        A TOML file or, if there is no such file, the name of a shipped suite, such as "paper"; ``armour init --list``
        lists them.  Files that the suite names are in its folder or, if not there, shipped ones.
    changes : mapping of str to object, optional
        Values that replace those of every scenario, by dotted key; tables are merged.

    Returns
    -------
    Suite

    Raises
    ------
    InputError
        With every mistake in the suite and in its scenarios.
    """
    changes = changes or {}
    path = suite_file(path)
    data = read_toml(path)
    try:
        suite = SuiteSection.model_validate(data)
    except ValidationError as error:
        problems = every_problem(error, SuiteSection, data, str(path), SuiteSection.model_validate)
        raise InputError([*problems, *_in_valid_parts(data, path, changes)]) from None
    cases = _cases_of_suite(suite, path, changes)
    if changes:
        scenarios = [(scenario, _reads_of(case)) for case in cases for scenario in case.scenarios]
        check_effect(values_by_key(changes), scenarios, "command line", option="--set ")
    return Suite(suite.title, path, tuple(cases), tuple(suite.table), suite.description)


def _in_valid_parts(data: Mapping[str, Any], path: Path, changes: Mapping[str, object]) -> Iterator[Problem]:
    """Yield the problems in the scenarios of a suite that is invalid, for its cases and tables that are valid.

    `data` is the content of the suite's file.
    """
    common = {key: value for key, value in data.items() if key in SuiteSection.model_fields.keys() - {"case", "table"}}
    for kind in ("case", "table"):
        parts = data.get(kind)
        for index, part in enumerate(parts if isinstance(parts, list) else []):
            try:
                _cases_of_suite(SuiteSection.model_validate({**common, kind: [part]}), path, changes)
            except ValidationError:
                continue  # reported already
            except InputError as error:
                for problem in error.problems:
                    yield problem._replace(key=problem.key.replace(f"{kind}[0]", f"{kind}[{index}]", 1))


def _cases_of_suite(suite: SuiteSection, path: Path, changes: Mapping[str, object]) -> list[Case]:
    """Return the cases of a suite, whose file is `path`; raise one InputError with the mistakes in all of them."""
    if not suite.case and not suite.table:
        raise mistake(path, "case", "is missing: a suite must have at least one case or table")
    unexpected = [
        Problem(str(path), key_name(["case", index, EXPECTED]), MUST_BE_GIVEN)
        for index, case in enumerate(suite.case)
        if case.expected is None and not is_regression(case, suite)
    ]
    cases: list[Case] = []
    # By table and problem, so that a mistake in many rows of a table is reported only for the first.
    wrong: dict[tuple[KeyPath, Problem], Problem] = {}
    for row in _rows_of_suite(suite):
        try:
            cases += _cases_of_row(row, suite, path.parent, changes)
        except InputError as error:
            for problem in error.problems:
                wrong.setdefault((row.place[:2], problem), _located(problem, row, path))
    refuse([*unexpected, *wrong.values()])
    return cases


def _located(problem: Problem, row: "_Row", path: Path) -> Problem:
    """Return a problem with a scenario as one of the suite's file, at the key of its row; one with tests as it is."""
    if row.section.file:
        return problem
    key = row.place[:4] if problem.key in row.inputs else (*row.place[:2], "scenario")
    return Problem(str(path), key_name(key), f"must be a valid scenario: {problem}")


class _Row(NamedTuple):
    """What a suite's file says about a case, a row of a table, or a table whose rows are in another file."""

    section: CaseSection | TableSection
    place: KeyPath  # of the expected value, or of the name of the file of tests
    expected: float | str | None = 0.0
    first: bool = True  # whether it is the first, or only, case of its section
    inputs: Mapping[str, float] = {}  # values of the columns, by key
    measured: float | None = None


def _rows_of_suite(suite: SuiteSection) -> Iterator[_Row]:
    """Yield a `_Row` for each row of the tables of a suite, then for its cases, and then for its tables with files."""
    for index, table in enumerate(suite.table):
        column = table.columns.index(EXPECTED) if table.rows else 0
        for row_index, numbers in enumerate(table.rows):
            values = dict(zip(table.columns, numbers, strict=True))
            measured = values.pop(MEASURED_COLUMN) if table.compares else None
            expected = values.pop(EXPECTED)
            yield _Row(table, ("table", index, "rows", row_index, column), expected, not row_index, values, measured)
    for index, case in enumerate(suite.case):
        yield _Row(case, ("case", index, EXPECTED), case.expected, measured=case.measured)
    for index, table in enumerate(suite.table):
        if table.file:
            yield _Row(table, ("table", index, "file"))


def _cases_of_row(row: _Row, suite: SuiteSection, folder: Path, changes: Mapping[str, object]) -> list[Case]:
    """Return the case of a row or, if its section names a file of tests, a case for each test in the file.

    `folder` is that of the suite, and `changes`, values by key, apply to every scenario.
    """
    section, file = row.section, _named_file(folder, row.section.scenario)
    scenario = _read_scenario(file, section.set, row.inputs, changes)
    replacement = None
    if section.replaced_by is not None:
        replacement = _read_scenario(file, section.set, section.replaced_by, changes)
    check_answerable(section.quantity, scenario, replacement)
    name = ", ".join(map(_value_in_words, row.inputs, row.inputs.values())) or section.name
    case = Case(suite, section, name, scenario, row.expected, row.place, replacement, row.measured)
    if row.first:
        _check_effects(case, row.inputs)
    return (
        _cases_of_file(case, section, folder, changes) if isinstance(section, TableSection) and section.file else [case]
    )


def _cases_of_file(common: Case, table: TableSection, folder: Path, changes: Mapping[str, object]) -> list[Case]:
    """Return a case for each test in a table's file; `common` is a case with what they share, `changes` among it."""
    path = _named_file(folder, table.file)
    # Each test is compared by itself: its target and lot are only notes.
    conditions = [key for part in (table, *table.group) for key in part.where]
    notes = [*dict.fromkeys((*common.suite.notes, *GROUPS, *conditions))]
    source = open_tests(path, notes)
    if not any(column_of(name, (table.quantity,)).known for name in source.header):
        # The message does not quote the columns found, since the file may be any file of the user.
        raise mistake(source.file, "", f"must be a table of tests with the column {table.quantity}")
    tests = read_open_tests(source, common.scenario, notes, closed=False)
    refuse(
        Problem(tests.file, key_name(key), f"must not be a column, as {option}{key_name(key)} sets it")
        for option, values in (("set.", table.set), ("--set ", changes))
        for key in values_by_key(values)
        if any(key_name(key) in cells for cells in tests.cells)
    )
    bounds = sum(m.side != 0 and m.quantity == table.quantity for m in tests.measurements)
    told = [f"{counted(bounds, 'bound')} on {table.quantity} left out"] if bounds else []
    warnings = tuple(f"{tests.file}: {text}" for text in (*told, *(tests.read.warnings if tests.read else ())))
    scenarios = {int(place): group.scenario for group in tests.groups for place in group.where}
    warned = replace(common, warnings=warnings)
    cases = [
        replace(warned, name=name, scenario=scenarios[place], expected=float(cells[table.quantity]), cells=cells)
        for place, (name, cells) in enumerate(zip(tests.names, tests.cells, strict=True))
        if table.quantity in cells and meets(cells, table.where)
    ]
    if not cases:
        selected = " and ".join((table.quantity, *table.where))
        raise mistake(tests.file, "", f"must have tests with {selected} as the suite selects them, found none")
    return cases


def _check_effects(case: Case, inputs: Mapping[str, float]) -> None:
    """Check that all changes and columns of a section have an effect on its quantity, given its first case.

    `inputs` has the values of the columns.
    """
    file, reads = case.scenario.file, _reads_of(case)
    for changes in (case.section.set, case.section.replaced_by or {}):
        keys = canonical([*map(key_name, values_by_key(changes)), *inputs], file)
        check_effect(map(parts_of, keys), [(scenario, reads) for scenario in case.scenarios], file, case.quantity)
        # Entries of the library are not checked as columns, since they may be based on each other.
        columns = [key for key in keys if not key.startswith("library.")]
        check_columns(case.scenario, columns, reads, file, case.quantity)


def _reads_of(case: Case) -> set[str]:
    """Return the sections and keys of a scenario on which the quantity of a case depends."""
    return with_round(QUESTIONS[case.quantity])


def suite_files(suite: Suite) -> list[Path]:
    """Return the files from which a suite is read: its own, those of its scenarios, and its files of tests."""
    scenarios = [file for case in suite.cases for file in files_of(case.scenario)]
    return [suite.file, *dict.fromkeys(scenarios), *(suite.file.parent / table.file for table in suite.tables)]


def _read_scenario(file: Path, *changes: Mapping[str, object]) -> Scenario:
    """Read a scenario from a file with changes, values by key that are applied one after the other."""
    return parse_changed(read_toml(file, quoted=False), *changes, file=named(file), folder=file.parent)


def _named_file(folder: Path, name: str) -> Path:
    """Return the path of a file that a suite names: in the suite's folder or else, by its name, a shipped one."""
    files = {**shipped_files("scenarios", ".toml"), **shipped_tests()}
    return files[name] if name in files and not exists(folder / name) else located(folder / name, {})


def _value_in_words(key: str, value: float) -> str:
    """Return a key with its value in words, such as "tile thickness 6.35 mm", for the name of a case."""
    words, unit = label_and_unit(key)
    return f"{words} {value:g} {unit}".rstrip()
