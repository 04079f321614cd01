"""What a report on a scenario says, and that it agrees with the functions that its results come from."""

from dataclasses import replace
from functools import cache

import pytest

from armour import __version__
from armour.analysis.ballistic_limit import ConfidenceResult, ballistic_limit, confidence
from armour.design.optimise import DesignResult, optimise
from armour.errors import Note
from armour.reporting.charts import Chart
from armour.reporting.report import Report, markdown_report
from armour.reporting.scenario_report import AgainstThreat, Contents, contents_of, scenario_report
from armour.reporting.views import design as design_view
from armour.reporting.views.confidence import SAMPLED_ALONE
from armour.reporting.views.design import frontier_table
from armour.scenario.evidence import NO_TEST, ModelError
from armour.scenario.scenario import load_scenario
from armour.statistics.uncertainty import uncertainty
from tests.helpers.cases import RANGE, SCENARIOS, THREATS, scenario
from tests.helpers.results import OTHER, THREAT, best_design, design_result, uncertainty_result

pytestmark = pytest.mark.slow


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


SAMPLED = {
    "samples": 128,
    "impact": {"velocity_m_s": {"distribution": "normal", "standard_deviation": 10.0}},
}


@cache
def wilkins() -> Contents:
    return contents_of(scenario(title="A title"))


@pytest.fixture(autouse=True)
def without_map(monkeypatch: pytest.MonkeyPatch) -> None:
    """Results made by hand have no map; that of others takes time, and is tested with their view."""
    monkeypatch.setattr(design_view, "map_chart", lambda result: Chart(f"map of {result.best.ceramic}", ()))


def designed(result: DesignResult) -> Contents:
    """The contents for a best design."""
    best = result.best
    threats = (AgainstThreat(name, True, 20.0, 10.0 * n, 0.6 + 0.1 * n) for n, name in enumerate(result.threats))
    return replace(wilkins(), design=result, threats=tuple(threats), governing=best.governing)


def report(contents: Contents, command: str = "armour report x.toml") -> Report:
    return scenario_report(contents, command)


def statements(contents: Contents) -> dict[str, tuple[str, str]]:
    return {card.subject: (card.statement, card.detail) for card in report(contents).cards}


def test_the_title_is_the_armour_reported_with_the_scenarios_beside_it():
    found = report(wilkins())
    assert found.title == "6.35 mm AD85 on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s"
    assert found.byline[0] == ("scenario", "A title")
    designed = contents_of(load_scenario("catalogue"))
    threats = "7.62 mm AP at 850 m/s and 7.62 mm APM2 at 830 m/s"
    assert report(designed).title == f"8 mm AD85 on 8 mm 7075-T6 against {threats}"


def test_questions():
    impact = wilkins().scenario.impact
    assert report(wilkins()).lead == f"Does this armour defeat the 7.62 mm AP at {impact.velocity_m_s:g} m/s?"
    one = report(designed(design_result())).lead
    assert one == "Which AD85 on 6061-T6 is the lightest that defeats the 7.62 mm AP at 800 m/s?"
    several = report(designed(design_result(threats=(THREAT, OTHER), pareto=True))).lead
    assert several == "Which available armour is the lightest that defeats the 7.62 mm AP at 800 m/s and the M2?"
    bare = report(designed(design_result(ceramic=""))).lead
    assert bare.startswith("Which 6061-T6 is the lightest that defeats")


def test_the_answer_without_a_design():
    found = statements(wilkins())
    assert found["Armour"] == ("6.35 mm AD85 on 6.35 mm 6061-T6", "12.7 mm thick")
    assert found["Areal density"] == (f"{wilkins().impact.areal_density_kg_m2:.2f} kg/m²", "")
    outcome = {"defeated": "projectile defeated", "perforated": "armour perforated"}[wilkins().impact.outcome]
    assert found["Outcome"][0] == outcome
    assert "ballistic limit 723.77 m/s, margin " in found["Outcome"][1]
    statement, detail = found["Probability of defeating the threat"]
    assert statement == "7 %"
    assert "95 % interval -15.2 to +15.9 %, from 13 tests of AD85 on 6061-T6" in detail


