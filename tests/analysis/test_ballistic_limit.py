import pytest

from armour.analysis.ballistic_limit import (
    ballistic_limit,
    bisect,
    curve_velocities,
    find_crossings,
    residual_velocity_curve,
    scan,
)
from armour.errors import NoLimitError
from tests.helpers.cases import scenario


def test_bisection_narrows_to_the_tolerance():
    low, high = bisect(lambda x: x > 2.0**0.5, 0.0, 4.0, 1e-6)
    assert low <= 2.0**0.5 < high
    assert high - low <= 1e-6


def test_bisection_ends_where_floats_do():
    low, high = bisect(lambda x: x > 1.0, 0.0, 4.0, 0.0)
    assert low == 1.0
    assert 1.0 < high < 1.0 + 1e-15


def test_the_scan_has_both_ends():
    velocities = scan(20.0, 4000.0, 33)
    assert (velocities[0], velocities[-1], len(velocities)) == (20.0, 4000.0, 33)
    assert velocities == sorted(velocities)


def test_all_crossings_are_found():
    crossings = find_crossings(lambda v: 300 < v < 800 or v > 1500, 20.0, 4000.0, 0.01)
    assert [c.above for c in crossings] == ["perforated", "defeated", "perforated"]
    found = [velocity for c in crossings for velocity in c.bracket_m_s]
    assert found == pytest.approx([300, 300, 800, 800, 1500, 1500], abs=0.01)


def test_the_limit_is_the_upper_end_of_its_bracket():
    result = ballistic_limit(scenario())
    low, high = result.bracket_m_s
    assert result.ballistic_limit_m_s == high
    assert 0 < high - low <= 0.01
    assert result.monotonic
    assert 33 < result.runs < 60
    assert result.areal_density_kg_m2 == pytest.approx(39.243)


def test_a_tighter_tolerance_is_kept():
    result = ballistic_limit(scenario(ballistic_limit={"tolerance_m_s": 1e-6}))
    assert result.bracket_m_s[1] - result.bracket_m_s[0] <= 1e-6
    assert result.ballistic_limit_m_s == pytest.approx(723.7707, abs=1e-3)


@pytest.mark.parametrize(
    ("low", "high", "message"),
    [(20.0, 500.0, "no velocity from 20 to 500 m/s perforates"), (900.0, 4000.0, "every velocity from 900")],
)
def test_a_range_without_a_limit(low: float, high: float, message: str):
    search = {"velocity_min_m_s": low, "velocity_max_m_s": high}
    with pytest.raises(NoLimitError, match=message):
        ballistic_limit(scenario(ballistic_limit=search))


def test_an_outcome_that_is_not_monotonic_is_reported(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("armour.analysis.ballistic_limit.perforates", lambda _s, _a, v: 300 < v < 800 or v > 1500)
    result = ballistic_limit(scenario())
    assert not result.monotonic
    assert len(result.crossings) == 3
    assert result.ballistic_limit_m_s == pytest.approx(300, abs=0.01)


def test_a_lowest_velocity_that_perforates_is_no_limit(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("armour.analysis.ballistic_limit.perforates", lambda _s, _a, v: v < 800 or v > 1500)
    with pytest.raises(NoLimitError, match=r"perforates, but some higher velocities do not .*defeated above 800"):
        ballistic_limit(scenario())


def test_the_curve_rises_from_the_limit():
    case = scenario()
    limit = ballistic_limit(case)
    velocities = curve_velocities(limit, case)
    assert velocities == sorted(velocities)
    curve = residual_velocity_curve(case, [limit.bracket_m_s[0], limit.bracket_m_s[1], 900.0])
    residual = [result.residual_velocity_m_s for result in curve]
    assert residual[0] == 0.0
    assert 0.0 < residual[1] < residual[2]


def test_the_residual_velocity_rises_as_a_square_root():
    """Twice as far above the limit, the square of the residual velocity is twice as large."""
    case = scenario(ballistic_limit={"tolerance_m_s": 1e-8})
    limit = ballistic_limit(case).ballistic_limit_m_s
    one, two = residual_velocity_curve(case, [limit + 0.01, limit + 0.02])
    ratio = (two.residual_velocity_m_s / one.residual_velocity_m_s) ** 2
    # The projectile counts as stopped at 1 m/s, so that its square is what is missing.
    first, second = (r.residual_velocity_m_s**2 - 1.0 for r in (one, two))
    assert second / first == pytest.approx(2.0, rel=0.01)
    assert ratio == pytest.approx(2.0, rel=0.1)
