"""Reports as one self-contained HTML file, without scripts."""

from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from armour.reporting.chart import Chart
from armour.reporting.charts import (
    energy_chart,
    frontier_chart,
    impact_chart,
    pareto_chart,
    parity_chart,
    sensitivity_chart,
    uncertainty_chart,
)
from armour.reporting.contents import Contents
from armour.reporting.inline_svg import inline_svg
from armour.reporting.tables.validation import note_table, suite_tables, verdict
from armour.reporting.wording import (
    ORIGIN,
    cards_of,
    energy_section,
    question_of,
    sections_of,
    title_of,
    version_table,
)
from armour.units import MM
from armour.validation.validate import SuiteResult

# Room round the drawing of the cross-section, mm.
ROOM_MM = 3.0


class Drawn(NamedTuple):
    """A chart as the page shows it."""

    heading: str
    svg: Markup
    note: str


class CrossSection(NamedTuple):
    """Armour and penetrator to scale, for the drawing; lengths in mm from its left edge and top."""

    width: float
    height: float
    font: float
    scale: float
    rod_start: float
    rod_length: float
    rod_diameter: float
    rod_name: str
    ceramic_start: float
    ceramic_thickness: float
    ceramic_name: str
    backing_thickness: float
    backing_name: str


def scenario_page(contents: Contents, command: str) -> str:
    """Return a report on a scenario as HTML.

    Parameters
    ----------
    contents : Contents
    command : str
        Command that makes the report.
    """
    energy = energy_section(contents)
    charts: list[Chart] = []
    if contents.design is not None:
        charts.append(frontier_chart(contents.design, "Required ceramic for each back plate"))
        if contents.design.pareto:
            charts.append(pareto_chart(contents.design, "Pareto front"))
    if contents.uncertainty is not None:
        charts.append(
            replace(uncertainty_chart(contents.uncertainty, contents.answer), title="Probability of perforation")
        )
    charts += [
        sensitivity_chart(contents.sensitivity, "Sensitivity to the inputs"),
        impact_chart(contents.impact, f"Impact of the {contents.answer.impact.projectile}"),
        energy_chart(contents.energy),
    ]
    return _rendered(
        "scenario.html",
        charts,
        title=title_of(contents),
        question=question_of(contents),
        cards=cards_of(contents),
        warnings=contents.warnings,
        drawing=_cross_section(contents),
        sections=(energy, *sections_of(contents)),
        scenario=contents.scenario.to_toml(),
        command=command,
    )


def suite_page(result: SuiteResult, command: str) -> str:
    """Return a report on a suite as HTML."""
    return _rendered(
        "suite.html",
        [replace(parity_chart(result), title="Computed and expected values")],
        title=result.title or result.file,
        verdict=verdict(result),
        passed=result.passed,
        tables=suite_tables(result),
        notes=note_table(result.checks),
        command=command,
    )


def _rendered(template: str, charts: list[Chart], **content: Any) -> str:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["zip"] = zip
    drawn = [
        Drawn(": ".join(chart.title.splitlines()), Markup(inline_svg(chart, f"chart{number}")), chart.note)
        for number, chart in enumerate(charts, start=1)
        if chart.panels
    ]
    page = environment.get_template(template)
    return page.render(charts=drawn, origin=ORIGIN, versions=version_table(), **content) + "\n"


def _cross_section(contents: Contents) -> CrossSection:
    armour, a = contents.answer.armour, contents.answer.core_armour()
    length, diameter = a.L0 / MM, a.D0 / MM
    thickness = armour.ceramic_thickness_mm + armour.backing_thickness_mm
    width = 4.0 * ROOM_MM + length + thickness
    return CrossSection(
        width=width,
        height=max(4.0 * diameter, 1.2 * thickness, 0.35 * width),
        font=0.032 * width,
        scale=10.0 if width > 30.0 else 5.0,
        rod_start=ROOM_MM,
        rod_length=length,
        rod_diameter=diameter,
        rod_name=f"{contents.answer.impact.projectile}: {length:.1f} by {diameter:g} mm",
        ceramic_start=2.0 * ROOM_MM + length,
        ceramic_thickness=armour.ceramic_thickness_mm,
        ceramic_name=armour.ceramic or "",
        backing_thickness=armour.backing_thickness_mm,
        backing_name=armour.backing,
    )
