"""Tables of plans of shots."""

from dataclasses import replace

import pytest

from armour.planning.firing import plan_shots
from armour.planning.procedures import OperatingPoint
from armour.reporting.table import Table
from armour.reporting.views.planning import ONE_SIDE, REPORT, tables_of_shot_plan
from armour.statistics.v50 import Shots
from tests.helpers.cases import scenario
from tests.reporting.tables import quantities

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
