"""The probability of defeat of armours with and without a limit; tests/statistics has its numbers."""

from armour.analysis.confidence import confidence
from tests.helpers.cases import scenario


def test_an_armour_that_the_slowest_impact_perforates_has_no_probability():
    found = confidence(scenario(ballistic_limit={"velocity_min_m_s": 790.0}))
    assert (found.probability_of_defeat, found.ballistic_limit_m_s) == (None, None)
    assert found.model_error is not None
    assert "790" in found.reason
    assert repr(found).endswith(": probability of defeat not known>")


def test_an_armour_that_the_fastest_impact_does_not_perforate_is_at_least_as_good():
    search = {"velocity_max_m_s": 700.0}
    assert confidence(scenario(velocity=690.0, ballistic_limit=search)).probability_of_defeat is None
    found = confidence(scenario(velocity=450.0, ballistic_limit=search))
    assert found.probability_of_defeat is not None
    assert found.probability_of_defeat > 0.995
    assert found.ballistic_limit_m_s is None
