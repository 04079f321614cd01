"""Results as figures; matplotlib is imported with this module, and this module only where a plot is asked for."""

from collections.abc import Mapping, Sequence
from io import BytesIO
from math import nan
from textwrap import wrap
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from armour.analysis.ballistic_limit import LimitResult
from armour.analysis.closed_forms import residual_velocity
from armour.analysis.comparison import Comparison
from armour.analysis.history import History
from armour.analysis.impact import ImpactResult, StageRecord
from armour.analysis.quantities import heading
from armour.design.catalogue import CRITERIA, StudyResult
from armour.design.optimisation import OptimumResult
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC
from armour.statistics.calibration import CalibrationResult
from armour.statistics.sensitivity import SensitivityResult
from armour.statistics.uncertainty import UncertaintyResult
from armour.statistics.v50 import FiringResult, Shots
from armour.units import words_and_unit
from armour.validation.figures import Chart
from armour.validation.validate import SuiteResult

Floats = NDArray[np.float64]

FORMATS = (".png", ".svg", ".pdf")

# Okabe and Ito's colours, which colour-blind readers can tell apart.
GREY = "#BBBBBB"
BLACK, ORANGE, BLUE, GREEN, RED = "#000000", "#E69F00", "#0072B2", "#009E73", "#D55E00"
STYLE: Any = {
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "figure.constrained_layout.use": True,
    "font.size": 9.0,
    "grid.alpha": 0.25,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "svg.fonttype": "none",
    "svg.hashsalt": "armour",
    "text.parse_math": False,  # titles are the user's
}
# One after the other for curves, so that they differ in more than colour.
COLOURS = (BLUE, RED, GREEN, ORANGE, BLACK)
LINES = ("-", "--", "-.", ":", "--")
MARKERS, MARK_SIZE = ("*", "D", "s"), (9.0, 5.0, 5.0)
ROUND_MARKERS = ("o", "s", "^")
# Width of a column of a two-column page, and characters in a line of a title there.
COLUMN_INCHES = 3.45
COLUMN_TITLE = 48
# A quantity whose least value is below this part of its largest is drawn from zero.
MOSTLY_FROM_ZERO = 0.3
# A stage narrower than this part of the axis is shaded but not named.
NARROWEST_NAMED = 0.025
# Below this part of the impact velocity what follows is a tail.
SLOW = 0.05
# Characters in a line of a title.
WIDEST_TITLE = 70


def impact_figure(result: ImpactResult, title: str) -> Figure:
    """Velocities, length, depth and bulge over time, the stages shaded and named.

    Parameters
    ----------
    result : ImpactResult
        With its history.
    title : str
    """
    history = result.history
    if history is None:
        raise ValueError("the result has no history; simulate(..., history=True) keeps it")
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.9, 7.0))
        velocities, lengths, depths = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 2))
        time = history.time_us
        velocities.plot(time, history.velocity_m_s, color=BLUE, label="projectile V")
        velocities.plot(time, history.penetration_velocity_m_s, "--", color=ORANGE, label="penetration U")
        velocities.plot(time, history.target_velocity_m_s, "-.", color=GREEN, label="target W")
        velocities.set_ylabel("velocity, m/s")
        lengths.plot(time, history.length_mm, color=BLUE)
        lengths.set_ylabel("rod length L, mm")
        lengths.set_ylim(bottom=0.0)
        depths.plot(time, history.depth_mm, color=BLUE, label="depth Z")
        depths.plot(time, history.bulge_height_mm, "-.", color=GREEN, label="bulge h")
        depths.set_ylabel("depth, bulge, mm")
        depths.set_xlabel("time since impact, us")
        shown = _shown_us(history, result)
        depths.set_xlim(0.0, max(shown, 1e-9))
        for axes in (velocities, lengths, depths):
            _shade(axes, result.stages)
        _name(velocities, result.stages, shown)
        for axes in (velocities, depths):
            axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        figure.suptitle(f"{_wrapped(title)}\n{_verdict(result)}", fontsize=10)
    return figure


def _shown_us(history: History, result: ImpactResult) -> float:
    """Time to show, us: all of it, but for a long tail in which the projectile hardly moves."""
    slow = history.time_us[history.velocity_m_s <= SLOW * result.impact_velocity_m_s]
    return min(result.duration_us, 1.5 * float(slow[0])) if slow.size else result.duration_us


