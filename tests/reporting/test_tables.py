import csv
from io import StringIO

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.impact import simulate
from armour.analysis.least_thickness import Design
from armour.core.stages import stage_name
from armour.core.state import Medium, Stage
from armour.reporting.tables import (
    STAGE_COLUMNS,
    STAGES,
    entry_rows,
    frontier_csv,
    history_csv,
    impact_rows,
    library_table,
    limit_rows,
    stage_rows,
)
from armour.scenario.library import shipped_library
from tests.cases import scenario


def test_every_stage_is_described():
    names = {
        stage_name(Stage(medium, eroding, penetrated, False, 1.0, 0.0))
        for medium in Medium
        for eroding in (False, True)
        for penetrated in (False, True)
    }
    assert names == set(STAGES)


def test_rows_of_an_impact():
    result = simulate(scenario())
    rows = {name: (number, unit) for name, number, unit in impact_rows(result)}
    assert rows["residual velocity"] == ("277.38", "m/s")
    assert rows["outcome"] == ("perforated", "")
    assert all(len(row) == len(STAGE_COLUMNS) for row in stage_rows(result))


def test_rows_of_a_limit():
    rows = {name: number for name, number, _ in limit_rows(ballistic_limit(scenario()))}
    assert rows["ballistic limit"] == "723.77"


def test_the_history_as_a_file_keeps_every_digit():
    history = simulate(scenario(), history=True).history
    assert history is not None
    rows = list(csv.DictReader(StringIO(history_csv(history))))
    assert [float(row["velocity_m_s"]) for row in rows] == history.velocity_m_s.tolist()
    assert rows[0]["stage"] == "i"


def test_the_frontier_as_a_file():
    text = frontier_csv([Design(10.3, 7.0, 54.579)])
    assert text == "ceramic_thickness_mm,backing_thickness_mm,areal_density_kg_m2\n10.3,7.0,54.579\n"


def test_tables_of_the_library():
    columns, rows = library_table(shipped_library(), "ceramic")
    assert columns == ("ceramic", "density kg m3", "youngs modulus GPa", "flow stress GPa", "description")
    assert ("AD85", "3430", "267", "5.2", "alumina, 85 %") in rows
    columns, rows = library_table(shipped_library(), "metal")
    assert dict(zip(columns, rows[-1], strict=True))["strain to fracture"] == "0.1"
    [entry] = shipped_library().find("AD85")
    assert ("flow_stress_GPa", "5.2", "fitted", "the paper, table 2, to Wilkins' ballistic limits") in entry_rows(entry)
