"""Reports as one self-contained HTML file, without scripts."""

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from armour.reporting.inline_svg import inline_svg
from armour.reporting.report import Report


def html_report(report: Report) -> str:
    """Format a report as HTML."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["zip"] = zip
    charts = [
        {
            "heading": ": ".join(chart.title.splitlines()),
            "svg": Markup(inline_svg(chart, f"chart{number}")),
            "note": chart.note,
        }
        for number, chart in enumerate(report.charts, start=1)
        if chart.panels
    ]
    return environment.get_template("report.html").render(report=report, charts=charts) + "\n"
