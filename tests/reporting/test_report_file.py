"""Reports as files."""

from pathlib import Path

import pytest

from armour.errors import InputError
from armour.reporting.show import report
from tests.helpers.cases import scenario
from tests.helpers.suites import case, result


def test_a_suite_as_html_and_markdown(folder: Path):
    found = result(folder, case("a", 720.0, "band = 5.0"))
    for name, start in (("x.html", "<!DOCTYPE html>"), ("x.md", "# ")):
        report(found, str(folder / name))
        text = (folder / name).read_text()
        assert text.startswith(start)
        assert "armour.report(result" in text


def test_a_scenario(folder: Path):
    report(scenario(title="Wilkins"), folder / "x.md")
    assert "armour.report(scenario" in (folder / "x.md").read_text()


def test_the_armour_as_it_is(folder: Path):
    asks = scenario(threat=[{"projectile": "7.62 mm AP", "velocity_m_s": 700.0}])
    report(asks, folder / "x.md", as_is=True)
    text = (folder / "x.md").read_text()
    assert "as_is=True)" in text
    assert "Best design" not in text


def test_another_ending(folder: Path):
    with pytest.raises(InputError, match=r"\.html or \.md"):
        report(result(folder, case("a", 720.0, "band = 5.0")), folder / "x.pdf")
