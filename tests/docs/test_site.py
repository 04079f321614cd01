"""The navigation of the site, and its pages that the program fills; `make site` builds it and checks every link."""

import re
from pathlib import Path

import pytest

import armour

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


def test_what_a_page_asks_for_is_there(site):
    asked = [
        line for page in DOCS.rglob("*.md") for line in re.findall(r"^<!-- site: (.+) -->$", page.read_text(), re.M)
    ]
    assert {line.split()[0] for line in asked} == site.PARTS.keys()


def test_the_api_has_every_public_name_once(site):
    pages = [site.filled(page.read_text(encoding="utf-8")) for page in (DOCS / "reference" / "api").glob("*.md")]
    assert sorted(re.findall(r"^::: armour\.(\w+)$", "\n".join(pages), re.MULTILINE)) == sorted(dir(armour))


def test_the_page_of_the_api_has_a_line_for_every_public_name():
    text = (DOCS / "reference" / "api.md").read_text(encoding="utf-8")
    names = re.findall(r"^\| \[`(\w+)`\]\(api/\w+\.md\) \| \S.*\. \|$", text, re.MULTILINE)
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
    link = '<a href="../references.html#tate1967">Tate1967</a>'
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
