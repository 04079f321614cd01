"""Charts of results: what each shows, as descriptions that are drawn to files and into reports."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from armour.analysis.closed_forms import residual_velocity
from armour.errors import InputError, Problem
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
    Style,
)
from armour.reporting.tables.design import COST, MARGIN, THICKNESS
from armour.reporting.tables.impact import AREAL_DENSITY, STAGES, energy_table
from armour.reporting.tables.statistics import deviation_percent
from armour.reporting.text import interval, percent
from armour.reporting.words import words_of
from armour.scenario.inputs import BACKING, CERAMIC, VELOCITY
from armour.scenario.sections import TINY
from armour.units import MM

if TYPE_CHECKING:
    from armour.analysis.ballistic_limit import LimitResult
    from armour.analysis.energy import EnergyBalance
    from armour.analysis.impact import ImpactResult
    from armour.design.optimise import Design, DesignResult
    from armour.scenario.scenario import Scenario
    from armour.statistics.calibration import CalibrationResult, Residual
    from armour.statistics.sensitivity import SensitivityResult
    from armour.statistics.uncertainty import UncertaintyResult
    from armour.statistics.v50 import FiringResult, Shots
    from armour.validation.comparison import Comparison
    from armour.validation.figures import Figure
    from armour.validation.validate import SuiteResult

Floats = NDArray[np.float64]

# Width of a column of a two-column page, inches.
COLUMN_INCHES = 3.45
# Looks of the best designs, on the grid and between its values.
BEST: dict[str, Any] = {"marker": "*", "size": 11.0, "colour": VERMILION}
REFINED: dict[str, Any] = {"marker": "D", "colour": ORANGE}
# Pairs of materials beside the best that are marked, and rows of bars.
MAX_PAIRS, MAX_ROWS = 11, 40
# Rows of a sweep whose points are marked on a curve.
MAX_MARKERS = 40
# What designs are compared by, named as in their tables.
CRITERIA = {
    column.key: Axis(column.label, column.unit, spec=spec)
    for column, spec in ((AREAL_DENSITY, ".2f"), (THICKNESS, ".5g"), (COST, ".2f"), (MARGIN, "+.1f"))
}
# Cases that the chart of a suite does not show.
LEFT_OUT = "of no table, of outcomes, of relative differences and without an answer"
# Probabilities between which the curve of a chart is shown whole.
SHOWN_PROBABILITY = 0.002


def quantity_axis(name: str, **options: Any) -> Axis:
    """Return the axis of a quantity, an input or a key of a scenario, in words."""
    words, unit = words_of(name)
    return Axis(words, unit, **options)


def _velocity_rule(label: str, velocity: float, colour: str, style: Style = "-") -> Rule:
    """Return a line at a velocity, with its value in the legend."""
    return Rule(velocity, style, label=f"{label} {velocity:.1f} m/s", colour=colour)


def impact_chart(result: "ImpactResult") -> Chart:
    """Describe an impact over time, from its history: velocities, rod length, depth and bulge, with its stages."""
    history = result.history
    if history is None:
        raise ValueError("the result has no history; simulate(..., history=True) keeps it")
    # Below 5 % of the impact velocity the projectile hardly moves; 1.5 times the time until then is shown.
    slow = history.time_us[history.velocity_m_s <= 0.05 * result.impact_velocity_m_s]
    shown = min(result.duration_us, 1.5 * float(slow[0])) if slow.size else result.duration_us
    seen = history.time_us <= shown
    time = history.time_us[seen].tolist()
    velocities = {
        "projectile V": history.velocity_m_s,
        "penetration U": history.penetration_velocity_m_s,
        "target W": history.target_velocity_m_s,
    }
    depths = {"depth Z": history.depth_mm, "bulge h": history.bulge_height_mm}
    x = Axis("time since impact", "µs", limits=(0.0, max(shown, 1e-9)), spec=".2f")
    stages = [stage for stage in result.stages if stage.start_us < shown]
    words = (f"stage {s.stage}: {STAGES[s.stage]}\n{s.start_us:.4g} to {s.end_us:.4g} µs" for s in stages)
    ends = [min(stage.end_us, shown) for stage in stages]
    names = tuple(stage.stage for stage in stages)
    spans = Spans([stage.start_us for stage in stages], ends, names, text=tuple(words))
    panels: list[Panel] = []
    colours = iter((BLUE, ORANGE, GREEN, INK, PURPLE, VERMILION))
    for y, height, curves in (
        (Axis("velocity", "m/s", spec=".1f"), 1.1, velocities),
        (Axis("rod length", "mm", from_zero=True, spec=".2f"), 0.65, {"rod length L": history.length_mm}),
        (Axis("depth, bulge", "mm", spec=".2f"), 0.75, depths),
    ):
        lines = (
            Line(time, values[seen].tolist(), style, label=label, colour=next(colours))
            for (label, values), style in zip(curves.items(), STYLES, strict=False)
        )
        panels.append(Panel(x, y, (spans, *lines), height=height, shares_x=bool(panels)))
        # The first panel alone names the stages.
        spans = replace(spans, names=(), text=())
    outcome = f"Impact: {result.outcome} at {result.impact_velocity_m_s:g} m/s"
    if result.outcome == "perforated":
        outcome += f", residual velocity {result.residual_velocity_m_s:.1f} m/s"
    # The caption names every stage: some are too narrow for a name above the panel, or start after the time shown.
    parts = (f"{s.stage} from {s.start_us:.3g} µs, {_stage_words(s.stage)}" for s in result.stages)
    caption = f"Stages: {'; '.join(parts)}."
    if shown < result.duration_us:
        caption = f"Drawn up to {shown:.3g} µs of {result.duration_us:.3g} µs. {caption}"
    return Chart(outcome, tuple(panels), caption, width=6.0)


def _stage_words(stage: str) -> str:
    """Return what a stage is, as a part of a list."""
    return STAGES[stage].replace(";", ",")


def limit_chart(limit: "LimitResult", curve: Sequence["ImpactResult"]) -> Chart:
    """Describe the residual velocity over impact velocity, in the order of the curve, with the ballistic limit."""
    impact = [result.impact_velocity_m_s for result in curve]
    series = (
        Line(impact, impact, ":", 1.0, label="no armour", colour=INK),
        Line(impact, [result.residual_velocity_m_s for result in curve], label="projectile"),
        Line(impact, [result.plug_velocity_m_s for result in curve], "--", label="plug", colour=GREEN),
        _velocity_rule("ballistic limit", limit.ballistic_limit_m_s, VERMILION),
    )
    return Chart("", (_residual_velocity_panel(series, limits=(impact[0], impact[-1])),))


def _residual_velocity_panel(series: Iterable[Series], limits: tuple[float, float] | None = None) -> Panel:
    x = quantity_axis(VELOCITY, limits=limits)
    return Panel(x, quantity_axis("residual_velocity_m_s", from_zero=True), tuple(series), height=1.2)


def design_chart(result: "DesignResult") -> Chart:
    """Describe the designs of a search: the frontier, the best of other pairs, and the Pareto front."""
    frontier = frontier_chart(result)
    if not result.pareto:
        return frontier
    named = {"best", _pair(result.best), *(name for name, *_ in _others(result))}
    pareto = pareto_chart(result)
    [front] = pareto.panels
    series = tuple(replace(item, label="") if item.label in named else item for item in front.series)
    money = "Costs are in the currency of the scenario." if COST.key in result.criteria[:2] else ""
    panels = *frontier.panels, replace(front, series=series, title=pareto.title)
    return replace(frontier, panels=panels, note=" ".join(filter(None, (frontier.note, pareto.note, money))))


def _others(result: "DesignResult") -> Sequence[tuple[str, str, "Design"]]:
    """Return the pairs of materials beside the best that are marked: their names, why they lose and their designs."""
    found = [(_pair(pair), pair.reason, pair.best) for pair in result.pairs if pair.best is not None and pair.reason]
    return found[:MAX_PAIRS]


def _looks(result: "DesignResult") -> dict[str, dict[str, Any]]:
    """Return colour and marker of every pair of materials."""
    names = [_pair(result.best), *(name for name, *_ in _others(result)), *map(_pair, result.pareto)]
    return {name: _look(index) for index, name in enumerate(dict.fromkeys(names))}


def _look(index: int) -> dict[str, Any]:
    """Return colour and marker of one of several series; when colours repeat, they have other markers."""
    turn, colour = divmod(index, len(COLOURS))
    return {"colour": COLOURS[colour], "marker": MARKERS[(colour + turn) % len(MARKERS)]}


def frontier_chart(result: "DesignResult") -> Chart:
    """Describe the criterion minimised and the required ceramic over the back plate, for the best pair and others."""
    x = quantity_axis(BACKING)
    # The legend is that of the first panel.
    required = tuple(replace(item, label="") for item in _frontier(result, "ceramic_thickness_mm"))
    panels = (
        Panel(x, CRITERIA[result.minimised], _frontier(result, result.minimised)),
        Panel(x, quantity_axis("required_ceramic_thickness_mm"), required, shares_x=True),
    )
    pairs = sum(pair.best is not None for pair in result.pairs)
    notes = []
    if pairs > 1:
        notes.append(f"The line is {_pair(result.best)}, the pair of the best design; a point is another pair's best.")
    if pairs > MAX_PAIRS + 1:
        notes.append(f"The best {MAX_PAIRS + 1} of {pairs} pairs of materials are shown.")
    if any(design.ceramic_thickness_mm == result.ceramic_min_mm for design in result.frontier):
        notes.append(
            f"Where the ceramic is {result.ceramic_min_mm:g} mm, the least of its range, less may be required."
        )
    return Chart("Required ceramic for each back plate", panels, " ".join(notes))


def _frontier(result: "DesignResult", key: str) -> tuple[Series, ...]:
    """Describe a quantity of the frontier, of the best designs of other pairs and of the best of all."""
    looks, pair = _looks(result), _pair(result.best)
    text = [_design_text(design, result.minimised) for design in result.frontier]
    if len(result.threats) > 1:
        governed = zip(text, result.frontier_governed_by, strict=True)
        text = [f"{words}\ngoverned by {threat}" for words, threat in governed]
    marks = [(*other, {"filled": False, **looks[other[0]]}) for other in _others(result)]
    marks.append(("best", _design_text(result.best, result.minimised), result.best, BEST))
    if result.refined is not None:
        marks.append(("refined", _design_text(result.refined, result.minimised), result.refined, REFINED))
    backing = [design.backing_thickness_mm for design in result.frontier]
    values = [getattr(design, key) for design in result.frontier]
    series: list[Series] = [Line(backing, values, label=pair, text=tuple(text), **looks[pair])]
    for name, detail, design, look in marks:
        words = (f"{name}\n{_design_text(design, result.minimised)}",)
        place = [design.backing_thickness_mm], [getattr(design, key)]
        series.append(Points(*place, label=f"{name}: {detail}", text=words, **look))
    return tuple(series)


def pareto_chart(result: "DesignResult") -> Chart:
    """Describe the Pareto front over its first two criteria, a series for each pair of materials."""
    looks = _looks(result)
    x, y = result.criteria[:2]
    series: list[Series] = []
    if len(result.criteria) == 2:
        # The points on it have the words.
        front = sorted(result.pareto, key=lambda design: getattr(design, x))
        series.append(Line(*_at(front, x, y), ":", 1.0, label="Pareto front", colour=INK, text=("",) * len(front)))
    for name, designs in _grouped(result.pareto, _pair).items():
        text = tuple(f"{name}\n{_design_text(design, *result.criteria)}" for design in designs)
        series.append(Points(*_at(designs, x, y), filled=False, label=name, text=text, **looks[name]))
    words = (f"best\n{_design_text(result.best, *result.criteria)}",)
    series.append(Points(*_at([result.best], x, y), label="best", text=words, **BEST))
    notes = ""
    if len(result.criteria) > 2:
        hidden = " and ".join(CRITERIA[key].label for key in result.criteria[2:])
        notes = f"A design of the front that another one beats in both criteria drawn is better in {hidden}."
    return Chart("Pareto front", (Panel(CRITERIA[x], CRITERIA[y], tuple(series)),), notes)


def _at(designs: Iterable["Design"], x: str, y: str) -> tuple[list[float], list[float]]:
    """Return two quantities of designs."""
    places = [(getattr(design, x), getattr(design, y)) for design in designs]
    return [place[0] for place in places], [place[1] for place in places]


def _pair(item: Any) -> str:
    return f"{item.ceramic} on {item.backing}" if item.ceramic else str(item.backing)


def _design_text(design: "Design", *criteria: str) -> str:
    """Return the thicknesses of a design and its values of criteria."""
    values = (f"{CRITERIA[key].label} {CRITERIA[key].text(getattr(design, key))}" for key in criteria)
    return ", ".join([f"{design.ceramic_thickness_mm:.4g} on {design.backing_thickness_mm:.4g} mm", *values])


def figure_chart(panels: Sequence["Figure"]) -> Chart:
    """Describe a figure of the paper: the model's curves, with the numbers of the paper's text as marks."""
    drawn: list[Panel] = []
    for panel in map(_figure_panel, panels):
        named = {item.label for other in drawn for item in other.series}
        series = (replace(item, label="") if item.label in named else item for item in panel.series)
        drawn.append(replace(panel, series=tuple(series)))
    return Chart(panels[0].section.title, tuple(drawn), width=COLUMN_INCHES)


def _figure_panel(figure: "Figure") -> Panel:
    section = figure.section
    series: list[Series] = [
        Line(figure.x, curve.values, STYLES[index], label=curve.label, colour=COLOURS[index])
        for index, curve in enumerate(figure.curves)
    ]
    series += (Rule(level.value, ":", vertical=False, label=level.label, colour=INK) for level in section.level)
    colours = {curve.label: colour for curve, colour in zip(figure.curves, COLOURS, strict=False)}
    for mark, marker, size in zip(section.mark, ("*", "D", "s"), (9.0, 5.0, 5.0), strict=False):
        xs, ys = zip(*mark.points, strict=True)
        ends, colour = tuple((low, high) for low, high in mark.x_ends), colours.get(mark.of, SOFT)
        series.append(Points(xs, ys, marker, size, x_ends=ends, label=mark.label, colour=colour))
    shown = [value for curve in figure.curves for value in curve.values if value is not None]
    from_zero = bool(shown) and min(shown) < 0.3 * max(shown)
    x, y = Axis(section.x_label, limits=(figure.x[0], figure.x[-1])), Axis(section.y_label, from_zero=from_zero)
    return Panel(x, y, tuple(series))


def parity_chart(result: "SuiteResult") -> Chart:
    """Describe computed over expected values of a suite's tables, or else of its cases, a panel for each quantity."""
    numbers = [check for check in result.checks if check.deviation is not None and check.case.measured is None]
    checks = [check for check in numbers if check.case.group] or numbers
    panels = []
    for quantity, same in _grouped(checks, lambda check: check.case.quantity).items():
        groups = {
            group or "cases": [
                (check.case.name, "expected", check.case.expected, check.computed, 0.0) for check in found
            ]
            for group, found in _grouped(same, lambda check: check.case.group).items()
        }
        # A band that all have in common, as a part of the expected values; else a tenth.
        bands = {round((c.case.band or 0.0) / abs(c.case.expected), 4) for c in same if abs(c.case.expected) > TINY}
        [part] = bands if len(bands) == 1 else [0.0]
        panels.append(_agreement_panel(quantity, "expected", groups, part or 0.1))
    left_out = len(result.checks) - len(checks)
    note = f"{left_out} of {len(result.checks)} cases are not shown: those {LEFT_OUT}." if left_out else ""
    return Chart("", tuple(panels), note, width=COLUMN_INCHES)


