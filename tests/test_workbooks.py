"""Workbooks are read as spreadsheet programs mean them, and those that attack are refused in seconds."""

import re
import sys
from collections.abc import Iterable
from datetime import datetime, time
from hashlib import sha256
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZIP_LZMA, ZipFile

import pytest

import armour
from armour import workbooks
from armour.workbooks import rows_of, workbook_of

TYPES = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
RELATED = '<Relationship Id="r1" Type="a/worksheet" Target="worksheets/sheet1.xml"/>'
HEAD = (
    '<row r="1"><c r="A1" t="str"><v>velocity_m_s</v></c><c r="B1" t="str"><v>result</v></c></row>'
    '<row r="2"><c r="A2"><v>700</v></c><c r="B2" t="str"><v>P</v></c></row>'
    '<row r="3"><c r="A3"><v>730</v></c><c r="B3" t="str"><v>C</v></c></row>'
)


def made(
    path: Path,
    rows: str | Iterable[str] = "",
    *,
    after: str = "",
    shared: str = "",
    styles: str = "<styleSheet/>",
    related: str = RELATED,
    sheets: str = '<sheet name="S" r:id="r1"/>',
    compression: int = ZIP_DEFLATED,
    parts: int = 0,
    head: str = HEAD,
) -> Path:
    """A workbook of a sheet that begins with two shots."""
    more = '<Relationship Id="t" Type="a/sharedStrings" Target="/xl/t.xml"/>'
    more += '<Relationship Id="s" Type="a/styles" Target="../xl/s.xml"/>'
    whole = f'<Relationship Id="r" Type="{TYPES}/officeDocument" Target="xl/b.xml"/>'
    contents = {
        "_rels/.rels": f"<Relationships>{whole}</Relationships>",
        "xl/_rels/b.xml.rels": f"<Relationships>{related}{more}</Relationships>",
        "xl/b.xml": f'<workbook xmlns:r="{TYPES}"><sheets>{sheets}</sheets></workbook>',
        "xl/t.xml": shared or "<sst/>",
        "xl/s.xml": styles,
        **{f"media/{number}": "" for number in range(parts)},
    }
    with ZipFile(path, "w", compression) as file:
        for name, content in contents.items():
            file.writestr(name, content)
        with file.open("xl/worksheets/sheet1.xml", "w") as part:
            for text in ("<worksheet><sheetData>", head, *([rows] if isinstance(rows, str) else rows)):
                part.write(text.encode())
            part.write(f"</sheetData>{after}</worksheet>".encode())
    return path


def cells_of(path: Path, sheet: str = "S") -> list[tuple[int, list[str]]]:
    """The rows of a sheet."""
    return [(number, cells) for number, cells, _ in rows_of(workbook_of(path, path.read_bytes()), sheet)]


