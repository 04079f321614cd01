"""Updates of a suite's expected values keep the file's layout."""

from pathlib import Path

from armour.analysis.ballistic_limit import ballistic_limit
from armour.validation.suite import load_suite
from armour.validation.validate import kept_by_update, updated_file, updates_of, validate
from tests.helpers.cases import scenario
from tests.helpers.suites import TABLE, case, result


def test_an_update_writes_what_is_computed_and_nothing_else(folder: Path):
    text = (
        "# kept\nregression = true\n"
        + case("a", 725.0, "band = 1.0  # kept too")
        + case("b", 1.0, 'not_scored = "no"')
        + TABLE
    )
    found = result(folder, text)
    new = float(f"{ballistic_limit(scenario()).ballistic_limit_m_s:.8g}")
    assert [(update.case.full_name, update.case.expected, update.expected) for update in updates_of(found)] == [
        ("t: ceramic thickness 6.35 mm", 720.0, new),
        ("t: ceramic thickness 6.35 mm", 730.0, new),
        ("a", 725.0, new),
    ]
    changed = updated_file(text.encode(), updates_of(found)).decode()
    expected = text.replace("725.0", str(new)).replace("720.0", str(new)).replace("6.35, 730.0", f"6.35, {new}")
    assert changed == expected
    again = result(folder, changed)
    assert updates_of(again) == []
    assert again.passed


def test_a_measurement_is_not_updated(folder: Path):
    """Within its band or not, and whatever the suite says, a value with a source stays; so does one without a mark."""
    within, outside = case("within", 724.0, "band = 1.0"), case("outside", 725.0, "band = 1.0")
    assert updates_of(result(folder, within + outside + TABLE)) == []
    published = (
        "regression = true\n" + within + 'source = "shots"\n' + outside + 'regression = true\nsource = "shots"\n'
    )
    assert updates_of(result(folder, published)) == []
    assert updates_of(result(folder, 'source = "shots"\nregression = true\n' + outside)) == []
    mixed = result(folder, within + "regression = true\n" + outside)
    assert [update.case.name for update in updates_of(mixed)] == ["within"]
    assert [check.case.name for check in kept_by_update(mixed).checks] == ["outside"]
    tables = kept_by_update(result(folder, TABLE + "regression = true\n"))
    assert (tables.checks, tables.summaries) == ((), ())


def test_an_outcome_is_updated_too(folder: Path):
    text = "regression = true\n" + case("a", '"defeated"', "").replace("ballistic_limit_m_s", "outcome")
    content = text.encode()
    assert updated_file(content, updates_of(result(folder, text))) == content.replace(b"defeated", b"perforated")


def test_an_update_keeps_the_byte_order_mark_and_the_line_ends(folder: Path):
    content = (
        b"\xef\xbb\xbf"
        + ("# \N{MICRO SIGN}\nregression = true\n" + case("a", 725.0, "band = 1.0") + TABLE)
        .replace("\n", "\r\n")
        .encode()
    )
    (folder / "suite.toml").write_bytes(content)
    found = validate(load_suite(folder / "suite.toml"))
    new = f"{ballistic_limit(scenario()).ballistic_limit_m_s:.8g}".encode()
    expected = content.replace(b"725.0", new).replace(b"720.0", new).replace(b"6.35, 730.0", b"6.35, " + new)
    assert updated_file(content, updates_of(found)) == expected