def _agreement_panel(
    quantity: str, word: str, groups: Mapping[str, Sequence[tuple[str, str, float, float, float]]], part: float = 0.0
) -> Panel:
    """Describe computed over known values, with lines of agreement and, on request, a part away from it.

    Each group has points of a name, the word for the known value, this value, the computed one, and the standard
    deviation of the known value, 0 where none is given.
    """
    axis = quantity_axis(quantity)
    series: list[Series] = []
    for index, (group, points) in enumerate(groups.items()):
        text = tuple(
            f"{n}\n{w} {axis.text(k)}{f' ± {axis.text(s)}' if s else ''}, computed {axis.text(c)}"
            for n, w, k, c, s in points
        )
        known, computed = [point[2] for point in points], [point[3] for point in points]
        ends = tuple((k - s, k + s) for *_, k, _, s in points) if any(point[4] for point in points) else ()
        series.append(Points(known, computed, filled=False, x_ends=ends, label=group, text=text, **_look(index)))
    span = _span(end for points in groups.values() for *_, k, c, s in points for end in (k - s, k + s, c))
    lines = [(1.0, "agreement", "-")]
    if part:
        # Few points that are near each other are shown with the lines beside them.
        margin = part * span[1] if span[1] - span[0] < part * span[1] else 0.0
        span = span[0] - margin, span[1] + margin
        lines += [(1.0 - part, f"± {percent(part)}", ":"), (1.0 + part, "", ":")]
    for factor, label, style in lines:
        across = [factor * end for end in span]
        series.append(Line(span, across, style, 0.8, label=label, colour=INK, text=("", "")))
    x, y = (replace(axis, label=f"{prefix} {axis.label}", limits=span) for prefix in (word, "computed"))
    return Panel(x, y, tuple(series), square=True)


