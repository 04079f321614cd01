"""Designs of small catalogues against a plain loop over every design, with materials both usual and exotic."""

from functools import cache
from math import exp, log, pi
from random import Random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from armour.design.optimise import Design, DesignResult, optimise
from armour.scenario.scenario import Scenario
from tests.design.results import best_of
from tests.helpers.cases import scenario, sourced
from tests.helpers.examples import examples
from tests.helpers.plain_designs import CRITERIA, designs, passes, posed, stops, withstands_below

pytestmark = pytest.mark.slow

# Exotic catalogues in which the lightest design that stops the threats at their own velocities has a lower limit.
LOWER_LIMITS = [52, 925, 1058]


def names(design: Design) -> tuple[str, str, float, float]:
    return design.ceramic, design.backing, design.ceramic_thickness_mm, design.backing_thickness_mm


def check(case: Scenario, result: DesignResult) -> None:
    """Compare best designs, frontier and Pareto front with those of a plain loop."""
    found = dict(designs(case, passes))
    assert case.design is not None
    minimise = case.design.minimise
    if not found:
        assert result.best is None
        return
    least = min(values[minimise] for values in found.values())
    assert getattr(best_of(result), minimise) == pytest.approx(least, rel=1e-9, abs=1e-9)
    assert names(best_of(result)) in found
    for pair in result.pairs:
        own = [values[minimise] for design, values in found.items() if design[:2] == (pair.ceramic, pair.backing)]
        assert (pair.best is not None) == bool(own)
        if pair.best is not None:
            assert getattr(pair.best, minimise) == pytest.approx(min(own), rel=1e-9, abs=1e-9)

    winner = names(best_of(result))[:2]
    thinnest: dict[float, float] = {}
    for ceramic, backing, hc, hb in found:
        if (ceramic, backing) == winner:
            thinnest[hb] = min(hc, thinnest.get(hb, hc))
    frontier = {design.backing_thickness_mm: design.ceramic_thickness_mm for design in result.frontier}
    assert frontier == thinnest

    costs = {tuple(round(values[name], 9) for name in CRITERIA) for values in found.values()}
    front = [own for own in costs if not any(other != own and all(map(float.__le__, other, own)) for other in costs)]
    by_search = [tuple(getattr(design, name) for name in CRITERIA) for design in result.pareto]
    for one in by_search:
        assert any(one == pytest.approx(other, rel=1e-9, abs=1e-8) for other in front)
    # What the search leaves out is matched to the resolution of every criterion.
    resolution = 0.01, 0.01, 0.001 * min(cost for *_, cost in front)
    for other in front:
        most = [value + 1e-8 + part for value, part in zip(other, resolution, strict=True)]
        assert any(all(map(float.__le__, one, most)) for one in by_search)


@cache
def exotic(seed: int) -> Scenario:
    """A catalogue of one pair and one or two threats with values far from those of any armour."""
    random = Random(seed)

    def wide(low: float, high: float) -> float:
        return float(f"{exp(random.uniform(log(low), log(high))):.4g}")

    def projectile() -> dict[str, float]:
        diameter, density = wide(3.0, 20.0), wide(1000.0, 20000.0)
        mass = density * pi / 4.0 * diameter**3 * wide(0.5, 10.0) * 1e-6
        rod = {"penetrator_diameter_mm": diameter, "penetrator_mass_g": mass, "density_kg_m3": density}
        return {**rod, "flow_stress_GPa": wide(0.05, 10.0)}

    ceramic = {
        "density_kg_m3": wide(500.0, 15000.0),
        "youngs_modulus_GPa": wide(5.0, 500.0),
        **sourced(wide(0.1, 30.0)),
    }
    metal = {
        "density_kg_m3": wide(500.0, 15000.0),
        "dynamic_yield_strength_MPa": 300.0,
        "flow_stress_GPa": wide(0.03, 10.0),
        "shear_strength_MPa": wide(5.0, 3000.0),
    }
    projectiles = {name: projectile() for name in ("x", "y")[: random.choice((1, 1, 2))]}
    diameter = projectiles["x"]["penetrator_diameter_mm"]

    def layer(name: str, most: float, count: int) -> dict[str, Any]:
        thicknesses = [round(diameter * random.uniform(0.1, most), 2) for _ in range(count)]
        return {"material": name, "thickness_mm": thicknesses, "cost_per_kg": wide(1.0, 50.0)}

    return scenario(
        projectile="x",
        ceramic="c",
        backing="b",
        perimeter=random.choice(["conoid", "projectile"]),
        library={"projectile": projectiles, "ceramic": {"c": ceramic}, "metal": {"b": metal}},
        threat=[
            {"projectile": name, "velocity_m_s": wide(100.0, 3500.0), "margin_m_s": random.choice([0.0, 20.0])}
            for name in projectiles
        ],
        design={"ceramic": [layer("c", 2.0, 6)], "backing": [layer("b", 1.5, 4)], "pareto": CRITERIA},
    )


