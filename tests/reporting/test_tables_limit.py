from armour.analysis.ballistic_limit import Crossing, LimitResult
from armour.reporting.tables.limit import crossing_table, limit_table, limit_tables
from tests.helpers.results import quantities

ONE = (Crossing((700.0, 700.01), "perforated"),)
THREE = (*ONE, Crossing((900.0, 900.01), "defeated"), Crossing((950.0, 950.01), "perforated"))


def limit(crossings: tuple[Crossing, ...]) -> LimitResult:
    return LimitResult(700.01, (700.0, 700.01), 46, 39.243, len(crossings) == 1, crossings, ())


def test_a_limit():
    assert quantities(limit_table(limit(ONE))) == {
        "ballistic limit, m/s": "700.01",
        "defeated at, m/s": "700.0000",
        "perforated at, m/s": "700.0100",
        "runs": "46",
        "areal density, kg/m²": "39.24",
    }


def test_crossings_are_listed_where_there_are_several():
    assert len(limit_tables(limit(ONE))) == 1
    assert limit_tables(limit(THREE))[1] == crossing_table(limit(THREE))
    assert crossing_table(limit(THREE)).rows[1] == (900.0, 900.01, "defeated")
