import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from armour.errors import InputError
from armour.statistics.measured import read_tests
from tests.helpers.cases import csv_file, scenario, shipped_scenario
from tests.helpers.fits import table_of

C, B, V = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm", "impact.velocity_m_s"


def test_measurements_and_bounds(tmp_path: Path):
    rows = ["a,6,,700,,", "b,7,800,,250,perforated", "c,9,810,,,stopped"]
    path = csv_file(tmp_path / "t.csv", f"test,{C},{V},ballistic_limit_m_s,residual_velocity_m_s,outcome", *rows)
    tests = read_tests(str(path), shipped_scenario("wilkins"))
    assert tests.names == ("a", "b", "c")
    assert not tests.weighted
    assert [(m.test, m.quantity, m.value, m.side) for m in tests.measurements] == [
        (0, "ballistic_limit_m_s", 700.0, 0),
        (1, "residual_velocity_m_s", 250.0, 0),
        (2, "ballistic_limit_m_s", 810.0, 1),
    ]
    [group] = tests.groups
    assert group.columns[C].tolist() == [6.0, 7.0, 9.0]
    assert group.columns[V].tolist() == [800.0, 800.0, 810.0]


def test_tests_are_grouped_by_material(tmp_path: Path):
    path = csv_file(
        tmp_path / "t.csv", f"armour.ceramic,{C},ballistic_limit_m_s", "AD85,6,700", "AD99.5,6,720", "AD85,7,730"
    )
    tests = read_tests(path, shipped_scenario("wilkins"))
    assert [(group.scenario.armour.ceramic, group.where.tolist()) for group in tests.groups] == [
        ("AD85", [0, 2]),
        ("AD99.5", [1]),
    ]


LIMIT, OUTCOME, UNCERTAINTY = "ballistic_limit_m_s", f"{C},{V},outcome", "ballistic_limit_uncertainty_m_s"
USUAL = (LIMIT, "residual_velocity_m_s", "residual_mass_g", "outcome", "test", C)
EVERY = "uncertainties must be given for every measurement and outcome, or for none"


@pytest.mark.parametrize(
    ("header", "rows", "message"),
    [
        (
            f"{C},armour.x,{LIMIT}",
            "6,1,700",
            f"rows: armour.x: unknown column; choose from {', '.join(USUAL)} and other",
        ),
        (OUTCOME, "6,700,maybe", 'row 1: outcome: must be "stopped" or "perforated" (or partial or complete, P or C'),
        (f"{C},outcome", "6,stopped", "row 1: impact.velocity_m_s: is missing and must be given with an outcome"),
        (f"{OUTCOME},residual_velocity_m_s", "6,700,stopped,50", "must not be stopped if there is a residual"),
        (f"{C},{V},residual_velocity_m_s", "6,700,0", "a projectile that is stopped is an outcome"),
        (f"test,{C},{LIMIT}", "a,6,700 a,6,710", 'row 1: test: must name one test, found "a"'),
        (f"{C},{LIMIT}", "6,700 -1,710", "rows: row 2: armour.ceramic_thickness_mm: must be at least 0, found -1"),
        (f"{C},{LIMIT}", "6,700 6,700", "row 2: repeats row 1"),
        (f"{B},{LIMIT}", "6,700 ,710", f"{B}: must be filled in every row that counts, found blank cells in row 2"),
        (
            f"armour.ceramic,{C},{LIMIT}",
            "AD85,6,700 AD85,,710",
            f"{C}: must be filled in every row that counts, found blank cells in row 2",
        ),
        (
            f"armour.ceramic,{C},{LIMIT}",
            "AD85,6,700 ,7,710",
            "armour.ceramic: must be filled in every row that counts, found blank cells in row 2",
        ),
        (f"{C},{LIMIT},{UNCERTAINTY}", "6,700,5 7,710,", EVERY),
        (f"{OUTCOME},{LIMIT},{UNCERTAINTY}", "6,,,700,5 6,750,stopped,,", EVERY),
        (f"{C},{LIMIT}", "6,1e-300 7,700", "row 1: ballistic_limit_m_s: must be at least 0.001"),
        (f"impact.projectile,{LIMIT}", "xx,7 yy,8", "row 2: impact.projectile: must name a projectile of the library"),
    ],
)
def test_wrong_tests(header: str, rows: str, message: str):
    with pytest.raises(InputError) as error:
        table_of(shipped_scenario("wilkins"), header, *rows.split())
    assert message in str(error.value)


