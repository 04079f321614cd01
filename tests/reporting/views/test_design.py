import re
from dataclasses import replace
from math import inf
from typing import Any

from armour.analysis.ballistic_limit import NeededFlowStress
from armour.design.check import check
from armour.design.optimise import DesignOfFront, DesignResult, Pair, optimise
from armour.design.requirements import Requirement
from armour.reporting.by_result import in_a_line
from armour.reporting.scenario_report import scenario_report
from armour.reporting.table import Table
from armour.reporting.views.design import (
    front_table,
    frontier_table,
    left_out,
    outside_notes,
    pair_table,
    requirement_table,
    standing,
    tables_of_check,
    tables_of_design,
    thin_designs,
)
from armour.reporting.words import flow_stress_notes, needed_words, requirement_parts, requirement_words
from tests.design.results import THREAT, best_design, best_of, design, design_result, of_front
from tests.helpers.cases import scenario
from tests.reporting.tables import headings


def kinds(result: DesignResult) -> list[str]:
    """First heading or title of every table."""
    return [item.title or headings(item)[0] for item in tables_of_design(result) if isinstance(item, Table)]


def test_thicknesses_of_a_table_have_the_decimals_that_they_need():
    found = design_result()
    halves = replace(found, frontier=(*found.frontier[:2], design("AD85", 6.5, 9.0, 46.0)))
    assert [row[0] for row in frontier_table(halves, slice(None)).texts()] == ["10.0", "8.0", "6.5"]
    thirds = replace(found, frontier=(design("AD85", 20.0 / 3.0, 10.0, 46.0),), frontier_governed_by=(THREAT,))
    assert frontier_table(thirds, slice(None)).texts()[0][:2] == ["6.667", "10.000"]


def test_pairs_of_materials_with_the_reasons_of_those_that_lose():
    pairs = (
        Pair("AD85", "5083-H3", best_design(cost_per_m2=None), None, 0.0, True, False),
        Pair("Al-N", "5083-H3", best_design(cost_per_m2=9.0), None, 4.0, True, True),
        Pair("SiC", "5083-H3", None, None, None, True, True),
        Pair("B4C", "5083-H3", None, best_design(), None, False, True),
    )
    result = replace(design_result(), pairs=pairs)
    table = pair_table(result)
    assert kinds(result)[-1] == "pairs of materials"
    *results, nearest = [row[-1] for row in table.rows]
    assert results == ["lightest", "runner-up: 4.0 % heavier", "none within 5 % of the best passes"]
    assert nearest == in_a_line(best_design().check)
    assert table.texts()[2][1:-1] == [""] * 4
    assert headings(table)[3] == "cost per m²"
    assert "cost per m²" not in headings(pair_table(replace(result, pairs=pairs[:1])))


def test_back_plates_without_a_row_are_told():
    for given, told in (
        ((2.0,), "no ceramic passes on 1 back plate, 2 mm"),
        ((2.0, 2.5), "no ceramic passes on 2 back plates, 2 to 2.5 mm"),
        ((1.0, 2.0, 3.0), "no ceramic passes on 3 back plates, 1 to 3 mm"),
    ):
        assert left_out(replace(design_result(), without_mm=given)) == told


def test_the_frontier_around_the_best_is_shown_unless_all_of_it_is_asked_for():
    row = [design("AD85", 20.0 - i, 4.0 + i, 50.0) for i in range(9)]
    found = replace(design_result(), frontier=tuple(row), frontier_governed_by=(THREAT,) * 9)

    def shown(best: int, **question: Any) -> tuple[list[str], list[str]]:
        thicknesses: dict[str, Any] = {"ceramic_thickness_mm": 20.0 - best, "backing_thickness_mm": 4.0 + best}
        result = replace(found, best=best_design(**thicknesses)).of(**question)
        *_, table = (item for item in tables_of_design(result) if isinstance(item, Table))
        return [each[1] for each in table.texts()], [
            note for note in tables_of_design(result) if isinstance(note, str) and "with -v" in note
        ]

    assert shown(4) == (["6", "7", "8", "9", "10"], ["4 more back plates with -v"])
    assert shown(0)[0] == ["4", "5", "6", "7", "8"]
    assert shown(8)[0][-1] == "12"
    assert len(shown(4, every_row=True)[0]) == 9
    assert shown(4, every_row=True)[1] == []
    several = replace(found, pairs=found.pairs * 2)
    for every_row in (False, True):
        titles = [item.title for item in tables_of_design(several.of(every_row=every_row)) if isinstance(item, Table)]
        assert ("AD85 on 6061-T6: thinnest ceramic for each back plate" in titles) == every_row


