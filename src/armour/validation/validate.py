"""Check the model against a suite: compute its cases, and compare the deviations with their bands."""

import codecs
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isnan, sqrt
from os import PathLike
from typing import Any, Literal

import numpy as np

from armour.analysis.evaluate import evaluate_groups, groups_of
from armour.analysis.results import TableResult, by_column
from armour.design.against import is_same
from armour.errors import NoAnswerError
from armour.evidence.core_digest import changed_equations
from armour.files import named
from armour.scenario.checked import checked
from armour.scenario.inputs import INPUTS, NAMES
from armour.scenario.sections import TINY
from armour.validation.questions import Subject, answer
from armour.validation.suite import Case, Suite, load_suite
from armour.validation.suite_sections import GroupSection, TableSection, meets

CheckStatus = Literal["within", "outside", "no answer", "no expected value", "not scored"]
FAILED: tuple[CheckStatus, ...] = ("outside", "no answer", "no expected value")


@dataclass(frozen=True)
class Check:
    """A case, its computed value, and whether this is within the band.

    Attributes
    ----------
    case : Case
    computed : float or str or None
        Computed value, to compare with the expected one; None if the question has no answer.
    status : {"within", "outside", "no answer", "no expected value", "not scored"}
    message : str
        Why there is no answer or no expected value, or why the case fails or is not scored.
    """

    case: Case
    computed: float | str | None
    status: CheckStatus
    message: str = ""

    @property
    def deviation(self) -> float | None:
        """Computed minus expected value; None if either is not a number."""
        if isinstance(self.computed, float) and isinstance(self.case.expected, float):
            return self.computed - self.case.expected
        return None

    @property
    def in_group(self) -> bool:
        """Whether the case is a row of a file of tests without a band of its own; its table is scored as a whole."""
        return bool(self.case.cells) and self.status == "not scored" and not (self.case.not_scored or self.message)

    @property
    def deviation_percent(self) -> float | None:
        """Deviation relative to the expected value, %.

        None without a deviation, near 0, and if the expected value is itself a relative difference.
        """
        expected, deviation = self.case.expected, self.deviation
        if deviation is None or not isinstance(expected, float) or abs(expected) < TINY:
            return None
        return 100.0 * deviation / abs(expected) if self.case.measured is None else None

    def to_dict(self) -> dict[str, Any]:
        """Return the check as plain data, by the keys of a case in JSON."""
        return {
            "table": self.case.group,
            "name": self.case.name,
            "scenario": self.case.scenario.file,
            "quantity": self.case.quantity,
            "expected": self.case.expected,
            "computed": self.computed,
            "deviation": self.deviation,
            "deviation_percent": self.deviation_percent,
            "band": self.case.band,
            "measured": self.case.measured,
            "status": self.status,
            "message": self.message or self.case.not_scored,
            "reason": self.case.reason,
            "source": self.case.source,
        }


@dataclass(frozen=True)
class TableSummary:
    """Mean, root mean square and magnitudes of the deviations of a table's rows, or of a group of them.

    They are in per cent if the band is relative or the rows are from a file, otherwise in the unit of the quantity.

    Attributes
    ----------
    name, group : str
        Name of the table and of the group of its rows; the group is empty for all rows.
    count : int
        Number of rows with a deviation.
    unit : str
        Unit of the deviations.
    mean, rms, largest, mean_magnitude : float
        Mean, root mean square and largest magnitude of the deviations, and mean of their magnitudes.
    rms_band : float or None
        Largest root mean square allowed.
    status : {"within", "outside", "not scored"}
    mean_expected, mean_band : float or None
        Expected mean, and the largest deviation of the mean from it that is allowed.
    """

    name: str
    count: int
    unit: str
    mean: float
    rms: float
    largest: float
    rms_band: float | None
    status: CheckStatus
    group: str = ""
    mean_magnitude: float = 0.0
    mean_expected: float | None = None
    mean_band: float | None = None

    @property
    def full_name(self) -> str:
        """Name of the table, followed by that of the group."""
        return f"{self.name}: {self.group}" if self.group else self.name


