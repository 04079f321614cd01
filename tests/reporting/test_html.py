"""Reports as HTML: one file, without scripts or links, with every chart and table."""

import re
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import pytest

from armour.reporting.html import html_report
from armour.reporting.report import Card, Report, Section
from armour.reporting.scenario_report import Contents, contents_of, scenario_report
from armour.reporting.table import Column, Table
from armour.reporting.views import suite as suite_view
from armour.scenario.scenario import load_scenario
from tests.helpers.cases import SCENARIOS, scenario
from tests.helpers.results import OTHER, THREAT, design_result, uncertainty_result
from tests.helpers.suites import TABLE, case, result

NO_BREAK = "\N{NO-BREAK SPACE}"


@cache
def contents(name: str) -> Contents:
    return contents_of(load_scenario(SCENARIOS / f"{name}.toml"))


def page(found: Contents) -> str:
    return html_report(scenario_report(found, "armour report case.toml")).replace(NO_BREAK, " ")


@cache
def page_of(name: str) -> str:
    return page(contents(name))


def headings(content: str) -> list[str]:
    return re.findall(r"<h2>(.*?)</h2>", content)


class Nesting(HTMLParser):
    """Checks that elements are closed in the order in which they were opened."""

    VOID = ("meta",)

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, _attributes: object) -> None:
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attributes: object) -> None:
        """An element that is closed at once."""

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.mark.parametrize("name", ["wilkins", "bare_plate", "paper/optimum_7.62mm_AP", "catalogue"])
def test_a_page_is_one_file_without_scripts_and_links(name: str):
    content = page_of(name)
    assert len(content.encode()) < 400_000
    assert "<script" not in content
    assert not re.findall(r" (?:src|href)=|https?://(?!www\.w3\.org)|@import|url\((?!#chart)", content)
    assert "default-src 'none'" in content
    nesting = Nesting()
    nesting.feed(content)
    assert nesting.open == []
    ids = re.findall(r' id="([^"]*)"', content)
    assert len(ids) == len(set(ids))


def test_every_chart_and_table_has_its_heading():
    found = headings(page(contents_of(scenario())))
    [impact] = [heading for heading in found if heading.startswith("Impact: ")]
    assert impact.startswith("Impact: perforated at 800 m/s, residual velocity 277")
    first, *rest = [heading for heading in found if heading != impact]
    assert first == "Cross-section, to scale"
    assert {*rest[:2]} == {"Sensitivity to the inputs", "Where the projectile&#39;s energy went"}
    assert rest[2:] == [
        "Energy balance of the projectile",
        "Stages of the impact",
        "Sensitivity to the inputs",
        "Projectile: 7.62 mm AP",
        "Ceramic: AD85",
        "Metal: 6061-T6",
        "Scenario",
        "Origin",
    ]


def test_a_design_and_an_uncertainty_are_shown():
    several = replace(
        contents("wilkins"),
        design=design_result(threats=(THREAT, OTHER), pareto=True),
        uncertainty=uncertainty_result()._of(scenario=scenario()),
    )
    found = headings(page(several))
    for heading in ("Pareto front", "Probability of perforation", "Pairs of materials", "Margins against the threats"):
        assert heading in found
    assert found.count("Pareto front") == 2


def test_numbers_are_aligned_to_the_right():
    content = page_of("wilkins")
    assert '<th scope="col" class="number">energy lost, J</th>' in content
    assert re.search(r'<td data-label="energy lost, J" class="number">\d+\.\d</td>', content)
    assert '<td data-label="description" class="prose">intact ceramic, penetrated; rod erodes</td>' in content


