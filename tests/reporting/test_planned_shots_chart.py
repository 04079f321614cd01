"""Charts of plans of tests."""

from armour.planning.shot_plan import plan_shots
from armour.reporting.chart import Line, Points, Rule
from armour.reporting.views.planned_shots import chart
from armour.statistics.v50 import Shots
from tests.helpers.cases import scenario

SHOTS = Shots((700.0, 720.0, 760.0, 710.0, 740.0), (False, True, True, False, False), "f.csv")


def test_prior_posterior_shots_and_the_next_velocity():
    plan = plan_shots(scenario(), SHOTS)
    drawn = chart(plan)
    assert drawn.title == "V50 firing, bayesian: 5 shots in f.csv"
    density, response = drawn.panels
    prior, posterior = (series for series in density.series if isinstance(series, Line))
    assert max(value for value in posterior.y if value) > max(value for value in prior.y if value)
    points = [series for series in response.series if isinstance(series, Points)]
    assert {series.label: list(series.x) for series in points} == {
        "partial penetration": [700.0, 710.0, 740.0],
        "complete penetration": [720.0, 760.0],
    }
    for panel in drawn.panels:
        [rule] = (series for series in panel.series if isinstance(series, Rule))
        assert rule.at == plan.next_velocity_m_s
    assert "95 % interval" in drawn.note


def test_without_a_prior_the_curve_is_that_of_the_shots():
    unknown = scenario(uncertainty={"model": {"included": False}})
    plan = plan_shots(unknown, SHOTS, procedure="up-and-down", half_width_m_s=100.0, requirement_m_s=730.0)
    drawn = chart(plan)
    [panel] = drawn.panels
    assert [series.label for series in panel.series if isinstance(series, Line)] == ["probit, penalised likelihood"]
    assert any(series.label == "requirement 730.0 m/s" for series in panel.series)


def test_shots_of_one_kind_have_no_curve():
    unknown = scenario(uncertainty={"model": {"included": False}})
    plan = plan_shots(unknown, Shots((700.0,), (False,), "f.csv"), procedure="up-and-down")
    [panel] = chart(plan).panels
    assert [series.label for series in panel.series if isinstance(series, Points)] == ["partial penetration"]
    assert not any(isinstance(series, Line) for series in panel.series)
