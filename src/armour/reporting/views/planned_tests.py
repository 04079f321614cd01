"""Planned tests among their candidates."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from armour.analysis.quantities import label_and_unit
from armour.planning.plan_tests import PlannedTests
from armour.reporting import charts
from armour.reporting.table import Cell, Column, Table, column_of, listing, record
from armour.reporting.text import percent
from armour.scenario.inputs import BACKING, CERAMIC, INPUTS, VELOCITY
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
    nothing = {*before.half_widths.values(), *before.limit_half_widths_m_s} == {None}
    steps = result.planned[1:] if nothing else result.planned
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


GAIN = "relative gain of one more test"
GAINS = "Gain of one more test{}, relative to the average planned test (1: as good)."
# Velocities that a note names one by one, and candidates up to which each has its gain as a number.
MAX_LISTED, MAX_NUMBERS = 6, 60
# Markers of candidates that are tested once, twice, and so on; those tested more often have the last.
MARKERS = "os^D*"


def chart(result: PlannedTests) -> charts.Chart:
    """Describe the gain of one more test over the inputs that vary, with the planned tests and their numbers.

    It is a map over two of them, by preference the thicknesses, or a curve over one; the greatest gain is shown where
    candidates differ in more.
    """
    varied = [key for key in result.candidates if key in INPUTS and len(set(result.candidates[key])) > 1]
    keys = [key for key in (CERAMIC, BACKING) if key in varied] or varied[:1] or [next(iter(result.candidates))]
    keys += [key for key in varied if key not in keys][: 2 - len(keys)]
    columns = [np.array(result.candidates[key]) for key in keys]
    gains = np.array(result.sensitivities or [np.nan] * len(columns[0]))
    axes = [charts.quantity_axis(key) for key in keys]
    steps = result.planned[1:]
    points: list[tuple[Any, ...]] = [tuple(step.inputs[key] for key in keys) for step in steps]
    if len(keys) == 1:
        x = np.unique(columns[0])
        greatest = [float(np.nanmax(gains[columns[0] == value])) if result.sensitivities else None for value in x]
        marker = "." if len(x) < 40 else ""
        series: list[charts.Series] = [charts.Line(x.tolist(), greatest, label="candidates", marker=marker)]
        points = [(value, greatest[int(np.searchsorted(x, value))]) for (value,) in points]
        axes.append(charts.Axis(GAIN, spec=".2f"))
    else:
        order = np.argsort(gains, kind="stable")  # the greatest is written last
        series = _candidates(*charts.on_grid(columns[0][order], columns[1][order], gains[order]))
        axes = [replace(axis, limits=charts.widened(of, 0.15)) for axis, of in zip(axes, columns, strict=True)]
    velocities = [float(step.inputs[VELOCITY]) for step in steps] if result.measure == "outcome" else []
    series += _planned(points, velocities)
    note = GAINS.format("" if result.planned[-1].total_cost is None else " per unit cost")
    if not result.sensitivities:
        note = "The planned tests do not determine the inputs, so no gain is shown."
    if velocities:
        note += f" The planned shots are at {velocities_in_words(velocities)}."
    title = f"Planned: {len(steps)} test{'s' if len(steps) > 1 else ''}"
    for name, half_width in result.planned[-1].half_widths.items():
        if half_width is not None:
            words, unit = label_and_unit(name)
            title += f", after which {words} ± {half_width:.2g} {unit}".rstrip()
            break
    return charts.Chart(title, (charts.Panel(axes[0], axes[1], tuple(series), height=1.2),), note)


def _planned(points: Sequence[tuple[Any, ...]], velocities: Sequence[float]) -> Iterator[charts.Points]:
    """Give the points of planned tests, those with the same number of tests together, and the velocities of shots."""
    repeats = Counter(points)
    for times in sorted(set(repeats.values())):
        some = [point for point, count in repeats.items() if count == times]
        shots = [[v for place, v in zip(points, velocities, strict=False) if place == point] for point in some]
        text = tuple(f"at {velocities_in_words(of_point)}" for of_point in shots) if velocities else ()
        rank = min(times, len(MARKERS))
        look: Any = {"label": "one test" if times == 1 else f"{times} tests", "colour": "vermilion", "text": text}
        xs, ys = zip(*some, strict=True)
        yield charts.Points(xs, ys, MARKERS[rank - 1], 5.0 + rank, **look)


def velocities_in_words(velocities: Iterable[float]) -> str:
    """Return different velocities in words, or their range where they are many."""
    found = [f"{velocity:.4g}" for velocity in sorted(set(velocities))]
    if len(found) > MAX_LISTED:
        return f"{len(found)} velocities, {found[0]} to {found[-1]} m/s"
    return f"{', '.join([*found[:-2], ' and '.join(found[-2:])])} m/s"


def _candidates(x: Any, y: Any, z: Any) -> list[charts.Series]:
    """Describe the gains of candidates: numbers beside points or, where they are many and a grid, colours."""
    if len(x) * len(y) > MAX_NUMBERS and np.isfinite(z).all():
        return [charts.Map(x, y, z, GAIN)]
    js, i = np.nonzero(np.isfinite(z)) if np.isfinite(z).any() else np.nonzero(np.isnan(z))
    words = tuple(f"{value:.2f}" if np.isfinite(value) else "" for value in z[js, i])
    places = x[i].tolist(), y[js].tolist()
    few = words if len(words) <= MAX_NUMBERS else ()
    return [charts.Points(*places, label=GAIN, filled=False, colour="soft", names=few, text=words)]