@dataclass(frozen=True, repr=False)
class SuiteResult(TableResult):
    """Result of a suite: the checks of its cases, and summaries of its tables.

    Attributes
    ----------
    title, file : str
    checks : tuple of Check
    summaries : tuple of TableSummary
        One per table and one per group of it.
    description : str
        Description of the suite, from its file.
    """

    title: str
    file: str
    checks: tuple[Check, ...]
    summaries: tuple[TableSummary, ...]
    description: str = ""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Changed equations, rows of files of tests that are left out, and columns that probably should be read."""
        changed = [f"computed with {words}"] if (words := self.question.get("changed")) else []
        return tuple(dict.fromkeys([*changed, *(text for check in self.checks for text in check.case.warnings)]))

    @property
    def passed(self) -> bool:
        """Whether any case is scored, and all cases and tables are within their bands."""
        return self.is_scored and self.count(*FAILED) == 0

    @property
    def is_scored(self) -> bool:
        """Whether any case or table is scored, so that the suite can pass or fail."""
        return self.count("within", *FAILED) > 0

    def count(self, *statuses: CheckStatus) -> int:
        """Return the number of cases and tables with one of the statuses."""
        return sum(row.status in statuses for rows in (self.checks, self.summaries) for row in rows)

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data."""
        return {
            "title": self.title,
            "suite": self.file,
            "passed": self.passed,
            "warnings": self.warnings,
            "cases": [check.to_dict() for check in self.checks],
            "tables": [vars(summary) for summary in self.summaries],
        }

    def _columns(self) -> dict[str, Any]:
        return by_column(check.to_dict() for check in self.checks)


# Called with a check and the number of all cases.
OnCheck = Callable[[Check, int], None]


@checked
def validate(suite: Suite | str | PathLike[str], *, on_check: OnCheck | None = None) -> SuiteResult:
    """Compute every case of a suite.

    Parameters
    ----------
    suite : Suite or path-like
        A suite, or what `load_suite` reads: a TOML file, or the name of a shipped suite, such as "paper".
    on_check : callable, optional
        Called after each case with its check and the number of cases.

    Returns
    -------
    SuiteResult

    Raises
    ------
    InputError
        With every mistake in the file of a suite; or if a run of a scenario does not end.
    """
    if not isinstance(suite, Suite):
        suite = load_suite(suite)
    subjects: dict[tuple[str, ...], Subject] = {}
    values_of_tests = _values_for_tests(suite.cases)
    checks = []
    for place, case in enumerate(suite.cases):
        if place in values_of_tests:
            checks.append(_judged(case, values_of_tests[place], f"no {case.quantity} in its range"))
        else:
            checks.append(check(case, subjects))
        if on_check is not None:
            on_check(checks[-1], len(suite.cases))
    return result_of(suite, checks)


def result_of(suite: Suite, checks: Sequence[Check]) -> SuiteResult:
    """Return the result of a suite, given the checks of its cases, or of those that are done."""
    tables = [(table, [check for check in checks if check.case.group == table.name]) for table in suite.tables]
    return SuiteResult(
        title=suite.title,
        file=named(suite.file),
        checks=tuple(checks),
        summaries=tuple(summary for table, rows in tables if rows for summary in _summaries(table, rows)),
        description=suite.description,
    ).of(changed=changed_equations())


def check(case: Case, subjects: dict[tuple[str, ...], Subject]) -> Check:
    """Compute the quantity of a case, and compare it with the band.

    `subjects` keeps what cases about the same scenarios share, by the hashes of these scenarios.
    """
    digests = tuple(scenario.digest() for scenario in case.scenarios)
    try:
        subject = subjects.setdefault(digests, Subject(*case.scenarios))
        return _judged(case, case.compared(answer(case.quantity, subject)))
    except NoAnswerError as error:
        return _judged(case, None, str(error))


def _judged(case: Case, computed: float | str | None, message: str = "") -> Check:
    """Return the check of a case, given its computed value; if that is None, `message` says why.

    A row of a file of tests may have no band, and is then not scored by itself.
    """
    status: CheckStatus = "not scored"
    calibrated = _why_calibrated(case)
    if not (case.not_scored or calibrated):
        if computed is None:
            status = "no answer"
        elif case.expected is None:
            return Check(case, computed, "no expected value", "no expected value yet; --update fills it in")
        elif isinstance(computed, str) or isinstance(case.expected, str):
            status = "within" if computed == case.expected else "outside"
        elif case.band is not None:
            status = "within" if abs(computed - case.expected) <= case.band else "outside"
    return Check(case, computed, status, message if computed is None else calibrated)


