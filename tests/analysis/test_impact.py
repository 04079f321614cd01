import math
from collections.abc import Callable
from dataclasses import fields
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit, confidence
from armour.analysis.impact import History, ImpactResult, simulate
from armour.errors import InputError
from armour.scenario.scenario import Scenario, load_scenario
from armour.statistics.sensitivity import sensitivity
from tests.helpers.cases import SCENARIOS, scenario, shipped_scenario
from tests.helpers.energy import energy_balance
from tests.helpers.known import known


def test_a_perforation():
    result = simulate(scenario())
    assert result.outcome == "perforated"
    assert result.residual_velocity_m_s == pytest.approx(277.3775, abs=1e-3)
    assert result.plug_velocity_m_s == pytest.approx(result.residual_velocity_m_s)
    assert result.penetration_depth_mm == pytest.approx(12.7)
    assert result.residual_mass_g == pytest.approx(5.46 * result.residual_length_mm / 20.96073, rel=1e-6)
    assert result.areal_density_kg_m2 == pytest.approx(39.243)
    assert [stage.stage for stage in result.stages] == ["i", "ii.1", "iii.3", "iii.4"]


def test_a_law_of_the_flow_stress_is_in_every_result():
    """On a back plate two diameters thick it doubles the flow stress; the history and the energy follow it too."""
    entry = {"based_on": "AD85", "flow_stress_backing_exponent": 1.0}
    doubled = {"based_on": "AD85", "flow_stress_GPa": 10.4}
    cases = [scenario(backing_mm=13.0, velocity=1100.0, library={"ceramic": {"AD85": e}}) for e in (entry, doubled)]
    one, other = (simulate(case, history=True) for case in cases)
    assert {**one.to_dict(), "warnings": ()} == {**other.to_dict(), "warnings": ()}
    assert known(one.history).interface_force_kN.tolist() == other.history.interface_force_kN.tolist()  # type: ignore[union-attr]
    assert energy_balance(cases[0], one) == energy_balance(cases[1], other)


def test_a_stopped_projectile():
    result = simulate(scenario(velocity=600.0))
    assert (result.outcome, result.residual_velocity_m_s, result.plug_velocity_m_s) == ("stopped", 0.0, 0.0)
    assert 0 < result.penetration_depth_mm < 12.7


def test_stages_follow_one_another_and_add_up():
    for velocity in (300.0, 600.0, 800.0, 1200.0):
        result = simulate(scenario(velocity=velocity))
        starts = [stage.start_us for stage in result.stages]
        ends = [stage.end_us for stage in result.stages]
        assert starts[0] == 0.0
        assert starts[1:] == ends[:-1]
        assert ends[-1] == result.duration_us
        names = [stage.stage for stage in result.stages]
        assert all(one != other for one, other in pairwise(names))
        lost = sum(stage.length_lost_mm for stage in result.stages)
        assert lost + result.residual_length_mm == pytest.approx(20.96073, rel=1e-6)
        left = result.residual_velocity_m_s or 1.0
        assert sum(stage.velocity_lost_m_s for stage in result.stages) == pytest.approx(velocity - left)
        kinetic = 5.46e-3 * velocity**2 / 2 - result.residual_mass_g * 1e-3 * left**2 / 2
        assert sum(stage.energy_lost_J for stage in result.stages) == pytest.approx(kinetic)


def test_dwell_shows_as_ii_2():
    result = simulate(scenario(velocity=300.0))
    assert result.stages[0].stage == "ii.2"


