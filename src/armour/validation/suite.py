"""Suites: cases with expected values and the bands within which the computed values must lie."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import isfinite
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from pydantic import BeforeValidator, Field, ValidationError, field_validator, model_validator

from armour.errors import InputError, Problem, suggestion
from armour.files import read_toml
from armour.scenario.assignments import changed
from armour.scenario.loading import Scenario, parse_scenario
from armour.scenario.messages import Section, describe, key_name, problems_of
from armour.units import words_and_unit
from armour.validation.questions import QUESTIONS, check_answerable

# Column of a table that holds the expected values.
EXPECTED = "expected"
# Questions about the replacement of one material by another.
SAVINGS = tuple(name for name, question in QUESTIONS.items() if question.of_two)


def _number_or_text(value: object) -> object:
    """Check an expected value before pydantic does, which would report each type of the union."""
    if isinstance(value, str) or (isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)):
        return value
    raise ValueError(f"must be a finite number, or the outcome in quotes, found {describe(value)}")


Name = Annotated[str, Field(min_length=1)]
Width = Annotated[float, Field(ge=0.0)]


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
    not_scored: str = ""

    @field_validator("quantity")
    @classmethod
    def _known(cls, quantity: str) -> str:
        if quantity not in QUESTIONS:
            hint = suggestion(quantity, list(QUESTIONS)) or f"; there are {', '.join(QUESTIONS)}"
            raise ValueError(f'must name a quantity, found "{quantity}"{hint}')
        return quantity

    @model_validator(mode="after")
    def _one_band(self) -> "_Expectation":
        given = [key for key in ("band", "band_percent") if getattr(self, key) is not None]
        if self.quantity == "outcome":
            if given:
                raise ValueError(f"an outcome has no band, found {given[0]}")
        elif len(given) == 2:
            raise ValueError("must have band or band_percent, found both")
        elif not given and not self.not_scored:
            raise ValueError("must have a band or band_percent: how far the computed value may be from the expected")
        return self

    def width(self, expected: float | str) -> float | None:
        """Return the half-width of the band around the expected value, in the unit of the quantity."""
        if self.band_percent is not None and not isinstance(expected, str):
            return self.band_percent / 100.0 * abs(expected)
        return self.band


class CaseSection(_Expectation):
    """A case."""

    expected: Annotated[float | str, BeforeValidator(_number_or_text)]
    replaced_by: dict[str, Any] | None = None

    @model_validator(mode="after")
    def _fits_the_quantity(self) -> "CaseSection":
        outcomes = ("perforated", "defeated")
        if self.quantity == "outcome":
            if self.expected not in outcomes:
                raise ValueError(f'expected must be "perforated" or "defeated", found {self.expected!r}')
        elif isinstance(self.expected, str):
            raise ValueError(f"expected must be a number for {self.quantity}, found {self.expected!r}")
        if (self.quantity in SAVINGS) != (self.replaced_by is not None):
            raise ValueError(f"replaced_by belongs to {' and '.join(SAVINGS)}, and to nothing else")
        return self


class TableSection(_Expectation):
    """A table of cases, one per row, that differ in some values of the scenario."""

    columns: list[Name]
    rows: Annotated[list[list[float]], Field(min_length=1)]
    rms_band: Width | None = None
    rms_band_percent: Width | None = None
    rivals: list[Name] = []

    @model_validator(mode="after")
    def _shape(self) -> "TableSection":
        if self.quantity in (*SAVINGS, "outcome"):
            raise ValueError(f"a table must be of numbers that one scenario answers, found {self.quantity}")
        if len(set(self.columns)) != len(self.columns):
            raise ValueError("columns must differ from each other")
        missing = [name for name in (EXPECTED, *self.rivals) if name not in self.columns]
        if missing:
            raise ValueError(f"columns must hold {', '.join(missing)}")
        lengths = [len(row) for row in self.rows]
        wrong = [index for index, length in enumerate(lengths) if length != len(self.columns)]
        if wrong:
            raise ValueError(
                f"every row must have the {len(self.columns)} numbers of the columns, "
                f"found {lengths[wrong[0]]} in rows[{wrong[0]}]"
            )
        if self.rms_band is not None and self.rms_band_percent is not None:
            raise ValueError("must have rms_band or rms_band_percent, found both")
        return self


class SuiteSection(Section):
    """The contents of a suite file."""

    title: str = ""
    source: str = ""
    case: list[CaseSection] = []
    table: list[TableSection] = []


class Place(NamedTuple):
    """Location of an expected value in the file."""

    keys: tuple[str | int, ...]

    def __str__(self) -> str:
        return key_name(self.keys)


@dataclass(frozen=True)
class Case:
    """A scenario with the expected value of one quantity.

    Attributes
    ----------
    group : str
        Name of the table to which the case belongs; empty for a single case.
    name : str
    scenario : Scenario
    replacement : Scenario or None
        The scenario with one material replaced, for the saving.
    quantity : str
        One of `armour.validation.questions.QUESTIONS`.
    expected : float or str
    band : float or None
        Largest deviation allowed, in the unit of the quantity.
    reason : str
        Reason for the width of the band.
    source : str
        Source of the expected value.
    not_scored : str
        Reason why the case is shown but not scored; empty where it is scored.
    rivals : mapping of str to float
        Predictions of other methods, by name.
    place : Place
        Location of the expected value in the file.
    """

    group: str
    name: str
    scenario: Scenario
    replacement: Scenario | None
    quantity: str
    expected: float | str
    band: float | None
    reason: str
    source: str
    not_scored: str
    place: Place
    rivals: Mapping[str, float] = field(default_factory=dict)

    @property
    def full_name(self) -> str:
        """Name of the case, preceded by that of its table."""
        return f"{self.group}: {self.name}" if self.group else self.name


@dataclass(frozen=True)
class TableBand:
    """A table of a suite with the band of its root mean square deviation."""

    name: str
    rms_band: float | None
    rms_band_percent: float | None


@dataclass(frozen=True)
class Suite:
    """Cases, and the tables to which they belong."""

    title: str
    file: Path
    cases: tuple[Case, ...]
    tables: tuple[TableBand, ...]

    def only(self, text: str) -> "Suite":
        """Return the suite with only the cases whose name contains the text.

        Raises
        ------
        InputError
            If there is none.
        """
        cases = tuple(case for case in self.cases if text.lower() in case.full_name.lower())
        if not cases:
            raise InputError(
                [Problem(str(self.file), "", f'must have a case whose name contains "{text}", found none')]
            )
        kept = {case.group for case in cases}
        return Suite(self.title, self.file, cases, tuple(table for table in self.tables if table.name in kept))


def load_suite(path: str | PathLike[str], changes: Mapping[str, object] | None = None) -> Suite:
    """Read a suite and all its scenarios.

    Parameters
    ----------
    path : path
        A TOML file; the scenarios that it names are relative to its folder.
    changes : mapping of str to object, optional
        Values that replace those of every scenario, by dotted key; tables are merged.

    Raises
    ------
    InputError
        With every mistake in the suite and in its scenarios.
    """
    path = Path(path)
    try:
        section = SuiteSection.model_validate(read_toml(path))
    except ValidationError as error:
        raise InputError(problems_of(error, SuiteSection, str(path))) from None
    if not section.case and not section.table:
        raise InputError([Problem(str(path), "case", "is missing: a suite must have at least one case or table")])
    problems: list[Problem] = []
    cases = [case for found in _cases(section, path, changes or {}, problems) for case in found]
    if problems:
        raise InputError(list(dict.fromkeys(problems)))
    tables = (TableBand(table.name, table.rms_band, table.rms_band_percent) for table in section.table)
    return Suite(section.title, path, tuple(cases), tuple(tables))


def _cases(
    suite: SuiteSection, path: Path, changes: Mapping[str, object], problems: list[Problem]
) -> Iterator[list[Case]]:
    """Yield the cases of each table and each single case; mistakes are added to the problems."""
    for index, table in enumerate(suite.table):
        inputs = [name for name in table.columns if name not in (EXPECTED, *table.rivals)]
        column = table.columns.index(EXPECTED)
        for number, row in enumerate(table.rows):
            values = dict(zip(table.columns, row, strict=True))
            own = {name: values[name] for name in inputs}
            place = Place(("table", index, "rows", number, column))
            yield _case(table, path, (table.set, own, changes), place, suite.source, problems, values)
    for index, case in enumerate(suite.case):
        place = Place(("case", index, EXPECTED))
        yield _case(case, path, (case.set, changes), place, suite.source, problems)


def _case(
    section: CaseSection | TableSection,
    path: Path,
    changes: tuple[Mapping[str, object], ...],
    place: Place,
    source: str,
    problems: list[Problem],
    values: Mapping[str, float] | None = None,
) -> list[Case]:
    """Return the case of a section in a list, which is empty where its scenario is wrong."""
    file = path.parent / section.scenario
    replacement = None
    try:
        scenario = _scenario(file, changes)
        if isinstance(section, CaseSection) and section.replaced_by is not None:
            replacement = _scenario(file, (*changes[:-1], section.replaced_by, changes[-1]))
        check_answerable(section.quantity, scenario, replacement)
    except InputError as error:
        where = key_name([*place.keys[:2], "scenario"])
        problems += (Problem(str(path), where, f"must be a valid scenario: {problem}") for problem in error.problems)
        return []
    table = section if isinstance(section, TableSection) else None
    expected = section.expected if isinstance(section, CaseSection) else (values or {})[EXPECTED]
    return [
        Case(
            group=table.name if table else "",
            name=_row_name(table, values or {}) if table else section.name,
            scenario=scenario,
            replacement=replacement,
            quantity=section.quantity,
            expected=expected,
            band=section.width(expected),
            reason=section.reason,
            source=section.source or source,
            not_scored=section.not_scored,
            place=place,
            rivals={name: (values or {})[name] for name in table.rivals} if table else {},
        )
    ]


def _scenario(file: Path, changes: tuple[Mapping[str, object], ...]) -> Scenario:
    """Read a scenario and apply the changes one after the other."""
    data = read_toml(file)
    for change in changes:
        data = changed(data, change)
    return parse_scenario(data, file=str(file), folder=file.parent)


def _row_name(table: TableSection, values: Mapping[str, float]) -> str:
    """Return the name of a row: its input values."""
    inputs = [name for name in table.columns if name not in (EXPECTED, *table.rivals)]
    return ", ".join(_in_words(name, values[name]) for name in inputs)


def _in_words(key: str, value: float) -> str:
    """Return a key and its value in words, such as "ceramic thickness 6.35 mm"."""
    words, unit = words_and_unit(key)
    return f"{words} {value:g} {unit}".rstrip()
