"""What a report on a scenario says, and that it agrees with the functions that its results come from."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import pytest

from armour import __version__
from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.estimates import Estimate
from armour.analysis.impact import energy_balance
from armour.design.check import CheckedThreat, check
from armour.design.optimise import DesignResult, optimise
from armour.design.requirements import Requirement, Verdict
from armour.errors import Note
from armour.evidence.model_error import NO_TEST
from armour.reporting.by_result import tables_of
from armour.reporting.formats import markdown_report
from armour.reporting.report import Report, ReportSection
from armour.reporting.scenario_report import Contents, contents_of, scenario_report
from armour.reporting.table import Table
from armour.reporting.views.design import AREAL_DENSITY, COST
from armour.reporting.words import SAMPLED_ALONE, chance, from_tests
from armour.scenario.scenario import load_scenario
from armour.statistics.uncertainty import uncertainty
from armour.validation.comparison import compare
from tests.design.results import OTHER, THREAT, best_of, design_result
from tests.helpers.cases import RANGE, SCENARIOS, scenario
from tests.reporting.tables import headings
from tests.statistics.results import uncertainty_result

pytestmark = pytest.mark.slow


@cache
def contents(name: str) -> Contents:
    return contents_of(load_scenario(SCENARIOS / f"{name}.toml"))


@pytest.mark.parametrize("name", ["paper/optimum_7.62mm_AP", "catalogue"])
def test_the_armour_is_the_best_design_against_the_threat_that_most_likely_perforates_it(name: str):
    found = contents(name)
    best = best_of(optimise(found.scenario))
    answer = found.answer
    assert answer.armour.ceramic == best.ceramic
    assert answer.armour.backing == best.backing
    assert answer.armour.ceramic_thickness_mm == best.ceramic_thickness_mm
    assert answer.armour.backing_thickness_mm == best.backing_thickness_mm
    least = min(best.probabilities_of_stopping, key=lambda threat: best.probabilities_of_stopping[threat] or 0.0)
    assert found.threat.threat == f"{answer.impact.projectile} at {answer.impact.velocity_m_s:g} m/s" == least
    assert found.threat.ballistic_limit_m_s == ballistic_limit(answer).ballistic_limit_m_s
    for threat in found.threats:
        assert threat.margin_m_s == pytest.approx(best.margins_m_s[threat.threat], abs=0.03)
        assert threat.probability_of_stopping == pytest.approx(best.probabilities_of_stopping[threat.threat], abs=1e-3)


def test_the_answer_of_a_bare_plate_has_no_ceramic():
    plate = {
        "ceramic_thickness_mm": {"min": 0.0, "max": 0.0, "step": 1.0},
        "backing_thickness_mm": {"min": 8.0, "max": 20.0, "step": 4.0},
    }
    found = contents_of(scenario(ceramic=None, ceramic_mm=0.0, velocity=500.0, optimise=plate))
    assert found.design is not None
    assert not found.answer.armour.ceramic
    assert found.answer.armour.backing_thickness_mm == best_of(found.design).backing_thickness_mm


def test_the_own_armour_is_reported_as_a_check_finds_it():
    own = load_scenario(SCENARIOS / "catalogue.toml", {"design.confidence": 0.6})
    found = contents_of(own, as_is=True)
    assert found.design is None
    assert found.answer.armour == own.armour
    assert found.check == check(own)
    assert found.threats == found.check.threats
    assert found.threat.threat == "7.62 mm AP at 850 m/s"
    assert found.answer.impact.projectile == "7.62 mm AP"


def test_a_limit_outside_the_range_is_reported_where_the_armour_is_perforated():
    threats = [{"projectile": "7.62 mm AP", "velocity_m_s": velocity} for velocity in (30.0, 900.0)]
    for high in (100.0, 1000.0):
        search = {"velocity_max_m_s": high}
        found = contents_of(scenario(threat=threats, ballistic_limit=search), as_is=True)
        assert found.threat == found.threats[1]
        assert [against.verdict for against in found.threats] == ["passes", "fails"]


def test_a_confidence_asks_for_no_design():
    own = scenario(design={"confidence": 0.9}, threat=[{"projectile": "7.62 mm AP", "velocity_m_s": 600.0}])
    assert contents_of(own).design is None


def test_a_density_on_offer_is_the_answers():
    case = load_scenario(
        SCENARIOS / "catalogue.toml",
        {"design.ceramic": [{"material": "AD85", "thickness_mm": [10.0], "density_kg_m3": 5000.0, "cost_per_kg": 1.0}]},
    )
    found = contents_of(case)
    assert found.design is not None
    assert found.impact.areal_density_kg_m2 == pytest.approx(best_of(found.design).areal_density_kg_m2)
    assert found.check.cost_per_m2 == pytest.approx(best_of(found.design).cost_per_m2)


def test_a_distribution_about_another_value_than_the_designs_is_left_out():
    grid = {"ceramic_thickness_mm": {"min": 5.0, "max": 12.0, "step": 0.5}}
    grid["backing_thickness_mm"] = {"min": 4.0, "max": 10.0, "step": 1.0}
    found = contents_of(load_scenario(SCENARIOS / "uncertain.toml", {"optimise": grid}))
    assert found.uncertainty is None
    assert any(
        "uncertainty.armour.ceramic_thickness_mm: is given for a value other than" in w for w in map(str, found.notes)
    )


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
    assert found.threat == fast
    assert fast.probability_of_stopping == 1.0 - found.uncertainty.probability_of_perforation.value
    alone = uncertainty(found.scenario.replaced({"impact.velocity_m_s": 680.0})).probability_of_perforation
    assert slow.probability_of_stopping == 1.0 - alone.value
    assert found.sampled == (slow.threat, fast.threat)
    assert not any("taken as exact" in warning for warning in map(str, found.notes))


def test_a_threat_that_a_distribution_does_not_fit_keeps_exact_inputs():
    found = uncertain(max=700.0)
    assert found.sampled == ()
    assert found.threats == found.check.threats
    assert sum("inputs are taken as exact" in warning for warning in map(str, found.notes)) == 2
    first, second = found.threats
    mixed = section(
        replace(found, threats=(replace(first, sampled=Estimate(0.1, 0.1, 0.1)), second)), "Threats"
    ).tables[0]
    assert [row[headings(mixed).index("inputs")] for row in mixed.texts()] == ["distributions", "exact"]


SAMPLED = {"samples": 128, "impact": {"velocity_m_s": {"distribution": "normal", "standard_deviation": 10.0}}}


STOPPING = "probability of stopping the projectile"


@cache
def wilkins() -> Contents:
    return contents_of(scenario(title="A title"))


def asked(*given: tuple[float | None, float | None]) -> Contents:
    """The contents for threats with probabilities, found and required."""
    [own] = wilkins().threats
    threats: list[CheckedThreat] = []
    for name, (found, required) in zip((THREAT, OTHER), given, strict=False):
        verdict: Verdict = "passes"
        if required is not None:
            verdict = "not known" if found is None else "passes" if found >= required else "fails"
        rows = (Requirement("probability_of_stopping", name, required or 0.0, found, verdict),)
        of = replace(own, threat=name, probability_of_stopping=found, required_probability=required)
        threats.append(replace(of, verdict=verdict, requirements=rows if required is not None else ()))
    worst = min((threat.verdict for threat in threats), key=["fails", "not known", "passes"].index)
    result = replace(wilkins().check, threats=tuple(threats), verdict=worst)
    faced = [{"projectile": "7.62 mm AP", "velocity_m_s": 800.0}, {**OTHER_THREAT}][: len(threats)]
    facing = wilkins().scenario.replaced({"threat": faced})
    return replace(wilkins(), scenario=facing, check=result, threats=tuple(threats))


OTHER_THREAT = {"projectile": "7.62 mm APM2", "velocity_m_s": 840.0, "name": OTHER}


def designed(result: DesignResult) -> Contents:
    """The contents for a best design."""
    return replace(asked((0.61, None), (0.7, None)), design=result)


def report(contents: Contents, command: str = "armour report x.toml", map_command: str = "") -> Report:
    return scenario_report(contents, command, map_command)


def statements(contents: Contents) -> dict[str, tuple[str, str]]:
    return {card.subject: (card.statement, card.detail) for card in report(contents).cards}


def section(contents: Contents, heading: str) -> ReportSection:
    return next(section for section in report(contents).sections if section.heading == heading)


def test_the_title_is_the_armour_reported_with_the_scenarios_beside_it():
    found = report(wilkins())
    assert found.title == "6.35 mm AD85 on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s"
    assert found.byline[0] == ("scenario", "A title")
    threats = "7.62 mm AP at 850 m/s and 7.62 mm APM2 at 830 m/s"
    assert report(contents("catalogue")).title == f"8 mm AD85 on 8 mm 7075-T6 against {threats}"


@pytest.mark.parametrize(
    ("given", "passed", "lead"),
    [
        ([(0.07, None)], None, ""),
        ([(0.96, 0.95)], True, "Meets the requirements."),
        ([(0.96, 0.95), (0.97, 0.95)], True, "Meets the requirements against every threat."),
        (
            [(0.5, 0.95), (0.97, 0.95)],
            False,
            f"Does not meet the requirements against {THREAT}: {STOPPING} 50 %, at least 95 % required.",
        ),
        (
            [(None, 0.95), (0.97, 0.95)],
            False,
            f"Not known to meet the requirements against {THREAT}: {STOPPING} unknown, at least 95 % required.",
        ),
        ([(None, None)], None, ""),
    ],
)
def test_the_verdict_follows_what_was_asked_for(
    given: list[tuple[float | None, float | None]], passed: bool | None, lead: str
):
    found = report(asked(*given))
    assert (found.passed, found.lead) == (passed, lead)
    table = section(asked(*given), "Threats").tables[0]
    if passed is not None:
        results = [row[headings(table).index("result")] for row in table.texts()]
        assert [result == "not known" for result in results] == [probability is None for probability, _ in given]


def test_the_answer_without_a_design():
    found = statements(wilkins())
    assert [*found] == ["Probability of stopping the projectile", "Armour", "Asked for"]
    assert found["Armour"][0] == "6.35 mm AD85 on 6.35 mm 6061-T6"
    density = AREAL_DENSITY.text(wilkins().impact.areal_density_kg_m2)
    assert (
        found["Armour"][1]
        == f"{density} kg/m², 12.7 mm thick; tested near this limit: 5.8 mm AD85 on 7.24 mm 6061-T6, 39.8 kg/m²"
    )
    assert found["Asked for"] == ("no probability", "--confidence 0.95 asks for a probability of 95 %")
    statement, detail = found["Probability of stopping the projectile"]
    assert statement == "7 %"
    error = wilkins().threat.model_error
    assert error is not None
    assert detail == from_tests(error)
    assert statements(asked((0.96, 0.95)))["Asked for"] == ("at least 95 %", "")


def test_every_threat_has_its_velocity_and_angle():
    table = section(asked((0.5, 0.95), (0.97, 0.9)), "Threats").tables[0]
    assert headings(table)[:4] == ["threat", "projectile", "velocity, m/s", "obliquity, °"]
    assert [row[:1] for row in table.texts()] == [[""], [OTHER]]
    found = [[*zip(headings(table), row, strict=True)] for row in table.texts()]
    assert {("velocity, m/s", "800"), ("obliquity, °", "0"), ("required", "at least 95 %")} <= {*found[0]}


def test_no_figure_where_nothing_was_tested():
    found = statements(contents_of(scenario(ceramic="SiC", uncertainty=SAMPLED)))
    statement, detail = found["Probability of stopping the projectile"]
    assert statement == "unknown"
    assert "no test of SiC on metal" in detail
    assert detail.endswith(SAMPLED_ALONE)
    assert not any("±" in text for card in found.values() for text in card)


def test_a_threat_of_an_unknown_probability():
    known = {"projectile": "7.62 mm AP", "velocity_m_s": 700.0}
    at_angle = {**known, "obliquity_deg": 30.0, "name": OTHER}
    found = contents_of(scenario(threat=[at_angle, {**known, "name": THREAT}]))
    assert found.threat.threat == THREAT
    p = chance(found.threat.probability_of_stopping)
    value, detail = statements(found)["Probability of stopping the projectile"]
    assert value == f"{p} or unknown"
    assert detail.startswith(f"unknown against {OTHER}; {p} against {THREAT}; ")
    # It is the one to report where the model alone says that it perforates.
    found = contents_of(scenario(threat=[{**at_angle, "velocity_m_s": 1200.0}, {**known, "name": THREAT}]))
    value, detail = statements(found)["Probability of stopping the projectile"]
    assert value == "unknown"
    assert detail.startswith(f"against {OTHER}; the model was compared with no test")


def test_the_answer_with_a_design():
    found = contents("catalogue")
    assert found.design is not None
    best = best_of(found.design)
    areal_density, cost = AREAL_DENSITY.text(best.areal_density_kg_m2), COST.text(best.cost_per_m2)
    near = "7.83 mm AD85 on 6.35 mm 6061-T6, 44.3 kg/m²"
    words = f"{areal_density} kg/m², 16.5 mm thick, cost {cost} per m²; tested near this limit: {near}"
    assert statements(found)["Lightest design"][1] == words
    detail = statements(designed(design_result()))["Probability of stopping the projectile"][1]
    assert detail.startswith(f"against {THREAT}, the most likely of 2 threats to perforate; ")
    asks = statements(found)["Asked for"]
    assert asks[0] == "margin of 20 m/s"
    assert asks[1].startswith("--confidence 0.95 asks for a probability of 95 %; thickness of at most 20 mm; ")


def test_the_report_names_the_command_of_the_map():
    command = "armour optimise x.toml --map map.html"
    [found] = [part for part in report(designed(design_result()), "", command).sections if part.code == command]
    assert found.heading == "Map of the designs"
    assert not any(part.code == command for part in report(wilkins(), "", command).sections)


def test_warnings_name_inputs_in_words():
    notes = (
        Note("high", "backing.flow_stress_GPa"),
        Note("other", "uncertainty.armour.ceramic_thickness_mm"),
        Note("far", "threat[0].projectile"),
        Note("new", "armour.ceramic"),
        Note("no", "threat"),
    )
    assert report(replace(wilkins(), notes=notes)).warnings[:5] == (
        "back plate flow stress, GPa: high",
        "distribution of the ceramic thickness, mm: other",
        "7.62 mm AP at 800 m/s: far",
        "ceramic: new",
        "threat: no",
    )


def test_the_answer_with_distributions():
    sampled = uncertainty_result().of(scenario=scenario())
    error = wilkins().threat.model_error
    with_error = replace(sampled, model_error=error).of(scenario=scenario())
    odds = Estimate(0.21, 0.2, 0.22)
    given = replace(wilkins(), uncertainty=with_error, threats=(replace(wilkins().threat, sampled=odds),))
    detail = statements(given)["Probability of stopping the projectile"][1]
    found = "95 % interval 78.0 to 80.0 % by sampling, from the given distributions and the model error: "
    assert error is not None
    assert detail == f"{found}{from_tests(error).removeprefix('model error: ')}"
    # Without a model error the distributions alone tell no probability, unless the scenario says so.
    untested = replace(wilkins().threat, probability_of_stopping=None, model_error=None, reason=NO_TEST)
    unknown = replace(wilkins(), uncertainty=sampled, threats=(untested,))
    assert statements(unknown)["Probability of stopping the projectile"][1].endswith(SAMPLED_ALONE)
    left_out = replace(unknown, threats=(replace(untested, sampled=odds),))
    without = "95 % interval 78.0 to 80.0 % by sampling, from the given distributions, without the model error"
    assert statements(left_out)["Probability of stopping the projectile"][1] == without


def test_sections_are_the_answer_and_what_explains_it():
    def headings(contents: Contents, *, folded: bool) -> list[str]:
        return [section.heading for section in report(contents).sections if section.folded == folded]

    assert headings(wilkins(), folded=False) == ["Threats", "What if", "Assumptions and limits", "References"]
    evidence = ["The impact, stage by stage", "Sensitivity to the inputs", "Values and their sources"]
    assert headings(wilkins(), folded=True) == [*evidence, "Weight", "Scenario", "Command and versions"]
    full = replace(
        designed(design_result(threats=(THREAT, OTHER), pareto=True)),
        uncertainty=uncertainty_result().of(scenario=scenario()),
    )
    folded = headings(full, folded=True)
    assert folded[:3] == ["Best of each pair", "Pairs of materials", "Results under uncertain inputs"]
    what_ifs = section(full, "What if").tables
    assert [table.title for table in what_ifs] == [f"against {THREAT}", f"against {OTHER}"]
    assert [table.title for table in section(full, "Pairs of materials").tables] == ["", "Pareto front"]
    assert "Required ceramic for each back plate" in headings(designed(design_result()), folded=True)


def test_stages_are_named_in_words():
    table = section(wilkins(), "The impact, stage by stage").tables[0]
    assert table.texts()[0][:2] == ["i", "intact ceramic; penetrator erodes"]
    energies = [cell for *_, cell in table.rows if isinstance(cell, float)]
    energy = energy_balance(wilkins().answer, wilkins().impact)
    assert sum(energies) == pytest.approx(energy.before - energy.left, rel=1e-3)


def test_the_references_are_those_of_the_tests_and_values_used():
    assert [name for name, _ in section(wilkins(), "References").notes][:2] == ["Paper", "Wilkins"]
    known = [name for name, _ in section(contents_of(scenario(ceramic="SiC")), "References").notes]
    assert "Ryan2023" not in known


def test_the_armour_is_said_to_be_the_best_design_or_the_scenarios_own():
    def words(contents: Contents) -> str:
        return section(contents, "Command and versions").paragraphs[0]

    assert words(wilkins()) == f"SHA-256 of the scenario's content: {wilkins().scenario.digest()}"
    assert words(designed(design_result())) == (
        "This report is about the design found, not the scenario's own armour, 6.35 mm AD85 on 6.35 mm 6061-T6; "
        "use --as-is for that."
    )
    grid = {"optimise": {"ceramic_thickness_mm": RANGE, "backing_thickness_mm": RANGE}}
    own = replace(wilkins(), scenario=wilkins().scenario.replaced(grid))
    assert words(own) == "This report is about the scenario's own armour; without --as-is it is about the design found."


def test_author_project_and_date_are_shown_where_given():
    assert report(wilkins()).byline == (("scenario", "A title"), ("program version", f"armour {__version__}"))
    keys = {"author": "A. Smith", "date": "2026-01-31", "project": "Door"}
    named = report(replace(wilkins(), scenario=wilkins().scenario.replaced(keys)))
    assert named.byline[1:4] == (("project", "Door"), ("author", "A. Smith"), ("date", "2026-01-31"))
    assert "project: Door, author: A. Smith, date: 2026-01-31, program version: armour " in markdown_report(named)


@pytest.mark.parametrize(
    ("changes", "passed"),
    [
        ({"armour.backing": "HHA Class 1", "armour.backing_thickness_mm": 45.0}, None),
        ({"ballistic_limit.velocity_max_m_s": 400.0, "design.confidence": 0.8}, True),
        ({"ballistic_limit.velocity_max_m_s": 400.0, "design.confidence": 0.8, "uncertainty": SAMPLED}, True),
    ],
)
def test_an_armour_without_a_limit_in_the_range_has_a_report(changes: Mapping[str, object], passed: bool | None):
    """Without a sensitivity, of which there is none."""
    own = {"armour.backing_thickness_mm": 40.0, "impact.velocity_m_s": 600.0}
    found = contents_of(load_scenario("bare_plate", {**own, **changes}))
    assert found.check.verdict == "passes"
    assert found.sensitivity is None
    assert found.uncertainty is None
    assert report(found).passed is passed


def test_a_weight_stands_beside_those_of_tested_armours():
    own = scenario("7.62 mm B32", velocity=700.0)
    [section] = [part for part in report(contents_of(own)).sections if part.heading == "Weight"]
    names, weights, limits = zip(*section.tables[0].rows, strict=True)
    assert [str(name).partition(": ")[0] for name in names] == ["this armour, by the model", *["measured"] * 3]
    assert weights[0] == own.areal_density_kg_m2()
    added = own.replaced({"design.added_areal_density_kg_m2": 5.0})
    [section] = [part for part in report(contents_of(added)).sections if part.heading == "Weight"]
    for tables in (section.tables, tables_of(compare(added))):
        [table] = [each for each in tables if isinstance(each, Table) and "nearest in limit" in each.columns[0].label]
        assert str(table.rows[0][0]).startswith("this armour without layers that have no ballistic effect")
        assert table.rows[0][1] == pytest.approx(weights[0])
    assert limits[0] == contents_of(own).threat.ballistic_limit_m_s