def test_no_figure_where_nothing_was_tested():
    found = statements(contents_of(scenario(ceramic="SiC", backing="Ti-6Al-4V")))
    statement, detail = found["Probability of defeating the threat"]
    assert statement == "unknown"
    assert "no test of such an armour" in detail
    uncertain = contents_of(scenario(ceramic="SiC", uncertainty=SAMPLED))
    assert statements(uncertain)["Probability of defeating the threat"][1].endswith(SAMPLED_ALONE)
    assert not any("±" in text for card in found.values() for text in card)


def test_the_answer_with_a_design():
    one = statements(designed(design_result()))
    assert "Best design" in one
    assert one["Areal density"] == ("43.60 kg/m²", "cost 100.00 per m²")
    # The table's digits.
    _, best, _ = frontier_table(design_result()).texts()
    assert one["Areal density"][0] == f"{best[2]} kg/m²"
    several = statements(designed(design_result(threats=(THREAT, OTHER))))
    statement, detail = several["Defeats"]
    assert statement == f"{THREAT} and {OTHER}"
    assert f"{THREAT}: margin +20.0 m/s, probability of defeat 60 %" in detail
    assert f"{OTHER}: margin +20.0 m/s (+10.0 m/s required, met), probability of defeat 70 %" in detail
    assert f"Probability of defeating the threat that governs, {THREAT}" in several


def test_a_design_without_a_margin_is_told():
    best = replace(best_design(), model_error=ModelError(0.0, 7.0, 12.0, "13 tests"))
    ask = "50 %; design.confidence = 0.95 in the scenario designs for a probability of 95 %"
    told = report(designed(replace(design_result(), best=best))).warnings[-1]
    assert told == f"a design without a margin is perforated with a probability of {ask}"
    assert not any(
        "without a margin" in warning
        for warning in report(designed(replace(design_result(), best=replace(best, model_error=None)))).warnings
    )


def test_a_required_margin_that_is_missed_is_told():
    found = AgainstThreat("M2", True, 2.4, 20.0, None)
    contents = replace(wilkins(), threats=(found, found._replace(threat="M3", margin_m_s=30.0)), governing="M2")
    assert "+2.4 m/s (+20.0 m/s required, not met)" in statements(contents)["Defeats"][1]
    [table] = next(s.tables for s in report(contents).sections if s.heading == "Margins against the threats")
    assert [row[table.headings().index("requirement")] for row in table.texts()] == ["not met", "met"]


def test_warnings_name_inputs_in_words():
    warnings = (
        Note("high", "backing.flow_stress_GPa"),
        Note("other", "uncertainty.armour.ceramic_thickness_mm"),
        Note("no", "threat"),
    )
    assert report(replace(wilkins(), warnings=warnings)).warnings[:3] == (
        "back plate flow stress, GPa: high",
        "distribution of the ceramic thickness, mm: other",
        "threat: no",
    )


def test_the_armour_is_said_to_be_the_best_design_or_the_scenarios_own():
    assert report(wilkins()).remarks == ()
    [remark] = report(designed(design_result())).remarks
    assert remark == (
        "The armour is the best design found. "
        "With --as-is, the report is on the scenario's own, 6.35 mm AD85 on 6.35 mm 6061-T6."
    )