@cache
def answer(seed: int) -> DesignResult:
    return optimise(exotic(seed))


THICKNESSES = st.lists(st.floats(3.0, 14.0).map(lambda t: round(t, 1)), min_size=1, max_size=4)
COSTS = st.floats(0.0, 50.0)
CERAMICS = st.sampled_from(["AD85", "AD99.5", "Al-N"])
METALS = st.sampled_from(["6061-T6", "7075-T6", "5083-H3"])
THREATS = st.lists(
    st.fixed_dictionaries(
        {
            "projectile": st.sampled_from(["7.62 mm AP", "7.62 mm APM2"]),
            "velocity_m_s": st.floats(500.0, 950.0),
            "margin_m_s": st.floats(0.0, 50.0),
            "obliquity_deg": st.sampled_from([0.0, 0.0, 30.0, 45.0]),
        }
    ),
    min_size=1,
    max_size=2,
    unique_by=lambda threat: f"{threat['projectile']} {threat['velocity_m_s']:g}",
)


def layers(names: st.SearchStrategy[str]) -> st.SearchStrategy[list[dict[str, Any]]]:
    return st.lists(
        st.fixed_dictionaries(
            {"material": names, "thickness_mm": THICKNESSES, "cost_per_kg": COSTS, "cost_per_m2": COSTS}
        ),
        min_size=1,
        max_size=2,
        unique_by=lambda layer: layer["material"],
    )


@given(layers(CERAMICS), layers(METALS), THREATS, st.sampled_from(CRITERIA))
@examples(max_examples=3)
def test_designs_of_usual_materials_are_those_of_a_plain_loop(ceramics: Any, metals: Any, threats: Any, minimise: str):
    design = {"ceramic": ceramics, "backing": metals, "minimise": minimise, "pareto": CRITERIA}
    # Without the model error no design is ranked behind for want of tests.
    case = scenario(threat=threats, design=design, uncertainty={"model": {"included": False}})
    check(case, optimise(case))


@pytest.mark.parametrize("seed", [1, 3, *LOWER_LIMITS])
def test_designs_of_exotic_materials_are_those_of_a_plain_loop(seed: int):
    check(exotic(seed), answer(seed))


@pytest.mark.parametrize("seed", LOWER_LIMITS)
def test_a_design_that_stops_the_threats_may_have_a_lower_limit(seed: int):
    """The lightest design that stops the threats at the velocities required is not the best."""
    case = exotic(seed)
    assert case.design is not None
    stopping = dict(designs(case, stops))
    lightest = min(stopping, key=lambda design: stopping[design]["areal_density_kg_m2"])
    best = best_of(answer(seed))
    assert stopping[lightest]["areal_density_kg_m2"] < best.areal_density_kg_m2
    [ceramic], [backing] = case.design.ceramic, case.design.backing
    own = [posed(case, ceramic, backing, *lightest[2:], threat) for threat in case.threat]
    assert not all(passes(each, threat.required_m_s) for each, threat in zip(own, case.threat, strict=True))
    assert max(best.short_m_s.values()) == 0.0


def test_a_narrow_range_of_perforation_below_the_threat_is_seen():
    """Its width is 2 % of the velocity: the scan of `ballistic_limit` has steps of 18 %."""
    of = exotic(280)
    best = best_of(optimise(of))
    assert of.design is not None
    [ceramic], [backing] = of.design.ceramic, of.design.backing
    own = posed(of, ceramic, backing, *names(best)[2:], of.threat[0])
    assert withstands_below(own, of.threat[0].required_m_s, 2_000)
