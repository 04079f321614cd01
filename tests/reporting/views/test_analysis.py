from dataclasses import replace

import pytest

from armour.analysis.ballistic_limit import Crossing, LimitResult, ballistic_limit, confidence
from armour.analysis.impact import ImpactResult, simulate
from armour.core.stages import stage_name
from armour.core.state import Medium, Stage
from armour.reporting.by_result import in_a_line
from armour.reporting.table import Table
from armour.reporting.views.analysis import STAGES, tables_of_impact, tables_of_limit
from tests.helpers.cases import scenario
from tests.reporting.tables import facts


def test_every_stage_is_described():
    names = {
        stage_name(Stage(medium, eroding, penetrated, False, 1.0, 0.0))
        for medium in Medium
        for eroding in (False, True)
        for penetrated in (False, True)
    }
    assert names == set(STAGES)


def impact(velocity_m_s: float, **changes: object) -> ImpactResult:
    armour = scenario(velocity=velocity_m_s, **changes)
    return simulate(armour).of(confidence=confidence(armour))


def test_an_impact_is_by_the_model_and_its_limit_also_as_expected():
    perforated, stopped = impact(800.0), impact(600.0)
    assert in_a_line(perforated) == "perforated by the model: 277 m/s left of 800 m/s"
    assert in_a_line(stopped) == "stopped by the model: 7.5 mm deep"
    assert facts(tables_of_impact(perforated))["left"] == (
        "14.6 mm and 3.81 g; plug 277 m/s; bulge 3.5 mm, after 39 µs"
    )
    assert facts(tables_of_impact(stopped))["limit"] == (
        "724 m/s by the model; 715 m/s expected, stops a shot with 97 %"
    )


@pytest.mark.parametrize(("velocity_m_s", "contradicted"), [(710.0, False), (720.0, True), (730.0, False)])
def test_an_expectation_that_contradicts_the_model_is_marked(velocity_m_s: float, contradicted: bool):
    """The limit is 724 m/s by the model and 715 m/s expected: they differ about 720 m/s alone."""
    assert (", but 715 m/s expected" in facts(tables_of_impact(impact(velocity_m_s)))["limit"]) == contradicted


def test_all_that_a_probability_rests_on_is_shown_at_length():
    known = impact(800.0)
    short, long = tables_of_impact(known), tables_of_impact(known.of(every_row=True))
    assert long[: len(short)] == short
    words = "\n".join(map(str, long[len(short) :]))
    for said in (
        "39.2 kg/m²",
        "12.7 mm below the front face",
        "from 13 tests",
        "V50 exceeds 800 m/s with 7 %",
        "2.5 %",
    ):
        assert said in words
    unknown = impact(800.0, ceramic="SiC").of(every_row=True)
    assert facts(tables_of_impact(unknown))["limit"] == "938 m/s by the model; no test of SiC on metal is known"


ONE = (Crossing((700.0, 700.01), "perforated"),)
THREE = (*ONE, Crossing((900.0, 900.01), "stopped"), Crossing((950.0, 950.01), "perforated"))


def limit(crossings: tuple[Crossing, ...]) -> LimitResult:
    return LimitResult(700.01, (700.0, 700.01), 46, 39.243, len(crossings) == 1, crossings, 33, (20.0, 4000.0), ())


def test_crossings_are_listed_where_there_are_several():
    assert [table for table in tables_of_limit(limit(ONE))[2:] if isinstance(table, Table)] == []
    line, table = tables_of_limit(limit(THREE))[-2:]
    assert line == "the outcome changes 3 times"
    assert isinstance(table, Table)
    assert table.rows[1] == (900.01, "stopped")
    scanned = "33 velocities from 20 to 4000 m/s were scanned; bracket width 0.01 m/s"
    assert tables_of_limit(limit(ONE).of(every_row=True))[-1] == scanned


def test_a_limit_names_its_tests_and_those_of_the_very_armour():
    known, other = ballistic_limit(scenario()), ballistic_limit(scenario(ceramic_mm=6.0))
    assert in_a_line(known) == "724 m/s by the model; 715 m/s expected (95 % between 614 and 839 m/s)"
    title = "13 of AD85 on 6061-T6 against the 7.62 mm AP (Wilkins)"
    assert facts(tables_of_limit(known))["tests"] == f"{title}; 1 of this very armour: 703 m/s"
    assert facts(tables_of_limit(other))["tests"] == title
    untested = ballistic_limit(scenario(ceramic="SiC"))
    assert in_a_line(untested) == "938 m/s by the model"
    assert facts(tables_of_limit(untested))["tests"] == "not known: no test of SiC on metal is known"


def test_an_existing_plate_is_weighed_apart():
    hull = ballistic_limit(scenario(design={"existing": "backing"}))
    weight = f"({hull.whole_areal_density_kg_m2:.1f} kg/m² with the existing plate)"
    assert facts(tables_of_limit(hull))["armour"].endswith(weight)
    alone = replace(hull, whole_areal_density_kg_m2=hull.areal_density_kg_m2)
    assert "existing" not in facts(tables_of_limit(alone))["armour"]
