"""Tables of plans of shots and of tests."""

from dataclasses import replace

import numpy as np
import pytest

from armour.planning.firing import plan_shots
from armour.planning.plan_tests import PlannedTests, plan_tests
from armour.planning.procedures import OperatingPoint
from armour.reporting.table import Table
from armour.reporting.views.planning import ONE_SIDE, REPORT, form_table, plan_table, tables_of_shot_plan
from armour.scenario.inputs import BACKING, CERAMIC, VELOCITY
from armour.statistics.measured import read_tests
from armour.statistics.v50 import Shots
from tests.helpers.cases import scenario, shipped_scenario
from tests.reporting.tables import quantities

GRID = {CERAMIC: [5.0, 8.0, 11.0], BACKING: [4.0, 8.0]}
SHOTS = Shots((700.0, 720.0), (False, True))


@pytest.mark.slow
def test_what_ended_the_firing_is_shown():
    shots = Shots(
        (720.0, 730.0, 731.0, 740.0, 741.0, 742.25), (False, False, True, False, True, True), names=["A1"] * 6
    )
    first, *_, listed = tables_of_shot_plan(plan_shots(scenario(), shots, procedure="up-and-down"))
    assert isinstance(first, Table)
    assert isinstance(listed, Table)
    assert quantities(first)["V50 by the mean of MIL-STD-662F, m/s"] == "734"
    assert listed.texts()[-1] == ["A1", "742.25", "complete"]
    alone = tables_of_shot_plan(plan_shots(scenario(), requirement_m_s=620.0, prior=True))
    assert "by the prior alone: no shot was fired" in alone


@pytest.mark.slow
def test_no_part_is_given_where_the_shots_contradict_the_prior():
    shots = Shots((300.0, 1500.0), (True, False))
    found = tables_of_shot_plan(plan_shots(scenario(), shots, procedure="up-and-down"))
    assert not any("of the precision" in item for item in found if isinstance(item, str))


@pytest.mark.slow
@pytest.mark.parametrize(("required", "noted"), [(620.0, True), (710.0, False), (790.0, True)])
def test_shots_on_one_side_of_a_requirement_say_little(required: float, noted: bool):
    found = tables_of_shot_plan(plan_shots(scenario(), SHOTS, requirement_m_s=required))
    assert (ONE_SIDE in found) == noted
    assert REPORT in found


FIVE = Shots((700.0, 720.0, 760.0, 710.0, 740.0), (False, True, True, False, False), "f.csv")


@pytest.mark.slow
def test_a_requirement_has_its_operating_characteristic_before_the_first_shot():
    points = (OperatingPoint(660.0, 14.0, 0.0, 1.0, 9.0), OperatingPoint(740.0, 14.0, 1.0, 0.0, 9.0))
    plan = plan_shots(scenario(), requirement_m_s=700.0, procedure="up-and-down")
    plan = replace(plan, operating_characteristic=points)
    found = [table.title for table in tables_of_shot_plan(plan) if isinstance(table, Table)]
    assert "operating characteristic: simulated firings at a scatter of 14 m/s" in found


@pytest.mark.slow
def test_without_a_model_error_the_prior_is_no_models():
    unknown = scenario(uncertainty={"model": {"included": False}})
    plan = plan_shots(unknown, FIVE, procedure="up-and-down", half_width_m_s=100.0, requirement_m_s=730.0)
    assert any(
        "prior of V50: within 30 % of the limit" in item for item in tables_of_shot_plan(plan) if isinstance(item, str)
    )


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
