"""Tables that people write, as every command reads them."""

import json
from hashlib import sha256
from pathlib import Path

import pytest

SHOTS = "velocity_m_s,result,shot\n700,partial,1\n715,complete,{}\n710,partial,3\n725,complete,4\n"
TESTS = "armour.ceramic_thickness_mm,ballistic_limit_m_s,test\n5,660,a\n6,705,{}\n8,790,c\n7,755,d\n"
CASES = "armour.ceramic_thickness_mm,armour.backing\n5,6061-T6\n6,{}\n8,6061-T6\n"
# A procedure that is computed soon.
SOON = ("--procedure", "up-and-down")
SUITE = """title = "x"
source = "x"
[[table]]
name = "x"
scenario = "wilkins"
file = "t.csv"
quantity = "ballistic_limit_m_s"
"""


@pytest.mark.parametrize(
    ("text", "arguments"),
    [
        (SHOTS, ["v50", "t.csv"]),
        (SHOTS, ["plan", "shots", "wilkins", "t.csv"]),
        (SHOTS, ["plan", "shots", "wilkins", "t.csv", "--result", "PP", "--velocity-m-s", "700"]),
        (TESTS, ["calibrate", "t.csv", "wilkins"]),
        (CASES, ["sweep", "wilkins", "--cases", "t.csv", "-o", "made.csv"]),
        (TESTS, ["validate", "s.toml"]),
    ],
    ids=lambda value: " ".join(value[:2]) if isinstance(value, list) else "",
)
@pytest.mark.parametrize("cell", ['"2', '"2" or 3'])
def test_an_open_quote_is_refused(cli, folder: Path, text: str, arguments: list[str], cell: str):
    (folder / "t.csv").write_text(text.format(cell))
    (folder / "s.toml").write_text(SUITE)
    [line] = cli.fails(2, *arguments)
    assert line.startswith("t.csv: line 3: must close each quote on its line, before a comma or the end of the line;")
    assert (folder / "t.csv").read_text() == text.format(cell)
    assert not (folder / "made.csv").exists()


EXPORT = (
    "Shot No;V (ft/s);Result;Panel;Valid\n"
    "1;2297;PP;A;yes\n2;2395;CP;A;yes\n3;2625;PP;B;yes\n4;2690;CP;B;yes\n5;9;CP;B;no\n"
)


def test_how_a_table_was_read_is_said_once(cli, folder: Path):
    (folder / "t.csv").write_text(EXPORT)
    for words in (["v50", "t.csv"], ["plan", "shots", "t.csv", *SOON], ["calibrate", "t.csv", "wilkins"]):
        noun = "tests" if words[0] == "calibrate" else "shots"
        [line] = [line for line in cli(*words, "--where", "panel=A").stderr.splitlines() if line.startswith("read ")]
        assert line == f"read t.csv: semicolons, velocity in ft/s, 2 {noun}, panel A, without 3 rows of other Panel"
    line, way_on = cli.fails(2, "v50", "t.csv")
    assert line.startswith(
        "t.csv: Panel: divides the shots: A (2 shots), B (2 shots); --where Panel=A chooses one, --each Panel gives"
    )
    assert way_on.endswith(" --where Panel=A")


def test_a_column_that_is_not_read_may_be_chosen_by_or_ignored(cli, folder: Path):
    (folder / "t.csv").write_text("velocity_m_s,result,unfair hit\n700,P,\n730,C,\n715,P,\n800,P,x\n")
    for words in (["v50", "t.csv"], ["plan", "shots", "t.csv", *SOON], ["calibrate", "t.csv", "wilkins"]):
        line, way_on = cli.fails(2, *words)
        assert line.startswith("t.csv: unfair hit: is not read and divides the ")
        assert way_on.endswith(" --where 'unfair hit='")
        assert " unfair hit blank" in cli(*words, "--where", "unfair hit=").stderr
        assert " 4 " in cli(*words, "--ignore", "unfair hit").stderr


