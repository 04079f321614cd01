"""Charts of results: what each shows, as descriptions that are drawn to files and into reports."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from armour.analysis.closed_forms import residual_velocity
from armour.analysis.quantities import QUANTITIES
from armour.reporting.chart import (
    BLUE,
    COLOURS,
    GREEN,
    INK,
    MARKERS,
    ORANGE,
    PURPLE,
    SOFT,
    STYLES,
    VERMILION,
    Axis,
    Band,
    Bars,
    Chart,
    Contours,
    Line,
    Map,
    Panel,
    Points,
    Rule,
    Series,
    Spans,
)
from armour.reporting.tables.impact import STAGES
from armour.scenario.parameters import BACKING, CERAMIC, INPUTS
from armour.units import MM, words_and_unit

if TYPE_CHECKING:
    from armour.analysis.ballistic_limit import LimitResult
    from armour.analysis.comparison import Comparison
    from armour.analysis.energy import EnergyBalance
    from armour.analysis.impact import ImpactResult
    from armour.design.optimise import Design, DesignResult, Pair
    from armour.scenario.loading import Scenario
    from armour.statistics.calibration import CalibrationResult, Residual
    from armour.statistics.sensitivity import SensitivityResult
    from armour.statistics.uncertainty import UncertaintyResult
    from armour.statistics.v50 import FiringResult, Shots
    from armour.validation.figures import Figure
    from armour.validation.validate import Check, SuiteResult

Floats = NDArray[np.float64]

# Below this part of the impact velocity the projectile hardly moves; 1.5 times the time until then is shown.
SLOW = 0.05
# A curve whose least value is below this part of its largest is drawn from zero.
MOSTLY_FROM_ZERO = 0.3
# Width of a column of a two-column page, inches.
COLUMN_INCHES = 3.45
# Look of the best design.
BEST: dict[str, Any] = {"marker": "*", "size": 11.0, "colour": VERMILION}
# Pairs of materials beside the best that are marked, and rows of bars.
MAX_PAIRS, MAX_ROWS = 4, 40
# Probabilities between which the curve of a chart is shown whole.
SHOWN_PROBABILITY = 0.002


def quantity_axis(name: str, *, from_zero: bool = False) -> Axis:
    """Return the axis of a quantity, or of an input, in words."""
    if name in QUANTITIES:
        words, unit = QUANTITIES[name].label, QUANTITIES[name].unit
    else:
        words, unit = words_and_unit(name)
        words = words.replace("backing", "back plate").replace("youngs", "Young's").replace("m2", "m²")
        role = {"impact": "impact", "projectile": "projectile", "ceramic": "ceramic", "backing": "back plate"}
        prefix = role.get(name.partition(".")[0], "") if "." in name else ""
        if prefix and not words.startswith(("penetrator", "projectile")):
            words = f"{prefix} {words}"
    return Axis(words, "µs" if unit == "us" else unit, from_zero=from_zero)


def _split(heading: str, **more: Any) -> Axis:
    """Return the axis of a heading "label, unit"."""
    label, comma, unit = heading.rpartition(", ")
    return Axis(label, unit, **more) if comma else Axis(heading, **more)


def impact_chart(result: "ImpactResult", title: str) -> Chart:
    """Describe an impact over time: velocities, rod length, depth and bulge, with its stages.

    Parameters
    ----------
    result : ImpactResult
        With its history.
    title : str

    Raises
    ------
    ValueError
        If the result has no history.
    """
    history = result.history
    if history is None:
        raise ValueError("the result has no history; simulate(..., history=True) keeps it")
    slow = history.time_us[history.velocity_m_s <= SLOW * result.impact_velocity_m_s]
    shown = min(result.duration_us, 1.5 * float(slow[0])) if slow.size else result.duration_us
    seen = history.time_us <= shown
    time = history.time_us[seen].tolist()
    axis = Axis("time since impact", "µs", limits=(0.0, max(shown, 1e-9)))
    stages = [stage for stage in result.stages if stage.start_us < shown]
    starts, ends = [stage.start_us for stage in stages], [min(stage.end_us, shown) for stage in stages]
    names = tuple(stage.stage for stage in stages)
    text = tuple(
        f"stage {stage.stage}: {STAGES[stage.stage]}\n{stage.start_us:.4g} to {stage.end_us:.4g} µs" for stage in stages
    )

    def line(values: Floats, label: str, colour: str, style: Any) -> Line:
        return Line(time, values[seen].tolist(), label, colour, style)

    velocities = (
        line(history.velocity_m_s, "projectile V", BLUE, "-"),
        line(history.penetration_velocity_m_s, "penetration U", ORANGE, "--"),
        line(history.target_velocity_m_s, "target W", GREEN, "-."),
    )
    depths = (
        line(history.depth_mm, "depth Z", PURPLE, "-"),
        line(history.bulge_height_mm, "bulge h", VERMILION, "-."),
    )
    lengths = (line(history.length_mm, "rod length L", INK, "-"),)
    shading = Spans(starts, ends)
    outcome = f"defeated at {result.impact_velocity_m_s:g} m/s"
    if result.outcome == "perforated":
        outcome = (
            f"perforated at {result.impact_velocity_m_s:g} m/s, "
            f"residual velocity {result.residual_velocity_m_s:.1f} m/s"
        )
    return Chart(
        title=f"{title}\n{outcome}".strip(),
        panels=(
            Panel(axis, Axis("velocity", "m/s"), (Spans(starts, ends, names, text), *velocities), height=1.1),
            Panel(axis, Axis("rod length", "mm", from_zero=True), (shading, *lengths), height=0.65, shares_x=True),
            Panel(axis, Axis("depth, bulge", "mm"), (shading, *depths), height=0.75, shares_x=True),
        ),
        note="Stages: "
        + "; ".join(f"{name} {STAGES[name]}" for name in dict.fromkeys(names)).replace("; rod", ", rod"),
        width=6.0,
    )


def limit_chart(limit: "LimitResult", curve: Sequence["ImpactResult"], title: str) -> Chart:
    """Describe the residual velocity over impact velocity, with the ballistic limit.

    Parameters
    ----------
    limit : LimitResult
    curve : sequence of ImpactResult
        In the order of impact velocity.
    title : str
    """
    impact = [result.impact_velocity_m_s for result in curve]
    found = limit.ballistic_limit_m_s
    series = (
        Line(impact, impact, "no armour", INK, ":", 1.0),
        Line(impact, [result.residual_velocity_m_s for result in curve], "projectile", BLUE),
        Line(impact, [result.plug_velocity_m_s for result in curve], "plug", GREEN, "--"),
        Rule(found, f"ballistic limit {found:.1f} m/s", VERMILION),
    )
    x = Axis("impact velocity", "m/s", limits=(impact[0], impact[-1]))
    return Chart(title, (Panel(x, Axis("residual velocity", "m/s", from_zero=True), series, height=1.2),))


def design_chart(result: "DesignResult", title: str) -> Chart:
    """Describe the designs of a search: what each back plate needs, other pairs, the best, and the Pareto front."""
    frontier = frontier_chart(result, title)
    if not result.pareto:
        return frontier
    named = {_pair(item) for item in (result.best, *_others(result))}
    [front] = pareto_chart(result, "").panels
    series = tuple(
        replace(item, label="") if isinstance(item, Points) and item.label in named else item for item in front.series
    )
    return replace(frontier, panels=(*frontier.panels, replace(front, series=series, title="Pareto front")))


def _others(result: "DesignResult") -> list["Pair"]:
    """Return the pairs of materials beside the best that are marked."""
    return [pair for pair in result.pairs if pair.best is not None and pair.reason][:MAX_PAIRS]


def _looks(result: "DesignResult") -> dict[str, tuple[str, str]]:
    """Return colour and marker of every pair of materials."""
    names = dict.fromkeys(_pair(item) for item in (result.best, *_others(result), *result.pareto))
    return {name: (COLOURS[index % len(COLOURS)], MARKERS[index % len(MARKERS)]) for index, name in enumerate(names)}


def frontier_chart(result: "DesignResult", title: str) -> Chart:
    """Describe what each back plate of the best pair needs, with the best designs of other pairs."""
    best, looks = result.best, _looks(result)
    backing = [design.backing_thickness_mm for design in result.frontier]
    governed = result.frontier_governed_by if len(result.threats) > 1 else ("",) * len(result.frontier)
    text = tuple(
        _design_text(design) + (f"\ngoverned by {threat}" if threat else "")
        for design, threat in zip(result.frontier, governed, strict=True)
    )
    line: dict[str, Any] = {"colour": looks[_pair(best)][0], "marker": "o", "text": text}
    areal: list[Series] = [
        Line(backing, [design.areal_density_kg_m2 for design in result.frontier], _pair(best), **line)
    ]
    required: list[Series] = [Line(backing, [design.ceramic_thickness_mm for design in result.frontier], **line)]
    for pair in _others(result):
        assert pair.best is not None
        place = [pair.best.backing_thickness_mm], [pair.best.areal_density_kg_m2]
        words = (f"{_pair(pair)}\n{_design_text(pair.best)}",)
        areal.append(Points(*place, f"{_pair(pair)}: {pair.reason}", *looks[_pair(pair)], filled=False, text=words))
    marked: list[tuple[str, Design, dict[str, Any]]] = [("best", best, BEST)]
    if result.refined is not None:
        marked.append(("refined", result.refined, {"marker": "D", "colour": ORANGE}))
    for name, design, style in marked:
        label = f"{name}: {_thicknesses(design)}, {design.areal_density_kg_m2:.2f} kg/m²"
        x, words = [design.backing_thickness_mm], (f"{name}\n{_design_text(design)}",)
        areal.append(Points(x, [design.areal_density_kg_m2], label, **style, text=words))
        required.append(Points(x, [design.ceramic_thickness_mm], **style, text=words))
    axis = Axis("back plate thickness", "mm")
    panels = (
        Panel(axis, Axis("areal density", "kg/m²"), tuple(areal)),
        Panel(axis, Axis("required ceramic thickness", "mm"), tuple(required), shares_x=True),
    )
    return Chart(title, panels)


def pareto_chart(result: "DesignResult", title: str) -> Chart:
    """Describe the Pareto front over its first two criteria, a series for each pair of materials."""
    looks = _looks(result)
    x, y = result.criteria[:2]
    series: list[Series] = []
    for name, designs in _grouped(result.pareto, _pair).items():
        text = tuple(f"{name}\n{_design_text(design)}" for design in designs)
        xs, ys = ([getattr(design, key) for design in designs] for key in (x, y))
        series.append(Points(xs, ys, name, *looks[name], filled=False, text=text))
    best = [getattr(result.best, x)], [getattr(result.best, y)]
    series.append(Points(*best, **BEST, text=(f"best\n{_design_text(result.best)}",)))
    return Chart(title, (Panel(quantity_axis(x), quantity_axis(y), tuple(series)),))


def _pair(item: Any) -> str:
    return f"{item.ceramic} on {item.backing}" if item.ceramic else str(item.backing)


def _thicknesses(design: "Design") -> str:
    return f"{design.ceramic_thickness_mm:.4g} on {design.backing_thickness_mm:.4g} mm"


def _design_text(design: "Design") -> str:
    words = f"{_thicknesses(design)}, {design.areal_density_kg_m2:.2f} kg/m²"
    return words + (f", {design.cost_per_m2:,.2f} per m²" if design.cost_per_m2 > 0.0 else "")


def figure_chart(figure: "Figure") -> Chart:
    """Describe a figure of the paper: the model's curves, with the numbers of the paper's text as marks."""
    x = _split(figure.x_label, limits=(figure.x[0], figure.x[-1]))
    series: list[Series] = [
        Line(figure.x, curve.values, curve.label, COLOURS[index], STYLES[index])
        for index, curve in enumerate(figure.curves)
    ]
    series += (Rule(level.value, level.label, INK, ":", vertical=False) for level in figure.levels)
    colours = {curve.label: colour for curve, colour in zip(figure.curves, COLOURS, strict=False)}
    for mark, marker, size in zip(figure.marks, ("*", "D", "s"), (9.0, 5.0, 5.0), strict=False):
        xs, ys = zip(*mark.points, strict=True)
        series.append(Points(xs, ys, mark.label, colours.get(mark.of, SOFT), marker, size))
    shown = [value for curve in figure.curves for value in curve.values if value is not None]
    from_zero = bool(shown) and min(shown) < MOSTLY_FROM_ZERO * max(shown)
    panel = Panel(x, _split(figure.y_label, from_zero=from_zero), tuple(series))
    return Chart(figure.title, (panel,), width=COLUMN_INCHES)


def parity_chart(result: "SuiteResult") -> Chart:
    """Describe computed over expected values of a suite's tables, a panel for each quantity.

    A suite without tables shows its cases.
    """
    numbers = [check for check in result.checks if check.deviation is not None]
    checks = [check for check in numbers if check.case.group] or numbers
    by_quantity = _grouped(checks, lambda check: check.case.quantity)
    return Chart("", tuple(_parity_panel(name, found) for name, found in by_quantity.items()), width=COLUMN_INCHES)


def _parity_panel(quantity: str, checks: Sequence["Check"]) -> Panel:
    axis = quantity_axis(quantity)
    series: list[Series] = []
    for index, (group, found) in enumerate(_grouped(checks, lambda check: check.case.group).items()):
        expected, computed = [c.case.expected for c in found], [c.computed for c in found]
        text = tuple(
            f"{c.case.name}\nexpected {axis.text(float(c.case.expected))}, computed {axis.text(float(c.computed or 0))}"
            for c in found
        )
        colour, marker = COLOURS[index % len(COLOURS)], MARKERS[index % len(MARKERS)]
        series.append(Points(expected, computed, group or "cases", colour, marker, filled=False, text=text))
    span = _span(value for item in series if isinstance(item, Points) for value in (*item.x, *item.y))
    series += _agreement(span, 0.1)
    x, y = (Axis(f"{word} {axis.label}", axis.unit, limits=span) for word in ("expected", "computed"))
    return Panel(x, y, tuple(series), square=True)


def _span(values: Iterable[float | None]) -> tuple[float, float]:
    """Return the range of values, a little wider than it is."""
    found = [value for value in values if value is not None]
    margin = 0.05 * (max(found) - min(found)) or 0.05 * abs(found[0]) or 1.0
    return min(found) - margin, max(found) + margin


def _agreement(span: tuple[float, float], part: float = 0.0) -> list[Series]:
    """Describe the line of agreement and, on request, lines a part away from it."""
    lines: list[Series] = [Line(span, span, "agreement", INK, width=0.8, text=("", ""))]
    for factor, label in ((1.0 - part, f"± {100.0 * part:g} %"), (1.0 + part, "")):
        if part:
            lines.append(Line(span, [factor * end for end in span], label, INK, ":", 0.8, text=("", "")))
    return lines


def _grouped(items: Iterable[Any], key: Any) -> dict[str, list[Any]]:
    groups: dict[str, list[Any]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups


def comparison_chart(result: "Comparison", title: str) -> Chart:
    """Describe the residual velocity by the model and by fits to it, with Florence's ballistic limits."""
    found = result.limit.ballistic_limit_m_s
    impact = [impact.impact_velocity_m_s for impact in result.curve]
    residual = [impact.residual_velocity_m_s for impact in result.curve]
    series: list[Series] = [Line(impact, residual, f"this model: ballistic limit {found:.1f} m/s", BLUE)]
    for fit, colour, style in zip(result.fits, COLOURS[1:], STYLES[1:], strict=False):
        fitted = [residual_velocity(velocity, found, fit.ratio, fit.exponent) for velocity in impact]
        label = f"{fit.name}: ratio {fit.ratio:.3f}, exponent {fit.exponent:.2f}"
        series.append(Line(impact, fitted, label, colour, style))
    for florence, colour, style in zip(result.florence, (ORANGE, PURPLE), (":", "--"), strict=False):
        limit = florence.ballistic_limit_m_s
        label = f"Florence, {florence.projectile}: ballistic limit {limit:.1f} m/s"
        series.append(Rule(limit, label, colour, style))
    y = Axis("residual velocity", "m/s", from_zero=True)
    return Chart(title, (Panel(Axis("impact velocity", "m/s"), y, tuple(series), height=1.2),))


