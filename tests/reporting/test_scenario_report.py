"""What a report on a scenario says, and that it agrees with the functions that its results come from."""

from functools import cache

import pytest

from armour import __version__
from armour.design.check import check
from armour.design.optimise import optimise
from armour.reporting.by_result import in_a_line, tables_of
from armour.reporting.formats import markdown_report
from armour.reporting.report import Report, ReportSection
from armour.reporting.scenario_report import scenario_report
from armour.reporting.table import Table
from armour.reporting.views.design import details, facts, nearly_as_good, tables_of_search
from armour.scenario.scenario import Scenario, load_scenario
from armour.statistics.sensitivity import sensitivity
from armour.statistics.uncertainty import uncertainty
from tests.design.results import best_of
from tests.helpers.cases import RANGE, SCENARIOS, scenario

pytestmark = pytest.mark.slow

SAMPLED = {"samples": 128, "impact": {"velocity_m_s": {"distribution": "normal", "standard_deviation": 10.0}}}
GRID = {"optimise": {"ceramic_thickness_mm": RANGE, "backing_thickness_mm": RANGE}}


@cache
def shipped(name: str) -> Scenario:
    return load_scenario(SCENARIOS / f"{name}.toml")


@cache
def reported(name: str) -> Report:
    return scenario_report(shipped(name), "armour report x.toml")


@cache
def wilkins() -> Report:
    return scenario_report(scenario(title="A title"), "armour report x.toml")


def section(report: Report, heading: str) -> ReportSection:
    return next(section for section in report.sections if section.heading == heading)


def shown(lines: list[Table | str]) -> tuple[list[list[list[str]]], list[str]]:
    """The texts of the tables among lines, and the other lines."""
    tables = [line.texts() for line in lines if isinstance(line, Table)]
    return tables, [str(line) for line in lines if not isinstance(line, Table)]


def of_section(section: ReportSection) -> tuple[list[list[list[str]]], list[str]]:
    return [table.texts() for table in section.tables], list(section.paragraphs)


@pytest.mark.parametrize("name", ["paper/optimum_7.62mm_AP", "catalogue"])
def test_the_report_is_about_the_best_design_as_the_search_and_a_check_show_it(name: str):
    found, report = optimise(shipped(name)), reported(name)
    best = best_of(found)
    words = in_a_line(best.check)
    assert report.lead == f"{words[:1].upper()}{words[1:]}."
    assert of_section(section(report, "Threats")) == shown(details(best.check))
    designs = section(report, "Designs")
    assert (designs.folded, len(designs.pictures)) == (True, 1)
    assert of_section(designs) == shown(tables_of_search(found))
    armour = best.scenario.armour_words()
    assert [*report.facts[:-2]] == facts(best.check, armour=armour, also=nearly_as_good(found))


def test_the_own_armour_is_reported_as_a_check_finds_it():
    own = load_scenario(SCENARIOS / "catalogue.toml", {"design.probability_of_stopping": 0.6})
    report, found = scenario_report(own, "", as_is=True), check(own)
    assert report.lead.startswith("FAILS")
    assert (report.passed, report.title.partition(" against ")[0]) == (False, own.armour_words())
    assert of_section(section(report, "Threats")) == shown(details(found))
    assert not any(part.heading == "Designs" for part in report.sections)


def test_details_are_those_of_the_results_against_the_threat_that_most_likely_perforates():
    threats = [{"projectile": "7.62 mm AP", "velocity_m_s": velocity} for velocity in (680.0, 720.0)]
    own = scenario(threat=threats, uncertainty=SAMPLED)
    report, answer = scenario_report(own, ""), own.against(own.threats()[1])
    assert of_section(section(report, "Results under uncertain inputs")) == shown(tables_of(uncertainty(answer)))
    assert of_section(section(report, "Sensitivity to the inputs")) == shown(tables_of(sensitivity(answer)))
    assert all(part.pictures for part in report.sections if part.heading.startswith(("Results", "Sensitivity")))


def test_the_title_is_the_armour_reported_with_the_scenarios_beside_it():
    assert wilkins().title == "6.35 mm AD85 on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s"
    assert wilkins().byline[0] == ("scenario", "A title")
    assert reported("catalogue").title.endswith(" against 7.62 mm AP at 850 m/s and 7.62 mm APM2 at 830 m/s")


