"""Contents of reports agree with the functions that they come from."""

from functools import cache

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.confidence import confidence
from armour.design.optimise import optimise
from armour.reporting.scenario_report import Contents, contents_of
from armour.scenario.scenario import load_scenario
from armour.statistics.uncertainty import uncertainty
from tests.helpers.cases import SCENARIOS, scenario
from tests.helpers.exotic import changing_designs


@cache
def contents(name: str) -> Contents:
    return contents_of(load_scenario(SCENARIOS / f"{name}.toml"))


@pytest.mark.parametrize("name", ["paper/optimum_7.62mm_AP", "catalogue"])
def test_the_answer_is_the_best_design_against_the_governing_threat(name: str):
    found = contents(name)
    best = optimise(found.scenario).best
    answer = found.answer
    assert answer.armour.ceramic == best.ceramic
    assert answer.armour.backing == best.backing
    assert answer.armour.ceramic_thickness_mm == best.ceramic_thickness_mm
    assert answer.armour.backing_thickness_mm == best.backing_thickness_mm
    assert f"{answer.impact.projectile} at {answer.impact.velocity_m_s:g} m/s" == best.governing
    assert found.limit == ballistic_limit(answer)
    assert found.limit is not None
    margin = found.limit.ballistic_limit_m_s - answer.impact.velocity_m_s
    assert margin == pytest.approx(best.margins_m_s[best.governing], abs=0.03)


def test_a_scenario_without_a_design_is_its_own_answer():
    found = contents_of(scenario())
    assert found.design is None
    assert found.answer == found.scenario
    assert [entry.name for entry in found.entries] == ["7.62 mm AP", "AD85", "6061-T6"]
    assert abs(found.energy.difference) < 1e-6 * found.energy.before


def test_the_answer_of_a_bare_plate_has_no_ceramic():
    plate = {
        "ceramic_thickness_mm": {"min": 0.0, "max": 0.0, "step": 1.0},
        "backing_thickness_mm": {"min": 8.0, "max": 20.0, "step": 1.0},
    }
    found = contents_of(scenario(ceramic=None, ceramic_mm=0.0, velocity=500.0, optimise=plate))
    assert found.design is not None
    assert not found.answer.armour.ceramic
    assert found.answer.armour.backing_thickness_mm == found.design.best.backing_thickness_mm


def test_the_own_armour_faces_every_threat():
    found = contents_of(load_scenario(SCENARIOS / "catalogue.toml"), as_is=True)
    assert found.design is None
    assert found.answer.armour == found.scenario.armour
    for threat, against in zip(found.scenario.threat, found.threats, strict=True):
        impact = {"impact.projectile": threat.projectile, "impact.velocity_m_s": threat.velocity_m_s}
        sure = confidence(found.scenario.replaced(impact))
        assert sure.ballistic_limit_m_s == pytest.approx(threat.velocity_m_s + (against.margin_m_s or 0.0))
        assert (against.threat, against.required_margin_m_s) == (threat.title, threat.margin_m_s)
        assert against.probability_of_defeat == sure.probability_of_defeat
    # Its margin falls short of the required one by more.
    assert found.governing == "7.62 mm APM2 at 830 m/s"
    assert found.answer.impact.projectile == "7.62 mm APM2"


def test_a_limit_outside_the_range_governs_where_the_armour_is_perforated():
    threats = [{"projectile": "7.62 mm AP", "velocity_m_s": velocity} for velocity in (30.0, 900.0)]
    for high, governing in ((100.0, 1), (1000.0, 1)):
        search = {"velocity_max_m_s": high}
        found = contents_of(scenario(threat=threats, ballistic_limit=search), as_is=True)
        assert found.governing == found.threats[governing].threat
        assert [against.defeated for against in found.threats] == [True, False]


def test_a_density_on_offer_is_the_answers():
    case = load_scenario(
        SCENARIOS / "catalogue.toml",
        {"design.ceramic": [{"material": "AD85", "thickness_mm": [10.0], "density_kg_m3": 5000.0, "cost_per_kg": 1.0}]},
    )
    found = contents_of(case)
    assert found.design is not None
    added = case.design.added_areal_density_kg_m2 if case.design is not None else 0.0
    assert found.impact.areal_density_kg_m2 + added == pytest.approx(found.design.best.areal_density_kg_m2)


def test_a_limit_outside_the_range_is_none():
    search = {"velocity_min_m_s": 20.0, "velocity_max_m_s": 100.0}
    assert contents_of(scenario(ballistic_limit=search)).limit is None


def test_changes_of_the_outcome_above_the_limit_are_told():
    found = contents_of(changing_designs()["defeated in between"])
    assert [warning.count("above") for warning in found.warnings if "not monotonic" in warning] == [3]


def test_a_distribution_about_another_value_than_the_designs_is_left_out():
    grid = {"ceramic_thickness_mm": {"min": 5.0, "max": 12.0, "step": 0.5}}
    grid["backing_thickness_mm"] = {"min": 4.0, "max": 10.0, "step": 1.0}
    found = contents_of(load_scenario(SCENARIOS / "uncertain.toml", {"optimise": grid}))
    assert found.uncertainty is None
    assert any("uncertainty.armour.ceramic_thickness_mm: is given for another value than" in w for w in found.warnings)


@cache
def uncertain(**velocity: float) -> Contents:
    """An armour of one's own against two threats, with a distribution of the velocity."""
    threats = [{"projectile": "7.62 mm AP", "velocity_m_s": value} for value in (680.0, 720.0)]
    distribution = {"distribution": "normal", "standard_deviation": 20.0, **velocity}
    return contents_of(
        scenario(threat=threats, uncertainty={"samples": 128, "impact": {"velocity_m_s": distribution}}), as_is=True
    )


def test_distributions_count_for_every_threat():
    found = uncertain()
    assert found.uncertainty is not None
    slow, fast = found.threats
    assert found.governing == fast.threat
    assert fast.probability_of_defeat == 1.0 - found.uncertainty.probability_of_perforation.value
    alone = uncertainty(found.scenario.replaced({"impact.velocity_m_s": 680.0})).probability_of_perforation
    assert slow.probability_of_defeat == 1.0 - alone.value
    assert slow.sampled
    assert fast.sampled


def test_a_threat_that_a_distribution_does_not_fit_keeps_exact_inputs():
    found = uncertain(max=700.0)
    assert [against.sampled for against in found.threats] == [False, False]
    assert sum("no sampled probability of perforation" in warning for warning in found.warnings) == 2


def test_a_distribution_about_the_answers_value_is_propagated():
    thickness = {"distribution": "normal", "standard_deviation_percent": 1.0}
    case = scenario(uncertainty={"samples": 128, "armour": {"ceramic_thickness_mm": thickness}})
    assert contents_of(case).uncertainty is not None