def test_each_lot_is_closed(cli, folder: Path):
    """What divides one lot is said of it, and a column that only tells the lots apart divides none."""
    head, shots = "velocity_m_s,result,lot,kiln,gunner\n", [(700, "P"), (720, "C"), (712, "P"), (716, "C")]
    rows = [f"{v},{word},{lot},{kiln},Jones\n" for lot, kiln in (("A", "old"), ("B", "new")) for v, word in shots]
    (folder / "t.csv").write_text(head + "".join([*rows, "750,C,B,new,Smith\n"]))
    line = cli.fails(2, "v50", "t.csv", "--each", "lot")[-1]
    assert line.startswith("t.csv: lot B: gunner: is not read and divides the shots: Jones (4 shots), Smith (1 shot)")
    shown = cli("v50", "t.csv", "--each", "lot", "--ignore", "gunner").stdout
    assert "V50 not found to differ: lot B minus lot A" in shown
    (folder / "t.csv").write_text("velocity_m_s,result,Kiln\n700,P,a\n720,C,\n")
    [line] = cli.fails(2, "v50", "t.csv", "--each", "Kiln")
    assert line == "t.csv: Kiln: must be filled in every row that counts, found blank cells in line 3"


def test_a_suite_takes_each_test_by_itself_and_quotes_remarks(cli, folder: Path):
    (folder / "s.toml").write_text(SUITE + "band = 0.5\n")
    head, *rows = TESTS.format("b").splitlines()
    (folder / "t.csv").write_text(
        "\n".join([f"{head},gun,remark", f"{rows[0]},A,edge hit", f"{rows[1]},A,", f"{rows[2]},B,"])
    )
    assert 'remark, which is not read, says "edge hit" in line 2' in cli("validate", "s.toml").stderr


def test_a_shot_whose_cell_would_divide_the_table_is_not_added(cli, folder: Path):
    (folder / "t.csv").write_text("velocity_m_s,result,round\n700,P,M2\n730,C,M2\n")
    before = (folder / "t.csv").read_text()
    shot = ["plan", "shots", "t.csv", *SOON, "--result", "P", "--velocity-m-s", "715"]
    assert "round: is not read and divides the shots: M2 (2 shots), blank (1 shot)" in cli.fails(2, *shot)[0]
    assert (folder / "t.csv").read_text() == before
    cli(*shot, "--where", "round=M2")
    assert (folder / "t.csv").read_text() == before + "715,P,M2\n"


def test_labels_of_cases_are_kept_as_they_are(cli, folder: Path):
    (folder / "t.csv").write_text("offer,armour.ceramic_thickness_mm,price\nA,6,0420.50\nB,8,=1+1\n")
    sweep = ["sweep", "wilkins", "--cases", "t.csv", "-o", "made.csv", "--quantities", "areal_density_kg_m2"]
    assert "--keep offer keeps it as a label, unused" in cli.fails(2, *sweep)[0]
    assert "2 rows, offer, price kept unused" in cli(*sweep, "--keep", "price", "--keep", "offer").stderr
    first, *rows = (folder / "made.csv").read_text().splitlines()
    assert first == "offer,price,armour.ceramic_thickness_mm,areal_density_kg_m2"
    assert [row.split(",")[:3] for row in rows] == [["A", "0420.50", "6.0"], ["B", "'=1+1", "8.0"]]


def test_an_answer_for_each_panel(cli, folder: Path):
    (folder / "t.csv").write_text(EXPORT)
    for words in (["v50", "t.csv"], ["plan", "shots", "wilkins", "t.csv", *SOON]):
        found = json.loads(cli(*words, "--each", "panel", "--json").stdout)
        assert [*found] == ["Panel A", "Panel B", *["differences"] * (words[0] == "v50"), "made_by"]
        assert [found["Panel B"]["fired"]["complete"], found["Panel B"]["fired"]["names"]] == [
            [False, True],
            ["3", "4"],
        ]
        assert found["Panel B"]["fired"]["read"]["left_out"] == ["line 6"]
        assert cli.fails(2, *words, "--each", "panel", "--plot", "x.svg") == [
            "command line: --plot: cannot be combined with --each"
        ]
    told = cli.fails(2, "v50", "t.csv", "--each", "panel", "--csv", "x.csv")
    assert told == ["command line: --csv: cannot be combined with --each"]
    for option, word in (("--each", "Lot"), ("--where", "Lot=A"), ("--ignore", "Lot")):
        [told] = cli.fails(2, "v50", "t.csv", option, word)
        assert told.startswith(f't.csv: {option}: must name a column, found "Lot"; choose from Shot No, V (ft/s)')
    assert cli.fails(2, "v50", "t.csv", "--where", "A") == [
        'command line: --where: must be COLUMN=VALUE, found the text "A"'
    ]