def _span(values: Iterable[float]) -> tuple[float, float]:
    """Return the range of values, a little wider than it is."""
    found = list(values)
    margin = 0.05 * (max(found) - min(found)) or 0.05 * abs(found[0]) or 1.0
    return min(found) - margin, max(found) + margin


def _grouped(items: Iterable[Any], key: Callable[[Any], str]) -> dict[str, list[Any]]:
    groups: dict[str, list[Any]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups


def comparison_chart(result: "Comparison") -> Chart:
    """Describe the residual velocity by the model and by fits to it, with Florence's ballistic limits."""
    found = result.limit.ballistic_limit_m_s
    impact = [impact.impact_velocity_m_s for impact in result.curve]
    residual = [impact.residual_velocity_m_s for impact in result.curve]
    series: list[Series] = [Line(impact, residual, label=f"this model: ballistic limit {found:.1f} m/s")]
    for fit, colour, style in zip(result.fits, COLOURS[1:], STYLES[1:], strict=False):
        fitted = [residual_velocity(velocity, found, fit.ratio, fit.exponent) for velocity in impact]
        label = f"{fit.name}: ratio {fit.ratio:.3f}, exponent {fit.exponent:.2f}"
        series.append(Line(impact, fitted, style, label=label, colour=colour))
    for florence, colour, style in zip(result.florence, (ORANGE, PURPLE), (":", "--"), strict=False):
        label = f"Florence, {florence.projectile}: ballistic limit"
        series.append(_velocity_rule(label, florence.ballistic_limit_m_s, colour, style))
    return Chart("", (_residual_velocity_panel(series),))


def calibration_chart(result: "CalibrationResult") -> Chart:
    """Describe computed over measured values, and the deviations test by test, fitted and left out."""
    words = {"": "measured", "at least": "defeated at", "at most": "perforated at"}
    panels = []
    for quantity, residuals in _grouped(result.residuals, lambda residual: residual.quantity).items():
        by_bound = _grouped(residuals, lambda residual: residual.bound)
        groups = {
            words[bound] if bound else "tests": [
                (residual.test, words[bound], residual.measured, residual.computed, residual.uncertainty or 0.0)
                for residual in by_bound[bound]
            ]
            for bound in words
            if bound in by_bound
        }
        panels.append(_agreement_panel(quantity, "measured", groups))
        if "" in by_bound:
            panels.append(_deviation_panel(quantity, by_bound[""]))
    given = any(residual.uncertainty for residual in result.residuals)
    note = "Error bars are one standard deviation of the measured value to either side." if given else ""
    return Chart(f"Calibration to {Path(result.tests).name}", tuple(panels), note)


def _deviation_panel(quantity: str, residuals: Sequence["Residual"]) -> Panel:
    """Describe deviations from measured values as bars; of many tests those with the largest."""
    title = f"Deviation of the {quantity_axis(quantity).label}"
    shown = list(residuals)
    if len(shown) > MAX_ROWS:
        shown = sorted(shown, key=lambda r: -abs(deviation_percent(r.computed, r.measured) or 0.0))[:MAX_ROWS]
        title += f", the {MAX_ROWS} largest of {len(residuals)}"
    values = {
        "fitted": [deviation_percent(residual.computed, residual.measured) for residual in shown],
        "leave-one-out": [deviation_percent(residual.left_out, residual.measured) for residual in shown],
    }
    x, names = Axis("deviation", "%", spec="+.2f"), tuple(residual.test for residual in shown)
    return _bars_panel(x, names, values, title)


def _bars_panel(
    x: Axis, names: tuple[str, ...], values: Mapping[str, Sequence[float | None]], title: str = "", start: float = 0.0
) -> Panel:
    """Describe several values of each name as bars side by side; from a start other than zero, in one row."""
    series: list[Series] = [Rule(start, colour=INK)]
    for slot, (label, ends) in enumerate(values.items()):
        place = (slot, len(values)) if start == 0.0 else (0, 1)
        series.append(Bars([start] * len(ends), ends, *place, label=label, colour=COLOURS[slot % len(COLOURS)]))
    return Panel(x, Axis(categories=names), tuple(series), title)


def sensitivity_chart(result: "SensitivityResult") -> Chart:
    """Describe the elasticities of every answer as bars, the inputs of the largest on top."""
    answers = [name for name, value in result.answers.items() if value is not None]
    largest = [max((abs(item.elasticities[name] or 0.0) for name in answers), default=0.0) for item in result.inputs]
    inputs = [result.inputs[index] for index in np.argsort(-np.array(largest), kind="stable")]
    # Without an elasticity an input, such as the velocity for the ballistic limit, has no row.
    inputs = [item for item in inputs if any(item.elasticities[answer] is not None for answer in answers)]
    names = tuple(quantity_axis(item.input).label for item in inputs)
    values = {quantity_axis(answer).label: [item.elasticities[answer] for item in inputs] for answer in answers}
    x = Axis("change per % of the input", "%", spec="+.3f")
    note = "Inputs are in the order of their longest bars."
    return Chart("Sensitivity to the inputs", (_bars_panel(x, names, values),), note)


# Height of the posterior's interval of V50, below that of the shots alone.
POSTERIOR = 0.4


def v50_chart(shots: "Shots", result: "FiringResult") -> Chart:
    """Describe shots, the recommended curve with its band, V50, and the model's ballistic limit where there is one."""
    if not result.fits:
        message = "must have a curve to draw, and these shots have none"
        raise InputError([Problem(shots.file, "", message)])
    # scipy is slow to import, and no other chart needs it.
    from armour.statistics.penalised_curve import penalised_band

    series: list[Series] = []
    for complete, colour, marker in ((False, GREEN, "o"), (True, VERMILION, "^")):
        velocities = shots.of(complete=complete)
        kind = "complete penetration" if complete else "partial penetration"
        text = tuple(f"{kind} at {velocity:g} m/s" for velocity in velocities)
        probabilities = [float(complete)] * len(velocities)
        series.append(Points(velocities, probabilities, marker, label=kind, colour=colour, text=text))
    slowest, fastest = min(shots.velocities_m_s), max(shots.velocities_m_s)
    reach, margin = fastest - slowest or 0.01 * fastest, 0.1 * (fastest - slowest)
    model, mean, between = result.model_ballistic_limit_m_s, result.mean, f"{percent(result.confidence)} interval"
    fit = result.recommended or result.fits[0]
    after = result.posterior
    ends = [fit.v50_m_s, *fit.v50_interval_m_s, model]
    between_ends = interval(fit.v50_interval_m_s, ".1f")
    bounded = fit.v50_interval_m_s != (None, None)
    if bounded:
        between_ends = f"{between_ends} m/s"
    wanted = [slowest, fastest, *(end for end in ends if end is not None)]
    low, high = max(slowest - reach, min(wanted) - margin), min(fastest + reach, max(wanted) + margin)
    if after is not None:
        low, high = min(low, after.v50_interval_m_s[0] - margin), max(high, after.v50_interval_m_s[1] + margin)
    x = np.linspace(low, high, 400).tolist()
    label = f"{fit.curve}, {fit.method}: V50 {fit.v50_m_s:.1f} m/s"
    if fit is result.recommended:
        band = penalised_band(shots.of(complete=False), shots.of(complete=True), fit.curve, x, result.confidence)
        series.insert(0, Band(x, *(edge.tolist() for edge in band)))
        label += f", with its {percent(result.confidence)} band"
    series.append(Line(x, [fit.probability(v) for v in x], label=label))
    if low <= fit.v50_m_s <= high:
        start, end = (edge if e is None else e for e, edge in zip(fit.v50_interval_m_s, (low, high), strict=True))
        words = (f"V50 {fit.v50_m_s:.1f} m/s\n{between} {between_ends}",)
        bar = ((start, end),) if bounded else ()
        series.append(Points([fit.v50_m_s], [0.5], x_ends=bar, text=words))
    if after is not None:
        name = f"posterior with the model as prior: V50 {after.v50_m_s:.1f} m/s"
        bar = (after.v50_interval_m_s,)
        series.append(Points([after.v50_m_s], [POSTERIOR], "D", label=name, colour=PURPLE, x_ends=bar, text=(name,)))
    if mean is not None:
        name = "mean of shots" if mean.rule == "no usual rule" else "MIL-STD-662F"
        series.append(_velocity_rule(f"{name}: V50", mean.v50_m_s, SOFT))
    bar_is = "The bar at one half is the {} of V50, {}." if bounded else "The {} of V50 is {}."
    notes = [bar_is.format(between, between_ends)]
    if after is not None:
        notes.append(f"The bar with a diamond is that of the posterior, {interval(after.v50_interval_m_s, '.1f')} m/s.")
    if model is not None and low <= model <= high:
        series.append(_velocity_rule("this model: ballistic limit", model, INK, ":"))
    elif model is not None:
        notes.append(f"The model's ballistic limit, {model:.1f} m/s, is outside the axis.")
    axes = (
        quantity_axis(VELOCITY, limits=(low, high)),
        Axis("probability of complete penetration", limits=(-0.02, 1.02)),
    )
    return Chart("", (Panel(*axes, tuple(series), height=1.1),), " ".join(notes))


def uncertainty_chart(result: "UncertaintyResult", scenario: "Scenario") -> Chart:
    """Describe the probability of perforation over velocity, and the ballistic limits at quantiles of each input."""
    curve, p, at = result.curve, result.probability_of_perforation, scenario.impact.velocity_m_s
    found, level = result.deterministic_m_s, percent(result.confidence)
    points = list(zip(curve.velocity_m_s, curve.probability, curve.low, curve.high, strict=True))
    text = tuple(
        f"perforated in {100.0 * value:.1f} % at {velocity:.1f} m/s\n{level} interval {low:.3f} to {high:.3f}"
        for velocity, value, low, high in points
    )
    label = f"at {at:g} m/s: {p.value:.3f}, {p.low:.3f} to {p.high:.3f} by sampling"
    quantiles = {name: result.ballistic_limit_m_s[name].value for name in ("V05", "V50", "V95")}
    series: list[Series] = [
        Band(curve.velocity_m_s, curve.low, curve.high),
        Line(curve.velocity_m_s, curve.probability, label=f"probability, with its {level} band by sampling", text=text),
        _velocity_rule("nominal ballistic limit", found, INK, ":"),
        *(_velocity_rule(*item, SOFT, style) for item, style in zip(quantiles.items(), ("-.", "-", "--"), strict=True)),
        Points(
            [at], [p.value], y_ends=((p.low, p.high),), label=label, colour=VERMILION, text=(f"perforated {label}",)
        ),
    ]
    uncertain = [velocity for velocity, value, *_ in points if SHOWN_PROBABILITY < value < 1.0 - SHOWN_PROBABILITY]
    changed = [limit for index in result.inputs for limit in index.limits_m_s]
    x = Axis(
        "velocity",
        "m/s",
        spec=".1f",
        limits=_span([at, found, quantiles["V05"], quantiles["V95"], *uncertain, *changed]),
    )
    panels = [Panel(x, Axis("probability of perforation", limits=(0.0, 1.0)), tuple(series))]
    if result.inputs:
        names = tuple(quantity_axis(index.input).label for index in result.inputs)
        values = {
            f"input at its {quantile} quantile": [index.limits_m_s[side] for index in result.inputs]
            for side, quantile in enumerate(("5 %", "95 %"))
        }
        title = "Ballistic limit with one input changed"
        swings = _bars_panel(x, names, values, title, found)
        panels.append(replace(swings, shares_x=True))
    return Chart("Probability of perforation", tuple(panels))


def energy_chart(energy: "EnergyBalance") -> Chart:
    """Describe the projectile's loss of kinetic energy, stage by stage."""
    categories = (*(f"{index}. stage {row.stage}" for index, row in enumerate(energy.rows, start=1)), "remaining")
    _, eroded, braked, *_ = (column.label for column in energy_table(energy).columns)
    looks = ((eroded, ORANGE), (braked, BLUE), ("remaining in the projectile", SOFT))
    parts = np.array([*((row.eroded, row.braked, 0.0) for row in energy.rows), (0.0, 0.0, energy.left)])
    share = 100.0 / energy.before if energy.before > 0.0 else 0.0
    series = []
    for (label, colour), values, ends in zip(looks, parts.T, parts.cumsum(axis=1).T, strict=True):
        shown = zip(categories, values, strict=True)
        text = tuple(f"{name}: {label}\n{value:.2f} J, {share * value:.1f} %" for name, value in shown)
        series.append(Bars((ends - values).tolist(), ends.tolist(), label=label, colour=colour, text=text))
    x = Axis("kinetic energy", "J", from_zero=True)
    panel = Panel(x, Axis(categories=categories), tuple(series))
    codes = dict.fromkeys(f"{row.stage}, {_stage_words(row.stage)}" for row in energy.rows)
    return Chart("Where the projectile's energy went", (panel,), f"Stages: {'; '.join(codes)}.")


def sweep_chart(table: Mapping[str, Floats], keys: Sequence[str], name: str, scenario: "Scenario") -> Chart:
    """Describe a quantity over one key of a sweep, as a curve, or two, as a map; thicknesses have areal densities.

    Over a key of names there is a bar for each name, and over such a key and numbers a curve for each.
    """
    axes = [quantity_axis(key) for key in keys]
    answer = quantity_axis(name)
    title = _sweep_title(answer.label, *(axis.label for axis in axes))
    found = table[name]
    missing = np.count_nonzero(np.isnan(found))
    note = f"{missing} of {len(found)} rows have no {answer.label}." if missing else ""
    named = [key for key in keys if table[key].dtype.kind not in "iuf"]
    if len(named) == len(keys):
        names = tuple(dict.fromkeys(table[named[0]].tolist()))
        values = {
            label: [
                dict(zip(table[named[0]][own].tolist(), _or_none(found[own]), strict=True)).get(name) for name in names
            ]
            for label, own in _by_name(table, named[1:])
        }
        return Chart(title, (_bars_panel(answer, names, values),), note)
    if len(keys) == 1 or named:
        [key] = [key for key in keys if key not in named]
        # The axis reaches rows without an answer too, and a single row has a point.
        across = quantity_axis(key, limits=_span(table[key].tolist()) if missing or len(set(table[key])) == 1 else None)
        curves = []
        for index, (label, own) in enumerate(_by_name(table, named)):
            order = np.flatnonzero(own)[np.argsort(table[key][own], kind="stable")]
            look = _look(index) if len(order) <= MAX_MARKERS else {"colour": COLOURS[index % len(COLOURS)]}
            curves.append(Line(table[key][order].tolist(), _or_none(found[order]), label=label, **look))
        return Chart(title, (Panel(across, answer, tuple(curves), height=1.1),), note)
    x, y = (np.unique(table[key]) for key in keys)
    z = np.full((len(y), len(x)), np.nan)
    z[np.searchsorted(y, table[keys[1]]), np.searchsorted(x, table[keys[0]])] = table[name]
    rows = [_or_none(row) for row in z]
    series: list[Series] = [Map(x.tolist(), y.tolist(), rows, answer.heading)]
    if min(z.shape) > 1 and np.isfinite(z).any() and np.nanmin(z) < np.nanmax(z):
        label = f"lines of equal {answer.heading}"
        series.append(Contours(x.tolist(), y.tolist(), rows, levels=8, label=label, colour=INK))
    if set(keys) == {CERAMIC, BACKING} and min(z.shape) > 1:
        ceramic, backing = np.meshgrid(x, y) if keys[0] == CERAMIC else np.meshgrid(x, y)[::-1]
        armour = scenario.core_armour()
        areal = (armour.rho_c * MM * ceramic + armour.rho_B * MM * backing).tolist()
        label = f"lines of equal {CRITERIA[AREAL_DENSITY.key].heading}"
        series.append(Contours(x.tolist(), y.tolist(), areal, "dashed", 5, label=label, colour=VERMILION))
    return Chart(title, (Panel(axes[0], axes[1], tuple(series), height=1.2),), note)


def _by_name(table: Mapping[str, Any], keys: Sequence[str]) -> list[tuple[str, Any]]:
    """Return each name of a key with its rows, as a mask; without a key all rows."""
    if not keys:
        return [("", np.ones(len(next(iter(table.values()))), dtype=bool))]
    names = table[keys[0]]
    return [(name, names == name) for name in dict.fromkeys(names.tolist())]


def _sweep_title(answer: str, first: str, second: str = "") -> str:
    """Return the title of a sweep, in which words that both keys end in stand once."""
    words, others = first.split(" "), second.split(" ")
    # Of each, one word at least remains.
    while second and len(words) > 1 and len(others) > 1 and words[-1] == others[-1]:
        words, others = words[:-1], others[:-1]
    over = f"{' '.join(words)} and {second}" if second else first
    return f"{answer[:1].upper()}{answer[1:]} over {over}"


def _or_none(values: Floats) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]
