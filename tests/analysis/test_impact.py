import sys
from dataclasses import fields
from itertools import pairwise

import numpy as np
import pytest

from armour.analysis.impact import simulate, time_step
from armour.core.state import Parameters
from armour.errors import InputError
from tests.cases import scenario


def test_a_perforation():
    result = simulate(scenario())
    assert result.outcome == "perforated"
    assert result.residual_velocity_m_s == pytest.approx(277.3775, abs=1e-3)
    assert result.plug_velocity_m_s == pytest.approx(result.residual_velocity_m_s)
    assert result.penetration_depth_mm == pytest.approx(12.7)
    assert result.residual_mass_g == pytest.approx(5.46 * result.residual_length_mm / 20.96073, rel=1e-6)
    assert result.areal_density_kg_m2 == pytest.approx(39.243)
    assert [stage.stage for stage in result.stages] == ["i", "ii.1", "iii.3", "iii.4"]


def test_a_defeat():
    result = simulate(scenario(velocity=600.0))
    assert (result.outcome, result.residual_velocity_m_s, result.plug_velocity_m_s) == ("defeated", 0.0, 0.0)
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


def test_the_history_is_kept_when_asked_for():
    assert simulate(scenario()).history is None
    result = simulate(scenario(), history=True)
    history = result.history
    assert history is not None
    lengths = {len(getattr(history, field.name)) for field in fields(history)}
    assert len(lengths) == 1
    assert history.time_us[0] == 0.0
    assert history.time_us[-1] == result.duration_us
    assert np.all(np.diff(history.time_us) >= 0.0)
    assert history.velocity_m_s[-1] == result.residual_velocity_m_s
    assert list(dict.fromkeys(history.stage)) == [stage.stage for stage in result.stages]
    assert history.ceramic_ahead_mm[0] == pytest.approx(6.35)
    assert history.ceramic_ahead_mm[-1] == 0.0
    assert history.backing_ahead_mm[0] == pytest.approx(6.35)


def test_the_history_is_on_the_grid_of_the_time_step():
    history = simulate(scenario(solver={"time_step_us": 0.25}), history=True).history
    assert history is not None
    off_grid = history.time_us % 0.25
    on_grid = np.minimum(off_grid, 0.25 - off_grid) < 1e-9
    changes = np.count_nonzero(history.stage[1:] != history.stage[:-1])
    # Besides the grid there are the events, each seen from both sides, the plate's rest and the end.
    assert np.count_nonzero(~on_grid) <= 2 * (changes + 1) + 1


def test_the_interface_force_is_recorded_on_both_sides_of_a_change():
    history = simulate(scenario(), history=True).history
    assert history is not None
    entered = int(np.flatnonzero(history.stage == "iii.3")[0])
    assert history.time_us[entered] == history.time_us[entered - 1]
    assert history.shear_force_kN[entered] != history.shear_force_kN[entered - 1]


def test_a_time_step_given_is_taken_unless_it_is_too_coarse():
    case = scenario(solver={"time_step_us": 0.25})
    a: Parameters = case.core_armour()
    assert time_step(case, a, 800.0) == pytest.approx(0.25e-6)
    coarse = scenario(solver={"time_step_us": 1000.0})
    assert time_step(coarse, a, 800.0) < 2e-6
    assert simulate(coarse).residual_velocity_m_s == pytest.approx(277.38, abs=0.5)


def test_plain_data_has_the_units_in_its_keys():
    content = simulate(scenario(), history=True).to_dict()
    assert "history" not in content
    assert set(content["stages"][0]) == {
        "stage",
        "start_us",
        "end_us",
        "velocity_lost_m_s",
        "length_lost_mm",
        "energy_lost_J",
    }


def test_a_run_without_end_is_an_input_error(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sys.modules["armour.analysis.impact"], "MAX_STEPS", 10)
    with pytest.raises(InputError, match="time_step_us: must let the run at 800 m/s end within 10 steps"):
        simulate(scenario())
