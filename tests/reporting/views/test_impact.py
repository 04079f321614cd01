import csv
from io import StringIO
from types import SimpleNamespace
from typing import Any

from armour.analysis.ballistic_limit import Crossing, LimitResult
from armour.analysis.impact import simulate
from armour.core.stages import stage_name
from armour.core.state import Medium, Stage
from armour.reporting.table import csv_text
from armour.reporting.views.impact import STAGES, energy_table, history_table, impact_table, stage_table
from armour.reporting.views.limit import crossing_table, limit_table, tables
from tests.helpers.cases import scenario
from tests.helpers.results import quantities


def test_every_stage_is_described():
    names = {
        stage_name(Stage(medium, eroding, penetrated, False, 1.0, 0.0))
        for medium in Medium
        for eroding in (False, True)
        for penetrated in (False, True)
    }
    assert names == set(STAGES)


def test_an_impact():
    result = simulate(scenario())
    found = quantities(impact_table(result))
    assert found["residual velocity, m/s"] == "277.38"
    assert found["outcome"] == "perforated"
    assert found["duration, µs"] == f"{result.duration_us:.2f}"
    assert found["areal density, kg/m²"] == "39.24"


def test_stages_have_their_losses():
    result = simulate(scenario())
    table = stage_table(result)
    assert [row[0] for row in table.rows] == ["i", "ii.1", "iii.3", "iii.4"]
    assert table.headings()[2:] == ["start, µs", "end, µs", "velocity lost, m/s", "length lost, mm", "energy lost, J"]
    assert table.rows[1][4] == result.stages[1].velocity_lost_m_s


def test_a_history_keeps_every_digit():
    history = simulate(scenario(), history=True).history
    assert history is not None
    rows = list(csv.DictReader(StringIO(csv_text(history_table(history)))))
    assert [float(row["velocity_m_s"]) for row in rows] == history.velocity_m_s.tolist()
    assert rows[0]["stage"] == "i"


def energy(before: float, *rows: tuple[str, float, float]) -> Any:
    """An energy balance: stages with the energy of what eroded and of what braked the rod."""
    stages = [SimpleNamespace(stage=stage, eroded=eroded, braked=braked) for stage, eroded, braked in rows]
    return SimpleNamespace(before=before, rows=stages)


def test_energies_end_in_their_sum():
    table = energy_table(energy(200.0, ("i", 30.0, 20.0), ("iii.3", 0.0, 50.0)))
    assert [row[1:] for row in table.rows] == [
        (30.0, 20.0, 50.0, 25.0),
        (0.0, 50.0, 50.0, 25.0),
        (30.0, 70.0, 100.0, 50.0),
    ]
    assert energy_table(energy(0.0)).rows[-1][1:] == (0, 0, 0, 0.0)


ONE = (Crossing((700.0, 700.01), "perforated"),)
THREE = (*ONE, Crossing((900.0, 900.01), "defeated"), Crossing((950.0, 950.01), "perforated"))


def limit(crossings: tuple[Crossing, ...]) -> LimitResult:
    return LimitResult(700.01, (700.0, 700.01), 46, 39.243, len(crossings) == 1, crossings, 33, (20.0, 4000.0), ())


def test_a_limit():
    assert quantities(limit_table(limit(ONE))) == {
        "ballistic limit, m/s": "700.01",
        "defeated at, m/s": "700.0000",
        "perforated at, m/s": "700.0100",
        "runs": "46",
        "areal density, kg/m²": "39.24",
    }


def test_crossings_are_listed_where_there_are_several():
    scanned = "33 velocities from 20 to 4000 m/s were scanned; "
    error = "the error of the model is not known for such an armour, or not included"
    assert tables(limit(ONE))[1:] == [scanned + "all above the ballistic limit perforate", error]
    changes = scanned + "the outcome changes 3 times"
    assert tables(limit(THREE))[1:] == [changes, crossing_table(limit(THREE)), error]
    assert crossing_table(limit(THREE)).rows[1] == (900.0, 900.01, "defeated")
