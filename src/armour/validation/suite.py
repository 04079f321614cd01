"""Suites: cases with expected values, listed in the suite or in files of tests, and the questions that they ask."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import compress
from math import inf
from os import PathLike
from os.path import exists
from pathlib import Path
from typing import Annotated, Any, ClassVar, NamedTuple

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    field_validator,
    model_validator,
)

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.evaluate import Answers, groups_of
from armour.analysis.quantities import DESIGNS, OF_GRID, QUANTITIES, label_and_unit
from armour.analysis.variants import Floats, Variants, grid_of
from armour.columns import perforates
from armour.csv_files import MUST_SAY, number, open_table
from armour.design.optimise import BestDesign, optimise
from armour.errors import InputError, NoAnswerError, Problem, choices, counted, mistake, refuse
from armour.files import located, named, read_toml, shipped_files, shipped_tests, suite_file
from armour.scenario.checked import checked
from armour.scenario.effect import check_columns, check_effect
from armour.scenario.inputs import ROUND_AND_ARMOUR
from armour.scenario.keys import KeyPath, canonical, describe, key_name, parts_of, values_by_key
from armour.scenario.scenario import Scenario, files_of, parse_changed
from armour.scenario.sections import LIST_TAG, RANGE_TAG, NumberOrText, Section, every_problem
from armour.statistics.measured import MEASURED, read_tests


class Subject:
    """A scenario and, if given, the same with a material replaced; nothing is computed twice."""

    def __init__(self, scenario: Scenario, replacement: Scenario | None = None) -> None:
        self.scenario, self.replacement = scenario, replacement

    @cached_property
    def answers(self) -> Answers:
        """The engine's answers about the scenario: one row."""
        return Answers(groups_of(self.scenario, {})[0].variants)

    @cached_property
    def lightest(self) -> BestDesign:
        """The lightest design of the scenario's grid; a NoAnswerError says why there is none."""
        result = optimise(self.scenario)
        if result.best is None:
            raise NoAnswerError(result.explanation)
        return result.best

    @cached_property
    def required(self) -> tuple[Variants, Variants]:
        """Armours with the least thickness of the layer whose material is replaced, before and after that."""
        assert self.replacement is not None, "a suite gives replaced_by with SAVINGS"
        before, after = self.answers, Subject(self.replacement).answers
        if self.scenario.armour.ceramic != self.replacement.armour.ceramic:
            return before.with_least_ceramic, after.with_least_ceramic
        return before.with_least_backing, after.with_least_backing


# Questions about the lightest design, named after its attributes.
LIGHTEST = ("optimum_ceramic_thickness_mm", "optimum_backing_thickness_mm", "optimum_areal_density_kg_m2")
# Questions about replacing a material by another: the quantity reduced, reported in per cent of its value.
SAVINGS: dict[str, Callable[[Variants], Floats]] = {
    "thickness_saved_percent": lambda armours: armours.ceramics_mm + armours.backings_mm,
    "weight_saved_percent": lambda armours: armours.areal_densities_kg_m2(),
}
# All questions that a suite may ask, and the parts of a scenario that each depends on, see `armour.scenario.effect`.
QUESTIONS: dict[str, tuple[str, ...]] = {
    **{name: quantity.reads for name, quantity in QUANTITIES.items()},
    **dict.fromkeys(LIGHTEST, DESIGNS),
    **dict.fromkeys(SAVINGS, OF_GRID),
}


def answer(name: str, subject: Subject) -> float | str:
    """Answer a question; raise NoAnswerError if it has no answer in the scenario's range."""
    value: float | str
    if name in LIGHTEST:
        value = getattr(subject.lightest, name.removeprefix("optimum_"))
    elif name in SAVINGS:
        before, after = (float(SAVINGS[name](armours)[0]) for armours in subject.required)
        value = 100.0 * (1.0 - after / before)
    else:
        value = QUANTITIES[name].compute(subject.answers)[0].item()
    if value == value:
        return value
    if "optimise" not in QUESTIONS[name]:
        ballistic_limit(subject.scenario)  # raises, with the reason
    velocity = subject.scenario.impact.velocity_m_s
    raise NoAnswerError(
        f"no design: no thickness of the range stops the projectile at {velocity:g} m/s; "
        "raise the max of optimise.ceramic_thickness_mm or of optimise.backing_thickness_mm"
    )


