import pytest

from armour.reporting.markdown import markdown_report, markdown_table, markdown_text
from armour.reporting.report import Report, ReportSection
from armour.reporting.table import Column, Table


def test_a_table():
    table = Table((Column("name | key"), Column("length", "mm", ".1f")), (("a*b", 1.25), ("c", None)))
    assert markdown_table(table).splitlines() == [
        "| name \\| key | length, mm |",
        "| --- | ---: |",
        "| a\\*b | 1.2 |",
        "| c |  |",
    ]


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("# a", "\\# a"),
        ("### a", "##\\# a"),
        ("- a", "\\- a"),
        ("+ a", "\\+ a"),
        ("12. a", "12\\. a"),
        ("3) a", "3\\) a"),
        ("---", "\\---"),
        ("> a", "\\> a"),
        ("-5.5", "-5.5"),
        ("600.5", "600.5"),
        ("#1", "#1"),
        ("$x$ ~a~ &amp;", "\\$x\\$ \\~a\\~ \\&amp;"),
    ],
)
def test_a_line_begins_no_block(text: str, shown: str):
    assert markdown_text(text) == shown


def test_lines_of_names_and_notes_stay_in_their_place():
    name = "a\n\n# heading\n| b |\u2028```\x1b"
    table = Table((Column(name),), ((name,),), name)
    report = Report(
        name, name, (ReportSection(name, (name,), name, "toml", (), (table,), ((name, name),)),), warnings=(name,)
    )
    lines = markdown_report(report).splitlines()
    headings = [number for number, line in enumerate(lines) if line.startswith("#")]
    rows = [line for line in lines if line.startswith("|")]
    fence = lines.index("````toml")
    code = range(fence, lines.index("````", fence))
    assert [number for number in headings if number not in code] == [0, 6]
    assert [line.count("|") - line.count("\\|") for line in rows if line != "| b |\\u2028```\\x1b"] == [2, 2, 2]
    assert all(line.isprintable() for line in lines)


def test_tables_have_their_titles_where_there_are_several():
    tables = (Table((Column("a"),), (("1",),), "one"), Table((Column("b"),), (("2",),), "two"))
    page = markdown_report(Report("T", "", (ReportSection("S", tables=tables), ReportSection("R", tables=tables[:1]))))
    assert [line for line in page.splitlines() if line.startswith("#")] == ["# T", "## S", "### one", "### two", "## R"]
