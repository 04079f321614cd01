from pathlib import Path
from time import process_time

import pytest

import armour
from armour import csv_files
from armour.columns import column_of
from armour.csv_files import number, open_table, read_rows
from armour.errors import InputError
from armour.statistics.v50 import SHOTS


def unknown(_name: str) -> bool:
    """Return that no column is known."""
    return False


def read(tmp_path: Path, text: str):
    path = tmp_path / "t.csv"
    path.write_text(text)
    keys = ("velocity_m_s", "result")
    source = open_table(path, lambda name: column_of(name, keys).known)
    table = read_rows(source, SHOTS)
    source.refuse()
    return table.rows


def messages(tmp_path: Path, text: str) -> list[str]:
    try:
        read(tmp_path, text)
        problems = []
    except InputError as error:
        problems = list(error.problems)
    return [str(problem).removeprefix(f"{tmp_path}/") for problem in problems]


def test_rows_with_their_lines(tmp_path: Path):
    rows = read(tmp_path, "velocity_m_s, result\n\n 700.5 , partial\n,complete\n")
    assert [(row.place, row.numbers, row.texts) for row in rows] == [
        ("line 3", {"velocity_m_s": 700.5}, {"velocity_m_s": "700.5", "result": "partial"}),
        ("line 4", {}, {"result": "complete"}),
    ]


def test_every_mistake_at_once(tmp_path: Path):
    assert messages(tmp_path, "velocity_m_s,result\nfast,partial\n700\nnan,partial\n710,partial\n710,partial\n") == [
        't.csv: line 2: velocity_m_s: must be a number, found "fast"',
        "t.csv: line 3: must have 2 cells as the header has, found 1",
        't.csv: line 4: velocity_m_s: must be a number, found "nan"',
    ]


@pytest.mark.parametrize(
    ("header", "found"),
    [
        ("velocity,result", ['velocity: must have its unit, as "velocity (m/s)" or "velocity (ft/s)"']),
        ("V (km/h),result", ['V (km/h): must have its unit, as "V (m/s)" or "V (ft/s)"']),
        (
            "v (m/s),V (ft/s),result\n700,700,P",
            ["line 1: v (m/s): must be the name of one column, found several: v (m/s) and V"],
        ),
        ("velocity_m_s,resul", ['resul: unknown column; did you mean "result"?', "result: is missing"]),
        ("velocity_m_s,result,result", ["line 1: result: must be the name of one column, found several"]),
        (
            "velocity_m_s,result\n812,4,partial",
            ["line 2: must have 2 cells as the header has, found 3; write decimals with points"],
        ),
        (
            "speed;colour",
            ["speed: must have its unit", "result: is missing and must be a column, found speed, colour"],
        ),
        (
            "Range report,page 3",
            ["Range report: unknown column; choose from", "page 3: unknown", "velocity_m_s: is missing", "result: is"],
        ),
    ],
)
def test_wrong_columns(tmp_path: Path, header: str, found: list[str]):
    told = messages(tmp_path, f"{header}\n")
    assert [line.startswith(f"t.csv: {start}") for line, start in zip(told, found, strict=True)] == [True] * len(found)


def test_tables_of_no_and_of_too_many_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(csv_files, "MAX_TABLE_ROWS", 2)
    rows = "velocity_m_s,result\n700,partial\n710,partial\n"
    assert messages(tmp_path, rows) == []
    assert messages(tmp_path, "") == ["t.csv: must have a header with velocity_m_s and result, found an empty file"]
    assert messages(tmp_path, rows[:20]) == ["t.csv: must have at least one row below its header"]
    assert messages(tmp_path, rows + "720,complete\n") == [
        "t.csv: must have at most 2 rows below its header, found more"
    ]


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ('700,"partial', "line 3: must close each quote on its line, before a comma or the end of the line"),
        ('700,partial\n710,"complete\n720,partial\n730,"complete\n', "line 4: must close each quote on its line"),
        ('700,"partial" or so\n', "line 3: must close each quote on its line"),
        (f"700,{'x' * 140_000}\n", "line 3: must be shorter than 100,000 characters"),
        ("700,partial\n710,\0\n", "line 4: must be text, found a binary file"),
    ],
)
def test_lines_that_are_no_rows(tmp_path: Path, rows: str | bytes, message: str):
    (tmp_path / "t.csv").write_bytes(b"\nvelocity_m_s,result\n" + (rows if isinstance(rows, bytes) else rows.encode()))
    with pytest.raises(InputError, match=f"t.csv: {message}"):
        list(open_table(tmp_path / "t.csv", unknown).lines)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_quotes_blanks_and_line_ends_of_other_programs(tmp_path: Path, end: str):
    lines = ("\ufeff velocity_m_s ,remark", "", '"700 ",5" of "it"', ",", ' 710,"say ""no"", then"')
    (tmp_path / "t.csv").write_bytes(end.join(lines).encode())
    source = open_table(tmp_path / "t.csv", unknown)
    assert (source.place, source.header) == ("line 1", ["velocity_m_s", "remark"])
    assert list(source.lines) == [("line 3", ["700", '5" of "it"']), ("line 5", ["710", 'say "no", then'])]


def test_what_cannot_be_opened(tmp_path: Path):
    for name, message in ((".", "is a directory"), ("none.csv", "no such file"), ("a\0b", ".*embedded null")):
        with pytest.raises(InputError, match=f"cannot be read: {message}"):
            open_table(tmp_path / name, unknown, own=True)


@pytest.mark.parametrize(("text", "value"), [("-1.5", -1.5), ("1e3", 1e3), ("700", 700), ("+.5", 0.5), ("7.E-2", 0.07)])
def test_numbers(text: str, value: float):
    assert number(text) == value


@pytest.mark.parametrize(
    "text", ["7_00", "\uff17\uff10\uff10", "\u0667", "nan", "inf", "-Infinity", "1e999", "0x10", "1,5", ""]
)
def test_texts_that_are_no_numbers(text: str):
    assert number(text) is None


@pytest.mark.parametrize("text", ["(" * 16_000, "(a" * 16_000, "velocity" + " " * 16_000 + "(m/s)", "(" + "a" * 16_000])
def test_a_long_heading_or_name_takes_no_time(tmp_path: Path, text: str):
    start = process_time()
    (tmp_path / "a.csv").write_text(f"shot,velocity_m_s,result,{text}\n1,700,P,\n2,720,C,\n")
    with pytest.raises(InputError, match=r"a\.csv: line 1: must have names of at most 500 characters"):
        armour.read_shots(tmp_path / "a.csv")
    (tmp_path / "b.csv").write_text(f"{text},{text}\nshot,velocity_m_s,result\n1,700,P\n{text},720,C\n")
    assert armour.read_shots(tmp_path / "b.csv").velocities_m_s == (700.0, 720.0)
    assert process_time() - start < 2.0