def test_what_all_designs_have_in_common_outside_the_tests_is_told_once():
    shared = {"ceramic": inf, "backing_strength_GPa": 1.5}
    thin = replace(design("SiC", 3.0, 6.0, 30.0), outside_tests={"ceramic_thickness_ratio": 0.5, **shared})
    others = replace(design("SiC", 8.0, 6.0, 45.0), outside_tests=shared)
    front = [DesignOfFront(**vars(each), margin_m_s=None) for each in (thin, others)]
    table = front_table(front)
    assert [row[-1] for row in table.texts()] == ["ceramic thickness \N{MULTIPLICATION SIGN}0.50", ""]
    [line] = outside_notes([thin, others])
    assert line == "all lie outside the tests in ceramic, plate flow stress \N{MULTIPLICATION SIGN}1.50"
    inside = of_front("AD85", 8.0, 6.0, 45.0)
    assert [row[-1] for row in front_table([front[1], inside]).texts()][1] == "inside"
    assert "outside the tests in" not in headings(front_table([inside, inside]))
    assert outside_notes([inside]) == []


def test_the_least_thickness_tested_is_told_for_each_threat_that_a_design_is_too_thin_for():
    names = ("7.62 mm AP", "14.5 mm B32")
    threats = [{"projectile": name, "velocity_m_s": 800.0} for name in names]
    case = scenario(threat=threats)
    thin = replace(design("AD85", 6.0, 6.0, 30.0), outside_tests={"ceramic_thickness_ratio": 0.5})
    thinner = replace(design("AD85", 3.0, 6.0, 20.0), outside_tests={"ceramic_thickness_ratio": 0.25})
    assert thin_designs([design("AD85", 8.0, 6.0, 45.0)], case) == []
    lines = thin_designs([thin], case)
    assert [line.partition(" against ")[2] for line in lines] == ["14.5 mm B32 at 800 m/s"]
    assert "0.89 penetrator diameters, here 11 mm, was tested" in lines[0]
    lines = thin_designs([thinner], case)
    assert [line.partition(" against ")[2] for line in lines] == [f"{name} at 800 m/s" for name in names]
    assert thin_designs([thinner], scenario())[0].endswith("limits with less")


def test_a_needed_flow_stress_below_that_of_all_ceramics_is_told_as_such():
    def needed(least: float, likely: float) -> NeededFlowStress:
        return NeededFlowStress("SiC", least, 0.9, likely, (), ())

    assert flow_stress_notes(needed(0.5, 0.6), "x") == [
        "stops x with a flow stress of SiC less than any ceramic of the library has (also for 90 %, with the error "
        "seen on AD85)"
    ]
    assert "less than any ceramic of the library has (9 GPa for 90 %" in flow_stress_notes(needed(0.5, 9.0))[0]
    assert "is 8 GPa or more (9 GPa for 90 %" in flow_stress_notes(needed(8.0, 9.0))[0]
    assert (needed_words(needed(0.5, 9.0)), needed_words(needed(8.0, 9.0))) == ("less than any", "8")


def test_of_threats_that_are_stopped_alike_the_least_margin_stands_first():
    threats = [{"projectile": "7.62 mm AP", "velocity_m_s": velocity} for velocity in (500.0, 600.0)]
    near, far = sorted(check(scenario(threat=threats)).threats, key=lambda threat: threat.velocity_m_s, reverse=True)
    alike = [replace(threat, probability_of_stopping=1.0) for threat in (far, near)]
    assert min(alike, key=standing).velocity_m_s == 600.0


