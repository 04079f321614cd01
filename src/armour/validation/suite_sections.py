"""Sections of a suite file: cases, tables of cases, and conditions that select rows of a file of tests."""

from collections.abc import Mapping
from math import inf
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, field_validator, model_validator

from armour.analysis.quantities import VERDICT, WORDS
from armour.columns import perforates
from armour.csv_files import MUST_SAY, number
from armour.design.requirements import VERDICTS
from armour.errors import choices
from armour.scenario.keys import describe
from armour.scenario.sections import LIST_TAG, RANGE_TAG, NumberOrText, Section
from armour.statistics.measured import MEASURED
from armour.validation.questions import QUESTIONS, SAVINGS

# Cells of a row of a file of tests, by column.
Cells = Mapping[str, float | str]


class Between(Section):
    """A range of numbers, from a minimum to below a maximum."""

    min: float = -inf
    below: float = inf


# Condition on a cell: it must equal a number or text, be in a list of these, or lie in a range.
Condition = Annotated[
    Annotated[list[NumberOrText], Tag(LIST_TAG)] | Annotated[Between, Tag(RANGE_TAG)],
    Discriminator(lambda value: LIST_TAG if isinstance(value, list) else RANGE_TAG),
    BeforeValidator(lambda value: value if isinstance(value, list | dict) else [value]),
]


def meets(cells: Cells, where: Mapping[str, Condition]) -> bool:
    """Return whether the cells of a row meet the conditions in `where`, by column; an empty cell meets none."""
    return all(_cell_meets(cells.get(column), condition) for column, condition in where.items())


def _cell_meets(cell: float | str | None, condition: Condition) -> bool:
    """Return whether a cell, or the number that it contains, meets a condition."""
    value = number(str(cell))
    if isinstance(condition, Between):
        return value is not None and condition.min <= value < condition.below
    return cell in condition or value in condition


# Column of a table that holds the expected values.
EXPECTED = "expected"
# Column of a table that holds measured values; the expected values are then relative differences from these.
MEASURED_COLUMN = "measured"
Name = Annotated[str, Field(min_length=1)]
Width = Annotated[float, Field(ge=0.0)]


class GroupSection(Section):
    """Rows of a table that are summarised together, with bands of the mean and RMS of their relative deviations."""

    name: Name
    where: dict[str, Condition] = {}
    mean_percent: float = 0.0
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
    def _check_quantity(cls, quantity: str) -> str:
        """Check that the quantity is one that a suite may ask for."""
        if quantity not in QUESTIONS:
            raise ValueError(f'must name a quantity, found "{quantity}"{choices(quantity, list(QUESTIONS))}')
        return quantity

    @model_validator(mode="after")
    def _check_bands(self) -> "_Expectation":
        """Check that there is one band where one is needed, and none for words."""
        bands = [key for key in ("band", "band_percent") if getattr(self, key) is not None]
        if self.quantity in WORDS:
            if bands:
                raise ValueError(f"{WORDS[self.quantity]} has no band, found {bands[0]}")
        elif len(bands) == 2:
            raise ValueError("must have band or band_percent, found both")
        elif not bands and not self.not_scored and not getattr(self, "file", ""):
            raise ValueError("must have a band or band_percent: how far the computed value may be from the expected")
        return self


def _outcome_name(expected: float | str) -> float | str:
    """Return an outcome as results name it, such as "stopped" for "partial"; other expected values as they are."""
    perforated = perforates(expected) if isinstance(expected, str) else None
    return expected if perforated is None else "perforated" if perforated else "stopped"


class CaseSection(_Expectation):
    """A single case of a suite: a scenario with changes, a quantity, and its expected value."""

    expected: Annotated[NumberOrText, AfterValidator(_outcome_name)] | None = None
    replaced_by: dict[str, Any] | None = None
    measured: Annotated[float, Field(gt=0.0)] | None = None
    file: ClassVar = ""

    @model_validator(mode="after")
    def _check_expected(self) -> "CaseSection":
        """Check that the expected value, and what else is given, fits the quantity."""
        # A regression value has no expected value until an update fills it in.
        if self.expected is not None and self.quantity == "outcome":
            if perforates(str(self.expected)) is None:
                raise ValueError(f"expected {MUST_SAY}, found {describe(self.expected)}")
        elif self.expected is not None and self.quantity == VERDICT:
            if self.expected not in VERDICTS:
                raise ValueError(f"expected must be one of {', '.join(VERDICTS)}, found {describe(self.expected)}")
        elif isinstance(self.expected, str):
            raise ValueError(f"expected must be a number for {self.quantity}, found {describe(self.expected)}")
        if (self.quantity in SAVINGS) != (self.replaced_by is not None):
            raise ValueError(f"replaced_by belongs to {' and '.join(SAVINGS)}, and to nothing else")
        if self.quantity in WORDS and self.measured is not None:
            raise ValueError(f"{WORDS[self.quantity]} has no difference from a measured value, found measured")
        return self


class TableSection(_Expectation, GroupSection):
    """A table of cases that differ in some inputs of a scenario; its rows are in the suite or in a CSV file."""

    columns: list[Name] = []
    rows: Annotated[list[list[float]], Field(min_length=1)] = []
    file: str = ""
    group: list[GroupSection] = []
    rms_band: Width | None = None
    replaced_by: ClassVar = None

    @model_validator(mode="after")
    def _check_rows(self) -> "TableSection":
        """Check that the table has rows or a file, the keys that belong to it, and columns that fit."""
        if self.quantity in (*SAVINGS, *WORDS):
            raise ValueError(f"a table must be of numbers that one scenario answers, found {self.quantity}")
        if self.rms_band is not None and self.rms_band_percent is not None:
            raise ValueError("must have rms_band or rms_band_percent, found both")
        excluded = ("columns", "rows", "rms_band") if self.file else ("where", "group", "mean_band_percent")
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
        if EXPECTED not in self.columns:
            raise ValueError(f"columns must include {EXPECTED}")
        for index, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                must = f"every row must have the {len(self.columns)} numbers of the columns"
                raise ValueError(f"{must}, found {len(row)} in rows[{index}]")
            if self.compares and (value := row[self.columns.index(MEASURED_COLUMN)]) <= 0.0:
                raise ValueError(f"measured must be greater than 0, found {value:g} in rows[{index}]")
        return self

    @property
    def compares(self) -> bool:
        """Whether the expected values are relative differences from measured ones, in per cent."""
        return MEASURED_COLUMN in self.columns


# Name of the table in which cases outside tables are shown.
CASES = "cases"


def _with_names_apart(tables: list[TableSection]) -> list[TableSection]:
    """Return the tables if their names differ; otherwise raise ValueError, as validators do."""
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
    table: Annotated[list[TableSection], AfterValidator(_with_names_apart)] = []


def is_regression(section: CaseSection | TableSection, suite: SuiteSection) -> bool:
    """Return whether the expected values of a section are results of this program, not values with a source."""
    return (section.regression or suite.regression) and not (section.source or suite.source)