def write_panels(folder: Path, **results: str) -> None:
    """Write a table of the results of shots at panels, 1 m/s faster each."""
    rows = [f"{v},{word},{name}\n" for name, words in results.items() for v, word in enumerate(words, 700)]
    (folder / "t.csv").write_text("velocity_m_s,result,panel\n" + "".join(rows))


def test_a_panel_without_an_answer_stops_no_other(cli, folder: Path):
    write_panels(folder, A="PPPPCPCPCCCC", B="PP", C="CCPP", D="C")
    why = {
        "panel B": "must have at least one partial and one complete penetration, found only partial ones; ",
        "panel C": "no V50: the complete penetrations were no faster on average (700.5 m/s) than the partial ones",
        "panel D": "must have at least one partial and one complete penetration, found only complete ones; ",
    }
    for code, words in ((1, ()), (3, ("--requirement-m-s", "650"))):
        shown, in_json = (cli("v50", "t.csv", "--each", "panel", *words, *form) for form in ((), ("--json",)))
        assert (shown.exit_code, in_json.exit_code) == (code, code)
        found = json.loads(in_json.stdout)
        assert [*found] == ["panel A", *why, "differences", "made_by"]
        assert found["panel A"]["decision"] == ("met" if words else "")
        for name, reason in why.items():
            assert f"\n{name}: {reason}" in shown.stdout
            assert found[name]["no_answer"].startswith(reason)
    planned = json.loads(cli("plan", "shots", "wilkins", "t.csv", "--each", "panel", "--json").stdout)
    assert [*planned] == ["panel A", "panel B", "panel C", "panel D", "made_by"]
    assert cli.fails(2, "v50", "t.csv", "--each", "panel", "--pairs", "7")[-1].startswith("command line: --span-m-s: ")


def test_a_swapped_panel_stops_no_other_plan(cli, folder: Path):
    write_panels(folder, A="PPPCCC", B="CCCPPP")
    shown = cli("plan", "shots", "wilkins", "t.csv", "--each", "panel", "--json")
    assert shown.exit_code == 1
    found = json.loads(shown.stdout)
    assert "fired" in found["panel A"]
    assert "are the results swapped?" in found["panel B"]["no_answer"]


def test_a_shot_is_added_to_an_export(cli, folder: Path):
    (folder / "t.csv").write_text(EXPORT)
    line = "plan shots wilkins t.csv --procedure up-and-down --where panel=A --result complete --velocity-m-s 715"
    found = json.loads(cli(*line.split(), "--json").stdout)
    content = (folder / "t.csv").read_text()
    assert content == EXPORT + "6;2345,80052;CP;A;yes\n"
    assert found["fired"]["velocities_m_s"][-1] == pytest.approx(715.0)
    assert found["fired"]["read"]["sha256"] == sha256(content.encode()).hexdigest()


def test_options_of_tables_need_one(cli, folder: Path):
    (folder / "t.csv").write_text("velocity_m_s,result,panel\n700,P,A\n710,P,A\n720,P,A\n")
    for option in (["--where", "panel=A"], ["--each", "panel"], ["--sheet", "x"]):
        assert cli.fails(2, "plan", "shots", "wilkins", *option) == [f"command line: {option[0]}: needs SHOTS"]
    assert cli.fails(2, "v50", "t.csv", "--sheet", "x") == [
        "t.csv: must be a workbook (.xlsx) for a sheet to be chosen"
    ]


def test_a_sheet_with_only_a_header_is_a_firing_without_shots(cli, folder: Path):
    (folder / "t.csv").write_text("Schuss;Geschwindigkeit (m/s);Ergebnis\n")
    cli("plan", "shots", "wilkins", "t.csv", *SOON)
    cli("plan", "shots", "wilkins", "t.csv", *SOON, "--result", "P", "--velocity-m-s", "720.5")
    assert (folder / "t.csv").read_text() == "Schuss;Geschwindigkeit (m/s);Ergebnis\n1;720,5;P\n"
    (folder / "t.csv").write_text("velocity_m_s,result\n")
    assert cli.fails(2, "v50", "t.csv") == ["t.csv: must have at least one row below its header"]
    assert cli.fails(2, "v50", "t.csv", "wilkins", "--prior") == ["t.csv: must have at least one shot, found none"]
