"""The record of a firing."""

import re
from pathlib import Path

import pytest

import armour
from armour.statistics.v50 import read_shots
from tests.helpers.browser import browse, needs_chromium
from tests.helpers.cases import SCENARIOS

pytestmark = pytest.mark.slow

TABLE = """Range North;Order 4711
Date 2026-11-20
Shot No;Velocity (m/s);Result;Fair hit;Remarks;Lot
1;772;PP;yes;;A
2;801;CP;yes;spall on witness;A
3;786;CP;yes;;A
4;764;PP;yes;;A
5;779;PP;yes;;A
6;791;CP;yes;;A
7;788;CP;no;yaw 6 deg;A
1;762;PP;yes;;B
2;861;CP;yes;;B
3;906;CP;yes;;B
4;704;PP;yes;;B
5;868;PP;yes;;B
6;951;CP;yes;;B
"""
SIGNED = "Fired by, date and signature: "


@pytest.fixture
def table(folder: Path) -> Path:
    path = folder / "range.csv"
    path.write_text(TABLE)
    return path


def rows_of(page: str, heading: str) -> list[list[str]]:
    """The rows of the table below a heading of a page."""
    lines = page.split(f"## {heading}\n")[1].split("\n## ")[0].splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")][2:]


def test_one_page_has_what_a_range_files(cli, folder: Path, table: Path):
    options = ("--where", "lot=A", "--requirement-m-s", "700", "--ignore", "Remarks", "--report", "r.md")
    assert cli("v50", "range.csv", SCENARIOS / "wilkins.toml", *options).exit_code in (0, 3)
    page = (folder / "r.md").read_text()
    assert page.startswith("# Record of a firing: Range North, Order 4711\n")
    assert "Date 2026-11-20; V50 of the shots in range.csv: 6.35 mm AD85 on" in page
    assert "Met: V50 of at least 700 m/s; risk of accepting 2.2 % (5 % decides)." in page
    assert "* mean: none: 3 + 3 shots within 37 m/s, 27.4 allowed; 2 + 2 shots within 19 m/s, 18.3 allowed" in page
    shots = rows_of(page, "Shots")
    assert [shot[0] for shot in shots] == ["1", "2", "3", "4", "5", "6"]
    assert shots[1] == ["2", "801.0", "perforated", "yes"]
    assert "| in the mean of 3 + 3 |" in page
    unused = rows_of(page, "Shots not used")
    assert unused[0] == ["line 10", "Fair hit: no", "7; 788; CP; no; yaw 6 deg; A"]
    assert [row[1] for row in unused[1:]] == ["Lot: B"] * 6
    read = read_shots(table, where={"lot": "A"}).read
    assert read is not None
    assert f"SHA-256 {read.sha256}" in page
    assert "SHA-256 of the scenario's content: " in page
    assert f"Made by armour {armour.__version__}, model {armour.MODEL_VERSION}, Python " in page
    assert "--report r.md" in page
    assert SIGNED in page


def test_each_lot_has_a_page_with_its_own_shots(cli, folder: Path, table: Path):
    assert cli("v50", "range.csv", "--each", "lot", "--report", "r.md").exit_code == 0
    first, second = (folder / "r.md").read_text().split("\n---\n")
    assert "# Record of a firing, Lot A: " in first
    assert "# Record of a firing, Lot B: " in second
    assert [row[0] for row in rows_of(first, "Shots not used")] == ["line 10"]
    assert "## Shots not used\n\nnone\n" in second
    for page in (first, second):
        assert "Lot B minus Lot A" in page
        assert SIGNED in page
    assert cli.fails(2, "v50", "range.csv", "--report", "r.txt")
    armour.report(armour.v50(read_shots(table, where={"lot": "B"})), folder / "b.md")
    assert rows_of((folder / "b.md").read_text(), "Shots") == rows_of(second, "Shots")
    # The mean is of two shots of each kind: of the fastest partial and the slowest complete penetrations.
    few = armour.Shots((700.0, 716.0, 720.0, 728.0, 731.0, 760.0), (False, False, True, False, True, True))
    armour.report(armour.v50(few), folder / "few.md")
    shots = rows_of((folder / "few.md").read_text(), "Shots")
    assert [shot[1] for shot in shots if shot[3]] == ["716.0", "720.0", "728.0", "731.0"]


@pytest.mark.usefixtures("drawn")
@needs_chromium
def test_a_lot_is_one_page_on_paper_and_its_picture_has_one_level(cli, folder: Path, table: Path):
    more = "".join(f"{n};{760 + 3 * n};{'CP' if n % 2 else 'PP'};yes;;A\n" for n in range(8, 20))
    table.write_text(table.read_text() + more)
    assert cli("v50", "range.csv", "--each", "lot", "--report", "r.html").exit_code == 0
    page = (folder / "r.html").read_text().replace("\N{NO-BREAK SPACE}", " ")
    assert {*re.findall(r"\d\d % (?:interval|band)", page)} == {"95 % interval", "95 % band"}
    browse(folder / "r.html", "--no-pdf-header-footer", f"--print-to-pdf={folder / 'r.pdf'}")
    assert (folder / "r.pdf").read_bytes().count(b"/Type /Page\n") == 2
