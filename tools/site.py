"""Hooks of the site, which mkdocs.yml names: they fill pages with what the program says of itself.

A line ``<!-- site: NAME ARGUMENT ... -->`` of a page stands for the Markdown that the function of this name in `PARTS`
returns, unless `tools.lists` has written it into the page.
"""

import re
import sys
from html import unescape
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert
from mkdocs.structure.files import File

import armour

sys.path.insert(0, str(Path(__file__).parents[1]))
from tools import lists
from tools.budget import LIST

DOCS = Path(__file__).parents[1] / "docs"
# Pages of the site whose text is kept elsewhere in the repository.
OUTSIDE = {"contributing.md": "CONTRIBUTING.md", "changes.md": "CHANGELOG.md"}


def api(package: str) -> str:
    """Return the directives of mkdocstrings for the public names of a package, functions first."""
    public = (name for name in dir(armour) if getattr(armour, name).__module__.split(".")[1] == package)
    names = sorted(public, key=lambda name: isinstance(getattr(armour, name), type))
    return "\n\n".join(f"::: armour.{name}" for name in names)


PARTS = {**lists.PARTS, "api": api}


def filled(markdown: str) -> str:
    """Return a page with its parts in their places."""
    unmarked = LIST.sub(lambda part: part[0].removeprefix(part[1]), markdown)
    return re.sub(r"^<!-- site: (\w+)(.*) -->$", lambda part: PARTS[part[1]](*part[2].split()), unmarked, flags=re.M)


def on_files(files: Any, config: Any) -> Any:
    """Add the pages that are kept outside of docs/."""
    for page, source in OUTSIDE.items():
        text = (DOCS.parent / source).read_text(encoding="utf-8").replace("](docs/", "](")
        files.append(File.generated(config, page, content=_inside(text, "")))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Fill a page, and make links of the keys of the bibliography."""
    up = "../" * page.file.src_uri.count("/")
    # A name leads to its description, which only the site has.
    markdown = re.sub(r"\[`(\w+)`\]\(api/\w+\.md\)", r"[`\1`][armour.\1]", markdown)
    markdown = filled(_inside(markdown, f"../{up}"))
    text = re.sub(r"\\\[(\w+)\]", lambda key: f"[{key[1]}]" if key[1] in lists.sources() else key[0], markdown)
    return "\n".join([text, "", *(f"[{key}]: {up}references.md#{key.lower()}" for key in lists.sources())])


def on_page_content(html: str, **_: Any) -> str:
    """Return the page with its formulas as MathML and its drawings inline, in the colours of the page."""
    html = re.sub(r'<(span|div) class="arithmatex">\\[\[(](.+?)\\[\])]</\1>', _formula, html, flags=re.DOTALL)
    html = re.sub(r'<img alt="([^"]+)" src="[./]*images/([\w-]+\.svg)" ?/?>', _drawing, html)
    # A reference to the bibliography keeps its brackets.
    html = re.sub(r'(<a href="[^"]*references\.html#\w+">\w+</a>)', r"[\1]", html)
    # mkdocstrings puts a dash before a description that is empty, and takes a type in words for Python.
    return re.sub(r'\u2013\s*<div class="doc-md-description">\s*</div>', "", html).replace("path - like", "path-like")


def _formula(found: re.Match[str]) -> str:
    """Return a formula in LaTeX as MathML, with the number of the equation beside it."""
    latex, _, tag = unescape(found[2]).partition(r"\tag")
    if found[1] == "span":
        return convert(latex)
    number = f"<span>({tag.strip().strip('{}')})</span>" if tag else ""
    return f'<div class="formula">{convert(latex.strip(), display="block")}{number}</div>'


def _drawing(found: re.Match[str]) -> str:
    """Return a drawing that takes the colour of the text as a part of the page; charts remain pictures."""
    drawing = (DOCS / "images" / found[2]).read_text(encoding="utf-8")
    if "currentColor" not in drawing:
        return found[0]
    # Its style is for where it is a picture.
    drawing = re.sub(r"<style>.*?</style>", "", drawing, flags=re.DOTALL)
    return drawing.replace("<svg ", f'<svg class="drawing" role="img" aria-label="{found[1]}" ', 1)


def _inside(markdown: str, up: str) -> str:
    """Return a page with its links to the pages kept outside of docs/ as links to those of the site."""
    for page, source in OUTSIDE.items():
        markdown = markdown.replace(f"]({up}{source}", f"]({up.removeprefix('../')}{page}")
    return markdown
