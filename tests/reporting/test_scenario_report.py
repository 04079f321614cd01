"""What a report on a scenario says."""

from dataclasses import replace
from functools import cache

import pytest

from armour.analysis.confidence import NO_TEST, ConfidenceResult
from armour.reporting.contents import Contents, contents_of
from armour.reporting.markdown import markdown_report
from armour.reporting.report import Report
from armour.reporting.scenario_report import scenario_report
from armour.reporting.tables.design import frontier_table
from tests.helpers.cases import scenario
from tests.helpers.results import OTHER, THREAT, design_result, uncertainty_result


@cache
def wilkins() -> Contents:
    return contents_of(scenario(title="A title"))


def report(contents: Contents, command: str = "armour report x.toml") -> Report:
    return scenario_report(contents, command)


def statements(contents: Contents) -> dict[str, tuple[str, str]]:
    return {card.subject: (card.statement, card.detail) for card in report(contents).cards}


def test_the_title_is_the_scenarios_or_its_file():
    assert report(wilkins()).title == wilkins().scenario.title
    untitled = replace(wilkins(), scenario=wilkins().scenario.replaced({"title": ""}))
    assert report(untitled).title == untitled.scenario.file


def test_questions():
    impact = wilkins().scenario.impact
    assert report(wilkins()).lead == f"Does this armour defeat the 7.62 mm AP at {impact.velocity_m_s:g} m/s?"
    one = report(replace(wilkins(), design=design_result())).lead
    assert one == "Which AD85 on 6061-T6 is the lightest that defeats the 7.62 mm AP at 800 m/s?"
    several = report(replace(wilkins(), design=design_result(threats=(THREAT, OTHER), pareto=True))).lead
    assert several == "Which available armour is the lightest that defeats the 7.62 mm AP at 800 m/s and the M2?"
    bare = report(replace(wilkins(), design=design_result(ceramic=""))).lead
    assert bare.startswith("Which 6061-T6 is the lightest that defeats")


def test_the_answer_without_a_design():
    found = statements(wilkins())
    assert found["Armour"] == ("6.35 mm AD85 on 6.35 mm 6061-T6", "12.7 mm thick")
    assert found["Areal density"] == (f"{wilkins().impact.areal_density_kg_m2:.2f} kg/m²", "")
    outcome = {"defeated": "projectile defeated", "perforated": "armour perforated"}[wilkins().impact.outcome]
    assert found["Outcome"][0] == outcome
    assert "ballistic limit 723.77 m/s, margin " in found["Outcome"][1]
    statement, detail = found["Probability of defeating the threat"]
    assert statement == "8 %"
    assert "± 7.0 %, from 13 tests of AD85 on 6061-T6" in detail


def test_no_figure_where_nothing_was_tested():
    found = statements(contents_of(scenario(ceramic="SiC", backing="Ti-6Al-4V")))
    statement, detail = found["Probability of defeating the threat"]
    assert statement == "unknown"
    assert "no test of such an armour" in detail
    assert not any("±" in text for card in found.values() for text in card)


def test_the_answer_with_a_design():
    one = statements(replace(wilkins(), design=design_result()))
    assert "Best design" in one
    assert one["Areal density"] == ("43.60 kg/m²", "cost 100.00 per m²")
    # The table's digits.
    _, best, _ = frontier_table(design_result()).texts()
    assert one["Areal density"][0] == f"{best[2]} kg/m²"
    several = statements(replace(wilkins(), design=design_result(threats=(THREAT, OTHER))))
    assert several["Defeats"][0] == f"{THREAT} and {OTHER}"
    assert several["Defeats"][1].startswith(f"governed by {THREAT}: ballistic limit")


