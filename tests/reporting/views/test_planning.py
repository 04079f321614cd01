"""Answers on plans of shots."""

from dataclasses import replace

import pytest

from armour.planning.firing import plan_shots
from armour.planning.procedures import OperatingPoint
from armour.reporting.by_result import in_a_line
from armour.reporting.table import Table
from armour.reporting.views.planning import tables_of_shot_plan
from armour.statistics.v50 import Shots
from tests.helpers.cases import scenario
from tests.reporting.tables import facts

SHOTS = Shots((700.0, 720.0), (False, True))


@pytest.mark.slow
def test_the_next_velocity_is_the_answer():
    plan = plan_shots(scenario())
    shown = tables_of_shot_plan(plan)
    assert (in_a_line(plan), len(shown)) == ("fire at 726.8 m/s", 2)
    assert facts(shown) == {
        "shots": "0 so far, about 14 to go until V50 is known to ± 15 m/s",
        "V50": "715 m/s expected (95 % between 614 and 839); scatter 14 m/s assumed",
    }


@pytest.mark.slow
def test_what_ended_the_firing_is_shown():
    shots = Shots(
        (720.0, 730.0, 731.0, 740.0, 741.0, 742.25), (False, False, True, False, True, True), names=["A1"] * 6
    )
    plan = plan_shots(scenario(), shots, procedure="up-and-down").of(every_row=True)
    assert in_a_line(plan).startswith("firing ended: ")
    *_, listed = shown = tables_of_shot_plan(plan)
    assert facts(shown)["mean"] == "734 m/s (MIL-STD-662F)"
    assert isinstance(listed, Table)
    assert listed.texts()[-1] == ["A1", "742.25", "perforated"]
    alone = plan_shots(scenario(), half_width_m_s=300.0)
    assert in_a_line(alone).endswith(", by the limit expected alone")


@pytest.mark.slow
def test_a_requirement_has_its_operating_characteristic_before_the_first_shot():
    points = (OperatingPoint(660.0, 14.0, 0.0, 1.0, 9.0), OperatingPoint(740.0, 14.0, 1.0, 0.0, 9.0))
    plan = plan_shots(scenario(), requirement_m_s=700.0, procedure="up-and-down")
    plan = replace(plan, operating_characteristic=points).of(every_row=True)
    found = [table.title for table in tables_of_shot_plan(plan) if isinstance(table, Table)]
    assert "operating characteristic: simulated firings at a scatter of 14 m/s" in found