@pytest.mark.parametrize(
    ("solver", "key", "found"),
    [
        ({"time_step_us": 0.25, "arrest_velocity_m_s": 1e-9}, "time_step_us", "0.25; raise it or leave it out"),
        ({"arrest_velocity_m_s": 1e-9}, "arrest_velocity_m_s", "1e-09; raise it"),
        ({}, "arrest_velocity_m_s", "1, the default; raise it"),
    ],
)
def test_a_run_that_does_not_end_names_the_key(
    solver: dict[str, float], key: str, found: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("armour.scenario.schema.Solver.max_steps", 5)
    with pytest.raises(InputError) as error:
        simulate(scenario(velocity=100.0, solver=solver))
    assert str(error.value) == f"scenario: solver.{key}: must let the run at 100 m/s end within 5 steps, found {found}"


@pytest.mark.parametrize("question", [simulate, ballistic_limit, confidence, sensitivity])
def test_threats_that_are_not_used_are_warned_of(question: Callable[[Scenario], Any]):
    [note] = [note for note in question(shipped_scenario("catalogue")).warnings if note.startswith("threat: ")]
    assert note.startswith("threat: is not used: the results are against the 7.62 mm AP at 850 m/s of [impact]")


@cache
def result(time_step_us: float | None = None) -> ImpactResult:
    """Result of the Wilkins case with its history."""
    solver = {} if time_step_us is None else {"time_step_us": time_step_us}
    return simulate(scenario(solver=solver), history=True)


def recorded(time_step_us: float | None = None) -> History:
    """History of the Wilkins case."""
    return known(result(time_step_us).history)


def test_a_history_goes_from_the_impact_to_the_result():
    history = recorded()
    lengths = {len(getattr(history, field.name)) for field in fields(history)}
    assert len(lengths) == 1
    assert history.time_us[0] == 0.0
    assert history.time_us[-1] == result().duration_us
    assert np.all(np.diff(history.time_us) >= 0.0)
    assert history.velocity_m_s[-1] == result().residual_velocity_m_s
    assert list(dict.fromkeys(history.stage)) == [stage.stage for stage in result().stages]
    assert history.ceramic_ahead_mm[0] == pytest.approx(6.35)
    assert history.ceramic_ahead_mm[-1] == 0.0
    assert history.backing_ahead_mm[0] == pytest.approx(6.35)


def test_the_history_is_on_the_grid_of_the_time_step():
    history = recorded(0.25)
    off_grid = history.time_us % 0.25
    on_grid = np.minimum(off_grid, 0.25 - off_grid) < 1e-9
    changes = np.count_nonzero(history.stage[1:] != history.stage[:-1])
    # Off the grid are the events, each recorded before and after, the plate's arrest and the end.
    assert np.count_nonzero(~on_grid) <= 2 * (changes + 1) + 1


def test_a_long_time_step_leaves_no_gaps_in_the_history():
    assert len(recorded(2.0).time_us) >= 100


def test_a_bulge_never_recedes():
    """Of this armour, whose plate starts to move slowly, the cubic's first bulge is below 0 by its error."""
    soft = {"metal": {"soft": {"density_kg_m3": 1700.0, "dynamic_yield_strength_MPa": 50.0}}}
    layers = 49.95435087091941, 20.348473194366214
    thick = scenario("7.62 mm APM2", "AD85", "soft", *layers, velocity=2825.506902573942, library=soft)
    history = known(simulate(thick, history=True).history)
    assert (np.diff(history.bulge_height_mm) >= 0.0).all()


def test_the_interface_force_is_recorded_on_both_sides_of_a_change():
    history = recorded()
    entered = int(np.flatnonzero(history.stage == "iii.3")[0])
    assert history.time_us[entered] == history.time_us[entered - 1]
    assert history.shear_force_kN[entered] != history.shear_force_kN[entered - 1]


NAMES = ["wilkins", "dwell", "bare_plate", "paper/fig10_20mm"]


@pytest.mark.parametrize("name", NAMES)
def test_the_balance_closes_to_the_order_of_the_method(name: str):
    """The losses are integrated apart from the motion, and the difference falls with the fourth power of the step."""
    case = load_scenario(SCENARIOS / f"{name}.toml")
    impact = simulate(case)
    energy = energy_balance(case, impact)
    assert 0.0 < abs(energy.difference) <= 2e-6 * energy.before
    assert energy.eroded >= 0.0
    assert energy.braked >= 0.0
    lost = sum(stage.energy_lost_J for stage in impact.stages)
    assert energy.eroded + energy.braked == pytest.approx(lost, abs=2e-6 * energy.before)
    assert 0.0 <= energy.left <= energy.before
    coarse, fine = (closing_error(case, impact.duration_us / steps) for steps in (200, 800))
    assert abs(fine) < 0.25 * abs(coarse)


def closing_error(case: Scenario, time_step_us: float) -> float:
    shorter = case.replaced({"solver.time_step_us": time_step_us})
    return energy_balance(shorter, simulate(shorter)).difference


def test_the_energy_at_impact_and_left_is_the_projectiles():
    case = scenario(velocity=800.0)
    impact = simulate(case)
    energy = energy_balance(case, impact)
    mass = case.entry("projectile", "7.62 mm AP")["penetrator_mass_g"] / 1000.0
    assert energy.before == pytest.approx(0.5 * mass * 800.0**2)
    residual = 0.5 * impact.residual_mass_g / 1000.0 * impact.residual_velocity_m_s**2
    assert energy.left == pytest.approx(residual)


def test_eroded_material_carries_off_its_energy():
    """While a rod erodes, the loss by braking has a closed form: its strength times area times the length eroded."""
    case = load_scenario(SCENARIOS / "dwell.toml", {"solver.arrest_velocity_m_s": 500.0})
    impact = simulate(case)
    energy, a = energy_balance(case, impact), case.core_armour()
    eroded_length = a.L0 - impact.residual_length_mm / 1000.0
    assert energy.braked == pytest.approx(a.Yp * math.pi * a.D0**2 / 4.0 * eroded_length, rel=1e-6)
    assert energy.eroded + energy.braked == pytest.approx(energy.before - energy.left, rel=1e-6)
