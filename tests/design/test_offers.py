"""Tables of offers: each row is checked as the scenario with its armour, and costs its price."""

from pathlib import Path
from typing import Any

import pytest

from armour.design.check import CheckResults, check
from armour.errors import InputError
from tests.helpers.cases import csv_file, scenario

REQUIRED = {"probability_of_stopping": 0.9}
OFFER: dict[str, object] = {
    "ceramic": "AD85",
    "ceramic thickness (mm)": 8.0,
    "metal": "5083-H3",
    "metal thickness (mm)": 10.0,
}
SAME = scenario(velocity=700.0, ceramic_mm=8.0, backing="5083-H3", backing_mm=10.0, design=REQUIRED)


def checked(*rows: dict[str, object], keep: Any = (), **design: Any) -> CheckResults:
    return check(scenario(velocity=700.0, design={**REQUIRED, **design}), cases=rows, keep=keep)


@pytest.mark.parametrize(
    "offers",
    [
        [OFFER],
        {key: [value] for key, value in OFFER.items()},
        [{"Tile": "AD85", "Tile thickness (in)": 8.0 / 25.4, "plate": "5083-H3", "plate thickness (cm)": 1}],
        [{"Kachel": "AD85", "Kacheldicke [mm]": 8, "Platte": "5083-H3", "Plattendicke [mm]": "10"}],
        [{"carreau": "AD85", "épaisseur du carreau (mm)": 8, "plaque": "5083-H3", "épaisseur plaque (mm)": 10}],
        [{"armour.ceramic_thickness_mm": 8.0, "armour.backing": "5083-H3", "armour.backing_thickness_mm": 10.0}],
    ],
    ids=["rows", "columns", "in inches", "German", "French", "keys"],
)
def test_an_offer_is_checked_as_the_scenario_with_its_armour(offers: Any):
    [found] = check(scenario(velocity=700.0, design=REQUIRED), cases=offers)
    [threat], [expected] = found.threats, check(SAME).threats
    assert found.verdict == "passes"
    assert threat.probability_of_stopping == pytest.approx(expected.probability_of_stopping, rel=1e-9)
    assert threat.ballistic_limit_m_s == pytest.approx(expected.ballistic_limit_m_s, rel=1e-12)
    assert (threat.what_ifs, found.cost_per_m2) == ((), None)


def test_a_layer_without_a_column_is_that_of_the_scenario():
    [thin, thick] = checked({"plate thickness (mm)": 6}, {"plate thickness (mm)": 12})
    assert [each.question["scenario"].armour_words() for each in (thin, thick)] == [
        "6.35 mm AD85 on 6 mm 6061-T6",
        "6.35 mm AD85 on 12 mm 6061-T6",
    ]


@pytest.mark.parametrize("blank", [{}, {"ceramic": "", "ceramic thickness (mm)": 0.0}, {"ceramic": None}])
def test_an_offer_without_a_tile_is_a_bare_plate(blank: dict[str, object]):
    bare = {"metal": "HHA Class 1", "metal thickness (mm)": 9.0, **blank}
    [_, found] = checked(OFFER, bare)
    assert found.question["scenario"].armour_words() == "9 mm HHA Class 1"
    alone = check(
        scenario(ceramic=None, ceramic_mm=0.0, backing="HHA Class 1", backing_mm=9.0, velocity=700.0, design=REQUIRED)
    )
    assert (found.verdict, found.threats[0].ballistic_limit_m_s) == ("fails", alone.threats[0].ballistic_limit_m_s)


def test_the_price_is_the_cost_of_the_armour(tmp_path: Path):
    rows = ("metal;metal thickness (mm);Preis (EUR/m2)", "5083-H3;12;1.450", "5083-H3;12;520,5", "5083-H3;12;")
    table = csv_file(tmp_path / "offers.csv", *rows)
    found = check(scenario(velocity=700.0, ceramic_mm=8.0, design={"cost_max_per_m2": 600.0}), cases=table)
    assert [each.cost_per_m2 for each in found] == [1450.0, 520.5, None]
    assert [each.verdict for each in found] == ["fails", "expected to stop", "not known"]


