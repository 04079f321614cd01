"""`armour check --cases`: a line for each offer of a table."""

import csv
import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.helpers.cases import csv_file

ROWS = [
    "offer;lead time;ceramic;ceramic thickness (mm);metal;metal thickness (mm);price per m2",
    "A;6 weeks;SiC;8;7075-T6;12;1450",
    "B;3 weeks;AD85;10;6061-T6;8;390",
    "B;3 weeks;AD85;8;6061-T6;6;330",
]
CHECK = ("check", "wilkins", "--probability", "0.9", "--cases", "offers.csv", "--keep", "offer", "--keep", "lead time")


@pytest.fixture
def offers(folder: Path) -> Path:
    return csv_file(folder / "offers.csv", *ROWS)


@pytest.mark.usefixtures("offers")
def test_an_offer_is_a_line(cli):
    result = cli(*CHECK)
    assert result.exit_code == 3
    summary, _, _, _, *lines = result.stdout.splitlines()
    assert summary == "3 armours: 1 passes, 1 not known, 1 FAILS (90 % required, 7.62 mm AP at 800 m/s)"
    assert [line.split()[0] for line in lines] == ["A", "B", "B", "*"]
    assert "10 mm AD85 on 8 mm 6061-T6" in lines[1]
    assert [line.split()[-1] for line in lines[:3]] == ["known", "passes", "FAILS"]
    assert lines[0].split()[-5:] == ["1237*", "not", "known", "not", "known"]
    [read] = result.stderr.splitlines()
    assert read.startswith("read offers.csv: semicolons, ")
    assert read.endswith(", 3 offers")


@pytest.mark.usefixtures("offers")
def test_every_output_has_the_labels(cli, folder: Path):
    cli(*CHECK, "--csv", "out.csv", "--junit", "out.xml", "--markdown", "out.md")
    with (folder / "out.csv").open() as file:
        rows = list(csv.DictReader(file))
    labels = [("A", "6 weeks"), ("B", "3 weeks"), ("B", "3 weeks")]
    assert [(row["offer"], row["lead time"]) for row in rows] == labels
    verdicts = ["not known", "passes", "fails"]
    assert [(row["cost_per_m2"], row["verdict"]) for row in rows] == [
        *zip(("1450.0", "390.0", "330.0"), verdicts, strict=True)
    ]
    data = json.loads(cli(*CHECK, "--json").stdout)
    assert [(each["name"], *each["labels"].values()) for each in data] == [(name, name, time) for name, time in labels]
    assert [each["verdict"] for each in data] == verdicts
    suites = ElementTree.parse(folder / "out.xml").findall("testsuite")
    assert [suite.get("name") for suite in suites] == ["wilkins: A", "wilkins: B", "wilkins: B"]
    assert "offer: A\nlead time: 6 weeks" in (suites[0].findtext("testcase/system-out") or "")
    assert "| offer | lead time | threat | verdict | why |" in (folder / "out.md").read_text()
    assert "| B | 3 weeks | 7.62 mm AP | passes |" in (folder / "out.md").read_text()


def test_mistakes_of_every_offer_are_told(cli, folder: Path):
    csv_file(folder / "offers.csv", ROWS[0], ROWS[1].replace("SiC", "SiCx"), ROWS[2].replace("6061-T6", "x"))
    told = cli.fails(2, *CHECK)
    assert [line.partition(": must")[0] for line in told] == [
        "offers.csv: line 2: ceramic",
        "offers.csv: line 3: metal",
    ]


@pytest.mark.parametrize(
    ("words", "found"),
    [
        (("wilkins", "--keep", "offer"), "--keep: needs --cases"),
        (("wilkins", "--sheet", "x"), "--sheet: needs --cases"),
        (("wilkins", "oblique", "--cases", "offers.csv"), "--cases: must be given with one scenario, not with several"),
        (("wilkins", "--cases", "offers.csv", "--plot", "x.svg"), "--cases: cannot be combined with --plot"),
        (("wilkins", "--cases", "offers.csv", "--against", "a.json"), "--cases: cannot be combined with --plot or --a"),
    ],
)
@pytest.mark.usefixtures("offers")
def test_wrong_options(cli, words: tuple[str, ...], found: str):
    [line] = cli.fails(2, "check", *words)
    assert line.startswith(f"command line: {found}")


def test_a_sheet_of_a_workbook(cli, folder: Path):
    book = pytest.importorskip("openpyxl").Workbook()
    sheet = book.create_sheet("Angebote")
    for row in (
        ["Angebot", "Kachel", "Kacheldicke [mm]", "Platte", "Plattendicke [mm]"],
        ["A", "AD85", 10, "6061-T6", 8],
    ):
        sheet.append(row)
    book.save(folder / "offers.xlsx")
    result = cli("check", "wilkins", "--cases", "offers.xlsx", "--sheet", "Angebote", "--keep", "Angebot")
    assert (result.exit_code, result.stdout.splitlines()[-1].split()[:5]) == (0, ["A", "10", "mm", "AD85", "on"])