def calibration_chart(result: "CalibrationResult", title: str) -> Chart:
    """Describe computed over measured values, and the deviations test by test, fitted and left out."""
    panels = []
    for quantity, residuals in _grouped(result.residuals, lambda residual: residual.quantity).items():
        panels.append(_measured_panel(quantity, residuals))
        exact = [residual for residual in residuals if not residual.bound]
        if exact:
            panels.append(_deviation_panel(quantity, exact))
    return Chart(title, tuple(panels))


def _measured_panel(quantity: str, residuals: Sequence["Residual"]) -> Panel:
    axis = quantity_axis(quantity)
    series: list[Series] = []
    labels = {"": "measured", "at least": "defeated at", "at most": "perforated at"}
    for (bound, label), colour, marker in zip(labels.items(), COLOURS, MARKERS, strict=False):
        found = [residual for residual in residuals if residual.bound == bound]
        if found:
            measured, computed = [r.measured for r in found], [r.computed for r in found]
            text = tuple(f"{r.test}\n{label} {axis.text(r.measured)}, computed {axis.text(r.computed)}" for r in found)
            series.append(Points(measured, computed, label, colour, marker, filled=False, text=text))
    span = _span(value for r in residuals for value in (r.measured, r.computed))
    x, y = (Axis(f"{word} {axis.label}", axis.unit, limits=span) for word in ("measured", "computed"))
    return Panel(x, y, (*series, *_agreement(span)), square=True)