def test_values_of_all_kinds(tmp_path: Path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    sheet = book.active
    sheet["B2"], sheet["C2"], sheet["D2"], sheet["E2"] = 700, 730.2, True, " a\n b "
    sheet["A4"], sheet["B4"] = datetime(2026, 2, 3), datetime(2026, 2, 3, 4, 5, 6)
    sheet["C4"], sheet["AA4"], sheet["D4"] = time(6, 0), -1e-5, "=1+1"
    sheet["A5"].number_format = "yyyy"
    sheet["B6"], sheet["C6"] = 1.5, 2
    sheet["B6"].number_format, sheet["C6"].number_format = '0.0" days"', "[Red]0"
    book.save(tmp_path / "t.xlsx")
    assert cells_of(tmp_path / "t.xlsx", "Sheet") == [
        (2, ["", "700", "730.2", "True", "a\n b"]),
        (4, ["2026-02-03 00:00:00", "2026-02-03 04:05:06", "06:00:00", *[""] * 23, "-1e-05"]),
        (6, ["", "1.5", "2", *[""] * 24]),
    ]


def test_texts_without_what_tells_their_pronunciation(tmp_path: Path):
    shared = "<sst><si><r><t>ge</t></r><r><t>halten </t></r><rPh><t>x</t></rPh></si></sst>"
    inline = '<c t="inlineStr"><is><t>a</t><rPh><t>x</t></rPh></is></c>'
    path = made(tmp_path / "t.xlsx", f'<row><c t="s"><v>0</v></c>{inline}</row>', shared=shared)
    assert cells_of(path)[-1] == (4, ["gehalten", "a"])


def test_rows_far_below_and_formatted_cells(tmp_path: Path):
    rows = (
        '<row r="1048576"><c r="A1048576"><v>740</v></c><c r="B1048576" t="str"><v>C</v></c><c r="XFD9" s="1"/></row>'
    )
    shots = armour.read_shots(made(tmp_path / "t.xlsx", rows))
    assert shots.velocities_m_s == (700.0, 730.0, 740.0)


TOO_MUCH = "must be a workbook with fewer or shorter cells; save the sheet as CSV"
BROKEN = "must be a workbook of a spreadsheet program (.xlsx)"
LAUGHS = "".join(f"<!ENTITY a{i + 1} '{f'&a{i};' * 10}'>" for i in range(9))
SHORT = "<row><c><v>1</v></c></row>"
WRONG = '<row><c t="s"><v>0</v></c><c t="s"><v>0</v></c></row>'
STYLE, MERGED = "<xf numFmtId='14'/>", "<mergeCell ref='A1:XFD9'/>"


def texts(*contents: str) -> dict[str, str]:
    """Texts that cells share."""
    return {"shared": f"<sst>{''.join(f'<si><t>{text}</t></si>' for text in contents)}</sst>"}


ATTACKS: dict[str, tuple[dict[str, Any], str]] = {
    "a row far away": ({"rows": '<row r="1000000000000000"/>'}, "must be numbered from 1 to 104,857"),
    "rows that go back": ({"rows": '<row r="2"/>'}, "in increasing order, found 2"),
    "many empty rows": ({"rows": ["<row/>" * 100_000] * 2}, "must be numbered from 1 to 104,857"),
    "many empty cells": ({"rows": [f"<row>{'<c/>' * 16_000}</row>"] * 20}, TOO_MUCH),
    "a row of empty cells": ({"rows": ["<row>", *["<c/>" * 100_000] * 3, "</row>"]}, TOO_MUCH),
    "a column far away": ({"rows": '<row r="4"><c r="XFD4"><v>1</v></c></row>'}, "at most 1,000 columns"),
    "a column without end": ({"rows": f"<row r='4'><c r='{'Z' * 9000}4'><v>1</v></c></row>"}, BROKEN),
    "short rows below a wide one": (
        {"rows": ['<row r="4"><c r="ALL4"><v>1</v></c></row>', *[SHORT * 1000] * 2]},
        "must have at most 500,000 cells",
    ),
    "a text in many cells": (
        {"rows": '<row><c t="s"><v>0</v></c></row>' * 1000, **texts("x" * 9000)},
        "and 5,000,000 characters in a sheet",
    ),
    "many texts": (texts(*"a" * 100_000), TOO_MUCH),
    "wide texts": (texts(*["x" * 300_000 + "\U0001f600"] * 20), "must have at most 5,000,000 characters"),
    "a long text": (texts("x" * 4_000_000), TOO_MUCH),
    "a negative text": ({"rows": '<row><c t="s"><v>-1</v></c></row>', **texts("a")}, BROKEN),
    "entities": ({"shared": f"<!DOCTYPE a [<!ENTITY a0 'a'>{LAUGHS}]><sst><si><t>&a9;</t></si></sst>"}, BROKEN),
    "blanks without end": ({"rows": [" " * 1_000_000] * 5}, TOO_MUCH),
    "deep elements": ({"rows": "<a>" * 200_000}, TOO_MUCH),
    "many names": ({"rows": "".join(f"<n{i}/>" for i in range(100_000))}, TOO_MUCH),
    "many attributes": ({"rows": f"<a {' '.join(f'b{i}=_' for i in range(300_000))}/>".replace("_", "''")}, TOO_MUCH),
    "a long comment": ({"rows": f"<!--{'x' * 2_000_000}-->"}, TOO_MUCH),
    "many styles": ({"styles": f"<s><cellXfs>{STYLE * 200_000}</cellXfs></s>"}, TOO_MUCH),
    "many sheets": ({"sheets": '<sheet name="S" r:id="r1"/>' * 200_000}, TOO_MUCH),
    "many sheets of empty rows": (
        {"rows": ["<row/>" * 100_000], "sheets": "".join(f'<sheet name="{i}" r:id="r1"/>' for i in range(300))},
        TOO_MUCH,
    ),
    "many relations": ({"related": RELATED * 160_000}, TOO_MUCH),
    "many merged cells": ({"rows": SHORT, "after": f"<mergeCells>{MERGED * 200_000}</mergeCells>"}, TOO_MUCH),
    "many files": ({"parts": 10_001}, "must be a workbook of at most 10,000 parts"),
    "a compression of any size": ({"compression": ZIP_LZMA}, BROKEN),
    "a long number": ({"rows": f"<row><c><v>{'9' * 9000}</v></c></row>"}, BROKEN),
    "a long name": ({"rows": "<row/>", "head": f"<row><c t='str'><v>{'(' * 9000}</v></c></row>"}, "at most 500 char"),
    "wrong cells": ({"rows": WRONG * 9_000, **texts("x" * 25)}, "row 4: "),
}


def test_no_workbook_is_read_beyond_a_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A tenth of the greatest numbers of tags and rows stands for these, which take a minute and 300 MB."""
    for name in ("MAX_TAGS", "MAX_ROWS"):
        monkeypatch.setattr(workbooks, name, getattr(workbooks, name) // 10)
    for name, (contents, message) in ATTACKS.items():
        with pytest.raises(armour.InputError, match=re.escape(message)):
            armour.read_shots(made(tmp_path / f"{name}.xlsx", **contents))


ROWS = {
    "velocity (m/s)": [735.3, 761.4, None, 750.0],
    "result": ["PP", "CP", "CP", "PP"],
    "counts": [True, True, False, True],
}


def parquet(path: Path, **options: Any) -> Path:
    """A Parquet file of three shots, and one that does not count, with other columns and texts as given."""
    pa = pytest.importorskip("pyarrow")
    __import__("pyarrow.parquet")
    pa.parquet.write_table(pa.table(ROWS | options), path, compression="zstd")
    return path


def test_shots_in_a_parquet_file(tmp_path: Path):
    path = parquet(tmp_path / "shots.parquet")
    shots = armour.read_shots(path)
    assert shots.velocities_m_s == (735.3, 761.4, 750.0)
    assert shots.complete == (False, True, False)
    assert shots.read is not None
    assert shots.read.left_out == ("row 3",)
    assert shots.read.sha256 == sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"each": [[1], [2], [3], [4]]}, "must have a single value in each cell"),
        ({f"column {place}": [1] * 4 for place in range(1000)}, "must have at most 1000 columns"),
        ({name: [name * 1_000_000] * 4 for name in "ab"}, "must have at most 5,000,000 characters"),
        ({"by": ["A", "A", "A", "B"]}, "by: is not read and divides the shots"),
    ],
)
def test_parquet_files_that_are_refused(tmp_path: Path, columns: dict[str, Any], message: str):
    with pytest.raises(armour.InputError, match=re.escape(message)):
        armour.read_shots(parquet(tmp_path / "shots.parquet", **columns))


def test_parquet_files_of_many_rows_and_bytes(tmp_path: Path):
    rows = {name: [value] * 100_001 for name, value in {"velocity_m_s": 700.0, "result": "PP"}.items()}
    with pytest.raises(armour.InputError, match="must have at most 100000 rows"):
        armour.read_shots(parquet(tmp_path / "rows.parquet", **rows | {name: [0] * 100_001 for name in ROWS}))
    with pytest.raises(armour.InputError, match="must be at most 100,000,000 bytes long, unpacked"):
        armour.read_shots(parquet(tmp_path / "bytes.parquet", note=[str(place) * 30_000_000 for place in range(4)]))


def test_no_parquet_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    whole = parquet(tmp_path / "whole.parquet").read_bytes()
    for content in (b"", b"velocity_m_s,result\n", whole[:-20], whole[:4] + bytes(200) + whole[204:]):
        (tmp_path / "t.parquet").write_bytes(content)
        with pytest.raises(armour.InputError, match=r"t\.parquet: must be a Parquet file"):
            armour.read_shots(tmp_path / "t.parquet")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(armour.InputError, match=r'needs pyarrow; pip install "pyarrow>=17", or save it as CSV'):
        armour.read_shots(tmp_path / "whole.parquet")
