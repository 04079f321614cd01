"""Candidate designs: free thicknesses, against grids and against each other."""

import pytest

from armour.analysis.impact import simulate
from armour.design.optimise import optimise
from armour.errors import InputError
from armour.scenario.scenario import load_scenario
from tests.helpers.cases import CERAMICS, METALS, SCENARIOS, THREATS, catalogue, scenario
from tests.helpers.results import best_of

pytestmark = pytest.mark.slow


def test_thicknesses_that_are_free_come_to_the_refined_optimum():
    optimum = load_scenario(SCENARIOS / "paper" / "optimum_7.62mm_AP.toml")
    refined = optimise(optimum, refine=True).refined
    assert refined is not None
    free = {"material": "AD85", "thickness_mm": {"min": 2.0, "max": 20.0}}
    metal = {"material": "5083-H3", "thickness_mm": {"min": 2.0, "max": 14.0}}
    best = best_of(optimise(optimum.replaced({"design": {"ceramic": [free], "backing": [metal]}})))
    assert best.areal_density_kg_m2 == pytest.approx(refined.areal_density_kg_m2, abs=2e-4)
    assert best.backing_thickness_mm == pytest.approx(refined.backing_thickness_mm, abs=0.05)
    one = best_of(
        optimise(optimum.replaced({"design": {"ceramic": [free], "backing": [{**metal, "thickness_mm": [6.0]}]}}))
    )
    other = best_of(
        optimise(
            optimum.replaced(
                {"design": {"ceramic": [{**free, "thickness_mm": [one.ceramic_thickness_mm]}], "backing": [metal]}}
            )
        )
    )
    assert other.backing_thickness_mm == pytest.approx(6.0, abs=1e-4)


def test_the_passing_thicknesses_may_end_below_the_greatest_on_offer():
    """Of the thickest, beyond the evidence, no probability is known: thinner ones pass all the same."""
    plate = scenario("7.62 mm APM2", None, "AA7039-T64", 0.0, 40.0)
    layer = {"material": "AA7039-T64", "thickness_mm": {"min": 20.0, "max": 110.0}}
    wide = plate.replaced({"design": {"confidence": 0.95, "backing": [layer]}})
    narrow = wide.replaced({"design.backing": [{**layer, "thickness_mm": {"min": 20.0, "max": 60.0}}]})
    assert best_of(optimise(wide)).backing_thickness_mm == pytest.approx(best_of(optimise(narrow)).backing_thickness_mm)
    ceramic = {"material": "AD85", "thickness_mm": {"min": 4.0, "max": 20.0}}
    metal = {"material": "5083-H3", "thickness_mm": [7.0, 8.5]}
    wide = scenario(backing="5083-H3", design={"confidence": 0.95, "ceramic": [ceramic], "backing": [metal]})
    narrow = wide.replaced({"design.ceramic": [{**ceramic, "thickness_mm": {"min": 4.0, "max": 12.0}}]})
    best = best_of(optimise(narrow))
    assert best_of(optimise(wide)).areal_density_kg_m2 == pytest.approx(best.areal_density_kg_m2, abs=2e-4)
    grid = {name: {"min": 6.0, "max": 9.0, "step": 1.0} for name in ("ceramic_thickness_mm", "backing_thickness_mm")}
    wilkins = optimise(load_scenario("wilkins", {"design.confidence": 0.9, "optimise": grid}), refine=True)
    assert wilkins.refined is not None
    assert wilkins.refined.areal_density_kg_m2 < best_of(wilkins).areal_density_kg_m2 - 0.1


def test_free_thicknesses_of_which_some_are_not_enough_and_limits():
    """Up to 9 mm of ceramic is too little on thin plates; a limit on the thickness then leaves a heavier optimum."""
    layers = {
        "ceramic": [{"material": "AD85", "thickness_mm": {"min": 2.0, "max": 9.0}}],
        "backing": [{"material": "6061-T6", "thickness_mm": {"min": 1.0, "max": 14.0}}],
    }
    wide = best_of(optimise(catalogue(THREATS[:1], **layers)))
    assert wide.ceramic_thickness_mm <= 9.0
    thinnest = best_of(optimise(catalogue(THREATS[:1], **layers, minimise="thickness_mm")))
    middle = 0.5 * (thinnest.thickness_mm + wide.thickness_mm)
    assert thinnest.thickness_mm < middle
    narrow = best_of(optimise(catalogue(THREATS[:1], **layers, thickness_max_mm=middle)))
    assert narrow.thickness_mm <= middle
    assert wide.areal_density_kg_m2 < narrow.areal_density_kg_m2 < thinnest.areal_density_kg_m2
    coarse = {
        "ceramic": [{"material": "AD85", "thickness_mm": {"min": 2.0, "max": 9.0, "step": 0.1}}],
        "backing": [{"material": "6061-T6", "thickness_mm": {"min": 1.0, "max": 14.0, "step": 0.1}}],
    }
    by_grid = best_of(optimise(catalogue(THREATS[:1], **coarse))).areal_density_kg_m2
    assert by_grid - 0.35 < wide.areal_density_kg_m2 <= by_grid


def test_free_thicknesses_against_several_threats_are_the_least():
    layers = {
        "ceramic": [{"material": "AD85", "thickness_mm": {"min": 2.0, "max": 14.0}}],
        "backing": [{"material": "6061-T6", "thickness_mm": [5.0, 7.0]}],
    }
    of = catalogue(**layers)
    for design in optimise(of).frontier:
        for less, outcomes in ((0.0, {"stopped"}), (2e-6, {"stopped", "perforated"})):
            against = [
                of.replaced(
                    {
                        "armour.ceramic_thickness_mm": design.ceramic_thickness_mm - less,
                        "armour.backing_thickness_mm": design.backing_thickness_mm,
                        "impact.projectile": threat.projectile,
                        "impact.velocity_m_s": threat.required_m_s,
                    }
                )
                for threat in of.threat
            ]
            assert {simulate(each).outcome for each in against} == outcomes


def test_refined_catalogues_are_free_between_their_thicknesses():
    result = optimise(catalogue(ceramic=CERAMICS[:1], backing=METALS[:1]), refine=True)
    assert result.refined is not None
    assert result.refined.areal_density_kg_m2 < best_of(result).areal_density_kg_m2
    assert min(result.refined.margins_m_s.values()) >= 0.0
    # A list stays a list.
    thin = {"material": "6061-T6", "thickness_mm": {"min": 4.0, "max": 4.5, "step": 0.5}}
    listed = optimise(catalogue(ceramic=CERAMICS[1:], backing=[METALS[1], thin]), refine=True)
    assert listed.refined == best_of(listed)


def test_lists_cannot_be_refined():
    one = {"material": "AD85", "thickness_mm": {"min": 8.0, "max": 8.0, "step": 1.0}}
    with pytest.raises(InputError, match="--refine: needs a thickness given as a range"):
        optimise(catalogue(ceramic=[CERAMICS[1], one], backing=METALS[1:]), refine=True)