def test_the_answer_with_distributions():
    sampled = uncertainty_result()
    error = wilkins().confidence.model_error
    found = statements(replace(wilkins(), uncertainty=replace(sampled, model_error=error)))
    statement, detail = found["Probability of defeating the threat"]
    assert statement == "79 %"
    with_error = "95 % interval 78.0 to 80.0 %, from the given distributions and the error of the model; "
    assert detail.startswith(f"{with_error}error of the model: ± 7.0 %")
    # Without an error of the model the distributions alone tell no probability of defeat, unless the scenario says so.
    unknown = ConfidenceResult(None, 700.0, None, NO_TEST)
    found = statements(replace(wilkins(), uncertainty=sampled, confidence=unknown))
    assert found["Probability of defeating the threat"][0] == "unknown"
    left_out = scenario(uncertainty={"model": {"included": False}})
    found = statements(replace(wilkins(), uncertainty=sampled, scenario=left_out))
    without = "95 % interval 78.0 to 80.0 %, from the given distributions, without the error of the model"
    assert found["Probability of defeating the threat"] == ("79 %", without)


def test_the_answer_without_a_limit():
    found = statements(contents_of(scenario(ballistic_limit={"velocity_max_m_s": 600.0})))
    assert "ballistic limit outside the range searched" in found["Outcome"][1]
    assert found["Probability of defeating the threat"][0] == "unknown"


def test_the_energy_section():
    section = report(wilkins()).sections[0]
    energy = wilkins().energy
    assert section.paragraphs[0].endswith(f"{energy.before:.2f} J at impact and {energy.left:.2f} J at the end.")
    [table] = section.tables
    assert len(table.rows) == len(energy.rows) + 1


def test_sections_follow_the_results():
    def headings(contents: Contents) -> list[str]:
        return [section.heading for section in report(contents).sections]

    entries = ["Projectile: 7.62 mm AP", "Ceramic: AD85", "Metal: 6061-T6"]
    assert headings(wilkins()) == [
        "Energy balance of the projectile",
        "Stages of the impact",
        "Sensitivity to the inputs",
        *entries,
        "Scenario",
        "Origin",
    ]
    full = replace(
        wilkins(), design=design_result(threats=(THREAT, OTHER), pareto=True), uncertainty=uncertainty_result()
    )
    assert headings(full)[1:5] == ["Best design", "Margins against the threats", "Pairs of materials", "Pareto front"]
    assert "Results under uncertain inputs" in headings(full)
    assert "Required ceramic for each back plate" in headings(replace(wilkins(), design=design_result()))


def test_charts_follow_the_results():
    def titles(contents: Contents) -> list[str]:
        return [chart.title.partition("\n")[0] for chart in report(contents).charts]

    last = ["Sensitivity to the inputs", "Impact of the 7.62 mm AP", "Where the projectile's energy went"]
    assert titles(wilkins()) == last
    full = replace(wilkins(), design=design_result(pareto=True), uncertainty=uncertainty_result())
    first = ["Required ceramic for each back plate", "Pareto front", "Probability of perforation"]
    assert titles(full) == [*first, *last]


def test_the_cross_section_is_that_of_the_answer():
    drawn = report(wilkins()).cross_section
    assert drawn is not None
    assert (drawn.rod, drawn.rod_diameter, drawn.ceramic, drawn.backing) == ("7.62 mm AP", 6.5, "AD85", "6061-T6")
    assert drawn.rod_length == pytest.approx(20.96, abs=0.01)
    assert (drawn.ceramic_thickness, drawn.backing_thickness) == (6.35, 6.35)


def test_markdown_says_the_same():
    full = report(replace(wilkins(), design=design_result(pareto=True), warnings=("a_key: is odd",)))
    text = markdown_report(full)
    assert text.startswith("# ")
    for card in full.cards:
        assert f"* {card.subject}: **{card.statement}**" in text
    for section in full.sections:
        assert f"\n## {section.heading}\n" in text
    assert "Warning: a\\_key: is odd" in text
    assert "```console\narmour report x.toml\n```" in text


def test_a_fence_is_longer_than_any_in_the_scenario():
    fenced = replace(wilkins(), scenario=wilkins().scenario.replaced({"title": "a ```` b"}))
    assert "`````toml\n" in markdown_report(report(fenced, ""))
