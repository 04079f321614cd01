"""Functions of the core that another program replaces."""

from functools import wraps
from math import sqrt

import pytest

import armour
from armour.core import equations, search
from armour.core.replaced import replaced_function


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


def test_a_limit_below_the_bound_is_found_where_the_change_is_not_noticed(monkeypatch: pytest.MonkeyPatch):
    """As in a clone whose equations were edited."""
    scenario, original = armour.load_scenario("bare_plate"), equations.shear_force_plug
    monkeypatch.setattr(equations, "shear_force_plug", lambda *args: 0.1 * original(*args))
    found = armour.ballistic_limit(scenario).ballistic_limit_m_s
    monkeypatch.setattr(search, "is_unchanged", lambda: True)
    assert armour.ballistic_limit(scenario).ballistic_limit_m_s == pytest.approx(found, abs=0.02)


@pytest.mark.parametrize("name", ["crack_velocity", "sqrt"])
def test_a_wrapped_function_is_noticed(monkeypatch: pytest.MonkeyPatch, name: str):
    assert replaced_function() == ""
    original = getattr(equations, name)
    monkeypatch.setattr(equations, name, wraps(original)(lambda *args: 0.5 * original(*args)))
    assert replaced_function() == f"armour.core.equations.{name}"


def test_a_function_with_other_code_is_noticed(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(equations.crack_velocity, "__code__", (lambda Ec, rho_c: 0.5 * sqrt(Ec / rho_c)).__code__)
    assert replaced_function() == "armour.core.equations.crack_velocity"
