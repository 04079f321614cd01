"""Tables of planned tests."""

from dataclasses import replace

import numpy as np
import pytest

from armour.planning.plan_tests import PlannedTests, plan_tests
from armour.reporting.views.planned_tests import (
    form_table,
    plan_table,
)
from armour.scenario.inputs import BACKING, CERAMIC, VELOCITY
from armour.statistics.measured import read_tests
from tests.helpers.cases import shipped_scenario

GRID = {CERAMIC: [5.0, 8.0, 11.0], BACKING: [4.0, 8.0]}


@pytest.fixture(scope="module")
def result() -> PlannedTests:
    return plan_tests(shipped_scenario("wilkins"), GRID, law="backing", number=5, scatter_percent=3.0, cost=10.0)


def test_tests_that_do_not_determine_the_inputs(result: PlannedTests):
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
