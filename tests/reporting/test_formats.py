"""Reports as HTML, one file without scripts or links, with every chart and table, and as Markdown."""

import re
from functools import cache
from xml.etree import ElementTree

import pytest

from armour.reporting.by_result import drawing_of
from armour.reporting.formats import (
    WIDTH_INCHES,
    html_report,
    inline_svg,
    markdown_report,
    markdown_table,
    markdown_text,
)
from armour.reporting.pictures.drawing import BLUE, INK, PANEL, SOFT, Picture, Sheet, drawn, rows
from armour.reporting.report import Report, ReportSection
from armour.reporting.scenario_report import scenario_report
from armour.reporting.table import Column, Table
from armour.reporting.views.validation import suite_report
from armour.scenario.scenario import load_scenario
from tests.analysis.results import impact
from tests.helpers.cases import scenario
from tests.helpers.suites import TABLE, case, result

pytestmark = pytest.mark.slow

NO_BREAK = "\N{NO-BREAK SPACE}"


TITLE = '<script>alert("x")</script> </script> & "quotes" <!--'
SCENARIOS = {
    "as it is": lambda: scenario(title="6.35 mm AD85"),
    "bare plate": lambda: load_scenario("bare_plate", {"title": TITLE}),
}


@cache
def page_of(name: str) -> str:
    return html_report(scenario_report(SCENARIOS[name](), "armour report '<b>'"))


@cache
def impact_svg() -> str:
    picture = drawn(drawing_of(impact().of(scenario=scenario())), Sheet(WIDTH_INCHES), title="")
    return inline_svg(picture, "an impact", "a")


def rows_of_names(sheet: Sheet, name: str = "a") -> Picture:
    """A picture whose title, row, series and axis are a name."""
    picture = sheet.panels(name, PANEL)
    rows(picture.axes[0], [name], {name: [1.0]})
    picture.axes[0].set_xlabel(name)
    return picture


def headings(content: str) -> list[str]:
    return re.findall(r"<h2>(.*?)</h2>", content)


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_page_is_one_file_without_scripts_and_links(name: str):
    content = page_of(name)
    assert len(content.encode()) < 400_000
    assert "<script" not in content
    assert not re.findall(r" (?:src|href)=|https?://(?!www\.w3\.org)|@import|url\((?!#chart)", content)
    assert "default-src 'none'" in content
    ids = re.findall(r' id="([^"]*)"', content)
    assert len(ids) == len(set(ids))


def test_what_explains_the_answer_is_folded():
    answer, *folded = page_of("as it is").replace(NO_BREAK, " ").split("<details>")
    assert headings(answer)[:2] == ["Threats", "Cross-section, to scale"]
    assert [len(headings(part)) for part in folded] == [1] * 5
    assert re.findall("<h3>(.*?)</h3>", folded[2]) == ["Projectile: 7.62 mm AP", "Ceramic: AD85", "Metal: 6061-T6"]


def test_no_line_ends_between_a_number_and_its_unit():
    content = page_of("as it is")
    shown, code = content.split('<pre class="toml">')
    armour = f"6.35{NO_BREAK}mm AD85 on 6.35{NO_BREAK}mm 6061-T6"
    assert f"<h1>{armour} against 7.62{NO_BREAK}mm AP at 800{NO_BREAK}m/s</h1>" in shown
    assert f"{armour}, 39.2{NO_BREAK}kg/m²" in shown
    assert f"7.62{NO_BREAK}mm AP, 21.0{NO_BREAK}mm long, 6.5{NO_BREAK}mm in diameter</span>" in shown
    assert "title = &#34;6.35 mm AD85&#34;" in code


def test_texts_of_users_are_text():
    content = page_of("bare plate")
    assert "<script" not in content
    assert "<!--" not in content
    assert "&lt;script&gt;alert" in content
    assert "&lt;b&gt;" in content


def test_control_characters_are_escaped():
    name = "\x1b[31m\x01\ufffe\u202e</pre><script>"
    table = Table((Column(name),), ((name,),))
    section = ReportSection(name, (name,), f"{name}\n{name}", "toml", (), (table,), ((name, name),))
    content = html_report(Report(name, name, (section,), (name,), (name,)))
    assert all(line.isprintable() for line in content.replace(NO_BREAK, " ").splitlines())
    assert content.count("\\x1b[31m\\x01\\ufffe\\u202e&lt;/pre&gt;&lt;script&gt;") == 14


def test_a_suite(folder):
    outcome = result(folder, TABLE + case("own", 700.0, "band = 70.0"))
    content = html_report(suite_report(outcome, "armour report s.toml"))
    assert "3 of 4 within their bands" in content
    assert content.count('class="chart"') == 1
    assert "computed ballistic limit, m/s" in content


def test_colours_follow_the_theme():
    content = impact_svg()
    assert not [colour for colour in (INK, SOFT, BLUE) if colour in content]
    assert {"var(--ink)", "var(--soft)", "var(--blue)"} <= set(re.findall(r"var\(--[a-z]+\)", content))


def test_identifiers_of_two_charts_differ_and_refer_to_each_other():
    first, second = impact_svg(), inline_svg(drawn(rows_of_names, Sheet(WIDTH_INCHES), title=""), "T", "c")
    ids = [set(re.findall(r' id="([^"]*)"', content)) for content in (first, second)]
    assert ids[0]
    assert not ids[0] & ids[1]
    for content, own in zip((first, second), ids, strict=True):
        assert set(re.findall(r"url\(#([^)]*)\)", content)) <= own
        assert set(re.findall(r'href="#([^"]*)"', content)) <= own


@pytest.mark.parametrize("name", ["<!--</svg><script>alert(1)</script>url(#x)", "a\x08\x00\u2028b"])
def test_names_are_text(name: str):
    picture = drawn(lambda sheet: rows_of_names(sheet, name), Sheet(WIDTH_INCHES), title="")
    content = inline_svg(picture, name, "c")
    assert "<script" not in content
    assert "<!--" not in content
    shown = "".join(ElementTree.fromstring(content).itertext())
    assert (name if name.isprintable() else "a\\x08\\x00\\u2028b") in shown


def test_a_table_in_markdown():
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
def test_a_line_of_markdown_begins_no_block(text: str, shown: str):
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


def test_layers_without_ballistic_effect_are_drawn_in_their_places():
    names = {"cover": "front", "glue": "between", "liner": "behind", "foil": "front"}
    rest = {"thickness_mm": 0.5, "areal_density_kg_m2": 0.6}
    layers = [{"name": name, "place": place, **rest} for name, place in names.items()]
    of = scenario().replaced({"armour.layer": layers})
    report = Report("T", "v", (ReportSection("S"),), cross_section=of)
    content = html_report(report).replace(NO_BREAK, " ")
    _, *caption = re.findall(r"</i>([\d.]+ mm [^<]*)</span>", content)
    assert caption == ["0.5 mm cover", "0.5 mm foil", "6.35 mm AD85", "0.5 mm glue", "6.35 mm 6061-T6", "0.5 mm liner"]
    drawn = [float(width) for width in re.findall(r'y="0" width="([\d.]+)" height="[\d.]+" fill="var', content)]
    assert drawn == [0.5, 0.5, 6.35, 0.5, 6.35, 0.5]