def test_a_probability_that_is_unknown_says_that_the_limit_fails():
    of = scenario("7.62 mm AP", "SiC", "6061-T6", 5.0, 5.0, velocity=900.0, design={"confidence": 0.9})
    found = check(of)
    assert (found.verdict, requirement_table(found).texts()[0][-2:]) == (
        "fails",
        ["unknown, and the limit does not suffice", "FAILS"],
    )


def test_every_metal_that_is_compared_is_named_for_its_kind_of_strength():
    costs = {"thickness_mm": [12.0], "cost_per_kg": 5.0}
    metals = [{"material": name, **costs} for name in ("6061-T6", "ARMOX500")]
    layers = {"ceramic": [{"material": "AD85", **costs}], "backing": metals}
    found = optimise(scenario(velocity=500.0, design={**layers, "minimise": "cost_per_m2"}))
    assert best_of(found).backing == "6061-T6"
    assert any("the yield strength of ARMOX500 is static" in warning for warning in found.warnings)
    assert re.search(r", cost \d+\.\d\d per m²", in_a_line(found))


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
    for tables in (tables_of_check(check(of)), tables_of_design(searched)):
        assert len([line for line in tables if isinstance(line, str) and line.startswith(words)]) == 1
    sections = [
        (section.heading, str((section.paragraphs, section.notes))) for section in scenario_report(of, "").sections
    ]
    assert [heading for heading, notes in sections if words in notes] == ["Threats"]
    assert [heading for heading, notes in sections if "'STANAG4569'" in notes] == ["References"]


def test_the_verdict_stands_before_what_is_not_known_and_without_what_is_met():
    threats = [{"projectile": name, "velocity_m_s": 500.0} for name in ("7.62 mm AP", "7.62 mm APM2")]
    heavy = scenario(
        "7.62 mm AP", "SiC", "6061-T6", 12.0, 6.0, velocity=500.0, design={"areal_density_max_kg_m2": 40.0}
    )
    unknown = check(heavy.replaced({"threat": threats, "design.confidence": 0.8}))
    assert in_a_line(unknown).startswith(
        "FAILS: areal density 54.46 kg/m², at most 40 kg/m² allowed; not known against "
    )
    known = check(heavy.replaced({"armour.ceramic": "AD85", "design.confidence": 0.8}))
    assert known.threats[0].verdict == "passes"
    assert in_a_line(known) == "FAILS: areal density 57.66 kg/m², at most 40 kg/m² allowed"


def test_a_sampled_probability_lies_within_its_interval_as_shown():
    row = Requirement("probability_of_stopping", THREAT, 0.9106, 0.91053, "not known", (0.91039, 0.91068))
    assert requirement_parts(row)[-1] == "91.0 % (91.0 to 91.1 %, sampled)"


def test_a_probability_is_shown_as_exactly_as_it_is_required():
    row = Requirement("probability_of_stopping", THREAT, 0.913, 0.9141, "passes")
    assert requirement_words(row) == "probability of stopping the projectile 91.4 %, at least 91.3 % required"
    assert requirement_parts(replace(row, required=0.9))[-1] == "91 %"


def test_a_pair_outside_the_limits_has_its_nearest_design_and_what_it_exceeds():
    """The lightest design is the nearest to the limit; the pair that is heavier must not vanish."""
    costs = {"thickness_mm": [6.0, 8.0]}
    layers = {
        "ceramic": [{"material": name, **costs} for name in ("AD85", "AD99.5")],
        "backing": [{"material": "6061-T6", "thickness_mm": 6.0}],
    }
    found = optimise(scenario(velocity=900.0, design={**layers, "areal_density_max_kg_m2": 30.0}))
    assert [pair.ceramic for pair in found.pairs] == ["AD85", "AD99.5"]
    words = [row[-1] for row in pair_table(found).texts()]
    assert all(re.fullmatch(r"FAILS: areal density .* at most 30 kg/m² .* required.*", each) for each in words)
    slow = optimise(scenario(velocity=300.0, design={**layers, "areal_density_max_kg_m2": 30.0}))
    assert in_a_line(slow) == (
        "none passes; the nearest: 6 mm AD85 on 6 mm 6061-T6, 37.08 kg/m²; "
        "FAILS: areal density 37.08 kg/m², at most 30 kg/m² allowed"
    )
