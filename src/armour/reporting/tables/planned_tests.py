"""Tables of planned tests."""

import re
from typing import TYPE_CHECKING

from armour.reporting.table import Cell, Column, Table, column_of, record
from armour.reporting.text import percent
from armour.reporting.words import words_of
from armour.scenario.inputs import INPUTS, VELOCITY
from armour.statistics.test_data import LIMIT, MEASURED, OUTCOME, Tests
from armour.units import words_and_unit

if TYPE_CHECKING:
    from armour.planning.plan_tests import PlannedTest, PlannedTests

CRITERIA = {
    "D": "D, the smallest confidence region of the fitted inputs",
    "I": "I, the least mean variance of the limits of the designs",
}
SOURCES = {
    "given": "given",
    "uncertainties": "from the uncertainties of the tests made before",
    "residuals": "estimated from the residuals of the tests made before",
}
PLANNED = re.compile(r"planned (\d+)")
NOTE = (
    "± is the half-width of the interval to expect once the test has been made, with those before it; for a limit it "
    "is that of the limit by the model, without the model's own error"
)

SLOPES = "a slope is the relative change of the flow stress per projectile diameter of the layer's thickness"


def plan_table(result: "PlannedTests") -> Table:
    """Return what the tests are planned for."""
    of = "ballistic limit" if result.measure == "limit" else "impact velocity"
    why = "the candidates do not determine the inputs" if result.not_identified else "too few tests"
    efficient = f"none: {why}" if result.efficiency is None else f"at least {percent_of(result.efficiency)}"
    return record(
        result,
        (Column("criterion"), CRITERIA[result.criterion]),
        (Column("candidates", spec="d"), len(next(iter(result.candidates.values())))),
        (
            Column("measured"),
            "ballistic limit" if result.measure == "limit" else "outcome of one shot, defeated or perforated",
        ),
        (
            Column("scatter of a test"),
            f"{result.scatter_percent:.3g} % of the {of}, {SOURCES[result.scatter_source]}",
        ),
        (Column("tests made before"), result.tests or None),
        (Column("law of the ceramic's flow stress"), result.law or None),
        *((Column(*words_of(name), ".4g"), value) for name, value in result.values.items()),
        (Column("efficiency"), efficient),
    )


def percent_of(part: float) -> str:
    """Format an efficiency, rounded down."""
    return percent(int(1000.0 * part) / 1000.0)


def step_table(result: "PlannedTests") -> Table:
    """Return the tests in their order, with what is known after each."""
    steps = result.planned[0 if _known(result.planned[0]) else 1 :]
    keys = list(result.candidates)
    varied = [key for key in keys if len(set(result.candidates[key])) > 1] or keys
    several = len(result.designs) > 1
    costly = result.planned[0].total_cost is not None
    columns = (
        Column("test"),
        *(Column(*words_of(key), "g" if key in INPUTS else "") for key in varied),
        Column("ballistic limit by the model", "m/s", ".0f"),
        *([column_of("total_cost", ".6g")] if costly else []),
        *(_half_width(name) for name in result.values),
        *(Column(f"± limit of {name if several else 'the design'}", "m/s", ".1f") for name in result.designs),
    )
    rows = (
        (
            str(step.number or "before"),
            *(step.inputs[key] if step.number else None for key in varied),
            step.ballistic_limit_m_s,
            *([step.total_cost] if costly else []),
            *step.half_widths.values(),
            *step.limit_half_widths_m_s,
        )
        for step in steps
    )
    return Table(columns, tuple(rows))


def _half_width(name: str) -> Column:
    words, unit = words_of(name)
    return Column(f"± {words}", unit, ".3g")


def _known(step: "PlannedTest") -> bool:
    return any(value is not None for value in (*step.half_widths.values(), *step.limit_half_widths_m_s))


def planned_tables(result: "PlannedTests") -> list[Table | str]:
    """Return all tables of planned tests."""
    slopes = [SLOPES] if any(name.endswith("_slope") for name in result.values) else []
    return [plan_table(result), step_table(result), NOTE, *slopes]


def form_table(result: "PlannedTests", tests: Tests | None) -> Table:
    """Return a table of tests for `armour calibrate` whose measured values are to be filled in.

    It has the tests made before, too; the names of the planned tests go on from theirs.
    """
    given = tests.weighted if tests is not None else result.scatter_known
    uncertainty = MEASURED[LIMIT]
    measured = LIMIT if result.measure == "limit" else OUTCOME
    made = {} if tests is None else dict(zip(tests.names, tests.cells, strict=True))
    rows: list[dict[str, Cell]] = [{**cells, "test": name} for name, cells in made.items()]
    last = max((int(found[1]) for found in map(PLANNED.fullmatch, made) if found), default=0)
    for step in result.planned[1:]:
        row: dict[str, Cell] = {"test": f"planned {last + step.number}", **step.inputs}
        value = step.ballistic_limit_m_s if result.measure == "limit" else step.inputs[VELOCITY]
        if given and value is not None:
            row[uncertainty] = float(f"{result.scatter_percent / 100.0 * float(value):.3g}")
        rows.append(row)
    keys = dict.fromkeys(["test", *(key for row in rows for key in row if key not in (measured, uncertainty))])
    columns = [*keys, measured, *([uncertainty] if given else [])]
    return Table(
        tuple(Column(words_and_unit(key)[0], key=key) for key in columns),
        tuple(tuple(row.get(key) for key in columns) for row in rows),
    )