def test_all_mistakes_at_once(tmp_path: Path):
    rows = ["6,x,7.62 mm AP", "-1,800,", "7,700,xx", "-3,-4,7.62 mm AP", "-5,,7.62 mm AP"]
    path = csv_file(tmp_path / "t.csv", f"{C},ballistic_limit_m_s,impact.projectile", *rows)
    with pytest.raises(InputError) as error:
        read_tests(path, shipped_scenario("wilkins"))
    assert sorted(str(problem).removeprefix(f"{path}: ").split(" must ")[0] for problem in error.value.problems) == [
        "impact.projectile:",
        "line 2: ballistic_limit_m_s:",
        f"line 3: {C}:",
        "line 4: impact.projectile:",
        f"line 5: {C}:",
        "line 5: ballistic_limit_m_s:",
        "line 6:",
        f"line 6: {C}:",
    ]


ROWS: list[dict[str, Any]] = [
    {"test": "a", "armour.ceramic_thickness_mm": 4.06, "ballistic_limit_m_s": 619, "armour.ceramic": "AD85"},
    {"test": "b", "armour.ceramic_thickness_mm": 6.35, "ballistic_limit_m_s": float("nan"), "outcome": "stopped"}
    | {"impact.velocity_m_s": 600.0, "armour.ceramic": "AD85"},
]


class Frame(dict[str, list[Any]]):
    """What a table of pandas and one of polars have in common."""

    @property
    def columns(self) -> list[str]:
        return list(self)


def test_rows_are_read_as_a_file_is(tmp_path: Path):
    case = scenario()
    names = list(dict.fromkeys(name for row in ROWS for name in row))
    frame = Frame({name: [row.get(name) for row in ROWS] for name in names})
    cells = (",".join(str(row.get(name)) for name in names) for row in ROWS)
    lines = (line.replace("None", "").replace("nan", "") for line in cells)
    text = csv_file(tmp_path / "t.csv", ",".join(names), *lines)
    read = [read_tests(rows, case) for rows in (ROWS, frame, text)]
    assert read[0].measurements == read[1].measurements == read[2].measurements
    assert read[0].cells == read[1].cells == read[2].cells
    assert read[0].scenario == case
    assert repr(read[0]) == "<Tests: 2 tests of rows, 2 measurements>"
    assert len(read_tests("tests/wilkins", case).names) == 13


def test_tests_are_a_table(monkeypatch: pytest.MonkeyPatch):
    tests = read_tests(ROWS, scenario())
    rows: list[dict[str, float | str | None]] = list(tests)
    shot = {"ballistic_limit_m_s": None, "outcome": "stopped", "impact.velocity_m_s": 600.0}
    same = {"armour.ceramic_thickness_mm": 6.35, "armour.ceramic": "AD85"}
    assert rows[1] == {"test": "b", **same, **shot}
    assert [[*row] for row in rows] == [[*rows[0]]] * 2
    assert tests == read_tests(rows, scenario())
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=dict))
    frame = tests.to_dataframe()
    assert (frame["test"], frame["ballistic_limit_m_s"]) == (["a", "b"], [619.0, None])


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([{**ROWS[0], LIMIT: "x"}], 'rows: row 1: ballistic_limit_m_s: must be a number, found "x"'),
        ([{**ROWS[0], "armour.backing_thicknes_mm": 6}], "armour.backing_thicknes_mm: unknown column; did you mean"),
        ([], "rows: must have a header, found an empty file"),
        (5, "rows: must be a path, rows as mappings, columns of equal length, or a data frame"),
        ([1, 2], "rows: must be a path, rows as mappings, columns of equal length, or a data frame"),
    ],
)
def test_wrong_rows(rows: Any, message: str):
    with pytest.raises(InputError, match=message):
        read_tests(rows, scenario())


@pytest.mark.parametrize(
    ("header", "rows"),
    [
        (f"armour.ceramic,{C},{LIMIT}", "SiC,8,700 ,,300"),
        (f"armour.ceramic,{C},{LIMIT}", "SiC,8,700 ,0,300"),
        (f"armour.ceramic,{C},{LIMIT}", "SiC,8,700 AD85,0,300"),
        (f"armour.ceramic,{LIMIT}", "SiC,700 ,300"),
        (f"{C},{LIMIT}", "8,700 ,300"),
        (f"{C},ceramic.flow_stress_GPa,{LIMIT}", "8,5,700 ,,300"),
    ],
)
def test_a_row_without_a_ceramic_is_a_bare_plate(header: str, rows: str):
    [group] = table_of(scenario(ceramic="SiC", ceramic_mm=8.0), header, *rows.split()).groups
    assert (group.scenario.armour.ceramic, group.where.tolist()) == ("SiC", [0, 1])
    assert group.variants().ceramics_mm.tolist() == pytest.approx([8.0, 0.0])
