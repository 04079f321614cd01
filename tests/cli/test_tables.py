"""Tables that people write, as every command reads them."""

from pathlib import Path

import pytest

SHOTS = "velocity_m_s,result,shot\n700,partial,1\n715,complete,{}\n710,partial,3\n725,complete,4\n"
TESTS = "armour.ceramic_thickness_mm,ballistic_limit_m_s,test\n5,660,a\n6,705,{}\n8,790,c\n7,755,d\n"
CASES = "armour.ceramic_thickness_mm,armour.backing\n5,6061-T6\n6,{}\n8,6061-T6\n"
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
        (TESTS, ["plan", "tests", "wilkins", "--tests", "t.csv", "--candidates", "armour.ceramic_thickness_mm=5:8:1"]),
        (CASES, ["plan", "tests", "wilkins", "--candidates", "t.csv"]),
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
    assert line == "t.csv: line 3: must close each quote on its line, before a comma or the end of the line"
    assert (folder / "t.csv").read_text() == text.format(cell)
    assert not (folder / "made.csv").exists()
