import math
from dataclasses import fields
from functools import cache

import numpy as np
import pytest

from armour.analysis.history import History
from armour.analysis.impact import ImpactResult, energy_balance, simulate
from armour.scenario.scenario import Scenario, load_scenario
from tests.helpers.cases import SCENARIOS, scenario


@cache
def result(time_step_us: float | None = None) -> ImpactResult:
    """Result of the Wilkins case with its history."""
    solver = {} if time_step_us is None else {"time_step_us": time_step_us}
    return simulate(scenario(solver=solver), history=True)


def recorded(time_step_us: float | None = None) -> History:
    """History of the Wilkins case."""
    history = result(time_step_us).history
    assert history is not None
    return history


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
    history = simulate(thick, history=True).history
    assert history is not None
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
    assert all(row.eroded >= 0.0 and row.braked >= 0.0 for row in energy.rows)
    for row, stage in zip(energy.rows, impact.stages, strict=True):
        assert row.stage == stage.stage
        assert row.total == pytest.approx(stage.energy_lost_J, abs=2e-6 * energy.before)
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
    """In dwell the loss by braking has a closed form: the rod's strength times area times the length eroded."""
    case = load_scenario(SCENARIOS / "dwell.toml")
    impact = simulate(case, history=True)
    first = energy_balance(case, impact).rows[0]
    a, history = case.core_armour(), impact.history
    assert history is not None
    inside = history.time_us <= impact.stages[0].end_us
    length, velocity = history.length_mm[inside][-1] / 1000.0, history.velocity_m_s[inside][-1]
    area = math.pi * a.D0**2 / 4.0
    lost = 0.5 * a.rho_p * area * (a.L0 * case.impact.velocity_m_s**2 - length * velocity**2)
    assert first.braked == pytest.approx(a.Yp * area * (a.L0 - length), rel=1e-6)
    assert first.total == pytest.approx(lost, rel=1e-6)