def test_without_prices_the_cost_is_that_by_the_scenario():
    costs = {
        "ceramic": [{"material": "AD85", "thickness_mm": [6.0], "cost_per_kg": 10.0}],
        "backing": [{"material": "5083-H3", "thickness_mm": [6.0], "cost_per_kg": 5.0}],
    }
    [found] = checked(OFFER, **costs)
    assert found.cost_per_m2 == scenario(ceramic_mm=8.0, backing="5083-H3", backing_mm=10.0, design=costs).cost_per_m2()
    assert found.cost_per_m2 is not None


def test_labels_are_kept_in_the_order_of_the_table():
    rows = [{**OFFER, "offer": "B", "price": 400, "lead time": "6 weeks"}, {**OFFER, "offer": "A", "price": 300}]
    found = checked(*rows, keep=["offer", "lead time", "price"])
    assert [each.question["name"] for each in found] == ["B", "A"]
    first, second = found.rows()
    assert [*first.items()][:3] == [("offer", "B"), ("lead time", "6 weeks"), ("price", "400")]
    assert (second["lead time"], second["cost_per_m2"], second["verdict"]) == ("", 300.0, "passes")
    assert [each.question["name"] for each in checked(*rows)] == ["row 1", "row 2"]


def test_a_label_does_not_hide_what_is_computed():
    [row] = checked({**OFFER, "verdict": "we pass"}, keep="verdict").rows()
    assert (row["verdict (offer)"], row["verdict"]) == ("we pass", "passes")


def test_of_several_threats_the_one_that_decides_is_in_the_row():
    threats = [{"projectile": "7.62 mm AP", "velocity_m_s": speed, "name": f"{speed:g}"} for speed in (500.0, 1200.0)]
    [found] = check(scenario(threat=threats, design=REQUIRED), cases=[OFFER])
    [row] = CheckResults([found]).rows()
    assert (row["threat"], row["verdict"], row["probability_of_stopping"]) == (
        "1200",
        "fails",
        found.threats[1].probability_of_stopping,
    )


def test_every_mistake_of_a_table_is_told_with_its_row_and_column(tmp_path: Path):
    table = [
        "Angebot;Kachel;Kacheldicke [mm];Platte;Plattendicke [mm];Preis",
        "A;AD86;8,5;6061-T7;x;330",
        "B;;3;6061-T6;6;-5",
        "C;SiC;;;6000;330",
    ]
    with pytest.raises(InputError) as error:
        check(scenario(), cases=csv_file(tmp_path / "offers.csv", *table), keep="Angebot")
    told = [f"{problem.key}: {problem.message}".partition(";")[0] for problem in error.value.problems]
    assert told == [
        'line 2: Plattendicke [mm]: must be a number, found "x"',
        'line 2: Kachel: must name a ceramic of the library, found "AD86"',
        'line 2: Platte: must name a metal of the library, found "6061-T7"',
        'line 3: Kachel: must be a name, found ""',
        "line 3: Preis: must be at least 0, found -5",
        'line 4: Kacheldicke [mm]: must be a number, found ""',
        'line 4: Platte: must be a name, found ""',
        "line 4: Plattendicke [mm]: must be at most 1000, found 6000.0",
    ]


@pytest.mark.parametrize(
    ("header", "found"),
    [
        ("ceramic,metal thickness (mm)", 'ceramic: must have its thickness in another column, such as "ceramic thickn'),
        ("metal,plate,metal thickness (mm)", "plate: must not be given with metal, which names the metal too"),
        ("price,colour", "must have the thickness of a layer in a column, such as ceramic, ceramic thickness"),
        ("metal thickness", 'metal thickness: must have its unit, as "metal thickness (mm)" or "metal thickness (in)"'),
        ("metal thickness (mm)", 'keep: must name a column, found "offer"; choose from metal thickness (mm)'),
    ],
)
def test_wrong_columns(tmp_path: Path, header: str, found: str):
    table = csv_file(tmp_path / "offers.csv", header, ",".join("1" for _ in header.split(",")))
    with pytest.raises(InputError) as error:
        check(scenario(), cases=table, keep=["offer"] * ("keep" in found))
    assert found in str(error.value)


def test_the_plate_of_an_offer_for_a_hull_is_the_one_that_exists():
    with pytest.raises(InputError, match=r"must be the plate of \[armour\], as design\.existing says that it exists"):
        checked(OFFER, existing="backing")
    own = {"metal": "6061-T6", "metal thickness (mm)": scenario().armour.backing_thickness_mm}
    assert len(checked({**OFFER, **own}, existing="backing")) == 1