def _verdict(result: ImpactResult) -> str:
    if result.outcome == "defeated":
        return f"defeated at {result.impact_velocity_m_s:g} m/s"
    return f"perforated at {result.impact_velocity_m_s:g} m/s, residual velocity {result.residual_velocity_m_s:.1f} m/s"


def _shade(axes: Axes, stages: Sequence[StageRecord]) -> None:
    for index, stage in enumerate(stages):
        if index % 2 == 0:
            axes.axvspan(stage.start_us, stage.end_us, color=BLACK, alpha=0.07, linewidth=0)


def _name(axes: Axes, stages: Sequence[StageRecord], shown_us: float) -> None:
    """Names of the stages above the axes."""
    for stage in stages:
        end_us = min(stage.end_us, shown_us)
        if end_us - stage.start_us >= NARROWEST_NAMED * shown_us:
            axes.text(
                0.5 * (stage.start_us + end_us),
                1.01,
                stage.stage,
                transform=axes.get_xaxis_transform(),
                ha="center",
                va="bottom",
                fontsize=8,
            )


def limit_figure(limit: LimitResult, curve: Sequence[ImpactResult], title: str) -> Figure:
    """Residual velocity over impact velocity, the ballistic limit marked.

    Parameters
    ----------
    limit : LimitResult
    curve : sequence of ImpactResult
        Impacts in the order of their velocity.
    title : str
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 4.4))
        axes = figure.subplots()
        impact = [result.impact_velocity_m_s for result in curve]
        axes.plot(impact, impact, ":", color=BLACK, linewidth=1.0, label="no armour")
        residual = [result.residual_velocity_m_s for result in curve]
        axes.plot(impact, residual, color=BLUE, label="projectile")
        plug = [result.plug_velocity_m_s for result in curve]
        axes.plot(impact, plug, "--", color=GREEN, label="plug")
        found = limit.ballistic_limit_m_s
        axes.axvline(found, color=RED, linewidth=1.0, label=f"ballistic limit {found:.1f} m/s")
        axes.set_xlabel("impact velocity, m/s")
        axes.set_ylabel("residual velocity, m/s")
        axes.set_ylim(bottom=0.0)
        axes.set_xlim(impact[0], impact[-1])
        figure.legend(loc="outside lower center", ncols=2)
        figure.suptitle(_wrapped(title), fontsize=10)
    return figure


def optimum_figure(result: OptimumResult, title: str) -> Figure:
    """Required ceramic thickness and areal density over backing thickness, the optimum marked."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 6.2))
        thickness, density = figure.subplots(2, 1, sharex=True)
        backing = [design.backing_thickness_mm for design in result.frontier]
        ceramic = [design.ceramic_thickness_mm for design in result.frontier]
        areal = [design.areal_density_kg_m2 for design in result.frontier]
        marks = [("*", 11.0, RED, "lightest of the grid", result.best)]
        if result.refined is not None:
            marks.append(("D", 5.0, ORANGE, "refined", result.refined))
        line = {"marker": "o", "markersize": 3.0, "color": BLUE}
        thickness.plot(backing, ceramic, label="thinnest ceramic that defeats", **line)
        density.plot(backing, areal, **line)
        for marker, size, colour, name, design in marks:
            label = (
                f"{name}: {design.ceramic_thickness_mm:.4g} on {design.backing_thickness_mm:.4g} mm, "
                f"{design.areal_density_kg_m2:.2f} kg/m²"
            )
            style = {"marker": marker, "markersize": size, "color": colour, "linestyle": "none"}
            thickness.plot(design.backing_thickness_mm, design.ceramic_thickness_mm, label=label, **style)
            density.plot(design.backing_thickness_mm, design.areal_density_kg_m2, **style)
        thickness.set_ylabel("required ceramic thickness, mm")
        density.set_ylabel("areal density, kg/m²")
        density.set_xlabel("backing thickness, mm")
        figure.legend(loc="outside lower center")
        figure.suptitle(_wrapped(title), fontsize=10)
    return figure