def _deviation_panel(quantity: str, residuals: Sequence["Residual"]) -> Panel:
    """Describe deviations from measured values as bars; of many tests those with the largest."""
    title = f"deviation of the {quantity_axis(quantity).label}"
    shown = list(residuals)
    if len(shown) > MAX_ROWS:
        shown = sorted(shown, key=lambda r: -abs(_percent(r.computed, r.measured) or 0.0))[:MAX_ROWS]
        title += f", the {MAX_ROWS} largest of {len(residuals)}"
    series: list[Series] = [Rule(0.0)]
    for slot, (name, colour, label) in enumerate((("computed", BLUE, "fitted"), ("left_out", ORANGE, "leave-one-out"))):
        values = [_percent(getattr(residual, name), residual.measured) for residual in shown]
        text = tuple(
            f"{r.test}, {label}\n{v or 0.0:+.2f} % of {r.measured:g}" for r, v in zip(shown, values, strict=True)
        )
        series.append(Bars([0.0] * len(shown), values, label, colour, slot, 2, text))
    return Panel(Axis("deviation", "%"), Axis(categories=tuple(r.test for r in shown)), tuple(series), title)


def _percent(value: float | None, measured: float) -> float | None:
    return None if value is None else 100.0 * (value / measured - 1.0)


def sensitivity_chart(result: "SensitivityResult", title: str) -> Chart:
    """Describe the elasticities of every answer as bars, the inputs of the largest on top."""
    answers = [name for name, value in result.answers.items() if value is not None]

    def largest(elasticities: Mapping[str, float | None]) -> float:
        return max((abs(elasticities[name] or 0.0) for name in answers), default=0.0)

    inputs = sorted(result.inputs, key=lambda item: -largest(item.elasticities))
    names = tuple(quantity_axis(item.input).label for item in inputs)
    series: list[Series] = [Rule(0.0)]
    for slot, (answer, colour) in enumerate(zip(answers, COLOURS, strict=False)):
        label = quantity_axis(answer).label
        values = [item.elasticities[answer] for item in inputs]
        text = tuple(f"{label}: {v or 0.0:+.3f} %\nper % of {n}" for v, n in zip(values, names, strict=True))
        series.append(Bars([0.0] * len(values), values, label, colour, slot, len(answers), text))
    return Chart(title, (Panel(Axis("change per % of the input", "%"), Axis(categories=names), tuple(series)),))