def test_the_answer_with_distributions():
    sampled = uncertainty_result().of(scenario=scenario())
    error = wilkins().confidence.model_error
    found = statements(replace(wilkins(), uncertainty=replace(sampled, model_error=error).of(scenario=scenario())))
    statement, detail = found["Probability of defeating the threat"]
    assert statement == "79 %"
    with_error = "95 % interval 78.0 to 80.0 %, from the given distributions and the error of the model; "
    assert detail.startswith(f"{with_error}error of the model: -1.2 %, 95 % interval")
    # Without an error of the model the distributions alone tell no probability of defeat, unless the scenario says so.
    unknown = ConfidenceResult(None, 700.0, None, NO_TEST)
    found = statements(replace(wilkins(), uncertainty=sampled, confidence=unknown))
    assert found["Probability of defeating the threat"][0] == "unknown"
    left_out = scenario(uncertainty={"model": {"included": False}})
    found = statements(replace(wilkins(), uncertainty=sampled, scenario=left_out))
    without = "95 % interval 78.0 to 80.0 %, from the given distributions, without the error of the model"
    assert found["Probability of defeating the threat"] == ("79 %", without)


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
        wilkins(),
        design=design_result(threats=(THREAT, OTHER), pareto=True),
        uncertainty=uncertainty_result().of(scenario=scenario()),
    )
    assert headings(full)[1:5] == ["Best design", "Margins against the threats", "Pairs of materials", "Pareto front"]
    assert "Results under uncertain inputs" in headings(full)
    assert "Required ceramic for each back plate" in headings(replace(wilkins(), design=design_result()))


@cache
def as_is(velocity: float) -> Contents:
    """An armour of one's own against two threats, of a scenario that asks for a design."""
    grid = {"ceramic_thickness_mm": RANGE, "backing_thickness_mm": RANGE}
    threats = [{**threat, "velocity_m_s": velocity} for threat in THREATS]
    return contents_of(scenario(ceramic_mm=8.0, threat=threats, optimise=grid), as_is=True)


def test_the_scenarios_own_armour_where_a_design_is_asked_for():
    found = report(as_is(780.0))
    assert found.lead == "Does this armour defeat the 7.62 mm AP at 780 m/s and the M2?"
    assert found.remarks == ("The armour is the scenario's own. Without --as-is, the report is on the best design.",)
    cards = statements(as_is(780.0))
    assert cards["Armour"][0] == "8 mm AD85 on 6.35 mm 6061-T6"
    [table] = next(section.tables for section in found.sections if section.heading == "Margins against the threats")
    assert [row[0] for row in table.texts()] == ["7.62 mm AP at 780 m/s", "M2"]
    assert [column.label for column in table.columns][:4] == ["threat", "outcome", "margin", "required margin"]
    assert [row[-1] for row in table.texts()].count("governs") == 1


def test_threats_that_perforate_are_named_alone():
    statement, detail = statements(as_is(830.0))["Perforated by"]
    perforating = [found.threat for found in as_is(830.0).threats if not found.defeated]
    assert statement == " and ".join(perforating)
    assert all(f"{name}: perforates; margin -" in detail for name in perforating)
    assert all(found.threat in detail for found in as_is(830.0).threats)


def test_author_project_and_date_are_shown_where_given():
    assert report(wilkins()).byline == (("scenario", "A title"), ("revision", f"armour {__version__}"))
    keys = {"author": "A. Smith", "date": "2026-01-31", "project": "Door"}
    named = report(replace(wilkins(), scenario=wilkins().scenario.replaced(keys)))
    assert named.byline[1:4] == (("project", "Door"), ("author", "A. Smith"), ("date", "2026-01-31"))
    assert "project: Door, author: A. Smith, date: 2026-01-31, revision: armour " in markdown_report(named)


def test_a_probability_with_exact_inputs_is_said_to_be_one_where_another_is_sampled():
    threats = tuple(AgainstThreat(name, True, 20.0, 0.0, 0.6, sampled=name == OTHER) for name in (THREAT, OTHER))
    _, detail = statements(replace(wilkins(), threats=threats))["Defeats"]
    assert detail == (
        f"{THREAT}: margin +20.0 m/s, probability of defeat 60 % with exact inputs; "
        f"{OTHER}: margin +20.0 m/s, probability of defeat 60 %"
    )


def test_a_threat_whose_limit_is_outside_the_range_has_no_margin():
    threats = tuple(AgainstThreat(name, True, None, 0.0, None) for name in (THREAT, OTHER))
    _, detail = statements(replace(wilkins(), threats=threats))["Defeats"]
    assert f"{OTHER}: limit outside the range searched, probability of defeat" in detail