def check_answerable(name: str, scenario: Scenario, replacement: Scenario | None) -> None:
    """Check that a scenario has the grid that a question needs, and that exactly one material is replaced."""
    if "optimise" in QUESTIONS[name]:
        grid_of(scenario)
    if replacement is not None:
        before, after = scenario.armour, replacement.armour
        if (before.ceramic != after.ceramic) == (before.backing != after.backing):
            raise mistake(scenario.file, "replaced_by", "must name another ceramic or another backing, and not both")


Cells = Mapping[str, float | str]


class Between(Section):
    """Numbers from a minimum to below a maximum."""

    min: float = -inf
    below: float = inf


# Condition on a cell: a number or text, a list of them, or a range.
Condition = Annotated[
    Annotated[list[NumberOrText], Tag(LIST_TAG)] | Annotated[Between, Tag(RANGE_TAG)],
    Discriminator(lambda value: LIST_TAG if isinstance(value, list) else RANGE_TAG),
    BeforeValidator(lambda value: value if isinstance(value, list | dict) else [value]),
]


def meets(cells: Cells, where: Mapping[str, Condition]) -> bool:
    """Return whether the cells of a row, without the empty ones, meet every condition."""
    return all(_meets(cells.get(column), condition) for column, condition in where.items())


def _meets(cell: float | str | None, condition: Condition) -> bool:
    value = number(str(cell))
    if isinstance(condition, Between):
        return value is not None and condition.min <= value < condition.below
    return cell in condition or value in condition


# Column of a table that holds the expected values.
EXPECTED = "expected"
# Column of a table that holds measured values; the expected values are then relative differences from these.
MEASURED_COLUMN = "measured"
# Largest number allowed, so that numbers computed from it are finite.
LARGEST = 1e12
Name = Annotated[str, Field(min_length=1)]
Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Width = Annotated[float, Field(ge=0.0, le=LARGEST)]


class GroupSection(Section):
    """Rows of a table that are summarised together, with the bands of their relative deviations."""

    name: Name
    where: dict[str, Condition] = {}
    mean_percent: Number = 0.0
    mean_band_percent: Width | None = None
    rms_band_percent: Width | None = None


class _Expectation(Section):
    """Keys shared by a case and a table of cases."""

    name: Name
    scenario: Name
    set: dict[str, Any] = {}
    quantity: str
    band: Width | None = None
    band_percent: Width | None = None
    reason: str = ""
    source: str = ""
    regression: bool = False
    not_scored: str = ""

    @field_validator("quantity")
    @classmethod
    def _known(cls, quantity: str) -> str:
        if quantity not in QUESTIONS:
            raise ValueError(f'must name a quantity, found "{quantity}"{choices(quantity, list(QUESTIONS))}')
        return quantity

    @model_validator(mode="after")
    def _one_band(self) -> "_Expectation":
        bands = [key for key in ("band", "band_percent") if getattr(self, key) is not None]
        if self.quantity == "outcome":
            if bands:
                raise ValueError(f"an outcome has no band, found {bands[0]}")
        elif len(bands) == 2:
            raise ValueError("must have band or band_percent, found both")
        elif not bands and not self.not_scored and not getattr(self, "file", ""):
            raise ValueError("must have a band or band_percent: how far the computed value may be from the expected")
        return self


def _outcome(expected: float | str) -> float | str:
    """Return an outcome, which has several names, by its name in results."""
    perforated = perforates(expected) if isinstance(expected, str) else None
    return expected if perforated is None else "perforated" if perforated else "stopped"


class CaseSection(_Expectation):
    """A single case."""

    expected: Annotated[NumberOrText, AfterValidator(_outcome)] | None = None
    replaced_by: dict[str, Any] | None = None
    measured: Annotated[float, Field(ge=1.0 / LARGEST, le=LARGEST)] | None = None
    file: ClassVar = ""

    @model_validator(mode="after")
    def _fits_the_quantity(self) -> "CaseSection":
        # A regression value has none until an update fills it in.
        if self.expected is not None and self.quantity == "outcome":
            if perforates(str(self.expected)) is None:
                raise ValueError(f"expected {MUST_SAY}, found {describe(self.expected)}")
        elif isinstance(self.expected, str) or abs(self.expected or 0.0) > LARGEST:
            must = f"expected must be a number up to {LARGEST:g} for {self.quantity}"
            raise ValueError(f"{must}, found {describe(self.expected)}")
        if (self.quantity in SAVINGS) != (self.replaced_by is not None):
            raise ValueError(f"replaced_by belongs to {' and '.join(SAVINGS)}, and to nothing else")
        if self.quantity == "outcome" and self.measured is not None:
            raise ValueError("an outcome has no difference from a measured value, found measured")
        return self