def v50_chart(shots: "Shots", result: "FiringResult") -> Chart:
    """Describe shots, the curves fitted to them and their V50, with the model's ballistic limit where there is one."""
    series: list[Series] = []
    for complete, colour, marker in ((False, GREEN, "o"), (True, VERMILION, "^")):
        velocities = shots.of(complete=complete)
        kind = "complete penetration" if complete else "partial penetration"
        text = tuple(f"{kind} at {velocity:g} m/s" for velocity in velocities)
        series.append(Points(velocities, [float(complete)] * len(velocities), kind, colour, marker, text=text))
    slowest, fastest = min(shots.velocities_m_s), max(shots.velocities_m_s)
    reach, margin = fastest - slowest or 0.01 * fastest, 0.1 * (fastest - slowest)
    model, mean = result.model_ballistic_limit_m_s, result.mean
    ends = [end for fit in result.fits for end in (fit.v50_m_s, *fit.v50_interval_m_s)] + [model]
    wanted = [slowest, fastest, *(end for end in ends if end is not None)]
    low, high = max(slowest - reach, min(wanted) - margin), min(fastest + reach, max(wanted) + margin)
    x = np.linspace(low, high, 400).tolist()
    for fit, style, colour, height in zip(result.fits, STYLES, (BLUE, ORANGE), (0.47, 0.53), strict=False):
        series.append(
            Line(x, [fit.probability(v) for v in x], f"{fit.curve}: V50 {fit.v50_m_s:.1f} m/s", colour, style)
        )
        start, end = (edge if e is None else e for e, edge in zip(fit.v50_interval_m_s, (low, high), strict=True))
        words = f"{fit.curve}: V50 {fit.v50_m_s:.1f} m/s\n{100.0 * result.confidence:g} % interval"
        words += f" {start:.1f} to {end:.1f} m/s"
        series.append(Points([fit.v50_m_s], [height], colour=colour, x_ends=((start, end),), text=(words,)))
    if mean is not None:
        series.append(Rule(mean.v50_m_s, f"MIL-STD-662F: V50 {mean.v50_m_s:.1f} m/s", SOFT))
    if model is not None:
        inside = "" if low <= model <= high else ", outside the axis"
        series.append(Rule(model, f"this model: ballistic limit {model:.1f} m/s{inside}", INK, ":"))
    panel = Panel(
        Axis("impact velocity", "m/s", limits=(low, high)),
        Axis("probability of complete penetration", limits=(-0.02, 1.02)),
        tuple(series),
        height=1.1,
    )
    note = f"Bars at one half are {100.0 * result.confidence:g} % intervals of V50."
    return Chart(shots.file, (panel,), note)