def test_the_box_has_what_the_verdict_rests_on_and_its_use():
    *rests_on, use = wilkins().facts
    assert rests_on == facts(check(scenario()), armour=scenario().armour_words())
    assert str(use).endswith("does not replace firing tests.")


def test_the_box_says_that_a_probability_is_not_known_and_why():
    report = scenario_report(scenario(ceramic="SiC", velocity=300.0, uncertainty=SAMPLED), "")
    assert report.lead.startswith("Stopped by the model: ")
    assert "no test of SiC on metal is known" in " ".join(section(report, "Threats").paragraphs)
    straight = {"projectile": "7.62 mm AP", "velocity_m_s": 600.0, "name": "straight"}
    at_angle = {**straight, "obliquity_deg": 30.0, "name": "oblique"}
    # What the model alone says that perforates decides.
    faced = scenario(threat=[{**at_angle, "velocity_m_s": 1200.0}, straight])
    assert scenario_report(faced, "").lead.startswith("Perforated by the model: oblique at 1200 m/s")


def test_warnings_name_inputs_in_words():
    light = {"metal": {"light": {"density_kg_m3": 1840.0, "static_yield_strength_MPa": 300.0}}}
    own = scenario(backing="light", library=light)
    told = [warning.partition(": ")[0] for warning in scenario_report(own, "").warnings]
    assert "plate density, kg/m³" in told
    assert not any("." in key for key in told)


def test_sections_are_the_answer_and_what_explains_it():
    def headings(report: Report, *, folded: bool) -> list[str]:
        return [section.heading for section in report.sections if section.folded == folded]

    assert headings(wilkins(), folded=False) == ["Threats", "Assumptions and limits", "References"]
    folded = ["The impact, stage by stage", "Sensitivity to the inputs", "Values and their sources", "Scenario"]
    assert headings(wilkins(), folded=True) == [*folded, "Command and versions"]
    assert headings(reported("catalogue"), folded=True)[0] == "Designs"


def test_the_references_are_those_of_the_tests_and_values_used():
    assert [name for name, _ in section(wilkins(), "References").notes][:2] == ["Paper", "Wilkins"]
    untested = [name for name, _ in section(scenario_report(scenario(ceramic="SiC"), ""), "References").notes]
    assert "Ryan2023" not in untested


def test_the_armour_is_said_to_be_the_best_design_or_the_scenarios_own():
    """In the box; nothing is said where the two are the same."""
    hashed = f"SHA-256 of the scenario's content: {scenario(title='A title').digest()}"
    assert section(wilkins(), "Command and versions").paragraphs[0] == hashed
    *_, words = reported("paper/optimum_7.62mm_AP").facts
    assert str(words).startswith("This report is about the design found, not the scenario's own armour, ")
    own = scenario_report(scenario(**GRID), "", as_is=True)
    *_, words = own.facts
    assert words == "This report is about the scenario's own armour; without --as-is it is about the design found."
    saved = best_of(optimise(scenario(**GRID))).scenario
    assert not any(str(fact).startswith("This report") for fact in scenario_report(saved, "").facts)


def test_author_project_and_date_are_shown_where_given():
    assert wilkins().byline == (("scenario", "A title"), ("program version", f"armour {__version__}"))
    keys = {"author": "A. Smith", "date": "2026-01-31", "project": "Door"}
    named = scenario_report(scenario(title="A title").replaced(keys), "")
    assert named.byline[1:4] == (("project", "Door"), ("author", "A. Smith"), ("date", "2026-01-31"))
    assert "project: Door, author: A. Smith, date: 2026-01-31, program version: armour " in markdown_report(named)


@pytest.mark.parametrize(
    "changes",
    [
        {"armour.backing": "HHA Class 1", "armour.backing_thickness_mm": 45.0},
        {"ballistic_limit.velocity_max_m_s": 400.0, "design.probability_of_stopping": 0.8},
        {"ballistic_limit.velocity_max_m_s": 400.0, "design.probability_of_stopping": 0.8, "uncertainty": SAMPLED},
    ],
)
def test_an_armour_without_a_limit_in_the_range_has_a_report(changes: dict[str, object]):
    """Without a sensitivity, of which there is none."""
    own = {"armour.backing_thickness_mm": 40.0, "impact.velocity_m_s": 600.0}
    report = scenario_report(load_scenario("bare_plate", {**own, **changes}), "")
    assert report.passed is not False
    assert not any(part.heading.startswith(("Sensitivity", "Results")) for part in report.sections)
