"""Reports: what is in them is what the functions say, and the books close."""

import json
import re
from typing import Any

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.design.catalogue import study
from armour.design.optimisation import optimise
from armour.reporting.contents import contents_of
from armour.reporting.html import scenario_page, suite_page
from armour.scenario.applicability import MODEL_ERROR_PERCENT
from armour.scenario.loading import Scenario, load_scenario
from armour.validation.suite import load_suite
from armour.validation.validate import paper_suite, validate
from tests.cases import SCENARIOS

NAMES = ["paper/optimum_7.62mm_AP", "uncertain", "dwell", "bare_plate", "paper/fig10_20mm", "catalogue"]
DOSSIERS = {name: contents_of(load_scenario(SCENARIOS / f"{name}.toml")) for name in NAMES}


@pytest.mark.parametrize("name", NAMES)
def test_the_ledger_closes_to_rounding(name: str):
    energy = DOSSIERS[name].energy
    assert abs(energy.difference) <= 1e-12 * energy.before
    assert all(row.eroded >= 0.0 and row.braked >= 0.0 for row in energy.rows)
    assert 0.0 <= energy.left <= energy.before


def test_what_eroded_took_its_energy_along():
    """In dwell the rod erodes at its own velocity: closed form of the energy that leaves with the material."""
    found = DOSSIERS["dwell"]
    case, first = found.answer, found.energy.rows[0]
    a, V = case.core_armour(), case.impact.velocity_m_s
    # V^2/2 - (Yp/rho_p) ln L is constant, so that the energy gone with the material is Yp A (L0 - L) less its own fall.
    history = found.impact.history
    assert history is not None
    record = found.impact.stages[0]
    inside = history.time_us <= record.end_us
    length, velocity = history.length_mm[inside][-1] / 1000.0, history.velocity_m_s[inside][-1]
    area = 3.141592653589793 * a.D0**2 / 4.0
    at = 0.5 * a.rho_p * area
    whole = at * (a.L0 * V**2 - length * velocity**2)
    braked = a.Yp * area * (a.L0 - length)
    assert first.braked == pytest.approx(braked, rel=5e-4)  # of steps that are summed
    assert first.total == pytest.approx(whole, rel=1e-9)


def test_the_answer_is_the_optimum_against_the_governing_threat():
    found = DOSSIERS["paper/optimum_7.62mm_AP"]
    best = optimise(found.scenario).best
    assert found.answer.armour.ceramic_thickness_mm == best.ceramic_thickness_mm
    assert found.limit == ballistic_limit(found.answer)
    catalogue = DOSSIERS["catalogue"]
    chosen = study(catalogue.scenario).best
    assert catalogue.answer.armour.ceramic == chosen.ceramic
    assert f"{catalogue.answer.impact.projectile} at {catalogue.answer.impact.velocity_m_s:g} m/s" == chosen.governing
    assert catalogue.margin_m_s == pytest.approx(chosen.margins_m_s[chosen.governing], abs=0.03)


def test_distributions_of_another_thickness_than_the_designs_are_left_out():
    """A range of thicknesses about the scenario's own says nothing of the design that the report is about."""
    grid = {"ceramic_thickness_mm": {"min": 5.0, "max": 12.0, "step": 0.5}}
    grid["backing_thickness_mm"] = {"min": 4.0, "max": 10.0, "step": 1.0}
    case = load_scenario(SCENARIOS / "uncertain.toml", {"optimise": grid})
    found = contents_of(case)
    assert found.uncertainty is None
    assert any("uncertainty.armour.ceramic_thickness_mm: is about a value of its own" in w for w in found.warnings)
    thickness = {"distribution": "normal", "standard_deviation_percent": 1.0}
    about = load_scenario(SCENARIOS / "wilkins.toml", {"uncertainty.armour.ceramic_thickness_mm": thickness})
    assert contents_of(about).uncertainty is not None


def test_the_models_error_is_that_of_the_suite():
    result = validate(load_suite(paper_suite()))
    [own] = [error for error in result.errors if error.predictor == "this model"]
    assert (round(own.mean_percent, 1), round(own.largest_percent, 1)) == MODEL_ERROR_PERCENT


def charts(page: str) -> dict[str, Any]:
    [data] = re.findall(r"^const charts = (.*);$", page, re.MULTILINE)
    found: dict[str, Any] = json.loads(data.replace("<\\/", "</"))
    return found


@pytest.mark.parametrize("name", NAMES)
def test_a_page_is_one_file_without_links_out(name: str):
    page = scenario_page(DOSSIERS[name], "armour report")
    assert len(page.encode()) < 6_000_000
    own = page[: page.index("<script>")]
    assert not re.findall(r"(?:src|href)=|https?://(?!www\.w3\.org)|@import|url\(", own)
    assert {"history", "energy", "sensitivity"} <= charts(page).keys()
    assert ("probability" in charts(page)) == (name == "uncertain")
    assert ("pareto" in charts(page)) == (name == "catalogue")


def test_titles_of_users_are_text():
    title = '<script>alert("x")</script> </script> & "quotes"'
    case: Scenario = load_scenario(SCENARIOS / "bare_plate.toml", {"title": title})
    page = scenario_page(contents_of(case), "armour report '<b>'")
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert" in page
    assert "&lt;b&gt;" in page


def test_a_suite():
    page = suite_page(validate(load_suite(paper_suite())), "armour report suites/paper.toml")
    assert "74 of 74 within their bands" in page
    assert len(charts(page)["parity"]["data"]) == 5
