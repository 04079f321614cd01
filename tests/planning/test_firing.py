"""Plans of V50 firings."""

import json
from math import isfinite
from typing import Any

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.errors import InputError
from armour.planning import procedures
from armour.planning.firing import plan_shots
from armour.planning.procedures import PROCEDURES
from armour.statistics.v50 import Shots
from tests.helpers.cases import scenario
from tests.helpers.known import known

pytestmark = pytest.mark.slow

SHOTS = Shots((723.0, 770.0, 745.0, 760.0), (False, True, False, False))
ARMOUR = "6.35 mm AD85 on 6.35 mm 6061-T6 against 7.62 mm AP"
# Silicon carbide on titanium: no error is known.
UNKNOWN = {"ceramic": "SiC", "backing": "Ti-6Al-4V"}


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulate no continuations, which tests/planning/test_procedures.py does."""
    monkeypatch.setattr(procedures, "expected_shots", lambda *_: 4.0)


@pytest.mark.parametrize("procedure", PROCEDURES)
def test_a_plan_is_a_pure_function_of_the_shots_so_far(procedure: Any):
    first = plan_shots(scenario(), SHOTS, procedure=procedure)
    # No state is kept between plans.
    if procedure == "bayesian":
        assert first == plan_shots(scenario(), SHOTS, procedure=procedure)
    assert first.next_velocity_m_s is not None
    assert 650.0 < first.next_velocity_m_s < 850.0
    assert first.reason
    assert (first.fired, first.stopped) == (SHOTS, "")
    found = json.loads(json.dumps(first.to_dict(), allow_nan=False))
    assert found["posterior"]["v50_m_s"] > found["prior"]["v50_m_s"]
    for said in (ARMOUR, f"{first.next_velocity_m_s:.1f} m/s"):
        assert said in repr(first)


SWAPPED = Shots((740.0, 750.0, 760.0, 700.0, 710.0, 720.0), (False, False, False, True, True, True), "fired.csv")


def test_swapped_results_are_named_and_not_planned_on():
    with pytest.raises(InputError, match=r"fired\.csv: result: must have complete .* are the results swapped\?"):
        plan_shots(scenario(), SWAPPED)
    # Two shots in this order are no sign of it.
    assert plan_shots(scenario(), Shots((740.0, 720.0), (False, True))).next_velocity_m_s


def test_a_requirement():
    plan = plan_shots(scenario(), SHOTS, requirement_m_s=760.0, requirement_fraction=0.05)
    assert 0.05 < known(plan.probability_met) < 0.5
    assert plan.half_width_m_s is None
    assert plan.decision == ""
    assert plan.consumers_risk == plan.producers_risk == pytest.approx(0.05)
    alone = plan_shots(scenario(), Shots((650.0,) * 7, (False,) * 7), requirement_m_s=650.0)
    assert alone.stopped == "the requirement is met, at a consumer's risk of at most 5 %"
    assert alone.decision == "met"
    assert (alone.evidence_met or 0.0) > 20.0 > (alone.evidence_not_met or 0.0)
    assert plan_shots(scenario(), requirement_m_s=700.0, procedure="up-and-down").next_velocity_m_s == 722.9
    shots = Shots((700.0, 703.0, 706.0, 709.0, 712.0, 715.0), (False, True) * 3)
    ended = plan_shots(scenario(), shots, requirement_m_s=700.0, procedure="up-and-down")
    assert ended.decision == "not decided"
    assert ended.stopped.endswith("within 27.432 m/s; the requirement is not decided")


def test_a_requirement_in_another_unit():
    with pytest.raises(InputError, match="and three times it, found 2600; is it in m/s"):
        plan_shots(scenario(), requirement_m_s=2600.0)


def test_the_operating_characteristic_of_a_firing_that_has_not_begun():
    plan = plan_shots(scenario(), requirement_m_s=700.0)
    points = plan.operating_characteristic
    assert [point.v50_m_s for point in points] == sorted(point.v50_m_s for point in points)
    assert points[0].v50_m_s < 670.0 < 730.0 < points[-1].v50_m_s
    assert (points[0].not_met, points[-1].met) == (1.0, 1.0)
    edge = next(point for point in points if point.v50_m_s == 700.0)
    assert edge.shots is None
    assert max(edge.met, edge.not_met) <= 0.11  # at most 5 % are expected of 100
    assert plan_shots(scenario(), SHOTS, requirement_m_s=700.0).operating_characteristic == ()


def test_without_a_scenario_limits_or_shots_say_where_v50_may_be():
    plan = plan_shots(None, SHOTS)
    middle = 0.5 * (min(SHOTS.velocities_m_s) + max(SHOTS.velocities_m_s))
    assert plan.prior.v50_m_s == pytest.approx(middle, rel=1e-3)
    assert (plan.model_ballistic_limit_m_s, plan.model_error) == (None, None)
    assert plan.next_velocity_m_s is not None
    given = plan_shots(limits_m_s=(700.0, 900.0))
    assert given.prior.v50_interval_m_s == pytest.approx((700.0, 900.0), rel=0.01)
    with pytest.raises(InputError, match="scenario: must be given, or a table of shots"):
        plan_shots()
    with pytest.raises(InputError, match="limits_m_s: must not be given with bayesian where the model error is known"):
        plan_shots(scenario(), limits_m_s=(700.0, 900.0))


def test_a_stated_error_is_a_prior_and_an_unknown_one_is_wide():
    limit = ballistic_limit(scenario(**UNKNOWN)).ballistic_limit_m_s
    wide = plan_shots(scenario(**UNKNOWN))
    assert wide.model_error is None
    assert wide.prior.v50_m_s == pytest.approx(limit, rel=1e-3)
    assert wide.prior.v50_interval_m_s == pytest.approx((0.7 * limit, 1.3 * limit), rel=0.01)
    assert "30 %" in wide.expected_from
    plan = plan_shots(scenario(**UNKNOWN), SHOTS, procedure="neyer", limits_m_s=(500.0, 1500.0))
    assert plan.prior.v50_interval_m_s == pytest.approx((500.0, 1500.0), rel=0.01)
    assert plan.recommended is not None
    # A requirement is decided on by the shots alone.
    assert plan_shots(scenario(**UNKNOWN), SHOTS, requirement_m_s=700.0).next_velocity_m_s is not None
    stated = scenario(
        **UNKNOWN, uncertainty={"model": {"scale_percent": 10.0, "degrees_of_freedom": 1e6, "source": "tests"}}
    )
    assert plan_shots(stated).prior is not None
    assert "not known" in plan_shots(scenario(uncertainty={"model": {"included": False}})).expected_from


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"requirement_fraction": 0.1}, "requirement_fraction: must not be given without a requirement"),
        ({"limits_m_s": (600.0, 900.0)}, "limits_m_s: must not be given with bayesian"),
        ({"limits_m_s": (900.0, 600.0), "procedure": "neyer"}, "limits_m_s: the lower one must be less .* 900 and 6"),
        ({"requirement_m_s": 700.0, "procedure": "neyer"}, "requirement_m_s: must not be given with neyer"),
        ({"requirement_m_s": 700.0, "half_width_m_s": 9.0}, "half_width_m_s: must not be given with a requirement"),
        ({"limits_m_s": (700.0,), "procedure": "langlie"}, r"limits_m_s\[1\]: is missing and must be given"),
    ],
)
def test_wrong_settings(settings: dict[str, Any], message: str):
    with pytest.raises(InputError, match=f"plan_shots: {message}"):
        plan_shots(scenario(), **settings)


@pytest.mark.parametrize("procedure", PROCEDURES)
def test_absurd_shots_have_a_finite_plan(procedure: Any):
    shots = Shots((12.0, 9000.0, 9000.0), (True, False, False))
    plan = plan_shots(None, shots, procedure=procedure)
    with pytest.raises(InputError, match=r"velocity_m_s: must be between a third of .* found 12; is it in m/s\?"):
        plan_shots(scenario(), shots)
    assert plan.next_velocity_m_s is not None
    assert isfinite(plan.next_velocity_m_s)
    assert 10.0 <= plan.next_velocity_m_s <= 10_000.0


def test_shots_that_contradict_the_prior_are_warned_of():
    # Velocities in ft/s, and an armour far better than the model says.
    feet = plan_shots(scenario(), Shots((1860.0, 1990.0), (False, True)))
    assert feet.warnings[0].startswith("the velocities, about 1925 m/s, are 2.7 times the limit by the model")
    assert feet.contradicts_prior
    better = plan_shots(scenario(), Shots((800.0, 850.0, 900.0, 950.0, 1000.0, 1050.0), (False,) * 6))
    assert any("the shots contradict the prior: with them the V50 is 1" in warning for warning in better.warnings)
    assert not any(
        "contradict" in warning or "far from" in warning for warning in plan_shots(scenario(), SHOTS).warnings
    )
