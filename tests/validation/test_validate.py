"""Statuses of cases, summaries of tables, and updates of expected values, which keep the file's layout."""

from pathlib import Path

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.reporting.views.validation import suite_junit, suite_tables
from armour.validation.suite import load_suite
from armour.validation.suite_sections import Between, meets
from armour.validation.validate import Check, SuiteResult, kept_by_update, result_of, updated_file, updates_of, validate
from tests.helpers.cases import scenario
from tests.helpers.suites import TABLE, case, load, result
from tests.validation.test_suite import CSV, FILE

LIMIT = ballistic_limit(scenario()).ballistic_limit_m_s
AS_WRITTEN = f"{LIMIT:.8g}"
BANDS = """
reason = "two lots"
rms_band_percent = 20.0
mean_percent = 0.5
mean_band_percent = 5.0
group = [
    { name = "A", where.lot = "A", mean_band_percent = 1.0 },
    { name = "thin", where."armour.backing_thickness_mm" = { below = 7 } },
    { name = "nothing", where.lot = "C" },
]
"""


def the_check(folder: Path, text: str) -> Check:
    [check] = result(folder, text).checks
    return check


@pytest.mark.parametrize(("expected", "status"), [("fails", "outside"), ("passes", "within"), ("not known", "outside")])
def test_a_verdict_is_that_of_a_check(folder: Path, expected: str, status: str):
    required = "set.design.probability_of_stopping = 0.9\nset.impact.velocity_m_s = 500.0"
    text = (
        f'[[case]]\nname = "a"\nscenario = "wilkins.toml"\nquantity = "verdict"\nexpected = "{expected}"\n{required}\n'
    )
    found = the_check(folder, text)
    assert (found.computed, found.status) == ("passes", status)


def test_within_and_outside(folder: Path):
    found = result(folder, case("in", 724.0, "band = 1.0") + case("out", 725.0, "band = 1.0"))
    inside, outside = found.checks
    assert (inside.status, outside.status) == ("within", "outside")
    assert inside.computed == LIMIT
    assert outside.deviation == pytest.approx(LIMIT - 725.0)
    assert outside.deviation_percent == pytest.approx(100.0 * (LIMIT / 725.0 - 1.0))
    assert not found.passed
    assert (found.count("within"), found.count("outside")) == (1, 1)


def test_a_difference_from_a_measured_value(folder: Path):
    """The expected value is a part of the measured one, in per cent, whichever is the greater."""
    for measured in (700.0, 750.0):
        found = the_check(folder, case("a", 3.4, f"band = 0.2\nmeasured = {measured}"))
        assert found.computed == pytest.approx(100.0 * abs(LIMIT / measured - 1.0))
        assert (found.status, found.case.unit, found.deviation_percent) == ("within", "%", None)
        assert found.to_dict()["measured"] == measured
    assert the_check(folder, case("a", 3.4, "band = 0.1\nmeasured = 740.0")).status == "outside"


def test_a_table_of_differences(folder: Path):
    rows = (
        TABLE.replace("720.0", "4.0, 756.0")
        .replace("730.0", "1.0, 730.0")
        .replace('"expected"]', '"expected", "measured"]')
    )
    found = result(folder, rows)
    assert [check.case.measured for check in found.checks] == [756.0, 730.0]
    assert [check.computed for check in found.checks] == pytest.approx([100 * (1 - LIMIT / v) for v in (756.0, 730.0)])
    assert found.summaries[0].unit == "%"


@pytest.mark.parametrize(
    ("expected", "quantity", "rest", "status"),
    [
        (725.0, "ballistic_limit_m_s", "band_percent = 0.2", "within"),
        (725.0, "ballistic_limit_m_s", "band_percent = 0.1", "outside"),
        (1.0, "ballistic_limit_m_s", 'not_scored = "a slip of the print"', "not scored"),
        (724.0, "ballistic_limit_m_s", "band = 1.0\nset.ballistic_limit.velocity_min_m_s = 1000.0", "no answer"),
        ('"perforated"', "outcome", "", "within"),
        ('"stopped"', "outcome", "", "outside"),
    ],
)
def test_a_status(folder: Path, expected: float | str, quantity: str, rest: str, status: str):
    found = result(folder, case("a", expected, rest).replace("ballistic_limit_m_s", quantity))
    assert found.checks[0].status == status
    assert found.passed is (status == "within")
    if status == "no answer":
        assert "lower ballistic_limit.velocity_min_m_s" in found.checks[0].message
        assert found.checks[0].deviation is None


