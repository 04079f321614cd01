"""Reports as one self-contained HTML file, the charts as data for plotly.js, or as Markdown without charts."""

import json
import re
import sys
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from armour import MODEL_VERSION, __version__
from armour.design.catalogue import CRITERIA, StudyResult
from armour.design.optimisation import OptimumResult
from armour.reporting.contents import Contents, rod_mm
from armour.reporting.markdown import markdown_table, markdown_text
from armour.reporting.table import Column, Table
from armour.reporting.tables.design import margin_table, pair_table, pareto_table
from armour.reporting.tables.impact import energy_table
from armour.reporting.tables.library import entry_table
from armour.reporting.tables.statistics import elasticity_table, estimate_table
from armour.reporting.tables.validation import note_table, suite_tables, verdict
from armour.scenario.applicability import MODEL_ERROR_PERCENT
from armour.units import words_and_unit
from armour.validation.validate import SuiteResult

Chart = dict[str, Any]

BLUE, RED, GREEN, ORANGE, GREY = "#3B8FC4", "#D55E00", "#009E73", "#E69F00", "#888888"
# Drawing of the cross-section, in its own units: mm of armour, with room round it.
ROOM_MM = 3.0
# Packages whose versions the numbers can depend on.
PACKAGES = ("numpy", "scipy", "numba", "llvmlite")
MODEL = "Modeling penetration of ceramic/metal lightweight armours by small and medium caliber projectiles"


def scenario_page(contents: Contents, command: str) -> str:
    """A report on a scenario, as HTML."""
    charts = {
        "design": _design_chart(contents.optimum),
        "pareto": _pareto_chart(contents.optimum),
        "probability": _probability_chart(contents),
        "history": _history_chart(contents),
        "energy": _energy_chart(contents),
        "sensitivity": _sensitivity_chart(contents),
    }
    drawn = {name: chart for name, chart in charts.items() if chart is not None}
    return _rendered("scenario.html", drawn, section=_cross_section(contents), **_content(contents, command))


def scenario_markdown(contents: Contents, command: str) -> str:
    """A report on a scenario without its charts, as Markdown."""
    content = _content(contents, command)
    energy = content["ledger"]
    parts = [f"# {markdown_text(content['title'])}", markdown_text(content["question"])]
    parts += [
        "\n".join(
            f"* {name}: **{markdown_text(large)}**; {markdown_text(small)}" for name, large, small in content["cards"]
        ),
        *(f"Mind: {markdown_text(warning)}" for warning in content["warnings"]),
        "## Where the projectile's energy went",
        markdown_table(energy["table"]),
        f"{energy['before']} J at impact, {energy['left']} J left; the books close to {energy['difference']} J.",
    ]
    for heading, table in [*content["tables"], *content["entries"]]:
        parts += [f"## {markdown_text(heading)}", markdown_table(table)]
    parts += ["## Scenario", *_fenced(content["scenario"], "toml"), "## Where this comes from"]
    parts += [
        f"The model is that of one published paper, “{MODEL}”. Nobody's protection may depend on this report alone."
    ]
    parts += _fenced(command, "console")
    return "\n\n".join([*parts, markdown_table(content["versions"])]) + "\n"


def _fenced(text: str, language: str) -> list[str]:
    """Text as it stands, within a fence longer than any in it."""
    fence = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    return [f"{fence}{language}\n{text.rstrip()}\n{fence}"]


def _content(contents: Contents, command: str) -> dict[str, Any]:
    """What a report says, but for its drawings."""
    return {
        "title": contents.scenario.title or contents.scenario.file,
        "question": _question(contents),
        "cards": _cards(contents),
        "tables": _tables(contents),
        "ledger": _ledger(contents),
        "warnings": contents.warnings,
        "entries": [(f"{entry.kind}: {entry.name}", entry_table(entry)) for entry in contents.entries],
        "scenario": contents.scenario.to_toml(),
        **_provenance(command),
    }


