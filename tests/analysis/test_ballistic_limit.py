import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit, confidence
from armour.analysis.impact import impact_at
from armour.analysis.variants import ballistic_limits, variants_of
from armour.errors import InputError, NoLimitError
from tests.helpers.cases import scenario
from tests.helpers.exotic import changing_designs

pytestmark = pytest.mark.slow


CHANGES = {
    "stopped again": [730.78, 1709.42],
    "stopped in between": [524.03, 670.95, 2156.25],
    "perforated between scanned velocities": [1488.70, 1735.91, 6038.31],
    "perforated at a maximum of depth": [48.02, 52.43, 143.89],
    "perforated in narrow ranges": [252.67, 292.35, 322.58, 329.08, 380.98],
}


@pytest.mark.parametrize("name", CHANGES)
def test_all_changes_of_the_outcome_are_found(name: str):
    of = changing_designs()[name]
    result = ballistic_limit(of)
    assert [c.bracket_m_s[1] for c in result.crossings] == pytest.approx(CHANGES[name], rel=1e-4)
    assert [c.above for c in result.crossings] == (["perforated", "stopped"] * 3)[: len(result.crossings)]
    assert [result.ballistic_limit_m_s] == ballistic_limits(variants_of(of, {}, 1)).tolist()
    assert result.ballistic_limit_m_s == result.crossings[0].bracket_m_s[1]
    assert not result.monotonic
    for crossing in result.crossings:
        outcomes = [impact_at(of, velocity).outcome for velocity in crossing.bracket_m_s]
        assert outcomes[0] != outcomes[1] == crossing.above
        assert 0.0 < crossing.bracket_m_s[1] - crossing.bracket_m_s[0] <= 0.01


def test_the_limit_is_the_upper_end_of_its_bracket():
    result = ballistic_limit(scenario())
    low, high = result.bracket_m_s
    assert result.ballistic_limit_m_s == high
    assert 0 < high - low <= 0.01
    assert result.monotonic
    assert 15 < result.runs < 30
    assert (result.scanned_velocities, result.scanned_range_m_s) == (33, (20.0, 4000.0))
    assert result.areal_density_kg_m2 == pytest.approx(39.243)


def test_a_tighter_tolerance_is_kept():
    result = ballistic_limit(scenario(ballistic_limit={"tolerance_m_s": 1e-6}))
    assert result.bracket_m_s[1] - result.bracket_m_s[0] <= 1e-6
    assert result.ballistic_limit_m_s == pytest.approx(723.7707, abs=1e-3)


@pytest.mark.parametrize(
    ("low", "high", "message"),
    [
        (20.0, 500.0, "none of 33 velocities from 20 to 500 m/s perforates"),
        (900.0, 4000.0, "all of 33 velocities from 900"),
    ],
)
def test_a_range_without_a_limit(low: float, high: float, message: str):
    velocities = {"velocity_min_m_s": low, "velocity_max_m_s": high}
    with pytest.raises(NoLimitError, match=message):
        ballistic_limit(scenario(ballistic_limit=velocities))


def test_a_lowest_velocity_that_perforates_is_no_limit(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("armour.analysis.variants.Variants.is_unusual", lambda row: np.zeros(len(row.velocities), bool))
    of = changing_designs()["stopped in between"].replaced({"ballistic_limit": {"velocity_min_m_s": 600.0}})
    with pytest.raises(NoLimitError, match=r"the lowest of 33 velocities from 600 to .* perforates"):
        ballistic_limit(of)


def test_a_run_that_does_not_end_names_its_velocity(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("armour.scenario.schema.Solver.max_steps", 3)
    with pytest.raises(InputError, match=r"the run at 333\.774 m/s"):
        ballistic_limit(scenario())
    assert "the run at 333.774 m/s" in confidence(scenario()).reason


def test_the_residual_velocity_rises_as_a_square_root():
    """Twice as far above the limit, the square of the residual velocity is twice as large."""
    case = scenario(ballistic_limit={"tolerance_m_s": 1e-8})
    limit = ballistic_limit(case).ballistic_limit_m_s
    one, two = (impact_at(case, limit + excess) for excess in (0.01, 0.02))
    ratio = (two.residual_velocity_m_s / one.residual_velocity_m_s) ** 2
    # The projectile counts as stopped at 1 m/s, so that its square is what is missing.
    first, second = (r.residual_velocity_m_s**2 - 1.0 for r in (one, two))
    assert second / first == pytest.approx(2.0, rel=0.01)
    assert ratio == pytest.approx(2.0, rel=0.1)


def test_an_armour_that_every_impact_perforates_has_no_probability():
    found = confidence(scenario(ceramic=None, ceramic_mm=0.0, backing_mm=0.01))
    assert (found.probability_of_stopping, found.ballistic_limit_m_s) == (None, None)
    assert found.reason == "every velocity from 20 m/s perforates"
    assert repr(found).endswith(": not known: every velocity from 20 m/s perforates>")


def test_an_armour_that_no_impact_perforates_is_at_least_as_good():
    given = {"uncertainty": {"model": {"scale_percent": 5.0, "degrees_of_freedom": 1e6, "source": "tests"}}}
    thick = {"ceramic": None, "ceramic_mm": 0.0, "backing_mm": 500.0, **given}
    assert confidence(scenario(velocity=9900.0, **thick)).probability_of_stopping is None
    found = confidence(scenario(velocity=450.0, **thick))
    assert found.probability_of_stopping is not None
    assert found.probability_of_stopping > 0.995
    assert found.ballistic_limit_m_s is None
