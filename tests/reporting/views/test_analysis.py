from dataclasses import fields

from armour.analysis.ballistic_limit import Crossing, LimitResult
from armour.analysis.impact import ImpactResult, simulate
from armour.core.stages import stage_name
from armour.core.state import Medium, Stage
from armour.reporting.table import Table
from armour.reporting.views.analysis import STAGES, crossing_table, tables_of_impact, tables_of_limit
from tests.helpers.cases import scenario


def test_every_stage_is_described():
    names = {
        stage_name(Stage(medium, eroding, penetrated, False, 1.0, 0.0))
        for medium in Medium
        for eroding in (False, True)
        for penetrated in (False, True)
    }
    assert names == set(STAGES)


def test_every_number_of_an_impact_is_shown():
    """In the table or, as the velocities, in the first lines."""
    numbers = {field.name for field in fields(ImpactResult) if field.type is float}
    said = {"impact_velocity_m_s", "residual_velocity_m_s"}
    hull = scenario(design={"existing": "backing"})  # so that the areal densities differ
    record, _ = (table for table in tables_of_impact(simulate(hull)) if isinstance(table, Table))
    assert {column.key for column in record.columns} == numbers - said


ONE = (Crossing((700.0, 700.01), "perforated"),)
THREE = (*ONE, Crossing((900.0, 900.01), "stopped"), Crossing((950.0, 950.01), "perforated"))


def limit(crossings: tuple[Crossing, ...]) -> LimitResult:
    return LimitResult(700.01, (700.0, 700.01), 46, 39.243, len(crossings) == 1, crossings, 33, (20.0, 4000.0), ())


def test_crossings_are_listed_where_there_are_several():
    scanned, width = "33 velocities from 20 to 4000 m/s were scanned, ", "; bracket width 0.01 m/s"
    error = "model error: unknown for such an armour, or not included"
    assert tables_of_limit(limit(ONE))[1:] == [error, f"{scanned}all above the limit perforate{width}"]
    changes = f"{scanned}the outcome changes 3 times{width}"
    assert tables_of_limit(limit(THREE))[1:] == [error, changes, crossing_table(limit(THREE))]
    assert crossing_table(limit(THREE)).rows[1] == (900.01, "stopped")