def uncertainty_chart(result: "UncertaintyResult", scenario: "Scenario") -> Chart:
    """Describe the probability of perforation over velocity, and what each input does to the ballistic limit."""
    curve, p, at = result.curve, result.probability_of_perforation, scenario.impact.velocity_m_s
    found, percent = result.deterministic_m_s, f"{100.0 * result.confidence:g} %"
    text = tuple(
        f"perforated in {100.0 * value:.1f} % at {velocity:.1f} m/s\n{percent} interval {low:.3f} to {high:.3f}"
        for velocity, value, low, high in zip(curve.velocity_m_s, curve.probability, curve.low, curve.high, strict=True)
    )
    label = f"at {at:g} m/s: {p.value:.3f}, {p.low:.3f} to {p.high:.3f}"
    series: list[Series] = [
        Band(curve.velocity_m_s, curve.low, curve.high, colour=BLUE),
        Line(curve.velocity_m_s, curve.probability, f"probability, with its {percent} band", BLUE, text=text),
        Rule(found, f"nominal ballistic limit {found:.1f} m/s", INK, ":"),
    ]
    for name, style in (("V05", "-."), ("V50", "-"), ("V95", "--")):
        place = result.ballistic_limit_m_s[name].value
        series.append(Rule(place, f"{name} {place:.1f} m/s", SOFT, style))
    series.append(Points([at], [p.value], label, VERMILION, y_ends=((p.low, p.high),), text=(f"perforated {label}",)))
    swings = [limit for index in result.inputs for limit in index.limits_m_s]
    uncertain = [
        velocity
        for velocity, value in zip(curve.velocity_m_s, curve.probability, strict=True)
        if SHOWN_PROBABILITY < value < 1.0 - SHOWN_PROBABILITY
    ]
    places = (result.ballistic_limit_m_s[name].value for name in ("V05", "V95"))
    x = Axis("velocity", "m/s", limits=_span([at, found, *places, *uncertain, *swings]))
    panels = [Panel(x, Axis("probability of perforation", limits=(0.0, 1.0)), tuple(series))]
    if result.inputs:
        names = tuple(quantity_axis(index.input).label for index in result.inputs)
        bars: list[Series] = []
        for side, colour, quantile in ((0, ORANGE, "5 %"), (1, PURPLE, "95 %")):
            limits = [index.limits_m_s[side] for index in result.inputs]
            words = tuple(
                f"{name} at its {quantile} quantile\nballistic limit {limit:.1f} m/s"
                for name, limit in zip(names, limits, strict=True)
            )
            label = f"input at its {quantile} quantile"
            bars.append(Bars([found] * len(limits), limits, label, colour, text=words))
        panels.append(
            Panel(
                x,
                Axis(categories=names),
                (*bars, Rule(found)),
                "Ballistic limit with one input changed",
                shares_x=True,
                height=0.5,
            )
        )
    return Chart(scenario.title, tuple(panels))