def _values_for_tests(cases: Sequence[Case]) -> dict[int, float | None]:
    """Return the computed values of the cases that are rows of files of tests, by index of the case.

    A value is None where there is no answer.  All cases with the same scenario, quantity and inputs are computed
    together, which is fast.
    """
    batches: dict[tuple[int, str, tuple[str, ...]], list[int]] = {}
    for place, case in enumerate(cases):
        if case.cells:
            inputs = tuple(name for name in INPUTS if name in case.cells)
            batches.setdefault((id(case.scenario), case.quantity, inputs), []).append(place)
    computed: dict[int, float | None] = {}
    for (_, quantity, inputs), places in batches.items():
        columns = {name: np.array([float(cases[place].cells[name]) for place in places]) for name in inputs}
        values = evaluate_groups(groups_of(cases[places[0]].scenario, columns), [quantity])[0][quantity]
        for place, value in zip(places, np.broadcast_to(values, len(places)).tolist(), strict=True):
            computed[place] = None if isnan(value) else value
    return computed


def _why_calibrated(case: Case) -> str:
    """Return the reason not to score a case, one of whose materials was calibrated to this very test; "" if none."""
    names = {key: case.scenario.name_of(role) for role, key in NAMES.items()}
    measured = case.expected if case.measured is None else case.measured
    values: Mapping[str, object] = {**case.scenario.inputs(), **names, **case.cells, case.quantity: measured}
    for role in NAMES:
        entry = case.scenario.entry_of(role)
        if entry is None:
            continue
        for key, value in entry.values.items():
            for test in value.tests:
                if case.quantity in test and all(is_same(cell, values.get(name)) for name, cell in test.items()):
                    return f"not scored: {key} of {entry.name} was calibrated to this test"
    return ""


def _summaries(table: TableSection, rows: Sequence[Check]) -> Iterator[TableSummary]:
    """Yield the summaries of a table, given the checks of its rows, and of each of its groups."""
    yield _summary(table, table, rows)
    for group in table.group:
        if rows_of_group := [row for row in rows if meets(row.case.cells, group.where)]:
            yield _summary(table, group, rows_of_group)


def _summary(table: TableSection, bands: GroupSection, rows: Sequence[Check]) -> TableSummary:
    """Return the summary of the deviations of rows; `bands` is their table or group, which gives the bands."""
    percent = bool(table.file) or table.rms_band_percent is not None
    deviations = [row.deviation_percent if percent else row.deviation for row in rows]
    numbers = [deviation for deviation in deviations if deviation is not None]
    count = len(numbers) or 1
    mean, rms = sum(numbers) / count, sqrt(sum(number * number for number in numbers) / count)
    rms_band, mean_band = bands.rms_band_percent if percent else table.rms_band, bands.mean_band_percent
    status: CheckStatus = "not scored"
    if not (rms_band is None and mean_band is None):
        rms_within = rms_band is None or rms <= rms_band
        mean_within = mean_band is None or abs(mean - bands.mean_percent) <= mean_band
        status = "within" if numbers and rms_within and mean_within else "outside"
    return TableSummary(
        name=table.name,
        count=len(numbers),
        unit="%" if percent else rows[0].case.unit,
        mean=mean,
        rms=rms,
        largest=max(map(abs, numbers), default=0.0),
        rms_band=rms_band,
        status=status,
        group=bands.name if bands is not table else "",
        mean_magnitude=sum(map(abs, numbers)) / count,
        mean_expected=None if mean_band is None else bands.mean_percent,
        mean_band=mean_band,
    )


# Number of significant digits in the values that an update writes.
UPDATE_DIGITS = 8


def updates_of(result: SuiteResult) -> list[Check]:
    """Return the checks whose regression values an update replaces, with computed values rounded as it writes them."""
    updates = []
    for check in result.checks:
        computed = float(f"{check.computed:.{UPDATE_DIGITS}g}") if isinstance(check.computed, float) else check.computed
        if check.case.regression and not check.case.not_scored and computed not in (None, check.case.expected):
            updates.append(replace(check, computed=computed))
    return updates


def kept_by_update(result: SuiteResult) -> SuiteResult:
    """Return the result without the regression values, which an update replaces, so that only the others are judged."""
    checks = tuple(check for check in result.checks if not check.case.regression)
    groups = {check.case.group for check in checks}
    summaries = tuple(summary for summary in result.summaries if summary.name in groups)
    return replace(result, checks=checks, summaries=summaries)


def updated_file(content: bytes, updates: Sequence[Check]) -> bytes:
    """Return the content of a suite file with new expected values; comments, layout and line ends stay as they are."""
    import tomlkit  # slow to import

    mark = codecs.BOM_UTF8 if content.startswith(codecs.BOM_UTF8) else b""
    document = tomlkit.parse(content.removeprefix(mark).decode())
    for update in updates:
        table: Any = document
        *path, last = update.case.place
        for key in path:
            table = table[key]
        table[last] = update.computed
    return mark + tomlkit.dumps(document).encode()
