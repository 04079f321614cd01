"""Equations that a program changes."""

import logging
from importlib import reload
from math import nan
from typing import Any
from unittest.mock import Mock

import pytest

import armour
from armour.core import equations, search
from armour.engine import batch, changes, compiled
from armour.errors import InputError
from armour.reporting.views.design import tables_of_check


@pytest.mark.parametrize(("name", "factor"), [("deceleration", 0.4), ("shear_force_plug", 0.1)])
def test_limits_below_the_bound_on_the_energy_are_found(name: str, factor: float):
    """The bound is derived from the equations as they are.  A function may call the one in whose place it is."""
    scenario = armour.load_scenario("bare_plate")
    with armour.equations(**{name: lambda *args: factor * getattr(equations, name)(*args)}):
        limit = armour.ballistic_limit(scenario).ballistic_limit_m_s
        outcomes = [armour.simulate(scenario.replaced({"impact.velocity_m_s": limit + v})).outcome for v in (-0.02, 0)]
        limits = armour.sweep(scenario, {"armour.backing_thickness_mm": [20.0, 20.0]})["ballistic_limit_m_s"]
    assert outcomes == ["stopped", "perforated"]
    assert limits.tolist() == [limit, limit]
    assert limit < armour.ballistic_limit(scenario).ballistic_limit_m_s


def test_a_function_that_is_set_into_the_core_is_refused(monkeypatch: pytest.MonkeyPatch):
    scenario = armour.load_scenario("wilkins")
    monkeypatch.setattr(equations, "sheared_diameter", Mock(side_effect=equations.sheared_diameter))
    message = r"armour\.core\.equations\.sheared_diameter: .+ with armour\.equations\(sheared_diameter=\.\.\.\)"
    for compute in (armour.simulate, armour.ballistic_limit, armour.check, armour.sensitivity):
        with pytest.raises(InputError, match=message):
            compute(scenario)


def test_a_constant_and_a_module_that_is_imported_again_are_refused(monkeypatch: pytest.MonkeyPatch):
    with monkeypatch.context() as changed:
        changed.setattr(search, "TOLERANCE", 1e-3)
        with pytest.raises(InputError, match=r"armour\.core\.search\.TOLERANCE: "):
            armour.ballistic_limit(armour.load_scenario("wilkins"))
    for name, value in vars(equations).items():
        monkeypatch.setattr(equations, name, value)
    reload(equations)
    with pytest.raises(InputError, match=r"armour\.core\.equations\.\w+: "):
        armour.simulate(armour.load_scenario("wilkins"))


def test_wrong_equations_are_all_named():
    wrong: Any = 1.0
    wrong_ones = armour.equations(crack_velocty=abs, cross_section=wrong, sqrt=abs, erosion_rate=lambda U, V: V - U)
    with pytest.raises(InputError) as caught, wrong_ones:
        pass
    names = [problem.key for problem in caught.value.problems]
    assert names == ["crack_velocty", "cross_section", "sqrt", "erosion_rate"]
    assert 'did you mean "crack_velocity"?' in str(caught.value)
    assert "erosion_rate: must be a function of V, U, in this order, found U, V" in str(caught.value)


def test_equations_are_as_before_behind_the_context():
    scenario, before = armour.load_scenario("wilkins"), dict(vars(equations))
    limit = armour.ballistic_limit(scenario)
    with armour.equations(crack_velocity=lambda _Ec, _rho_c, speed=900.0: speed):
        with (
            pytest.raises(ZeroDivisionError),
            armour.equations(sheared_diameter=equations.sheared_diameter, crack_velocity=lambda _Ec, _rho_c: 1 / 0),
        ):
            armour.ballistic_limit(scenario)
        assert changes.changed_names() == "crack_velocity"
    assert dict(vars(equations)) == before
    assert armour.ballistic_limit(scenario) == limit


@pytest.mark.parametrize(
    ("name", "value"), [("fragmented_strength", nan), ("crack_velocity", None), ("intact_strength", 1j)]
)
def test_an_equation_without_a_value_is_named(name: str, value: Any):
    scenario = armour.load_scenario("wilkins")
    message = f"equations: {name}: must return a finite number, found "
    with armour.equations(**{name: lambda *_: value}):
        for function in (armour.simulate, armour.ballistic_limit, armour.check):
            with pytest.raises(InputError, match=message):
                function(scenario)
        with pytest.raises(InputError, match=message):
            armour.sweep(scenario, {"armour.ceramic_thickness_mm": [6.0, 7.0]})
        assert message in armour.confidence(scenario).reason


def test_a_long_computation_says_that_python_computes(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
):
    scenario = armour.load_scenario("wilkins")
    compiled._warn.cache_clear()
    with caplog.at_level(logging.WARNING), armour.equations(crack_velocity=lambda _Ec, _rho_c: 1000.0):
        armour.simulate(scenario)
        assert not caplog.records
        monkeypatch.setitem(batch.PORTIONS, "impacts", 1)
        for _ in range(2):
            armour.sweep(scenario, {"armour.ceramic_thickness_mm": [6.0, 7.0]}, ["outcome"])
    [record] = caplog.records
    assert record.getMessage() == "computing in plain Python, about a hundred times slower: crack_velocity changed"


def test_results_name_changed_equations():
    scenario = armour.load_scenario(
        "wilkins", {"uncertainty.model": {"scale_percent": 7.0, "degrees_of_freedom": 1e6, "source": "tests"}}
    )
    words = "computed with crack_velocity changed"
    with armour.equations(crack_velocity=lambda _Ec, _rho_c: 1000.0):
        for function in (armour.simulate, armour.ballistic_limit, armour.confidence, armour.check):
            assert words in function(scenario).warnings
        [warning] = armour.sweep(scenario, {"armour.ceramic_thickness_mm": [6.0, 7.0]}).warnings
        assert warning == f"{words}; this concerns 2 of 2 rows"
        assert words in armour.validate(armour.load_suite("paper").only("5.2 GPa")).warnings
        assert words in tables_of_check(armour.check(scenario))