def energy_chart(energy: "EnergyBalance") -> Chart:
    """Describe where the projectile's kinetic energy went, stage by stage."""
    names = tuple(f"{index}. stage {row.stage}" for index, row in enumerate(energy.rows, start=1))
    categories = (*names, "left")
    eroded, braked = [row.eroded for row in energy.rows], [row.total for row in energy.rows]

    def words(label: str, values: Sequence[float]) -> tuple[str, ...]:
        parts = [100.0 * value / energy.before if energy.before > 0.0 else 0.0 for value in values]
        return tuple(
            f"{name}: {label}\n{value:.2f} J, {part:.1f} %"
            for name, value, part in zip(categories, values, parts, strict=True)
        )

    count = len(eroded)
    series = (
        Bars(
            [0.0] * (count + 1),
            [*eroded, 0.0],
            "carried off by eroded material",
            ORANGE,
            text=words("carried off", [*eroded, 0.0]),
        ),
        Bars(
            [*eroded, 0.0],
            [*braked, 0.0],
            "braking the rod",
            BLUE,
            text=words("braking", [*(row.braked for row in energy.rows), 0.0]),
        ),
        Bars(
            [None] * count + [0.0],
            [None] * count + [energy.left],
            "left in the projectile",
            SOFT,
            text=words("in the projectile", [0.0] * count + [energy.left]),
        ),
    )
    x = Axis("kinetic energy", "J", from_zero=True)
    return Chart("Where the projectile's energy went", (Panel(x, Axis(categories=categories), series),))