class TableSection(_Expectation, GroupSection):
    """A table of cases that differ in some values of the scenario: rows of the suite, or of a CSV file of tests."""

    columns: list[Name] = []
    rows: Annotated[list[list[Number]], Field(min_length=1)] = []
    file: str = ""
    group: list[GroupSection] = []
    rms_band: Width | None = None
    rivals: list[Name] = []
    replaced_by: ClassVar = None

    @model_validator(mode="after")
    def _shape(self) -> "TableSection":
        if self.quantity in (*SAVINGS, "outcome"):
            raise ValueError(f"a table must be of numbers that one scenario answers, found {self.quantity}")
        if self.rms_band is not None and self.rms_band_percent is not None:
            raise ValueError("must have rms_band or rms_band_percent, found both")
        excluded = ("columns", "rows", "rivals", "rms_band") if self.file else ("where", "group", "mean_band_percent")
        if wrong := [key for key in excluded if key in self.model_fields_set]:
            raise ValueError(f"must not have {wrong[0]} {'with' if self.file else 'without'} a file")
        if self.file:
            if self.quantity not in MEASURED:
                raise ValueError(f"quantity must be one of {', '.join(MEASURED)} with a file, found {self.quantity}")
            return self
        if not self.rows:
            raise ValueError("must have rows, or a file that has them")
        if len(set(self.columns)) != len(self.columns):
            raise ValueError("columns must differ from each other")
        if missing := [name for name in (EXPECTED, *self.rivals) if name not in self.columns]:
            raise ValueError(f"columns must include {', '.join(missing)}")
        for index, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                must = f"every row must have the {len(self.columns)} numbers of the columns"
                raise ValueError(f"{must}, found {len(row)} in rows[{index}]")
            if self.compares and (value := row[self.columns.index(MEASURED_COLUMN)]) < 1.0 / LARGEST:
                raise ValueError(f"measured must be at least {1.0 / LARGEST:g}, found {value:g} in rows[{index}]")
        return self

    @property
    def compares(self) -> bool:
        """Whether the expected values are differences from measured ones."""
        return MEASURED_COLUMN in self.columns and MEASURED_COLUMN not in self.rivals


# Name under which cases outside a table are listed.
CASES = "cases"


def _named_once(tables: list[TableSection]) -> list[TableSection]:
    names = [table.name for table in tables]
    for name in names:
        if names.count(name) > 1 or name == CASES:
            raise ValueError(f'must each have a name of its own, other than "{CASES}", found "{name}"')
    return tables


class SuiteSection(Section):
    """The contents of a suite file."""

    title: str = ""
    description: str = ""
    source: str = ""
    regression: bool = False
    notes: list[Name] = []
    case: list[CaseSection] = []
    table: Annotated[list[TableSection], AfterValidator(_named_once)] = []


