import re
from dataclasses import replace

from armour.analysis.ballistic_limit import NeededFlowStress
from armour.analysis.estimates import Estimate
from armour.design.check import CheckResult, check
from armour.design.optimise import DesignResult, optimise
from armour.reporting.by_result import in_a_line
from armour.reporting.scenario_report import scenario_report
from armour.reporting.table import Table
from armour.reporting.views import design as view
from armour.reporting.views.design import chance_text, nearly_as_good, pair_table, tables_of_check, tables_of_design
from armour.reporting.words import chance, needed_flow_stress
from armour.scenario.inputs import BACKING, FLOW_STRESS
from tests.design.results import best_design, best_of, design, design_result
from tests.helpers.cases import scenario
from tests.reporting.tables import headings


def test_a_needed_flow_stress_stands_beside_its_sources():
    def words(least: float | None, enough: float | None, *sources: float) -> str:
        return needed_flow_stress(NeededFlowStress("SiC", least, 0.9, enough, sources, ()))

    assert (
        words(8.0, 9.01, 9.0, 14.0)
        == "a flow stress of SiC of 8 GPa by the model, 9.1 GPa for 90 %; sources give 9 to 14"
    )
    assert words(8.0, None) == "a flow stress of SiC of 8 GPa by the model, no value for 90 %; no source"
    assert words(None, None, 9.0) == "no flow stress of SiC up to 100 GPa is enough; sources give 9"


def test_every_metal_that_is_compared_is_named_for_its_kind_of_strength():
    costs = {"thickness_mm": [12.0], "cost_per_kg": 5.0}
    metals = [{"material": name, **costs} for name in ("6061-T6", "ARMOX500")]
    layers = {"ceramic": [{"material": "AD85", **costs}], "backing": metals}
    found = optimise(scenario(velocity=500.0, design={**layers, "minimise": "cost_per_m2"}))
    assert best_of(found).backing == "6061-T6"
    assert any("the yield strength of ARMOX500 is static" in warning for warning in found.warnings)
    assert re.search(r", cost \d+ per m²", in_a_line(found))


def test_answers_say_of_a_named_threat_that_its_standard_was_not_read():
    named = "STANAG 4569 level 3, B32"
    of = scenario(
        threat=[{"threat": named, "velocity_m_s": 600.0}, {"projectile": "7.62 mm AP", "velocity_m_s": 500.0}]
    )
    words = f"{named}: unconfirmed, [STANAG4569] as secondary sources quote it"
    layers = {
        "ceramic": [{"material": "AD85", "thickness_mm": [12.0]}],
        "backing": [{"material": "6061-T6", "thickness_mm": 15.0}],
    }
    searched = optimise(of.replaced({"design": layers}))
    for result in (check(of), searched):
        assert words_of(result, every_row=True).count(words) == 1
    sections = [
        (section.heading, str((section.paragraphs, section.notes))) for section in scenario_report(of, "").sections
    ]
    assert [heading for heading, notes in sections if words in notes] == ["Threats"]
    assert [heading for heading, notes in sections if "'STANAG4569'" in notes] == ["References"]


def words_of(result: DesignResult | CheckResult, *, every_row: bool = False) -> str:
    """The lines of an answer that are no tables."""
    result = result.of(every_row=every_row)
    tables = tables_of_design(result) if isinstance(result, DesignResult) else tables_of_check(result)
    return "\n".join(text for text in tables if isinstance(text, str))


def test_designs_on_other_plates_within_1_percent_of_the_best_are_named():
    near = [design("AD85", 10.0 - i, 6.0 + i, weight) for i, weight in enumerate((50.0, 50.4, 50.1, 50.2, 50.3, 60.0))]
    result = replace(design_result(), frontier=tuple(near), best=best_design(areal_density_kg_m2=50.0))
    others = replace(result, best=best_design(areal_density_kg_m2=50.0, backing_thickness_mm=6.0))
    assert nearly_as_good(others) == "8 on 8, 7 on 9, 6 on 10 mm and 1 more"


THREATS = [{"projectile": name, "velocity_m_s": 600.0} for name in ("7.62 mm AP", "7.62 mm APM2")]


