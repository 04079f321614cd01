"""The navigation of the site, and its pages that the program fills; `make site` builds it and checks every link."""

import json
import re
from pathlib import Path

import pytest

import armour
from armour.cli.app import app
from armour.scenario.library import named_threats
from tests.helpers.cases import scenario

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
CONFIGURATION = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
NAVIGATION = re.findall(r"[:-] (\S+\.(?:md|ipynb))$", CONFIGURATION, re.MULTILINE)
RECORDS = re.findall(r"^  (\S+\.md)$", CONFIGURATION, re.MULTILINE)


@pytest.fixture
def site():
    pytest.importorskip("mkdocs")
    from tools import site

    return site


def test_every_page_is_in_the_navigation_once_or_a_record(site):
    pages = [path.relative_to(DOCS).as_posix() for ending in ("md", "ipynb") for path in DOCS.rglob(f"*.{ending}")]
    assert sorted([*NAVIGATION, *RECORDS]) == sorted([*pages, *site.OUTSIDE])


def test_the_old_places_of_moved_pages_forward(site):
    for name in site.MOVED:
        assert (DOCS / "evidence" / f"{name}.md").exists()
        assert not (DOCS / f"{name}.md").exists()
    assert 'location.replace("new.html" + location.hash)' in site.FORWARD.format(place="new.html")


def test_what_a_page_asks_for_is_there(site):
    asked = [
        line for page in DOCS.rglob("*.md") for line in re.findall(r"^<!-- site: (.+) -->$", page.read_text(), re.M)
    ]
    assert {line.split()[0] for line in asked} == site.PARTS.keys()


def test_the_api_has_every_public_name_once(site):
    pages = [site.filled(page.read_text(encoding="utf-8")) for page in (DOCS / "reference" / "api").glob("*.md")]
    assert sorted(re.findall(r"^::: armour\.(\w+)$", "\n".join(pages), re.MULTILINE)) == sorted(dir(armour))


def test_the_command_line_has_every_command(site):
    text = site.commands()
    for command in app.registered_commands:
        assert f"\n## `armour {command.name}`\n" in text


def test_the_page_of_keys_has_every_section_and_its_links_lead_to_them(site):
    text = site.scenario()
    anchors = {site.slugify(heading.replace("`", ""), "-") for heading in re.findall(r"^## (.+)$", text, re.MULTILINE)}
    assert set(re.findall(r"\]\(#([^)]+)\)", text)) <= anchors
    assert len(anchors) == len(armour_sections()) + 1


def armour_sections() -> set[str]:
    from armour.scenario.scenario import scenario_schema

    return set(re.findall(r'"#/\$defs/(\w+)"', json.dumps(scenario_schema())))


def test_the_library_has_every_entry_with_its_sources(site):
    for kind, entries in armour.shipped_library().entries.items():
        text = site.entries(kind)
        assert re.findall(r"^## (.+)$", text, re.MULTILINE) == list(entries)
    assert "\\[Ryan2023]" in text
    text = site.threats()
    assert all(f"## {name}\n" in text and threat.source in text for name, threat in named_threats().items())


def test_the_error_is_known_of_what_was_tested_and_of_no_other_entry(site):
    found, library = site.tested_with(), armour.shipped_library()
    assert {("ceramic", "AD85"), ("metal", "6061-T6"), ("projectile", "7.62 mm AP")} < found.keys()
    assert not {("ceramic", "AD85 initial"), ("ceramic", "SiC"), ("metal", "Ti-6Al-4V")} & found.keys()
    assert not {("projectile", "7.62 mm B32"), ("projectile", "30 mm APDS")} & found.keys()
    for ceramic in library.names("ceramic"):
        known = armour.confidence(scenario(ceramic=ceramic)).model_error is not None
        assert known == (("ceramic", ceramic) in found), ceramic


def test_files_of_these_names_in_the_working_folder_are_not_read(site, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "tests").mkdir()
    for name in ("tests/plates", "tests/wilkins", "wilkins"):
        (tmp_path / name).write_text("a,b\n1,2\n")
    monkeypatch.chdir(tmp_path)
    assert site.tested_with.__wrapped__() == site.tested_with()


@pytest.mark.parametrize("kind", ["threat", "projectile", "metal", "ceramic"])
def test_a_table_of_the_library_links_every_name_to_its_values_and_says_what_it_was_tested_with(site, kind):
    rows = re.findall(rf"^\| \[(.+)\]\(library/{kind}s\.md#(\S+)\) \| (.*?) ?\|", site.library(kind), re.MULTILINE)
    page = (DOCS / "reference" / "library" / f"{kind}s.md").read_text(encoding="utf-8")
    assert [name for name, _, _ in rows] == re.findall(r"^## (.+)$", site.filled(page), re.MULTILINE)
    assert all(anchor == site.slugify(name, "-") for name, anchor, _ in rows)
    rounds = {name: ("projectile", threat.projectile) for name, threat in named_threats().items()}
    found = {name for name, _, tests in rows if tests}
    assert found == {name for name, _, _ in rows if rounds.get(name, (kind, name)) in site.tested_with()} != set()


def test_the_page_of_the_api_has_a_line_for_every_public_name(site):
    text = site.filled((DOCS / "reference" / "api.md").read_text(encoding="utf-8"))
    names = re.findall(r"^\| \[`(\w+)`\]\[armour\.\1\] \| \S.*\. \|$", text, re.MULTILINE)
    assert sorted(names) == sorted(dir(armour))


def test_no_description_of_the_api_ends_with_a_dash(site):
    html = '<code>Design</code>\n \u2013\n <div class="doc-md-description">\n </div>'
    assert "\u2013" not in site.on_page_content(html)


def test_a_formula_is_rendered_when_the_site_is_built(site):
    html = site.on_page_content('<p><span class="arithmatex">\\(Y_p &lt; Y\\)</span></p>')
    assert html == "<p>" + site.convert("Y_p < Y") + "</p>"
    html = site.on_page_content('<div class="arithmatex">\\[\nV = U \\tag{2, 3}\n\\]</div>')
    assert html == f'<div class="formula">{site.convert("V = U", display="block")}<span>(2, 3)</span></div>'


def test_a_reference_to_the_bibliography_keeps_its_brackets(site):
    link = '<a href="../references.html#Tate1967">Tate1967</a>'
    assert site.on_page_content(link) == f"[{link}]"


def test_no_formula_of_a_page_is_left_as_it_is_typed(site):
    from markdown import markdown

    for page in DOCS.rglob("*.md"):
        html = markdown(
            page.read_text(encoding="utf-8"),
            extensions=["md_in_html", "tables", "pymdownx.arithmatex", "pymdownx.superfences"],
            extension_configs={"pymdownx.arithmatex": {"generic": True}},
        )
        assert "\\" not in re.sub(r"<code>.*?</code>", "", site.on_page_content(html), flags=re.DOTALL).replace(
            "\\[", ""
        ), page