def study_figure(result: StudyResult, title: str) -> Figure:
    """What each backing needs of the best pair, the best designs of the others and the Pareto front."""
    best = result.best
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 4.6 if not result.pareto else 8.0))
        panels = figure.subplots(2 if result.pareto else 1, 1, squeeze=False)[:, 0]
        axes = panels[0]
        backing = [design.backing_thickness_mm for design in result.frontier]
        areal = [design.areal_density_kg_m2 for design in result.frontier]
        axes.plot(backing, areal, marker="o", markersize=3.0, color=BLUE, label=f"{best.ceramic} on {best.backing}")
        for index, pair in enumerate(pair for pair in result.pairs if pair.best is not None and pair.reason):
            if pair.best is not None and index < len(ROUND_MARKERS):
                label = f"{pair.ceramic} on {pair.backing}: {pair.reason}"
                style: Any = {"color": COLOURS[index + 1], "markerfacecolor": "none", "linestyle": "none"}
                place = pair.best.backing_thickness_mm, pair.best.areal_density_kg_m2
                axes.plot(*place, ROUND_MARKERS[index], label=label, **style)
        label = f"best: {best.ceramic_thickness_mm:g} on {best.backing_thickness_mm:g} mm"
        at = best.backing_thickness_mm, best.areal_density_kg_m2
        axes.plot(*at, "*", markersize=11.0, color=RED, label=label)
        axes.set_xlabel("backing thickness, mm")
        axes.set_ylabel("areal density, kg/m²")
        if result.pareto:
            x, y = result.criteria[:2]
            values = [[getattr(item, name) for item in result.pareto] for name in (x, y)]
            panels[1].plot(*values, "o", markersize=4.0, color=BLUE)
            panels[1].set_xlabel(CRITERIA[x])
            panels[1].set_ylabel(CRITERIA[y])
            panels[1].set_title("Pareto front", fontsize=9)
        figure.legend(loc="outside lower center")
        figure.suptitle(_wrapped(title), fontsize=10)
    return figure


def chart_figure(chart: Chart) -> Figure:
    """A figure of the paper: the model's curves, the numbers of its text as marks; fits a column of a page."""
    with mpl.rc_context({**STYLE, "font.size": 8.0}):
        figure = Figure(figsize=(COLUMN_INCHES, 3.4))
        axes = figure.subplots()
        for index, curve in enumerate(chart.curves):
            values = [nan if value is None else value for value in curve.values]
            axes.plot(chart.x, values, LINES[index], color=COLOURS[index], label=curve.label)
        colours = {curve.label: colour for curve, colour in zip(chart.curves, COLOURS, strict=False)}
        for level in chart.levels:
            axes.axhline(level.value, color=BLACK, linewidth=0.8, linestyle=":", label=level.label)
        for index, mark in enumerate(chart.marks):
            colour = colours.get(mark.of, GREY)
            style: Any = {
                "markeredgecolor": BLACK,
                "markeredgewidth": 0.6,
                "color": colour,
                "clip_on": False,
                "zorder": 5,
            }
            xs, ys = zip(*mark.points, strict=True)
            axes.plot(xs, ys, MARKERS[index], label=mark.label, linestyle="none", markersize=MARK_SIZE[index], **style)
        axes.set_xlabel(chart.x_label)
        axes.set_ylabel(chart.y_label)
        axes.set_xlim(chart.x[0], chart.x[-1])
        shown = [value for curve in chart.curves for value in curve.values if value is not None]
        if min(shown) < MOSTLY_FROM_ZERO * max(shown):
            axes.set_ylim(bottom=0.0)
        figure.legend(loc="outside lower center", ncols=1)
        figure.suptitle(_wrapped(chart.title, COLUMN_TITLE), fontsize=8.5)
    return figure


def parity_figure(result: SuiteResult) -> Figure:
    """Computed over expected values of a suite's tables, with the line of agreement."""
    with mpl.rc_context({**STYLE, "font.size": 8.0}):
        figure = Figure(figsize=(COLUMN_INCHES, 4.2))
        axes = figure.subplots()
        ends = []
        for index, summary in enumerate(result.summaries):
            pairs = [
                (float(check.case.expected), check.computed)
                for check in result.checks
                if check.case.group == summary.name and isinstance(check.computed, float)
            ]
            expected, computed = zip(*pairs, strict=True)
            ends += [*expected, *computed]
            style: Any = {"color": COLOURS[index], "markersize": 5.0, "markerfacecolor": "none", "linestyle": "none"}
            axes.plot(expected, computed, ROUND_MARKERS[index], label=summary.name, **style)
        span = 0.97 * min(ends), 1.03 * max(ends)
        axes.plot(span, span, color=BLACK, linewidth=0.8, label="agreement")
        for part, label in ((0.9, "10 % off"), (1.1, None)):
            axes.plot(span, [part * end for end in span], ":", color=BLACK, linewidth=0.8, label=label)
        axes.set_xlim(span)
        axes.set_ylim(span)
        axes.set_aspect("equal")
        axes.set_xlabel("expected ballistic limit, m/s")
        axes.set_ylabel("computed ballistic limit, m/s")
        figure.legend(loc="outside lower center", ncols=1)
    return figure


