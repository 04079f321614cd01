"""Properties of every impact."""

from math import isfinite
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from armour.analysis.impact import simulate
from armour.analysis.variants import ballistic_limits, variants_of
from armour.core.run import run
from armour.core.state import Outcome, Parameters
from armour.scenario.scenario import parse_scenario
from armour.scenario.schema import DRIVE_LAWS, SHEAR_LAWS
from tests.helpers.cases import perforates
from tests.helpers.examples import examples

pytestmark = pytest.mark.slow

PROJECTILES = {"7.62 mm AP": 6.5, "25 mm APDS": 14.25, "7.62 mm APM2": 6.25}


@st.composite
def scenarios(draw: st.DrawFn) -> dict[str, Any]:
    """Any scenario of the library's projectiles and materials, from a foil to ten diameters."""
    projectile = draw(st.sampled_from(sorted(PROJECTILES)))
    diameter = PROJECTILES[projectile]
    bare = draw(st.booleans()) and draw(st.booleans())
    thickness = st.floats(0.02, 10.0)
    return {
        "impact": {"projectile": projectile, "velocity_m_s": draw(st.floats(10.0, 4000.0))},
        "armour": {
            "ceramic": draw(st.sampled_from(["AD85", "AD85 initial", "AD99.5", "Al-N"])),
            "ceramic_thickness_mm": 0.0 if bare else diameter * draw(thickness),
            "backing": draw(st.sampled_from(["6061-T6", "7075-T6", "5083-H3", "hard", "soft"])),
            "backing_thickness_mm": diameter * draw(thickness),
        },
        "model": {
            "shear_perimeter": draw(st.sampled_from([*SHEAR_LAWS])),
            "plate_drive": draw(st.sampled_from([*DRIVE_LAWS])),
        },
        "library": {
            "metal": {
                "hard": {"density_kg_m3": 17000.0, "dynamic_yield_strength_MPa": 2500.0},
                "soft": {"density_kg_m3": 1700.0, "dynamic_yield_strength_MPa": 50.0},
            }
        },
    }


@given(scenarios())
@examples(max_examples=8)
def test_every_impact_ends_with_an_outcome_and_sensible_numbers(data: dict[str, Any]):
    scenario = parse_scenario(data)
    result = simulate(scenario, history=True)
    assert result.outcome in ("perforated", "stopped")
    numbers = [value for value in result.to_dict().values() if isinstance(value, float)]
    numbers += [value for stage in result.stages for value in (stage.start_us, stage.end_us, stage.energy_lost_J)]
    assert all(isfinite(value) for value in numbers)
    assert 0.0 <= result.residual_velocity_m_s <= result.impact_velocity_m_s
    armour = scenario.core_armour()
    assert 0.0 < result.residual_length_mm <= armour.L0 * 1e3 * (1 + 1e-12)
    mass = scenario.entry("projectile", scenario.impact.projectile)["penetrator_mass_g"]
    assert 0.0 < result.residual_mass_g <= mass * (1 + 1e-12)
    assert result.bulge_height_mm >= 0.0
    assert (result.residual_velocity_m_s == 0.0) == (result.outcome == "stopped")
    history = result.history
    assert history is not None
    for name in ("length_mm", "velocity_m_s", "target_velocity_m_s", "bulge_height_mm", "interface_force_kN"):
        column = getattr(history, name)
        assert column.min() >= 0.0
        assert all(isfinite(value) for value in column)
    assert all(stage.energy_lost_J >= 0.0 for stage in result.stages)


@given(scenarios())
@examples(max_examples=12)
def test_just_above_its_limit_an_armour_is_perforated_and_just_below_it_is_not(data: dict[str, Any]):
    """By plain Python, of limits that the engine searches for as plain Python does (test_searches)."""
    scenario = parse_scenario(data)
    search = scenario.ballistic_limit
    [limit] = ballistic_limits(variants_of(scenario, {}, 1)).tolist()
    if not isfinite(limit):
        thin = perforates(scenario, search.velocity_min_m_s)
        assert thin or not perforates(scenario, search.velocity_max_m_s)
        return
    assert perforates(scenario, limit)
    assert not perforates(scenario, limit - search.tolerance_m_s)


positive = st.floats(0.05, 20.0)


@given(
    size=st.floats(1e-4, 1.0),
    velocity=st.floats(20.0, 5000.0),
    slenderness=st.floats(0.3, 30.0),
    strengths=st.tuples(
        st.floats(0.05e9, 10e9), st.floats(0.5e9, 20e9), st.floats(0.05e9, 10e9), st.floats(0.02e9, 5e9)
    ),
    densities=st.tuples(*[st.floats(1000.0, 20000.0)] * 3),
    thicknesses=st.tuples(st.floats(0.0, 20.0), positive),
    law=st.tuples(*[st.sampled_from([0.0, -3.0, 3.0]) | st.floats(-3.0, 3.0)] * 4),
    shear_law=st.sampled_from(sorted(SHEAR_LAWS.values())),
    drive_law=st.sampled_from(sorted(DRIVE_LAWS.values())),
)
@examples(max_examples=60)
def test_impacts_of_any_materials_end_with_an_outcome(
    size: float,
    velocity: float,
    slenderness: float,
    strengths: tuple[float, ...],
    densities: tuple[float, ...],
    thicknesses: tuple[float, ...],
    law: tuple[float, float, float, float],
    shear_law: int,
    drive_law: int,
):
    Yp, Yc0, YB, tau = strengths
    rho_p, rho_c, rho_B = densities
    a = Parameters(
        size * slenderness, size, rho_p, Yp, size * thicknesses[0], rho_c, 300e9, Yc0, *law,
        size * thicknesses[1], rho_B, YB, tau, shear_law, drive_law,
    )  # fmt: skip
    end = run(a, velocity, 0.0, 1.0, 500_000)
    assert end.outcome in (Outcome.PERFORATED, Outcome.STOPPED)
    assert all(isfinite(value) for value in end.y)
    assert velocity >= end.y.V
    assert 0.0 < end.y.L <= a.L0
    assert end.y.W >= 0.0
    assert end.y.h >= 0.0