def suite_page(result: SuiteResult, command: str) -> str:
    """A report on a suite, as HTML."""
    return _rendered(
        "suite.html",
        {"parity": _parity_chart(result)},
        title=result.title or result.file,
        verdict=verdict(result),
        passed=result.passed,
        tables=[(table.title, table) for table in suite_tables(result)],
        notes=note_table(result.checks),
        **_provenance(command),
    )


def _rendered(template: str, charts: Mapping[str, Chart], **content: Any) -> str:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from plotly.offline import get_plotlyjs

    folder = Path(__file__).parent / "templates"
    environment = Environment(
        loader=FileSystemLoader(folder),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    # "</" would end the script that holds the data.
    data = json.dumps(charts, ensure_ascii=False, allow_nan=False).replace("</", "<\\/")
    return environment.get_template(template).render(charts=charts, data=data, plotly=get_plotlyjs(), **content) + "\n"


def _provenance(command: str) -> dict[str, Any]:
    versions = [("armour", __version__), ("model", MODEL_VERSION), ("Python", sys.version.split()[0])]
    versions += [(name, version(name)) for name in PACKAGES]
    table = Table((Column("program"), Column("version")), tuple(versions))
    return {"versions": table, "command": command, "model": MODEL}


def _question(contents: Contents) -> str:
    """What the scenario asks."""
    optimum, impact = contents.optimum, contents.scenario.impact
    if isinstance(optimum, StudyResult):
        words = {"areal_density_kg_m2": "lightest", "thickness_mm": "thinnest", "cost_per_m2": "cheapest"}
        return f"Which is the {words[optimum.minimised]} armour on offer that defeats {' and '.join(optimum.threats)}?"
    if optimum is not None:
        armour = contents.scenario.armour
        pair = f"{armour.ceramic} on {armour.backing}" if armour.ceramic else armour.backing
        return f"Which is the lightest {pair} that defeats the {impact.projectile} at {impact.velocity_m_s:g} m/s?"
    return f"Does this armour stop the {impact.projectile} at {impact.velocity_m_s:g} m/s?"


def _cards(contents: Contents) -> list[tuple[str, str, str]]:
    """The answer: what it is about, in large, and in small."""
    armour, impact = contents.answer.armour, contents.answer.impact
    layers = [f"{armour.backing_thickness_mm:.4g} mm {armour.backing}"]
    if armour.ceramic is not None and armour.ceramic_thickness_mm > 0.0:
        layers.insert(0, f"{armour.ceramic_thickness_mm:.4g} mm {armour.ceramic}")
    areal, thickness = contents.impact.areal_density_kg_m2, armour.ceramic_thickness_mm + armour.backing_thickness_mm
    if isinstance(contents.optimum, StudyResult):
        areal, thickness = contents.optimum.best.areal_density_kg_m2, contents.optimum.best.thickness_mm
    found = "Build" if contents.optimum is not None else "Armour"
    cards = [
        (found, " on ".join(layers), f"{thickness:.4g} mm thick"),
        ("It weighs", f"{areal:.1f} kg/m²", _cost(contents) or "per area of armour"),
        ("It stops", *_stopped(contents)),
        ("How sure", *_sure(contents)),
    ]
    if contents.optimum is None:
        outcome = {"defeated": "projectile stopped", "perforated": "armour perforated"}[contents.impact.outcome]
        cards[2] = ("Outcome", outcome, f"at {impact.velocity_m_s:g} m/s; {_stopped(contents)[1]}")
    return cards


def _cost(contents: Contents) -> str:
    """What the design costs, where costs are given."""
    cost = contents.optimum.best.cost_per_m2 if isinstance(contents.optimum, StudyResult) else 0.0
    return f"and costs {cost:,.0f} per m²" if cost > 0.0 else ""


def _stopped(contents: Contents) -> tuple[str, str]:
    impact = contents.answer.impact
    if contents.limit is None:
        return (
            f"{impact.projectile} at {impact.velocity_m_s:g} m/s",
            "its ballistic limit is outside the range searched",
        )
    margin = contents.margin_m_s or 0.0
    return (
        f"{impact.projectile} at {impact.velocity_m_s:g} m/s",
        f"ballistic limit {contents.limit.ballistic_limit_m_s:.1f} m/s, a margin of {margin:+.1f} m/s",
    )


def _sure(contents: Contents) -> tuple[str, str]:
    """How sure the answer is: by the declared distributions, and by the model's error on tests."""
    mean, largest = MODEL_ERROR_PERCENT
    error = f"On Wilkins' 13 tests the model's limits are {mean:g} % off on average, {largest:g} % at most"
    if contents.uncertainty is not None:
        p = contents.uncertainty.probability_of_perforation
        words = f"perforated in {100.0 * p.value:.1f} % of samples"
        return words, f"{100.0 * p.low:.1f} to {100.0 * p.high:.1f} %, of the scatter declared. {error}."
    if contents.limit is None:
        return "not known", f"{error}."
    limit, margin = contents.limit.ballistic_limit_m_s, contents.margin_m_s or 0.0
    usual = mean / 100.0 * limit
    inside = "inside" if abs(margin) < usual else "beyond"
    large = f"± {usual:.0f} m/s"
    return large, f"{error}: the margin is {inside} that. {'Test before use.' if inside == 'inside' else ''}".strip()


def _tables(contents: Contents) -> list[tuple[str, Table]]:
    """Tables with their headings."""
    found: list[tuple[str, Table]] = []
    optimum: Any = contents.optimum
    if isinstance(optimum, StudyResult):
        found.append(("Margins against the threats", margin_table(optimum)))
        found.append(("Pairs of materials", pair_table(optimum)))
        if optimum.pareto:
            found.append(("Pareto front", pareto_table(optimum)))
    if contents.uncertainty is not None:
        found.append(("Under the scatter declared", estimate_table(contents.uncertainty)))
    found.append(("Sensitivity", elasticity_table(contents.sensitivity)))
    return found


def _ledger(contents: Contents) -> dict[str, Any]:
    """The ledger of energy in words."""
    energy = contents.energy
    return {
        "table": energy_table(energy),
        "before": f"{energy.before:.2f}",
        "left": f"{energy.left:.2f}",
        "difference": f"{energy.difference:.1e}",
    }


def _cross_section(contents: Contents) -> dict[str, Any]:
    """The armour and the penetrator to scale, in mm, as numbers for the drawing."""
    armour = contents.answer.armour
    length, diameter = rod_mm(contents.answer)
    ceramic, backing = armour.ceramic_thickness_mm, armour.backing_thickness_mm
    width = 2.0 * ROOM_MM + length + ROOM_MM + ceramic + backing + ROOM_MM
    height = max(4.0 * diameter, 1.2 * (ceramic + backing), 0.35 * width)
    front = 2.0 * ROOM_MM + length
    return {
        "width": width,
        "height": height,
        "rod": {"x": front - ROOM_MM - length, "y": 0.5 * (height - diameter), "width": length, "height": diameter},
        "ceramic": {"x": front, "width": ceramic, "name": armour.ceramic or ""},
        "backing": {"x": front + ceramic, "width": backing, "name": armour.backing},
        "rod_words": f"{contents.answer.impact.projectile}: {length:.1f} by {diameter:g} mm",
        "font": 0.032 * width,
        "scale": 10.0 if width > 30.0 else 5.0,
    }


def _axes(x: str, y: str, **more: Any) -> Chart:
    return {"xaxis": {"title": {"text": x}}, "yaxis": {"title": {"text": y}}, **more}


def _design_chart(optimum: OptimumResult | StudyResult | None) -> Chart | None:
    if optimum is None:
        return None
    backing = [design.backing_thickness_mm for design in optimum.frontier]
    ceramic = [design.ceramic_thickness_mm for design in optimum.frontier]
    areal = [design.areal_density_kg_m2 for design in optimum.frontier]
    governed = list(optimum.frontier_governed_by) if isinstance(optimum, StudyResult) else None
    hover = "%{customdata} mm on %{x} mm: %{y:.2f} kg/m²<extra></extra>"
    line = {"x": backing, "y": areal, "customdata": ceramic, "hovertemplate": hover, "name": "areal density"}
    best = optimum.best
    star = {
        "x": [best.backing_thickness_mm],
        "y": [best.areal_density_kg_m2],
        "customdata": [best.ceramic_thickness_mm],
        "hovertemplate": hover,
        "mode": "markers",
        "marker": {"symbol": "star", "size": 15, "color": RED},
        "name": "best",
    }
    thickness = {"x": backing, "y": ceramic, "yaxis": "y2", "line": {"color": ORANGE, "dash": "dot"}}
    thickness |= {"name": "required ceramic", "mode": "lines", "hovertemplate": "%{y} mm of ceramic<extra></extra>"}
    right = {"title": {"text": "required ceramic, mm"}, "overlaying": "y", "side": "right", "showgrid": False}
    lines = {**line, "mode": "lines+markers", "line": {"color": BLUE}}
    if governed is not None:
        told = "%{customdata} mm on %{x} mm: %{y:.2f} kg/m²<br>governed by %{text}<extra></extra>"
        lines |= {"text": governed, "hovertemplate": told}
    return {
        "heading": "What each back plate needs",
        "data": [lines, thickness, star],
        "layout": _axes("backing thickness, mm", "areal density, kg/m²", yaxis2=right),
    }


def _pareto_chart(optimum: OptimumResult | StudyResult | None) -> Chart | None:
    if not isinstance(optimum, StudyResult) or not optimum.pareto:
        return None
    x, y = optimum.criteria[:2]
    traces = []
    for pair in dict.fromkeys((item.ceramic, item.backing) for item in optimum.pareto):
        items = [item for item in optimum.pareto if (item.ceramic, item.backing) == pair]
        traces.append(
            {
                "x": [getattr(item, x) for item in items],
                "y": [getattr(item, y) for item in items],
                "text": [f"{item.ceramic_thickness_mm:g} on {item.backing_thickness_mm:g} mm" for item in items],
                "mode": "markers",
                "name": " on ".join(pair),
            }
        )
    return {"heading": "Pareto front", "data": traces, "layout": _axes(CRITERIA[x], CRITERIA[y])}


def _probability_chart(contents: Contents) -> Chart | None:
    if contents.uncertainty is None:
        return None
    curve = contents.uncertainty.curve
    x = list(curve.velocity_m_s)
    band: Chart = {"x": x + x[::-1], "y": [*curve.high, *curve.low[::-1]], "fill": "toself", "mode": "lines"}
    band |= {"line": {"width": 0}, "fillcolor": "rgba(59,143,196,0.3)", "name": "95 % band", "hoverinfo": "skip"}
    line = {"x": x, "y": list(curve.probability), "line": {"color": BLUE}, "name": "probability", "mode": "lines"}
    p = contents.uncertainty.probability_of_perforation
    point = {
        "x": [contents.answer.impact.velocity_m_s],
        "y": [p.value],
        "error_y": {"type": "data", "symmetric": False, "array": [p.high - p.value], "arrayminus": [p.value - p.low]},
        "mode": "markers",
        "marker": {"color": RED, "size": 8},
        "name": "at the threat's velocity",
    }
    layout = _axes("velocity, m/s", "probability of perforation")
    return {"heading": "Probability of perforation", "data": [band, line, point], "layout": layout}


def _history_chart(contents: Contents) -> Chart:
    history = contents.impact.history
    assert history is not None
    time = history.time_us.round(4).tolist()
    quantities = (
        ("projectile V", history.velocity_m_s, BLUE, "solid"),
        ("penetration U", history.penetration_velocity_m_s, ORANGE, "dash"),
        ("target W", history.target_velocity_m_s, GREEN, "dashdot"),
    )
    traces = [
        {
            "x": time,
            "y": values.round(3).tolist(),
            "name": name,
            "mode": "lines",
            "line": {"color": colour, "dash": dash},
            "text": [f"stage {stage}" for stage in history.stage.tolist()],
        }
        for name, values, colour, dash in quantities
    ]
    length = {"x": time, "y": history.length_mm.round(5).tolist(), "name": "rod length L", "yaxis": "y2"}
    traces.append({**length, "mode": "lines", "line": {"color": GREY, "dash": "dot"}})
    bands = [
        {
            "type": "rect",
            "xref": "x",
            "yref": "paper",
            "x0": stage.start_us,
            "x1": stage.end_us,
            "y0": 0,
            "y1": 1,
            "line": {"width": 0},
            "fillcolor": "rgba(128,128,128,0.12)" if index % 2 == 0 else "rgba(0,0,0,0)",
            "label": {"text": stage.stage, "textposition": "top center"},
        }
        for index, stage in enumerate(contents.impact.stages)
    ]
    right = {
        "title": {"text": "rod length, mm"},
        "overlaying": "y",
        "side": "right",
        "showgrid": False,
        "rangemode": "tozero",
    }
    impact = contents.answer.impact
    return {
        "heading": f"The {impact.projectile} at {impact.velocity_m_s:g} m/s: {contents.impact.outcome}",
        "data": traces,
        "layout": _axes("time since impact, us", "velocity, m/s", shapes=bands, yaxis2=right),
    }


def _energy_chart(contents: Contents) -> Chart:
    energy = contents.energy
    stages = [f"{index + 1}. stage {row.stage}" for index, row in enumerate(energy.rows)]
    layout = _axes("J", "", barmode="stack")
    layout["yaxis"] = {"autorange": "reversed", "automargin": True}
    bars = {"type": "bar", "orientation": "h"}
    eroded, braked = [row.eroded for row in energy.rows], [row.braked for row in energy.rows]
    left = {**bars, "y": ["left"], "x": [energy.left], "name": "left in the projectile", "marker": {"color": GREY}}
    return {
        "heading": "Where the projectile's energy went",
        "data": [
            {**bars, "y": stages, "x": eroded, "name": "with what eroded", "marker": {"color": ORANGE}},
            {**bars, "y": stages, "x": braked, "name": "braking the rod", "marker": {"color": BLUE}},
            left,
        ],
        "layout": layout,
    }


def _sensitivity_chart(contents: Contents) -> Chart:
    result = contents.sensitivity
    colours = (BLUE, ORANGE, GREEN)
    traces = [
        {
            "type": "bar",
            "orientation": "h",
            "y": [item.input for item in result.inputs],
            "x": [item.elasticities[name] for item in result.inputs],
            "name": words_and_unit(name)[0],
            "marker": {"color": colours[index]},
        }
        for index, name in enumerate(name for name in result.answers if name != "residual_velocity_m_s")
    ]
    layout = _axes("% per % of the input", "", barmode="group")
    layout["yaxis"] = {"autorange": "reversed", "automargin": True}
    return {"heading": "What matters", "data": traces, "layout": layout, "tall": True}


def _parity_chart(result: SuiteResult) -> Chart:
    groups: dict[str, tuple[list[float], list[float], list[str]]] = {}
    for check in result.checks:
        if isinstance(check.computed, float) and not isinstance(check.case.expected, str):
            expected, computed, names = groups.setdefault(check.case.group or "cases", ([], [], []))
            expected.append(float(check.case.expected))
            computed.append(check.computed)
            names.append(check.case.name)
    traces: list[Chart] = [
        {"x": expected, "y": computed, "text": names, "mode": "markers", "name": name}
        for name, (expected, computed, names) in groups.items()
    ]
    ends = [value for x, y, _ in groups.values() for value in (*x, *y)]
    if ends:
        span = [min(ends), max(ends)]
        agreement = {"x": span, "y": span, "mode": "lines", "line": {"color": GREY}, "name": "agreement"}
        traces.append(agreement)
    return {"heading": "Computed over expected", "data": traces, "layout": _axes("expected", "computed"), "tall": True}
