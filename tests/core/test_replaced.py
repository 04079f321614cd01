"""Functions of the core that another program replaces."""

import pytest

import armour
from armour.core import equations


@pytest.mark.parametrize(("name", "factor"), [("deceleration", 0.4), ("shear_force_plug", 0.1)])
def test_limits_below_the_bound_on_the_energy_are_found(monkeypatch: pytest.MonkeyPatch, name: str, factor: float):
    """The bound is derived from the equations as they are."""
    scenario, original = armour.load_scenario("bare_plate"), getattr(equations, name)
    monkeypatch.setattr(equations, name, lambda *args: factor * original(*args))
    limit = armour.ballistic_limit(scenario).ballistic_limit_m_s
    outcomes = [armour.simulate(scenario.replaced({"impact.velocity_m_s": limit + v})).outcome for v in (-0.02, 0.0)]
    assert outcomes == ["stopped", "perforated"]
    limits = armour.sweep(scenario, {"armour.backing_thickness_mm": [20.0, 20.0]})["ballistic_limit_m_s"]
    assert limits.tolist() == [limit, limit]
