from dataclasses import fields
from functools import cache

import numpy as np
import pytest

from armour.analysis.history import History
from armour.analysis.impact import ImpactResult, simulate
from tests.helpers.cases import scenario


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
    """A time step beyond the default is not taken."""
    assert recorded(1000.0) == recorded()


def test_the_interface_force_is_recorded_on_both_sides_of_a_change():
    history = recorded()
    entered = int(np.flatnonzero(history.stage == "iii.3")[0])
    assert history.time_us[entered] == history.time_us[entered - 1]
    assert history.shear_force_kN[entered] != history.shear_force_kN[entered - 1]


def test_histories_are_compared():
    found = simulate(scenario(), history=True)
    assert found == simulate(scenario(), history=True)
    assert found != simulate(scenario(velocity=810.0), history=True)
    assert found.history != simulate(scenario(velocity=810.0), history=True).history
    assert repr(found.history).startswith("<History: ")
    assert repr(found.history).endswith(f"instants from 0 to {found.duration_us:.2f} µs>")