def test_the_threat_that_decides_stands_first_in_the_verdict():
    several = check(scenario(threat=[*THREATS, {"projectile": "7.62 mm AP", "velocity_m_s": 700.0, "name": "fast"}]))
    assert in_a_line(several).startswith("expected to stop against every threat: a shot of fast at 700 m/s, with ")
    far = "far from the tests against 7.62 mm APM2 at 600 m/s: 7.62 mm APM2 (tested with 7.62 mm AP)"
    assert far in map(str, tables_of_check(several))
    missed = check(scenario(threat=[{"projectile": "7.62 mm AP", "velocity_m_s": 900.0}, *THREATS]))
    assert in_a_line(missed) == ("FAILS: stops a shot of 7.62 mm AP at 900 m/s with below 1 % (none required)")


def test_a_limit_of_the_design_that_is_exceeded_decides():
    heavy = scenario("7.62 mm AP", "AD85", "6061-T6", 12.0, 6.0, 500.0, design={"areal_density_max_kg_m2": 40.0})
    assert in_a_line(check(heavy)) == "FAILS: areal density 57.7 kg/m², at most 40 kg/m² allowed"
    assert "57.7 of at most 40 kg/m²" in str(tables_of_check(check(heavy)))
    light = check(heavy.replaced({"design.areal_density_max_kg_m2": 60.0}))
    assert in_a_line(light).endswith(" (none required); keeps all limits of [design]")


def test_a_sampled_probability_lies_within_its_interval_as_shown():
    [threat] = check(scenario(velocity=600.0, design={"probability_of_stopping": 0.9106})).threats
    shown = replace(threat, probability_of_stopping=0.91053, sampled=Estimate(0.08947, 0.08932, 0.08961))
    assert chance_text(shown) == "91.0 % (sampled 91.0 to 91.1 %)"
    assert view.reasons(shown).endswith(" 91.0 % (sampled 91.0 to 91.1 %, 91.06 % required)")


def test_a_probability_is_shown_as_exactly_as_it_is_required():
    assert [chance(0.9147, None, required) for required in (None, 0.9, 0.913, 0.9133)] == [
        "91 %",
        "91 %",
        "91.4 %",
        "91.47 %",
    ]


def test_pairs_have_their_best_design_or_the_nearest_and_the_verdict_on_it():
    costs = {"thickness_mm": [6.0, 8.0]}
    layers = {
        "ceramic": [{"material": name, **costs} for name in ("AD85", "AD99.5")],
        "backing": [{"material": "6061-T6", "thickness_mm": 6.0}],
    }
    found = optimise(scenario(velocity=600.0, design={**layers, "areal_density_max_kg_m2": 38.0}))
    [table, *notes] = pair_table(found)
    assert isinstance(table, Table)
    assert headings(table) == ["materials", "best", "kg/m²", "limit, m/s", "stops", "verdict"]
    assert [(row[0], row[-1]) for row in table.texts()] == [
        ("AD85 on 6061-T6", "expected to stop"),
        ("AD99.5 on 6061-T6", "FAILS"),
    ]
    assert notes[0] == "* by the model, without tests"
    [table, *_] = pair_table(optimise(scenario(threat=THREATS, design=layers)))
    assert isinstance(table, Table)
    assert "against" in headings(table)


def test_a_verdict_counts_the_sources_of_the_flow_stress():
    few = scenario().replaced({FLOW_STRESS: 10.0}), scenario(ceramic="B4C")
    assert [view.verdict_cell(check(of)) for of in few] == ["not known, 0 sources", "not known, 1 source"]


def test_the_next_step_is_without_settings_that_the_tests_were_not_computed_with():
    checked = check(scenario(velocity=500.0).replaced({"solver.time_step_us": 0.1}))
    assert view.next_step(checked) == ("", "without solver.time_step_us = 0.1, tests may tell")
    bare = check(scenario(velocity=500.0, uncertainty={"model": {"scale_percent": 5.0}}))
    assert view.next_step(bare)[1].startswith("uncertainty.model is not used: ")


def test_the_next_step_is_no_search_that_would_be_refused():
    tile, plate = ([{"material": name, "thickness_mm": [8.0]}] for name in ("AD85", "6061-T6"))
    layers = {"ceramic": tile, "backing": plate, "existing": "backing"}
    hull = scenario(backing_mm=8.0, velocity=1200.0, design=layers)
    assert [view.next_step(check(each))[0] for each in (hull, hull.replaced({BACKING: 7.0}))] == ["optimise", ""]
