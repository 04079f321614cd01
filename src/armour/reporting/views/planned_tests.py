"""Planned tests among their candidates."""

import re

from armour.analysis.quantities import label_and_unit
from armour.planning.plan_tests import PlannedTests
from armour.reporting.table import Cell, Column, Table, column_of, listing, record
from armour.reporting.text import percent
from armour.scenario.inputs import INPUTS, VELOCITY
from armour.statistics.measured import LIMIT, MEASURED, OUTCOME, Tests

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
    "±: expected half-width of the interval after this test and all before it; for limits by the model, without the "
    "model error"
)


SLOPES = "slope: relative change of the flow stress per projectile diameter of layer thickness"


def plan_table(result: PlannedTests) -> Table:
    """Return what the tests are planned for."""
    measured = relative_to = "ballistic limit"
    if result.measure == "outcome":
        measured, relative_to = "outcome of one shot, stopped or perforated", "impact velocity"
    why = "the candidates do not determine the inputs" if result.not_identified else "too few tests"
    efficient = f"none: {why}"
    if result.efficiency is not None:
        efficient = f"at least {percent(int(1000.0 * result.efficiency) / 1000.0)}"
    scatter = f"{result.scatter_percent:.3g} % of the {relative_to}, {SOURCES[result.scatter_source]}"
    return record(
        result,
        (Column("criterion"), CRITERIA[result.criterion]),
        (Column("candidates", spec="d"), len(next(iter(result.candidates.values())))),
        (Column("measured"), measured),
        (Column("scatter of a test"), scatter),
        (Column("tests made before"), result.tests),
        (Column("law of the ceramic's flow stress"), result.law),
        *((Column(*label_and_unit(name), ".4g"), value) for name, value in result.values.items()),
        (Column("efficiency"), efficient),
    )


def step_table(result: PlannedTests) -> Table:
    """Return the tests in their order, with what is known after each."""
    before = result.planned[0]
    is_nothing_known = {*before.half_widths.values(), *before.limit_half_widths_m_s} == {None}
    steps = result.planned[1:] if is_nothing_known else result.planned
    keys = list(result.candidates)
    varied = [key for key in keys if len(set(result.candidates[key])) > 1] or keys
    names = result.designs if len(result.designs) > 1 else ["the design"] * len(result.designs)
    return listing(
        steps,
        (Column("test"), lambda step: str(step.number or "before")),
        *(
            (
                column_of(key, "g" if key in INPUTS else ""),
                lambda step, key=key: step.inputs[key] if step.number else None,
            )
            for key in varied
        ),
        (Column("limit by the model", "m/s", ".0f"), lambda step: step.ballistic_limit_m_s),
        column_of("total_cost", ".6g"),
        *(
            (Column(f"± {words}", unit, ".3g"), lambda step, name=name: step.half_widths[name])
            for name, (words, unit) in zip(result.values, map(label_and_unit, result.values), strict=True)
        ),
        *(
            (Column(f"± limit of {name}", "m/s", ".0f"), lambda step, index=index: step.limit_half_widths_m_s[index])
            for index, name in enumerate(names)
        ),
    )


def tables(result: PlannedTests) -> list[Table | str]:
    """Return all tables of planned tests."""
    slopes = [SLOPES] if any(name.endswith("_slope") for name in result.values) else []
    return [step_table(result), NOTE, *slopes, plan_table(result)]


def form_table(result: PlannedTests) -> Table:
    """Return a table of tests for `armour calibrate` whose measured values are to be filled in.

    It has the tests made before, too; the names of the planned tests go on from theirs.
    """
    tests: Tests | None = result.question.get("tests")
    has_scatter = tests.weighted if tests is not None else result.scatter_known
    uncertainty = MEASURED[LIMIT]
    measured = LIMIT if result.measure == "limit" else OUTCOME
    earlier = {} if tests is None else dict(zip(tests.names, tests.cells, strict=True))
    rows: list[dict[str, Cell]] = [{**cells, "test": name} for name, cells in earlier.items()]
    last = max((int(match[1]) for match in map(PLANNED.fullmatch, earlier) if match), default=0)
    for step in result.planned[1:]:
        row: dict[str, Cell] = {"test": f"planned {last + step.number}", **step.inputs}
        value = step.ballistic_limit_m_s if result.measure == "limit" else step.inputs[VELOCITY]
        if has_scatter and value is not None:
            row[uncertainty] = float(f"{result.scatter_percent / 100.0 * float(value):.3g}")
        rows.append(row)
    keys = dict.fromkeys(["test", *(key for row in rows for key in row if key not in (measured, uncertainty))])
    columns = [*keys, measured, *([uncertainty] if has_scatter else [])]
    return Table(
        tuple(Column(label_and_unit(key)[0], key=key) for key in columns),
        tuple(tuple(row.get(key) for key in columns) for row in rows),
    )
