from armour.reporting.markdown import markdown_report, markdown_table, markdown_text
from armour.reporting.report import Card, Report, Section
from armour.reporting.table import Column, Table


def test_a_table():
    table = Table((Column("name | key"), Column("length", "mm", ".1f")), (("a*b", 1.25), ("c", None)))
    assert markdown_table(table).splitlines() == [
        "| name \\| key | length, mm |",
        "| --- | ---: |",
        "| a\\*b | 1.2 |",
        "| c |  |",
    ]


def test_text_is_no_markup_and_one_line():
    assert markdown_text("a_b <i>\n[x](y) `z` \x1b[1m") == "a\\_b \\<i\\> \\[x](y) \\`z\\` \\\\x1b\\[1m"


def test_a_report():
    table = Table((Column("n"),), (("1",),))
    section = Section("H_1", ("A *word*.",), "x = 1\n", "toml", (table,), (("name", "no_te"),))
    cards = (Card("Subject", "so_so", "detail"), Card("Other", "yes", ""))
    report = Report("T_1", "Is it?", (section,), charts=(), cards=cards, warnings=("a_key",))
    assert markdown_report(report).split("\n\n") == [
        "# T\\_1",
        "Is it?",
        "* Subject: **so\\_so**; detail\n* Other: **yes**",
        "Warning: a\\_key",
        "## H\\_1",
        "A \\*word\\*.",
        "```toml\nx = 1\n```",
        "| n |\n| --- |\n| 1 |",
        "* name: no\\_te.\n",
    ]