@dataclass(frozen=True)
class Case:
    """A scenario with the expected value of one quantity.

    Attributes
    ----------
    suite : SuiteSection
        The suite, as its file gives it.
    section : CaseSection or TableSection
        The case, or the table of which it is a row, as the file gives it.
    name : str
    scenario : Scenario
    expected : float or str or None
        None for a regression value that has not been filled in yet.
    place : tuple of str and int
        Keys and indices of the expected value in the file.
    replacement : Scenario or None
        The scenario with one material replaced, for the saving.
    rivals : mapping of str to float
        Predictions of other methods, by name.
    measured : float or None
        If given, the expected value is the magnitude of the relative difference from it, in per cent.
    cells : mapping of str to float or str
        Row of the CSV file from which the case is read: its inputs, measurements and notes.
    """

    suite: SuiteSection
    section: CaseSection | TableSection
    name: str
    scenario: Scenario
    expected: float | str | None
    place: KeyPath
    replacement: Scenario | None = None
    rivals: Mapping[str, float] = field(default_factory=dict)
    measured: float | None = None
    cells: Cells = field(default_factory=dict)

    @property
    def scenarios(self) -> tuple[Scenario, ...]:
        """The scenario and, if there is one, that with a material replaced."""
        return (self.scenario,) if self.replacement is None else (self.scenario, self.replacement)

    @property
    def group(self) -> str:
        """Name of the table to which the case belongs; empty for a single case."""
        return self.section.name if isinstance(self.section, TableSection) else ""

    @property
    def full_name(self) -> str:
        """Name of the case, preceded by that of its table."""
        return f"{self.group}: {self.name}" if self.group else self.name

    @property
    def quantity(self) -> str:
        """One of `armour.validation.suite.QUESTIONS`."""
        return self.section.quantity

    @property
    def unit(self) -> str:
        """Unit of the expected value."""
        return label_and_unit(self.quantity)[1] if self.measured is None else "%"

    @property
    def band(self) -> float | None:
        """Largest deviation allowed, in the unit of the quantity."""
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
        """Return a computed value or, if a measured value is given, its relative difference from that, per cent."""
        if self.measured is None or isinstance(value, str):
            return value
        return 100.0 * abs(value / self.measured - 1.0)


MISSING = "is missing and must be given; --update fills in only a regression value without a source"


def is_regression(section: CaseSection | TableSection, suite: SuiteSection) -> bool:
    """Return whether the expected values of a section are results of this program, not values with a source."""
    return (section.regression or suite.regression) and not (section.source or suite.source)


@dataclass(frozen=True, repr=False)
class Suite:
    """Cases, and the tables to which they belong.

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
        is_chosen = [text.lower() in case.full_name.lower() for case in self.cases]
        cases = tuple(compress(self.cases, is_chosen))
        if not cases:
            raise mistake(self.file, "", f'must have a case whose name contains "{text}", found none')
        names = {case.group for case in cases}
        # The bands of a table with a file hold for all its rows together.
        partial = {case.group for case, chosen in zip(self.cases, is_chosen, strict=True) if case.cells and not chosen}
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
        A TOML file or, if there is no such file, the name of a shipped suite, "paper" or "plates".  The files that it
        names are relative to its folder or shipped ones, by their names.
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
    """Yield the problems in the scenarios of those cases and tables of a suite that are valid."""
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
    """Return the cases of the sections of a suite."""
    if not suite.case and not suite.table:
        raise mistake(path, "case", "is missing: a suite must have at least one case or table")
    unexpected = [
        Problem(str(path), key_name(["case", index, EXPECTED]), MISSING)
        for index, case in enumerate(suite.case)
        if case.expected is None and not is_regression(case, suite)
    ]
    cases: list[Case] = []
    # A mistake in many rows of a table is reported for the first of them.
    wrong: dict[tuple[KeyPath, Problem], Problem] = {}
    for row in _rows(suite):
        try:
            cases += _cases(row, suite, path.parent, changes)
        except InputError as error:
            for problem in error.problems:
                wrong.setdefault((row.place[:2], problem), _placed(problem, row, path))
    refuse([*unexpected, *wrong.values()])
    return cases


def _placed(problem: Problem, row: "_Row", path: Path) -> Problem:
    """Return a problem in the scenario of a case with its place in the suite; leave one in a file of tests."""
    if row.section.file:
        return problem
    key = row.place[:4] if problem.key in row.inputs else (*row.place[:2], "scenario")
    return Problem(str(path), key_name(key), f"must be a valid scenario: {problem}")


class _Row(NamedTuple):
    """Contents of the suite's file for a case, a row of a table, or a table whose rows are in a file of tests."""

    section: CaseSection | TableSection
    place: KeyPath
    expected: float | str | None = 0.0
    first: bool = True  # whether it is the case of its section, or the first of them
    inputs: Mapping[str, float] = {}
    rivals: Mapping[str, float] = {}
    measured: float | None = None