def test_a_table_as_a_whole(folder: Path):
    found = result(folder, TABLE)
    [summary] = found.summaries
    first, second = LIMIT - 720.0, LIMIT - 730.0
    assert (summary.count, summary.unit) == (2, "m/s")
    assert summary.mean == pytest.approx((first + second) / 2)
    assert summary.rms == pytest.approx(((first**2 + second**2) / 2) ** 0.5)
    assert summary.largest == pytest.approx(-second)
    # Its root mean square alone leaves its band.
    assert (summary.status, {check.status for check in found.checks}) == ("outside", {"within"})
    assert not found.passed
    for band, unit, status in (
        ("rms_band = 6.0", "m/s", "within"),
        ("", "m/s", "not scored"),
        ("rms_band_percent = 0.8", "%", "within"),
    ):
        [other] = result(folder, TABLE.replace("rms_band = 5.0", band)).summaries
        assert (other.unit, other.status) == (unit, status)
    assert other.largest == pytest.approx(-second / 7.3)


def test_as_many_as_have_been_checked(folder: Path):
    suite = load(folder, TABLE + case("a", 724.0, "band = 1.0"))
    done: list[Check] = []
    validate(suite, on_check=lambda check, total: done.append(check) if total == 3 else None)
    part = result_of(suite, done[:1])
    assert [summary.count for summary in part.summaries] == [1]
    assert result_of(suite, []).summaries == ()


@pytest.fixture
def of_file(folder: Path) -> SuiteResult:
    """Result of a table whose rows are in a CSV file."""
    (folder / "t.csv").write_text(CSV)
    return result(folder, FILE + BANDS)


def test_every_row_of_a_file_has_its_own_materials_and_values(of_file: SuiteResult):
    cases = [("f: one", 6.35, "AD85"), ("f: two", 7.0, "AD85"), ("f: three", 6.35, "AD99.5")]
    for check, (name, backing, ceramic) in zip(of_file.checks, cases, strict=True):
        assert check.case.full_name == name
        assert check.computed == ballistic_limit(scenario(ceramic=ceramic, backing_mm=backing)).ballistic_limit_m_s
        assert (check.status, check.in_group) == ("not scored", True)


def test_rows_of_a_file_and_groups_are_summarised(of_file: SuiteResult):
    percents = [check.deviation_percent or 0.0 for check in of_file.checks]
    whole, lot, thin = of_file.summaries
    assert (whole.full_name, lot.full_name, thin.full_name) == ("f", "f: A", "f: thin")
    assert (whole.count, lot.count, thin.count) == (3, 1, 2)
    assert whole.mean == pytest.approx(sum(percents) / 3)
    assert whole.unit == "%"
    assert whole.mean_magnitude == pytest.approx(sum(map(abs, percents)) / 3)
    assert thin.mean == pytest.approx((percents[0] + percents[2]) / 2)
    assert [summary.status for summary in of_file.summaries] == ["within", "outside", "not scored"]
    assert (lot.mean_expected, lot.mean_band) == (0.0, 1.0)
    assert (thin.mean_expected, thin.mean_band) == (None, None)
    assert not of_file.passed
    # JUnit XML has the groups and not the rows, and an update keeps the measurements.
    text = suite_junit(of_file, [0.0] * len(of_file.checks), {}).decode()
    assert (text.count("<testcase"), text.count("<failure")) == (2, 1)
    assert "mean band +0 ± 1 %" in text
    assert updates_of(of_file) == []


def test_a_row_of_a_file_may_have_a_band_of_its_own_and_no_answer(folder: Path):
    (folder / "t.csv").write_text(CSV)
    own = result(folder, FILE + "band = 50.0\n")
    assert [check.status for check in own.checks] == ["within", "outside", "within"]
    [table] = [table for table in suite_tables(own) if "not within" in table.title]
    assert [(row[0], row[-1]) for row in table.texts()] == [("two", "outside")]
    narrow = result(folder, FILE + "[table.set.ballistic_limit]\nvelocity_min_m_s = 730.0\n")
    assert (narrow.checks[0].status, narrow.summaries[0].count) == ("no answer", 2)