def sweep_chart(table: Mapping[str, Floats], keys: Sequence[str], name: str, scenario: "Scenario") -> Chart:
    """Describe a quantity over the one or two keys of a sweep: a curve, or a map with contours.

    Over both thicknesses lines of equal areal density are added.

    Parameters
    ----------
    table : mapping of str to array
        Columns of the sweep, in the order of its grid.
    keys : sequence of str
        The keys swept.
    name : str
        The quantity.
    scenario : Scenario
    """
    axes = [_key_axis(key) for key in keys]
    answer = quantity_axis(name)
    if len(keys) == 1:
        values = _or_none(table[name])
        return Chart(scenario.title, (Panel(axes[0], answer, (Line(table[keys[0]].tolist(), values),), height=1.1),))
    x, y = (np.unique(table[key]) for key in keys)
    z = np.full((len(y), len(x)), np.nan)
    z[np.searchsorted(y, table[keys[1]]), np.searchsorted(x, table[keys[0]])] = table[name]
    rows = [_or_none(row) for row in z]
    series: list[Series] = [Map(x.tolist(), y.tolist(), rows, answer.heading)]
    if min(z.shape) > 1 and np.isfinite(z).any() and np.nanmin(z) < np.nanmax(z):
        series.append(Contours(x.tolist(), y.tolist(), rows, levels=8, at=0.3))
    note = ""
    if set(keys) == {CERAMIC, BACKING} and min(z.shape) > 1:
        ceramic, backing = np.meshgrid(x, y) if keys[0] == CERAMIC else np.meshgrid(x, y)[::-1]
        armour = scenario.core_armour()
        areal = armour.rho_c * MM * ceramic + armour.rho_B * MM * backing
        series.append(Contours(x.tolist(), y.tolist(), areal.tolist(), VERMILION, "dashed", 5, 0.8))
        note = "Dashed lines: equal areal density, kg/m²."
    return Chart(scenario.title, (Panel(axes[0], axes[1], tuple(series), height=1.2),), note)


def _key_axis(key: str) -> Axis:
    """Return the axis of a scenario's key; one that is no input keeps the name of its library entry."""
    if key in INPUTS or key.count(".") < 2:
        return quantity_axis(key)
    axis = quantity_axis(key.rsplit(".", 1)[-1])
    return Axis(f"{key.split('.')[-2]} {axis.label}", axis.unit)


def _or_none(values: Floats) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]