def comparison_figure(result: Comparison, title: str) -> Figure:
    """Residual velocity by the model and by the fits, and every ballistic limit."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 4.8))
        axes = figure.subplots()
        found = result.limit.ballistic_limit_m_s
        impact = [impact.impact_velocity_m_s for impact in result.curve]
        residual = [impact.residual_velocity_m_s for impact in result.curve]
        axes.plot(impact, residual, color=COLOURS[0], label=f"this model: limit {found:.1f} m/s")
        for index, fit in enumerate(result.fits, start=1):
            fitted = [residual_velocity(velocity, found, fit.ratio, fit.exponent) for velocity in impact]
            label = f"{fit.name}: ratio {fit.ratio:.3f}, exponent {fit.exponent:.2f}"
            axes.plot(impact, fitted, LINES[index], color=COLOURS[index], label=label)
        for index, florence in enumerate(result.florence):
            limit = florence.ballistic_limit_m_s
            label = f"Florence, {florence.projectile}: limit {limit:.1f} m/s"
            axes.axvline(limit, color=COLOURS[3 + index], linestyle=LINES[3 + index], linewidth=1.2, label=label)
        axes.set_xlabel("impact velocity, m/s")
        axes.set_ylabel("residual velocity, m/s")
        axes.set_ylim(bottom=0.0)
        figure.legend(loc="outside lower center", ncols=1)
        figure.suptitle(_wrapped(title), fontsize=10)
    return figure


def calibration_figure(result: CalibrationResult, title: str) -> Figure:
    """Computed over measured values and their deviations, test by test, in and left out of the fit."""
    quantities = list(dict.fromkeys(residual.quantity for residual in result.residuals))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.9, 1.0 + 3.2 * len(quantities)))
        panels = figure.subplots(len(quantities), 2, squeeze=False)
        for (parity, bars), quantity in zip(panels, quantities, strict=True):
            found = [residual for residual in result.residuals if residual.quantity == quantity]
            ends = []
            for index, bound in enumerate(("", "at least", "at most")):
                some = [residual for residual in found if residual.bound == bound]
                if some:
                    measured, computed = [r.measured for r in some], [r.computed for r in some]
                    ends += [*measured, *computed]
                    style: Any = {"color": COLOURS[index], "markerfacecolor": "none", "linestyle": "none"}
                    label = {"": "test", "at least": "defeated at", "at most": "perforated at"}[bound]
                    parity.plot(measured, computed, ROUND_MARKERS[index], label=label, **style)
            margin = 0.05 * (max(ends) - min(ends)) or 1.0
            span = min(ends) - margin, max(ends) + margin
            parity.plot(span, span, color=BLACK, linewidth=0.8, label="agreement")
            parity.set(xlim=span, ylim=span, aspect="equal", xlabel=f"measured {heading(quantity)}", ylabel="computed")
            parity.legend(fontsize=7)
            exact = [residual for residual in found if not residual.bound]
            places = np.arange(len(exact))
            for shift, name, colour, label in (
                (-0.2, "computed", BLUE, "fitted"),
                (0.2, "left_out", ORANGE, "left out"),
            ):
                found_or_not = [(getattr(residual, name), residual.measured) for residual in exact]
                values = [nan if v is None else 100.0 * (v / measured - 1.0) for v, measured in found_or_not]
                bars.barh(places + shift, values, height=0.4, color=colour, label=label)
            bars.axvline(0.0, color=BLACK, linewidth=0.8)
            bars.set_yticks(places, [residual.test for residual in exact], fontsize=7)
            bars.set_ylim(len(exact) - 0.5, -0.5)
            bars.set_xlabel("deviation, %")
            bars.grid(visible=False, axis="y")
            bars.legend(fontsize=7)
        figure.suptitle(_wrapped(title), fontsize=10)
    return figure


def sensitivity_figure(result: SensitivityResult, title: str) -> Figure:
    """Elasticities of each answer as bars, the largest on top."""
    answers = [name for name, value in result.answers.items() if value is not None]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(1.6 + 2.3 * len(answers), 0.9 + 0.24 * len(result.inputs)))
        panels = figure.subplots(1, len(answers), sharey=True, squeeze=False)[0]
        names = [item.input for item in result.inputs]
        for axes, answer in zip(panels, answers, strict=True):
            values = [item.elasticities[answer] or 0.0 for item in result.inputs]
            _tornado(axes, names, [(min(value, 0.0), max(value, 0.0)) for value in values], 0.0)
            axes.set_xlabel(f"% of {words_and_unit(answer)[0]}\nper % of the input")
        figure.suptitle(_wrapped(title), fontsize=10)
    return figure


def _tornado(axes: Axes, names: Sequence[str], ends: Sequence[tuple[float, float]], centre: float) -> None:
    """Bars from one value to another, the first on top; blue beyond the centre, red below it."""
    places = range(len(names))
    below, beyond = [min(low - centre, 0.0) for low, _ in ends], [max(high - centre, 0.0) for _, high in ends]
    for widths, colour in ((below, RED), (beyond, BLUE)):
        axes.barh(places, widths, left=centre, color=colour, height=0.7)
    axes.axvline(centre, color=BLACK, linewidth=0.8)
    axes.set_yticks(places, names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")
    axes.use_sticky_edges = False
    axes.autoscale(axis="x")


def firing_figure(shots: Shots, result: FiringResult) -> Figure:
    """Shots, the curves fitted to them and the ballistic limit of the model, where there is one."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 4.4))
        axes = figure.subplots()
        for complete, colour, marker in ((False, GREEN, "o"), (True, RED, "^")):
            velocities = shots.of(complete=complete)
            label = "complete penetration" if complete else "partial penetration"
            axes.plot(velocities, [float(complete)] * len(velocities), marker, color=colour, label=label, clip_on=False)
        slowest, fastest = min(shots.velocities_m_s), max(shots.velocities_m_s)
        ends = [end for fit in result.fits for end in fit.v50_interval_m_s if end is not None]
        least, most = 2.0 * slowest - fastest, 2.0 * fastest - slowest
        margin = 0.1 * (fastest - slowest)
        shown = np.linspace(max(least, min([slowest, *ends]) - margin), min(most, max([fastest, *ends]) + margin), 400)
        for fit, line, colour, height in zip(result.fits, LINES, (BLUE, ORANGE), (0.47, 0.53), strict=False):
            label = f"{fit.curve}: V50 {fit.v50_m_s:.1f} m/s"
            axes.plot(shown, [fit.probability(v) for v in shown], line, color=colour, label=label)
            bar = [s if e is None else e for e, s in zip(fit.v50_interval_m_s, shown[[0, -1]], strict=True)]
            axes.plot(bar, [height, height], color=colour, linewidth=3.0, alpha=0.5, solid_capstyle="butt")
        if result.mean is not None:
            axes.axvline(result.mean.v50_m_s, color=GREY, label=f"MIL-STD-662F: V50 {result.mean.v50_m_s:.1f} m/s")
        model = result.model_ballistic_limit_m_s
        if model is not None:
            axes.axvline(model, color=BLACK, linestyle=":", label=f"this model: limit {model:.1f} m/s")
        axes.set_xlim(shown[0], shown[-1])
        axes.set_ylim(0.0, 1.0)
        axes.set_xlabel("impact velocity, m/s")
        axes.set_ylabel("probability of complete penetration")
        figure.legend(loc="outside lower center", ncols=2)
        figure.suptitle(
            f"{shots.file}\nbars at one half: {100.0 * result.confidence:g} % intervals of V50", fontsize=10
        )
    return figure