def test_a_file_has_the_columns_that_calibrate_reads(folder: Path):
    """Other names and units, a title, and conditions on a column of lots that the suite does not list."""
    lines = ["Range 17,,,", "test,Los,Ceramic thickness (mm),V50 (ft/s)", "one,A,6.35,2400", "two,B,6.35,2500"]
    (folder / "t.csv").write_text("\n".join(lines))
    text = FILE.replace('"lot", "kept"', "").replace("kept = 1", 'lot = "A"') + "band = 20.0\n"
    [check] = result(folder, text).checks
    assert (check.case.name, check.status) == ("one", "within")
    assert check.case.expected == pytest.approx(731.52)
    assert len(result(folder, text.replace('where = { lot = "A" }', "")).checks) == 2
    (folder / "t.csv").write_text("\n".join(lines).replace("Ceramic", "Strike face"))
    assert ["not read: Strike face" in warning for warning in result(folder, text).warnings] == [True]


def test_a_bound_is_left_out(folder: Path):
    (folder / "t.csv").write_text("test,V50 (m/s)\none,720\ntwo,above 750\n")
    found = result(folder, FILE.replace("where = { kept = 1 }", "") + "band = 20.0\n")
    assert [check.case.name for check in found.checks] == ["one"]
    assert found.warnings == (f"{folder}/t.csv: 1 bound on ballistic_limit_m_s left out",)


@pytest.mark.parametrize(
    ("condition", "cell", "met"),
    [
        (["A", 3.0], "A", True),
        (["A", 3.0], "3.00", True),
        (["A"], None, False),
        (Between(min=3.0, below=7.0), "3", True),
        (Between(min=3.0, below=7.0), 7.0, False),
        (Between(min=3.0), None, False),
    ],
)
def test_conditions(condition: list[float | str] | Between, cell: float | str | None, met: bool):
    assert meets({} if cell is None else {"a": cell}, {"a": condition}) is met


def test_an_update_writes_what_is_computed_and_nothing_else(folder: Path):
    text = (
        "# kept\nregression = true\n"
        + case("a", 725.0, "band = 1.0  # kept too")
        + case("b", 1.0, 'not_scored = "no"')
        + case("c", '"stopped"', "").replace("ballistic_limit_m_s", "outcome")
        + TABLE
    )
    found = result(folder, text)
    assert [(update.case.full_name, update.case.expected, update.computed) for update in updates_of(found)] == [
        ("t: tile thickness 6.35 mm", 720.0, float(AS_WRITTEN)),
        ("t: tile thickness 6.35 mm", 730.0, float(AS_WRITTEN)),
        ("a", 725.0, float(AS_WRITTEN)),
        ("c", "stopped", "perforated"),
    ]
    changed = updated_file(text.encode(), updates_of(found)).decode()
    for old, new in (("725.0", AS_WRITTEN), ("720.0", AS_WRITTEN), ("6.35, 730.0", f"6.35, {AS_WRITTEN}")):
        text = text.replace(old, new)
    assert changed == text.replace("stopped", "perforated")
    again = result(folder, changed)
    assert updates_of(again) == []
    assert again.passed


def test_a_measurement_is_not_updated(folder: Path):
    """Within its band or not, and whatever the suite says, a value with a source stays; so does one without a mark."""
    within, outside = case("within", 724.0, "band = 1.0"), case("outside", 725.0, "band = 1.0")
    sourced = 'source = "shots"\n'
    for text in (
        within + outside + TABLE,
        f"regression = true\n{within}{sourced}{outside}regression = true\n{sourced}",
        f"{sourced}regression = true\n{outside}",
    ):
        assert updates_of(result(folder, text)) == []
    mixed = result(folder, within + "regression = true\n" + outside)
    assert [update.case.name for update in updates_of(mixed)] == ["within"]
    assert [check.case.name for check in kept_by_update(mixed).checks] == ["outside"]
    tables = kept_by_update(result(folder, TABLE + "regression = true\n"))
    assert (tables.checks, tables.summaries) == ((), ())


def test_an_update_keeps_the_byte_order_mark_and_the_line_ends(folder: Path):
    text = "# \N{MICRO SIGN}\nregression = true\n" + case("a", 725.0, "band = 1.0")
    content = b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode()
    (folder / "suite.toml").write_bytes(content)
    found = validate(load_suite(folder / "suite.toml"))
    assert updated_file(content, updates_of(found)) == content.replace(b"725.0", AS_WRITTEN.encode())


def test_a_suite_without_a_scored_case_fails(folder: Path):
    found = result(folder, case("in", 724.0, 'not_scored = "later"'))
    assert not found.passed
    assert '<failure message="no case is scored">' in suite_junit(found, [0.0], {}).decode()
