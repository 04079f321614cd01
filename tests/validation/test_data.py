"""Tables of a suite whose rows are in a CSV file."""

from pathlib import Path

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.errors import InputError
from armour.reporting.views.suite import junit, suite_tables
from armour.validation.suite import Condition, load_suite
from armour.validation.validate import SuiteResult, updates_of
from tests.helpers.cases import scenario
from tests.helpers.suites import load, result

CSV = """test,armour.ceramic,armour.backing_thickness_mm,ballistic_limit_m_s,lot,kept
one,AD85,6.35,700,A,1
two,AD85,7.0,800,B,1
three,AD99.5,6.35,800,B,1
four,AD99.5,,800,B,0
"""
SUITE = """
notes = ["lot", "kept"]
[[table]]
name = "t"
scenario = "wilkins.toml"
quantity = "ballistic_limit_m_s"
file = "t.csv"
where = { kept = 1 }
rms_band_percent = 20.0
mean_percent = 0.5
mean_band_percent = 5.0
group = [
    { name = "A", where.lot = "A", mean_band_percent = 1.0 },
    { name = "thin", where."armour.backing_thickness_mm" = { below = 7 } },
    { name = "nothing", where.lot = "C" },
]
"""


@pytest.fixture
def found(folder: Path) -> SuiteResult:
    (folder / "t.csv").write_text(CSV)
    return result(folder, SUITE)


def mistakes(folder: Path, suite: str, table: str = CSV) -> list[str]:
    (folder / "t.csv").write_text(table)
    with pytest.raises(InputError) as error:
        load(folder, suite)
    return [str(problem) for problem in error.value.problems]


def test_every_row_has_its_own_materials_and_values(found: SuiteResult):
    cases = [(6.35, "AD85"), (7.0, "AD85"), (6.35, "AD99.5")]
    assert [check.case.full_name for check in found.checks] == ["t: one", "t: two", "t: three"]
    for check, (backing, ceramic) in zip(found.checks, cases, strict=True):
        assert check.computed == ballistic_limit(scenario(ceramic=ceramic, backing_mm=backing)).ballistic_limit_m_s
        assert (check.status, check.in_group) == ("not scored", True)


def test_rows_and_groups_are_summarised(found: SuiteResult):
    percents = [check.deviation_percent or 0.0 for check in found.checks]
    whole, lot, thin = found.summaries
    assert (whole.full_name, lot.full_name, thin.full_name) == ("t", "t: A", "t: thin")
    assert (whole.count, lot.count, thin.count) == (3, 1, 2)
    assert whole.mean == pytest.approx(sum(percents) / 3)
    assert whole.unit == "%"
    assert whole.mean_magnitude == pytest.approx(sum(map(abs, percents)) / 3)
    assert thin.mean == pytest.approx((percents[0] + percents[2]) / 2)
    assert [summary.status for summary in found.summaries] == ["within", "outside", "not scored"]
    assert (lot.mean_expected, lot.mean_band) == (0.0, 1.0)
    assert (thin.mean_expected, thin.mean_band) == (None, None)
    assert not found.passed


def test_ci_is_told_of_groups_and_not_of_rows(found: SuiteResult):
    text = junit(found, 0.0).decode()
    assert (text.count("<testcase"), text.count("<failure")) == (2, 1)
    assert "mean band +0 ± 1 %" in text


def test_a_part_of_the_rows_is_not_held_to_bands(folder: Path):
    (folder / "t.csv").write_text(CSV)
    part = load(folder, SUITE).only("two")
    assert [case.name for case in part.cases] == ["two"]
    [table] = part.tables
    assert (table.group, table.rms_band_percent, table.mean_band_percent) == ([], None, None)
    assert load(folder, SUITE).only("t:").tables[0].group


def test_measurements_in_files_are_not_updated(found: SuiteResult):
    assert updates_of(found) == []


def test_a_row_may_have_a_band_of_its_own(folder: Path):
    (folder / "t.csv").write_text(CSV)
    own = result(folder, SUITE.replace("rms_band_percent", "band = 50.0\nrms_band_percent")).checks
    assert [check.status for check in own] == ["within", "outside", "within"]


def test_the_rows_outside_their_bands_are_named(folder: Path):
    (folder / "t.csv").write_text(CSV)
    found = result(folder, SUITE.replace("rms_band_percent", "band = 50.0\nrms_band_percent"))
    [table] = [table for table in suite_tables(found) if "not within" in table.title]
    assert [(row[0], row[-1]) for row in table.texts()] == [("two", "outside")]


def test_a_row_without_an_answer_fails(folder: Path):
    (folder / "t.csv").write_text(CSV)
    found = result(folder, SUITE + "[table.set.ballistic_limit]\nvelocity_min_m_s = 730.0\n")
    assert found.checks[0].status == "no answer"
    assert found.summaries[0].count == 2


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('file = "t.csv"', "band = 1.0", "suite.toml: table[0]: must have a file with where"),
        ("where = { kept = 1 }", 'rivals = ["x"]', "suite.toml: table[0]: must not have rivals with a file"),
        ("ballistic_limit_m_s", "penetration_depth_mm", "suite.toml: table[0]: quantity must be one of"),
        ('"lot", ', "", "t.csv: lot: unknown column"),
        ("kept = 1", "kept = 2", "t.csv: must have tests with ballistic_limit_m_s and kept"),
        ("kept = 1", "kept = { max = 2 }", "suite.toml: table[0].where.kept: must be a text, a number, a list of them"),
        ("wilkins.toml", "no.toml", "no.toml: cannot be read"),
    ],
)
def test_mistakes(folder: Path, old: str, new: str, expected: str):
    first, *_ = mistakes(folder, SUITE.replace(old, new))
    assert expected in first


def test_mistakes_in_the_file_are_all_told(folder: Path):
    lines = mistakes(folder, SUITE, CSV.replace("6.35", "x").replace("AD99.5,,", "AD9,,"))
    assert [line.rsplit("t.csv: ")[1].split(":")[0] for line in lines] == ["line 2", "line 4", "line 5"]


@pytest.mark.parametrize(
    ("condition", "cell", "met"),
    [
        (Condition(("A", 3.0)), "A", True),
        (Condition(("A", 3.0)), "3.00", True),
        (Condition(("A", 3.0)), "B", False),
        (Condition(("A",)), None, False),
        (Condition((), 3.0, 7.0), "3", True),
        (Condition((), 3.0, 7.0), 7.0, False),
        (Condition((), 3.0), "x", False),
        (Condition((), 3.0), None, False),
    ],
)
def test_conditions(condition: Condition, cell: float | str | None, met: bool):
    assert condition.met(cell) is met


def test_shipped_suites_go_by_name(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(folder)
    assert load_suite("paper").file.name == "paper.toml"
    with pytest.raises(
        InputError, match=r"plate: cannot be read.*did you mean \"plates\"\?; shipped are paper, plates"
    ):
        load_suite("plate")
    (folder / "plates").write_text("")
    with pytest.raises(InputError, match="plates: case: is missing"):
        load_suite("plates")