def uncertainty_figure(result: UncertaintyResult, scenario: Scenario) -> Figure:
    """Probability of perforation over velocity with its band, and what each input does to the ballistic limit."""
    with mpl.rc_context(STYLE):
        rows = 2 if result.inputs else 1
        figure = Figure(figsize=(6.2, 4.0 + 0.28 * len(result.inputs)))
        panels = figure.subplots(rows, 1, sharex=True, squeeze=False, height_ratios=(3.0, 2.0)[:rows])[:, 0]
        curve, axes = result.curve, panels[0]
        axes.fill_between(curve.velocity_m_s, curve.low, curve.high, color=BLUE, alpha=0.3, linewidth=0)
        axes.plot(curve.velocity_m_s, curve.probability, color=BLUE, label="probability, with its 95 % band")
        found = result.deterministic_m_s
        axes.axvline(found, color=BLACK, linestyle=":", label=f"limit as it stands, {found:.1f} m/s")
        for name, line in (("V05", "-."), ("V50", "-"), ("V95", "--")):
            place = result.ballistic_limit_m_s[name].value
            axes.axvline(place, color=GREY, linestyle=line, linewidth=1.0, label=f"{name} {place:.1f} m/s")
        p = result.probability_of_perforation
        label = f"at {scenario.impact.velocity_m_s:g} m/s: {p.value:.3f}, {p.low:.3f} to {p.high:.3f}"
        at, ends = scenario.impact.velocity_m_s, [[p.value - p.low], [p.high - p.value]]
        axes.errorbar([at], [p.value], ends, fmt="o", color=RED, markersize=4.0, capsize=3.0, label=label)
        axes.set_ylabel("probability of perforation")
        axes.set_ylim(0.0, 1.0)
        if result.inputs:
            swings = [(min(index.limits_m_s), max(index.limits_m_s)) for index in result.inputs]
            _tornado(panels[1], [index.input for index in result.inputs], swings, found)
            panels[1].set_title("limit with one input from its 5th to its 95th hundredth", fontsize=9)
        panels[-1].set_xlabel("velocity, m/s")
        figure.legend(loc="outside lower center", ncols=2)
        figure.suptitle(_wrapped(scenario.title), fontsize=10)
    return figure


