"""Functions of the core that another program replaces."""

import logging
import tomllib
from functools import cache, partial, wraps
from importlib import reload
from math import inf, nan, sqrt
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

import armour
from armour.core import equations, search
from armour.core.replaced import replaced_in_words
from armour.errors import InputError
from armour.reporting.by_result import in_a_line
from armour.scenario import checked


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
    assert replaced_in_words() == ""
    original = getattr(equations, name)
    monkeypatch.setattr(equations, name, wraps(original)(lambda *args: 0.5 * original(*args)))
    assert replaced_in_words() == f"armour.core.equations.{name}"


def test_a_function_with_other_code_is_noticed(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(equations.crack_velocity, "__code__", (lambda Ec, rho_c: 0.5 * sqrt(Ec / rho_c)).__code__)
    assert replaced_in_words() == "armour.core.equations.crack_velocity"


def test_a_constant_is_noticed_and_taken(monkeypatch: pytest.MonkeyPatch):
    scenario = armour.load_scenario("wilkins")
    thicknesses = {"armour.ceramic_thickness_mm": [6.0, 8.0]}
    limits = armour.sweep(scenario, thicknesses)["ballistic_limit_m_s"]
    monkeypatch.setattr(search, "TOLERANCE", 1e-3)
    assert replaced_in_words() == "armour.core.search.TOLERANCE"
    table = armour.sweep(scenario, thicknesses)
    assert (table["ballistic_limit_m_s"] != limits).all()
    assert table.warnings == ("computed with armour.core.search.TOLERANCE replaced; this concerns 2 of 2 rows",)


def test_a_module_that_is_imported_again_is_noticed(monkeypatch: pytest.MonkeyPatch):
    """As in a notebook, after a change of its file."""
    for name, value in vars(equations).items():
        monkeypatch.setattr(equations, name, value)
    reload(equations)
    first, second, third, more = replaced_in_words().split(" and ")
    assert all(name.startswith("armour.core.equations.") for name in (first, second, third))
    assert more.endswith(" more")


@pytest.mark.parametrize(
    "other",
    [
        min,
        sqrt,
        equations.cross_section,
        partial(equations.sheared_diameter),
        cache(equations.sheared_diameter),
        wraps(equations.sheared_diameter)(partial(equations.sheared_diameter)),
        Mock(side_effect=equations.sheared_diameter),
    ],
)
def test_every_kind_of_function_is_noticed(monkeypatch: pytest.MonkeyPatch, other: Any):
    monkeypatch.setattr(equations, "sheared_diameter", other)
    assert replaced_in_words() == "armour.core.equations.sheared_diameter"


@pytest.mark.parametrize("value", [nan, inf, None, "1", 1j])
@pytest.mark.parametrize("name", ["fragmented_strength", "crack_velocity", "intact_strength"])
def test_an_equation_without_a_value_is_named(monkeypatch: pytest.MonkeyPatch, name: str, value: Any):
    scenario = armour.load_scenario("wilkins")
    monkeypatch.setattr(equations, name, lambda *_: value)
    message = f"armour.core.equations.{name}: must return a finite number, found "
    for function in (armour.simulate, armour.ballistic_limit, armour.check):
        with pytest.raises(InputError, match=message):
            function(scenario)
    with pytest.raises(InputError, match=message):
        armour.sweep(scenario, {"armour.ceramic_thickness_mm": [6.0, 7.0]})
    assert message in armour.confidence(scenario).reason


@pytest.mark.parametrize("function", [armour.simulate, armour.ballistic_limit, armour.confidence])
def test_each_computation_names_a_replaced_function(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, function: Any
):
    scenario = armour.load_scenario("wilkins")
    monkeypatch.setattr(equations, "crack_velocity", lambda _Ec, _rho_c: 1000.0)
    monkeypatch.setattr(checked, "_named", set())
    with caplog.at_level(logging.WARNING):
        function(scenario)
        function(scenario)
    [record] = caplog.records
    assert record.getMessage() == (
        "computing in plain Python, about a hundred times slower: armour.core.equations.crack_velocity replaced; "
        "replacing equations leaves with version 3: there, with armour.equations(...) takes its place"
    )


def test_results_name_a_replaced_function(monkeypatch: pytest.MonkeyPatch):
    scenario = armour.load_scenario(
        "wilkins", {"uncertainty.model": {"scale_percent": 7.0, "degrees_of_freedom": 1e6, "source": "tests"}}
    )
    monkeypatch.setattr(equations, "crack_velocity", lambda _Ec, _rho_c: 1000.0)
    words = "computed with armour.core.equations.crack_velocity replaced"
    for function in (armour.simulate, armour.ballistic_limit, armour.confidence, armour.check):
        assert words in function(scenario).warnings
    [warning] = armour.sweep(scenario, {"armour.ceramic_thickness_mm": [6.0, 7.0]}).warnings
    assert warning == f"{words}; this concerns 2 of 2 rows"
    assert words in in_a_line(armour.check(scenario))


def test_a_calibration_by_a_replaced_function_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    scenario, library = armour.load_scenario("wilkins"), tmp_path / "lot.toml"
    tests = armour.read_tests([{"ballistic_limit_m_s": 700.0}], scenario)
    assert armour.calibrate(tests, scenario).reason == ""
    original = equations.fragmented_strength
    with monkeypatch.context() as changed:
        changed.setattr(equations, "fragmented_strength", lambda *args: 0.8 * original(*args))
        result = armour.calibrate(tests, scenario)
    words = "computed with armour.core.equations.fragmented_strength replaced"
    assert result.evidence is None
    assert result.reason.endswith(f"model error: their limits were {words}")
    armour.save_fit(result, tests, scenario, lot="7", library=library)
    entry = tomllib.loads(library.read_text())["ceramic"]["AD85, 7"]
    assert entry["evidence"]["reason"] == result.reason
    assert words in entry["flow_stress_GPa"]["source"]