def _rows(suite: SuiteSection) -> Iterator[_Row]:
    for index, table in enumerate(suite.table):
        column = table.columns.index(EXPECTED) if table.rows else 0
        for row, numbers in enumerate(table.rows):
            values = dict(zip(table.columns, numbers, strict=True))
            rivals = {name: values[name] for name in table.rivals}
            measured = values.pop(MEASURED_COLUMN) if table.compares else None
            inputs = {name: value for name, value in values.items() if name not in (EXPECTED, *rivals)}
            place = ("table", index, "rows", row, column)
            yield _Row(table, place, values[EXPECTED], not row, inputs, rivals, measured)
    for index, case in enumerate(suite.case):
        yield _Row(case, ("case", index, EXPECTED), case.expected, measured=case.measured)
    for index, table in enumerate(suite.table):
        if table.file:
            yield _Row(table, ("table", index, "file"))


def _cases(row: _Row, suite: SuiteSection, folder: Path, changes: Mapping[str, object]) -> list[Case]:
    """Return the case of a row, or those of a file."""
    section, file = row.section, _file(folder, row.section.scenario)
    scenario = _scenario(file, section.set, row.inputs, changes)
    replacement = None
    if section.replaced_by is not None:
        replacement = _scenario(file, section.set, section.replaced_by, changes)
    check_answerable(section.quantity, scenario, replacement)
    name = ", ".join(map(_in_words, row.inputs, row.inputs.values())) or section.name
    case = Case(suite, section, name, scenario, row.expected, row.place, replacement, row.rivals, row.measured)
    if row.first:
        _check_changes(case, row.inputs)
    return _cases_of_file(case, section, folder) if isinstance(section, TableSection) and section.file else [case]


def _cases_of_file(common: Case, table: TableSection, folder: Path) -> list[Case]:
    """Return the cases of a table's file of tests, given what they have in common."""
    path = _file(folder, table.file)
    source = open_table(path, lambda name: name == table.quantity)
    if table.quantity not in source.header:
        # Its columns are not quoted: it may be any file of the user.
        raise mistake(source.file, "", f"must be a table of tests with the column {table.quantity}")
    tests = read_tests(path, common.scenario, common.suite.notes)
    scenarios = {int(place): group.scenario for group in tests.groups for place in group.where}
    cases = [
        replace(common, name=name, scenario=scenarios[place], expected=float(cells[table.quantity]), cells=cells)
        for place, (name, cells) in enumerate(zip(tests.names, tests.cells, strict=True))
        if table.quantity in cells and meets(cells, table.where)
    ]
    if not cases:
        conditions = " and ".join((table.quantity, *table.where))
        raise mistake(tests.file, "", f"must have tests with {conditions} as the suite selects them, found none")
    return cases


def _check_changes(case: Case, inputs: Mapping[str, float]) -> None:
    """Check that the changes and the columns of a section all have an effect, given its first case."""
    file, reads = case.scenario.file, _reads_of(case)
    for changes in (case.section.set, case.section.replaced_by or {}):
        keys = canonical([*map(key_name, values_by_key(changes)), *inputs], file)
        check_effect(map(parts_of, keys), [(scenario, reads) for scenario in case.scenarios], file, case.quantity)
        # Entries of the library may be based on each other.
        columns = [key for key in keys if not key.startswith("library.")]
        check_columns(case.scenario, columns, reads, file, case.quantity)


def _reads_of(case: Case) -> set[str]:
    """Return the parts of its scenarios on which the quantity of a case depends."""
    return {*ROUND_AND_ARMOUR, *QUESTIONS[case.quantity]}


def suite_files(suite: Suite) -> list[Path]:
    """Return the files that a suite is read from: its own, those of its scenarios, and its tables."""
    scenarios = [file for case in suite.cases for file in files_of(case.scenario)]
    return [suite.file, *dict.fromkeys(scenarios), *(suite.file.parent / table.file for table in suite.tables)]


def _scenario(file: Path, *changes: Mapping[str, object]) -> Scenario:
    """Return the scenario of a file with changes, one after the other."""
    return parse_changed(read_toml(file, quoted=False), *changes, file=named(file), folder=file.parent)


def _file(folder: Path, name: str) -> Path:
    """Return the file that a suite in a folder names: a path there or, if there is none, a shipped name."""
    files = {**shipped_files("scenarios", ".toml"), **shipped_tests()}
    return files[name] if name in files and not exists(folder / name) else located(folder / name, {})


def _in_words(key: str, value: float) -> str:
    """Return a key and its value in words, such as "ceramic thickness 6.35 mm"."""
    words, unit = label_and_unit(key)
    return f"{words} {value:g} {unit}".rstrip()
