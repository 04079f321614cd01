"""Charts and tables of planned tests."""

from dataclasses import replace

import numpy as np
import pytest

from armour.planning.plan_tests import PlannedTests, plan_tests
from armour.reporting.charts import Line, Points
from armour.reporting.show import plot
from armour.reporting.views.planned_tests import (
    GAIN,
    chart,
    form_table,
    plan_table,
    velocities_in_words,
)
from armour.scenario.inputs import BACKING, CERAMIC, VELOCITY
from armour.statistics.measured import read_tests
from tests.helpers.cases import shipped_scenario

GRID = {CERAMIC: [5.0, 8.0, 11.0], BACKING: [4.0, 8.0]}


@pytest.fixture(scope="module")
def result() -> PlannedTests:
    return plan_tests(shipped_scenario("wilkins"), GRID, law="backing", number=5, scatter_percent=3.0, cost=10.0)


def test_a_map_with_the_number_of_tests_of_each_armour(result: PlannedTests):
    [panel] = chart(result).panels
    assert (panel.x.heading, panel.y.heading) == ("ceramic thickness, mm", "back plate thickness, mm")
    points = {item.label: len(item.x) for item in panel.series if isinstance(item, Points)}
    assert points == {GAIN: 6, "2 tests": 1, "3 tests": 1}
    [gains] = [item.names for item in panel.series if item.label == GAIN and isinstance(item, Points)]
    assert sorted(gains) == sorted(f"{gain:.2f}" for gain in result.sensitivities)
    assert plot(result, title="mine").axes


def test_gains_are_per_cost_where_tests_have_one(result: PlannedTests):
    assert "per unit cost" in chart(result).note
    free = tuple(replace(step, cost=None, total_cost=None) for step in result.planned)
    assert "per unit cost" not in chart(replace(result, planned=free)).note


def test_a_curve_over_one_input(result: PlannedTests):
    one = replace(result, candidates={CERAMIC: result.candidates[CERAMIC], BACKING: (4.0,) * 6})
    [panel] = chart(one).panels
    assert isinstance(panel.series[0], Line)
    assert len(panel.series[0].x) == 3


def test_candidates_that_are_no_grid(result: PlannedTests):
    few = {key: values[:3] + values[5:] for key, values in result.candidates.items()}
    some = replace(result, candidates=few, sensitivities=result.sensitivities[:3] + result.sensitivities[5:])
    assert chart(some).panels[0].series[0].label == GAIN


def test_tests_that_do_not_determine_the_inputs(result: PlannedTests):
    assert "no gain" in chart(replace(result, sensitivities=())).note
    assert "none: too few tests" in plan_table(replace(result, efficiency=None)).rows[0]
    lacking = replace(result, efficiency=None, not_identified=("ceramic.flow_stress_GPa",))
    assert "none: the candidates do not determine the inputs" in plan_table(lacking).rows[0]


def test_the_names_of_planned_tests_go_on(result: PlannedTests):
    form = form_table(result)
    made = [
        {column.key: value for column, value in zip(form.columns, row, strict=True)} | {"ballistic_limit_m_s": 760.0}
        for row in form.rows
    ]
    again = form_table(replace(result).of(tests=read_tests(made, shipped_scenario("wilkins"))))
    assert [row[0] for row in again.rows] == [f"planned {i}" for i in range(1, 11)]


def test_planned_shots_have_their_velocities():
    grid = {CERAMIC: [5.0, 6.0], BACKING: [6.0, 8.0], VELOCITY: np.arange(600.0, 900.0, 25.0)}
    wilkins = shipped_scenario("wilkins")
    shots = plan_tests(wilkins, grid, law="backing", number=2, scatter_percent=3.0, measure="outcome")
    assert "3 % of the impact velocity, given" in plan_table(shots).rows[0]
    assert [row[-1] for row in form_table(shots).rows] == pytest.approx(
        [0.03 * float(step.inputs[VELOCITY]) for step in shots.planned[1:]], abs=0.05
    )
    drawn = chart(shots)
    slow, fast = sorted(step.inputs[VELOCITY] for step in shots.planned[1:])
    assert drawn.note.endswith(f"The planned shots are at {slow:g} and {fast:g} m/s.")
    texts = [
        text for item in drawn.panels[0].series if isinstance(item, Points) and item.label != GAIN for text in item.text
    ]
    assert sorted(texts) == [f"at {slow:g} m/s", f"at {fast:g} m/s"]


def test_many_velocities_are_a_range():
    assert velocities_in_words([720.0, 700.0, 750.0]) == "700, 720 and 750 m/s"
    assert velocities_in_words(range(700, 780, 10)) == "8 velocities, 700 to 770 m/s"
