"""Format reports as HTML, one self-contained page without scripts, and reports and tables as Markdown.

Pictures in HTML are SVG, which follow the colours of the page.
"""

import re
from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from armour.files import printable
from armour.reporting.report import Report
from armour.reporting.table import Table, printable_lines, unbroken

if TYPE_CHECKING:
    from armour.reporting.pictures.drawing import Picture, Sheet

REPORT_ENDINGS = (".html", ".md")
SVG, XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
TEMPLATES = Path(__file__).parent / "templates"
WIDTH_INCHES, POINTS_PER_INCH = 4.2, 72
# Colours of pictures, and the variables of the style sheet that replace them, so that pictures follow the theme.
THEME = {"#16191c": "var(--ink)", "#6a7178": "var(--soft)", "#0072b2": "var(--blue)", "#ffffff": "var(--paper)"}


def _safe_text(text: str) -> str:
    """Escape the control characters of a text, and keep numbers and their units on one line."""
    return unbroken(printable_lines(text))


def report_text(report: Report, path: Path) -> str:
    """Format a report as Markdown if the path ends in .md, else as HTML."""
    return markdown_report(report) if path.suffix.lower() == ".md" else html_report(report)


def html_report(report: Report) -> str:
    """Format a report as a page of HTML, with its pictures."""
    numbers = count(1)

    def shown(draw: "Callable[[Sheet], Picture]", heading: str) -> tuple[str, Markup, str]:
        from armour.reporting.pictures.drawing import Sheet, drawn

        picture = drawn(draw, Sheet(WIDTH_INCHES), title="")
        svg = inline_svg(picture, picture.title or heading, f"chart{next(numbers)}")
        return picture.title, Markup(svg), picture.note

    return rendered("report.html", report=report, shown=shown)


def rendered(template: str, safe_text: Callable[[str], str] = _safe_text, **context: Any) -> str:
    """Render a template of this package with the variables in `context`.

    `safe_text` is applied to every text inserted; HTML templates also escape it.
    """
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=select_autoescape(),
        finalize=lambda value: safe_text(value) if type(value) is str else value,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"zip": zip, "printable": printable_lines}
    return environment.get_template(template).render(context) + "\n"


def inline_svg(picture: "Picture", label: str, name: str) -> str:
    """Return a picture as the text of an SVG element, which screen readers announce by its label.

    `name` is a prefix of the element's identifiers, different for every picture of a page.
    """
    # Imported here, as it is slow, and not every page has pictures.
    from armour.reporting.pictures.drawing import saved

    figure = picture.figure
    figure.set_dpi(POINTS_PER_INCH)
    root = ElementTree.fromstring(saved(figure, ".svg", dpi=POINTS_PER_INCH, transparent=True))
    for part in root.findall(f"{{{SVG}}}metadata") + root.findall(f"{{{SVG}}}defs[{{{SVG}}}style]"):
        root.remove(part)
    for element in root.iter():
        for key, value in element.attrib.items():
            element.set(key, _adapted_attribute(key, value, name))
    for size in ("width", "height"):
        del root.attrib[size]
    root.attrib |= {"role": "group", "aria-label": printable_lines(label)}
    ElementTree.register_namespace("", SVG)
    ElementTree.register_namespace("xlink", XLINK)
    return ElementTree.tostring(root, encoding="unicode")


def _adapted_attribute(key: str, value: str, name: str) -> str:
    """Return the value of an SVG attribute, its identifiers prefixed by `name` and its colours those of the theme."""
    if key == "id":
        return f"{name}-{value}"
    if key == f"{{{XLINK}}}href" and value.startswith("#"):
        return f"#{name}-{value[1:]}"
    value = value.replace("url(#", f"url(#{name}-")
    if key == "style":
        value = re.sub(r"'DejaVu Sans'.*?(?=;|$)", "sans-serif", value)
        for colour, themed in THEME.items():
            value = value.replace(colour, themed)
    return value


def markdown_report(report: Report) -> str:
    """Format a report as Markdown, without its pictures."""
    return rendered("report.md", markdown_text, report=report, fenced=_fenced).rstrip() + "\n"


def markdown_table(table: Table) -> str:
    """Format a table as Markdown, without its title."""
    return rendered("table.md", markdown_text, table=table).rstrip()


def markdown_text(text: str) -> str:
    """Escape the markup and the control characters of a text, and join its lines."""
    text = re.sub(r"[\\|*_<>`\[~$&]", r"\\\g<0>", printable(" ".join(text.split())))
    # Also escape what would begin a heading, a list or a rule at the start of a line.
    return re.sub(r"^(#{0,5}|\d{0,9})([#+\-.)])(?=[ -]|$)", r"\1\\\2", text)


def _fenced(text: str, language: str) -> Markup:
    """Return text as a fenced block of code; the fence is longer than any run of backticks in the text."""
    text = printable_lines(text)
    fence = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    return Markup(f"{fence}{language}\n{text.rstrip()}\n{fence}")
