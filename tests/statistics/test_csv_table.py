from pathlib import Path

import pytest

from armour.errors import InputError
from armour.statistics import csv_table
from armour.statistics.csv_table import lines_of, read_rows


def read(tmp_path: Path, text: str):
    path = tmp_path / "t.csv"
    path.write_text(text)
    return read_rows(
        *lines_of(path), numbers=("velocity_m_s",), texts=("shot", "result"), needed=("velocity_m_s", "result")
    )


def messages(tmp_path: Path, text: str) -> list[str]:
    try:
        _, problems = read(tmp_path, text)
    except InputError as error:
        problems = list(error.problems)
    return [str(problem).removeprefix(f"{tmp_path}/") for problem in problems]


def test_rows_with_their_lines(tmp_path: Path):
    rows, problems = read(tmp_path, "velocity_m_s, result\n\n 700.5 , partial\n,complete\n")
    assert [(row.place, row.numbers, row.texts) for row in rows] == [
        ("line 3", {"velocity_m_s": 700.5}, {"velocity_m_s": "700.5", "result": "partial"}),
        ("line 4", {}, {"result": "complete"}),
    ]
    assert problems == []


def test_every_mistake_at_once(tmp_path: Path):
    assert messages(tmp_path, "velocity_m_s,result\nfast,partial\n700\nnan,partial\n710,partial\n710,partial\n") == [
        't.csv: line 2: velocity_m_s: must be a number, found "fast"',
        "t.csv: line 3: must have 2 cells as the header has, found 1",
        't.csv: line 4: velocity_m_s: must be a number, found "nan"',
        "t.csv: line 6: repeats line 5; where both took place, name them in the column shot",
    ]


def test_a_row_twice_with_names_is_two(tmp_path: Path):
    rows, problems = read(tmp_path, "shot,velocity_m_s,result\na,710,partial\nb,710,partial\n")
    assert (len(rows), problems) == (2, [])


@pytest.mark.parametrize(
    ("header", "found"),
    [
        (
            "velocity,result",
            ["velocity: unknown column; its unit is missing: velocity_m_s", "velocity_m_s: is missing"],
        ),
        ("velocity_m_s,resul", ['resul: unknown column; did you mean "result"?', "result: is missing"]),
        ("velocity_m_s,result,result", ["result: must be the name of one column, found several"]),
        ("velocity_m_s;result", ["line 1: must separate columns by commas, found semicolons"]),
        ("velocity_m_s\tresult", ["line 1: must separate columns by commas, found tabs"]),
        ("velocity_m_s,result,", ["header: unknown column; choose from velocity_m_s, shot, result"]),
    ],
)
def test_wrong_columns(tmp_path: Path, header: str, found: list[str]):
    told = messages(tmp_path, f"{header}\n")
    assert [line.startswith(f"t.csv: {start}") for line, start in zip(told, found, strict=True)] == [True] * len(found)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "t.csv: must have a header with velocity_m_s and result, found an empty file"),
        ("velocity_m_s,result\n", "t.csv: must have at least one row below its header"),
    ],
)
def test_nothing_in_it(tmp_path: Path, text: str, message: str):
    assert messages(tmp_path, text) == [message]


def test_a_table_of_too_many_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(csv_table, "MAX_ROWS", 2)
    rows = "velocity_m_s,result\n700,partial\n710,partial\n"
    assert messages(tmp_path, rows) == []
    assert messages(tmp_path, rows + "720,complete\n") == ["t.csv: must have at most 2 rows below its header, found 3"]


def test_a_cell_that_is_too_long_for_a_table(tmp_path: Path):
    [message] = messages(tmp_path, f"velocity_m_s,result\n700,{'x' * 140_000}\n")
    assert message == "t.csv: line 2: must be CSV: field larger than field limit (131072)"