def sweep_figure(table: Mapping[str, Floats], keys: Sequence[str], name: str, scenario: Scenario) -> Figure:
    """A quantity over the one or two keys of a sweep: a curve, or a map with contours.

    Over both thicknesses lines of equal areal density are drawn as well.

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
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 4.2))
        axes = figure.subplots()
        axes.set_xlabel(heading(keys[0]))
        if len(keys) == 1:
            axes.plot(table[keys[0]], table[name], color=BLUE)
            axes.set_ylabel(heading(name))
        else:
            _map(figure, axes, table, keys, name)
            axes.set_ylabel(heading(keys[1]))
            if set(keys) == {CERAMIC, BACKING}:
                _equal_areal_densities(axes, scenario, ceramic_first=keys[0] == CERAMIC)
        figure.suptitle(_wrapped(scenario.title), fontsize=10)
    return figure


def _map(figure: Figure, axes: Axes, table: Mapping[str, Floats], keys: Sequence[str], name: str) -> None:
    x, y = (np.unique(table[key]) for key in keys)
    z = np.full((len(y), len(x)), np.nan)
    z[np.searchsorted(y, table[keys[1]]), np.searchsorted(x, table[keys[0]])] = table[name]
    axes.grid(visible=False)
    shown = axes.pcolormesh(x, y, np.ma.masked_invalid(z), cmap="cividis", shading="nearest", rasterized=True)
    figure.colorbar(shown, label=heading(name))
    if min(z.shape) > 1 and np.isfinite(z).any() and np.nanmin(z) < np.nanmax(z):
        lines = axes.contour(x, y, z, levels=8, colors="white", linewidths=0.8)
        axes.clabel(lines, fontsize=7, fmt="%g")


def _equal_areal_densities(axes: Axes, scenario: Scenario, *, ceramic_first: bool) -> None:
    """Lines of equal areal density over both thicknesses."""
    x, y = (np.linspace(*limits, 50) for limits in (axes.get_xlim(), axes.get_ylim()))
    ceramic, backing = np.meshgrid(x, y) if ceramic_first else np.meshgrid(x, y)[::-1]
    areal = scenario.areal_density_kg_m2(1.0, 0.0) * ceramic + scenario.areal_density_kg_m2(0.0, 1.0) * backing
    lines = axes.contour(x, y, areal, levels=6, colors=BLACK, linewidths=0.8, linestyles="dashed")
    axes.clabel(lines, fontsize=7, fmt="%g kg/m²")


def _wrapped(title: str, widest: int = WIDEST_TITLE) -> str:
    return "\n".join(wrap(title, widest))


def rendered(figure: Figure, suffix: str) -> bytes:
    """The figure as a file of the format that the suffix names, one of `FORMATS`."""
    content = BytesIO()
    metadata = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}[suffix]
    with mpl.rc_context(STYLE):
        figure.savefig(content, format=suffix[1:], dpi=160, metadata=metadata)
    return content.getvalue()