def test_no_line_ends_between_a_number_and_its_unit():
    found = contents_of(scenario(title="6.35 mm AD85"))
    content = html_report(scenario_report(found, "armour report case.toml"))
    shown, code = content.split('<pre class="toml">')
    armour = f"6.35{NO_BREAK}mm AD85 on 6.35{NO_BREAK}mm <span>6061-T6</span>"
    assert f"<h1>{armour} against 7.62{NO_BREAK}mm AP at 800{NO_BREAK}m/s</h1>" in shown
    assert f"<b>{armour}</b>" in shown
    assert f"7.62{NO_BREAK}mm AP, 21.0{NO_BREAK}mm long, 6.5{NO_BREAK}mm in diameter</span>" in shown
    assert "title = &#34;6.35 mm AD85&#34;" in code


def test_no_line_ends_within_an_option_or_a_name():
    remarks = ("With --as-is <b>", "a --- b", "6061-T6, Ti-6Al-4V and half-open")
    content = html_report(Report("T", "", (), (), remarks=remarks))
    assert "<p>With <code>--as-is</code> &lt;b&gt;</p>" in content
    assert "<p>a --- b</p>" in content
    assert "<p><span>6061-T6</span>, <span>Ti-6Al-4V</span> and half-open</p>" in content
    [section] = [part for part in page_of("catalogue").split("<h2>") if part.startswith("Origin")]
    assert '<pre class="console">armour report case.toml</pre>' in section
    assert re.search(r"^code, p span.* { white-space: nowrap; }", content, re.MULTILINE)


def test_charts_stand_in_two_columns_of_nearly_the_same_height():
    content = page_of("catalogue")
    columns = content.split('<div class="column">')[1:]
    heights = [sum(map(float, re.findall(r'viewBox="0 0 \S+ (\S+)"', column))) for column in columns]
    assert len(heights) == 2
    assert abs(heights[0] - heights[1]) < 0.2 * max(heights)
    assert sorted(re.findall(r'class="chart" style="order: (\d)"', content)) == ["1", "2", "3", "4", "5"]


def test_texts_of_users_are_text():
    title = '<script>alert("x")</script> </script> & "quotes" <!--'
    found = contents_of(load_scenario(SCENARIOS / "bare_plate.toml", {"title": title}))
    content = html_report(scenario_report(found, "armour report '<b>'"))
    assert "<script" not in content
    assert "<!--" not in content
    assert "&lt;script&gt;alert" in content
    assert "&lt;b&gt;" in content


def test_control_characters_are_escaped():
    name = "\x1b[31m\x01\ufffe\u202e</pre><script>"
    table = Table((Column(name),), ((name,),))
    section = Section(name, (name,), f"{name}\n{name}", "toml", (table,), ((name, name),))
    content = html_report(Report(name, name, (section,), (), (Card(name, name, name),), (name,)))
    assert all(line.isprintable() for line in content.replace(NO_BREAK, " ").splitlines())
    assert content.count("\\x1b[31m\\x01\\ufffe\\u202e&lt;/pre&gt;&lt;script&gt;") == 16
    nesting = Nesting()
    nesting.feed(content)
    assert nesting.open == []


def test_names_of_materials_are_text():
    name = "<!--<script>"
    library = {"ceramic": {name: {"based_on": "AD85"}}}
    content = page(contents_of(scenario(ceramic=name, library=library)))
    assert "<script" not in content
    assert content.count("<!--") == 0


def test_a_suite(folder):
    outcome = result(folder, TABLE + case("own", 700.0, "band = 100.0"))
    content = html_report(suite_view.report(outcome, "armour report s.toml"))
    assert "3 of 4 within their bands" in content
    assert content.count('class="chart"') == 1
    assert "computed ballistic limit, m/s" in content
    nesting = Nesting()
    nesting.feed(content)
    assert nesting.open == []


def test_a_suite_without_numbers_has_no_chart(folder):
    outcome = 'scenario = "wilkins.toml"\nquantity = "outcome"\nexpected = "perforated"'
    content = html_report(suite_view.report(result(folder, f'[[case]]\nname = "o"\n{outcome}\n')))
    assert 'class="chart"' not in content
