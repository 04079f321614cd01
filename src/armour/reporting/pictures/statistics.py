"""Draw uncertainties, sensitivities, calibrations and V50 from firing results."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from armour.errors import mistake
from armour.reporting.by_result import draw, headline
from armour.reporting.pictures import drawing
from armour.reporting.table import Column, deviation_percent, grouped, in_words, interval, percent
from armour.reporting.views.statistics import MEANS, at_one_level, velocity_name
from armour.scenario.inputs import VELOCITY
from armour.statistics.calibration import CalibrationResult, Residual
from armour.statistics.curves import FittedCurve, ShotLikelihood
from armour.statistics.sensitivity import SensitivityResult
from armour.statistics.uncertainty import UncertaintyResult
from armour.statistics.v50 import FiringResult, Shots

# Kinds of shots: label, whether the penetration is complete, colour and marker.
PENETRATIONS = (
    ("stopped", False, drawing.GREEN, "o"),
    ("perforated", True, drawing.VERMILION, "^"),
)
# The velocity axis shows the curve from this probability to 1 minus it.
SHOWN_PROBABILITY = 0.002
# What is drawn where the probability is not known.
ALONE = "stopped, with the model taken as exact"


@draw.register
def draw_uncertainty(result: UncertaintyResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the probability of stopping a shot over velocity, and the limits at two quantiles of each input."""
    curve, level = result.curve, percent(result.confidence)
    p, shares = result.probability_of_perforation or result.perforated_by_distributions, curve.probability
    assert p is not None
    velocity = drawing.recorded(result, "scenario").impact.velocity_m_s
    names = [Column.of(each.input).label for each in result.inputs]
    ends = f"{1.0 - p.high:.3f} to {1.0 - p.low:.3f}"
    note = f"{level} intervals by sampling: {ends} at {velocity:g} m/s; the band for the curve."
    heights = [drawing.PANEL, *([drawing.rows_height(names, titled=True)] if names else [])]
    picture = sheet.panels(headline(result), *heights, note=note, sharex=True)
    axes = picture.axes[0]
    axes.set(ylabel="stops a shot" if shares else ALONE, ylim=(0.0, 1.0))
    stops, below, above = (1.0 - np.array(ends) for ends in (shares or curve.by_distributions, curve.high, curve.low))
    axes.fill_between(curve.velocity_m_s, below, above, color=drawing.BLUE, **drawing.BAND)
    axes.plot(curve.velocity_m_s, stops, color=drawing.BLUE)
    limits = {"limit by the model": result.deterministic_m_s}
    quantiles = {f"limit, {100 * float(key):g} % below": each for key, each in result.limit_quantiles_m_s.items()}
    limits |= {name: each.value for name, each in quantiles.items()}
    for (name, limit), style in zip(limits.items(), (":", "-.", "-", "--"), strict=True):
        colour = drawing.SOFT if name in quantiles else drawing.INK
        axes.axvline(limit, linestyle=style, linewidth=1.0, color=colour, label=f"{name} {limit:.1f} m/s")
    interval, stopped = [[p.high - p.value], [p.value - p.low]], 1.0 - p.value
    axes.errorbar([velocity], [stopped], interval, fmt="none", ecolor=drawing.VERMILION, capsize=drawing.CAP)
    drawing.points(axes, [velocity], [stopped], color=drawing.VERMILION, label=f"{stopped:.3f} at {velocity:g} m/s")
    if names:
        low, high = zip(*(each.limits_m_s for each in result.inputs), strict=True)
        swings = {"input at its 5 % quantile": low, "input at its 95 % quantile": high}
        drawing.rows(picture.axes[1], names, swings, result.deterministic_m_s)
        picture.axes[1].set_title("Ballistic limit with one input changed")
    falling = (stops > SHOWN_PROBABILITY) & (stops < 1.0 - SHOWN_PROBABILITY)
    uncertain = np.array(curve.velocity_m_s)[falling].tolist()
    changed = [limit for each in result.inputs for limit in each.limits_m_s]
    picture.axes[-1].set(
        xlabel="velocity, m/s", xlim=drawing.widened([velocity, *limits.values(), *uncertain, *changed])
    )
    return picture


@draw.register
def draw_sensitivity(result: SensitivityResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the elasticities of each answer, in a row for each input.

    Inputs are sorted by the first answer, which is the ballistic limit if there is one; the largest is on top.
    """
    answers = [name for name, value in result.answers.items() if value is not None]
    # An input without an elasticity, such as the velocity for the ballistic limit, sorts as 0.
    inputs = [item for item in result.inputs if any(item.elasticities[answer] is not None for answer in answers)]
    inputs.sort(key=lambda item: [-abs(item.elasticities[answer] or 0.0) for answer in answers])
    names, titles = [Column.of(item.input).label for item in inputs], [Column.of(name).label for name in answers]
    note = "Change in % for a 1 % increase of the input."
    picture = sheet.panels(headline(result), *[drawing.rows_height(names, titled=True)] * len(answers), note=note)
    for axes, answer, heading in zip(picture.axes, answers, titles, strict=True):
        drawing.rows(axes, names, {"": [item.elasticities[answer] for item in inputs]}, 0.0)
        axes.set(title=heading, xlabel="change, %")
    return picture


# Largest number of rows with deviations; words for what a test measured, by its bound.
MAX_TESTS = 40
WORDS = {"": "measured", "at least": "stopped at", "at most": "perforated at"}


@draw.register
def draw_calibration(result: CalibrationResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw computed over measured values, and deviations, for each quantity measured."""
    has_uncertainties = any(residual.uncertainty for residual in result.residuals)
    by_quantity = grouped(result.residuals, lambda residual: residual.quantity)
    measured = {quantity: [r for r in residuals if not r.bound] for quantity, residuals in by_quantity.items()}
    heights = []
    for residuals in measured.values():
        tests = [residual.test for residual in _largest(residuals)]
        heights += [sheet.width - 0.3, *([drawing.rows_height(tests, titled=True)] if tests else [])]
    note = "Error bars: ± one standard deviation of the measured value." if has_uncertainties else ""
    picture = sheet.panels(headline(result), *heights, note=note)
    panels = iter(picture.axes)
    for quantity, residuals in by_quantity.items():
        groups: dict[str, list[drawing.Compared]] = {}
        for r in sorted(residuals, key=lambda residual: list(WORDS).index(residual.bound)):
            pair = drawing.Compared(r.test, WORDS[r.bound], r.measured, r.computed, r.uncertainty or 0.0)
            groups.setdefault(WORDS[r.bound] if r.bound else "tests", []).append(pair)
        drawing.agreement(next(panels), quantity, "measured", groups)
        if measured[quantity]:
            _draw_deviations(next(panels), quantity, measured[quantity])
    return picture


def _largest(residuals: Sequence[Residual]) -> list[Residual]:
    """Return the residuals, at most `MAX_TESTS`, with the largest relative deviations."""
    return sorted(residuals, key=lambda r: -abs(deviation_percent(r.computed, r.measured) or 0.0))[:MAX_TESTS]


def _draw_deviations(axes: Axes, quantity: str, residuals: Sequence[Residual]) -> None:
    """Draw the relative deviations from measured values, %, the largest ones if there are many."""
    title, shown = f"Deviation of the computed {Column.of(quantity).label}", _largest(residuals)
    if len(shown) < len(residuals):
        title += f", the {MAX_TESTS} largest of {len(residuals)}"
    fitted = [deviation_percent(residual.computed, residual.measured) for residual in shown]
    left_out = [deviation_percent(residual.left_out, residual.measured) for residual in shown]
    values = {"fitted": fitted, "leave-one-out": left_out}
    drawing.rows(axes, [residual.test for residual in shown], values, 0.0)
    axes.set(title=title, xlabel="deviation, %")


# Number of values of V50, and of the scatter, in the grid for their joint region.
REGION_NODES = 121
# Height at which the posterior interval of V50 is drawn; the interval from the shots alone is at 0.5.
POSTERIOR = 0.4


@draw.register
def draw_firing(result: FiringResult, sheet: drawing.Sheet, *, alone: bool = False) -> drawing.Picture:
    """Draw the part of shots that perforate over velocity, the region of V50 and scatter, and the shots.

    With `alone`, only the first of these.
    """
    shots = drawing.recorded(result, "shots")
    if not result.fits:
        raise mistake(shots.file, "", "must have a curve to draw, and these shots have none")
    fit, posterior, model = result.recommended or result.fits[0], result.posterior, result.model_ballistic_limit_m_s
    # The axis extends by half the range of the shots; limits beyond it are left out.
    shown = [*shots.velocities_m_s, *(() if posterior is None else posterior.v50_interval_m_s)]
    low, high = drawing.widened(shown, 0.5)
    level, notes = percent(result.confidence), []
    ends = fit.v50_interval_m_s
    if fit is result.recommended:
        notes.append(f"Band: {level} band of the curve.")
    panels = [1.1 * drawing.PANEL]
    if sheet.ax is None and fit is result.recommended and not alone:
        panels += [drawing.PANEL, drawing.PANEL]
    if posterior is not None:
        posterior_ends = interval(posterior.v50_interval_m_s, ".1f")
        notes.append(f"Posterior, with the model as prior: {level} interval {posterior_ends} m/s.")
    if model is not None and not low <= model <= high:
        notes.append(f"The limit by the model, {model:.1f} m/s, lies outside the axis.")
    if (required := result.requirement_m_s) is not None and not low <= required <= high:
        notes.append(f"The velocity required, {required:g} m/s, lies outside the axis: {result.decision}.")
    picture = sheet.panels(at_one_level(result), *panels, note=" ".join(notes))
    axes = picture.axes[0]
    axes.set(xlabel=in_words(VELOCITY), ylabel="part of shots that perforate")
    axes.set(xlim=(low, high), ylim=(-0.02, 1.02))
    x = np.linspace(low, high, 400).tolist()
    if fit is result.recommended:
        band = np.array([row["probability_interval"] for row in result.band(x)])
        axes.fill_between(x, band[:, 0], band[:, 1], color=drawing.BLUE, **drawing.BAND)
    draw_shots(axes, shots)
    axes.plot(x, [fit.probability(v) for v in x], color=drawing.BLUE, label=f"{fit.curve}, {fit.method}")
    if low <= fit.v50_m_s <= high:
        if ends != (None, None):
            start, end = (edge if e is None else e for e, edge in zip(ends, (low, high), strict=True))
            drawing.ranges(axes, [0.5], [(start, end)], drawing.BLUE)
        drawing.points(axes, [fit.v50_m_s], [0.5], color=drawing.BLUE)
    if posterior is not None:
        name = f"posterior, V50 {posterior.v50_m_s:.1f} m/s"
        drawing.ranges(axes, [POSTERIOR], [posterior.v50_interval_m_s], drawing.PURPLE)
        drawing.points(axes, [posterior.v50_m_s], [POSTERIOR], marker="D", color=drawing.PURPLE, label=name)
    if result.mean is not None:
        drawing.velocity_line(axes, result.mean.v50_m_s, drawing.SOFT, "-", MEANS[result.mean.rule])
    name = f"{result.decision}: {velocity_name(result.requirement_fraction)} required"
    drawing.velocity_line(axes, required, drawing.VERMILION, "--", name)
    drawing.velocity_line(axes, model, drawing.INK, ":", "limit by the model")
    if len(panels) > 1:
        _draw_region(picture.axes[1], fit, shots, result.confidence, (low, high))
        _draw_order(picture.axes[2], shots, None if ends == (None, None) else ends)
    return picture


def _draw_region(axes: Axes, fit: FittedCurve, shots: Shots, confidence: float, ends: tuple[float, float]) -> None:
    """Draw the joint confidence regions of V50 and scatter, at 50 % and at the confidence level.

    `ends` is the range of V50 to draw, m/s, if its interval is not bounded.
    """
    likelihood = ShotLikelihood(shots.of(complete=False), shots.of(complete=True), fit.curve, penalised=True)
    (slowest, fastest), widest = fit.v50_interval_m_s, fit.scale_interval_m_s[1]
    if slowest is not None and fastest is not None:
        ends = drawing.widened((slowest, fastest), 0.4)
    spread = max(shots.velocities_m_s) - min(shots.velocities_m_s)
    top = spread if widest is None else min(1.3 * widest, spread)
    v50s, scatters = np.meshgrid(np.linspace(*ends, REGION_NODES), np.linspace(top / REGION_NODES, top, REGION_NODES))
    deviances = likelihood.deviances(v50s.ravel(), scatters.ravel()).reshape(v50s.shape)
    # The deviance has a chi-squared distribution with two degrees of freedom, whose quantile is -2 ln(1 - level).
    levels = [0.0, *(-2.0 * np.log(1.0 - level) for level in sorted({0.5, confidence}))]
    axes.contourf(v50s, scatters, deviances, levels, colors=[drawing.BLUE] * 2, alpha=0.25)
    axes.contour(v50s, scatters, deviances, levels[1:], colors=drawing.BLUE, linewidths=1.0)
    title = f"V50 and scatter together, {percent(0.5)} and {percent(confidence)}"
    axes.set(xlabel="V50, m/s", ylabel="scatter, m/s", xlim=ends, ylim=(0.0, top), title=title)
    drawing.points(axes, [fit.v50_m_s], [fit.scale_m_s], color=drawing.BLUE)


def _draw_order(axes: Axes, shots: Shots, ends: tuple[float | None, float | None] | None) -> None:
    """Draw the velocities of the shots in the order fired; `ends` is the interval of V50, m/s, None for none."""
    for kind, complete, colour, marker in PENETRATIONS:
        numbers = [number for number, result in enumerate(shots.complete, start=1) if result == complete]
        fired = [shots.velocities_m_s[number - 1] for number in numbers]
        drawing.points(axes, numbers, fired, marker=marker, label=kind, color=colour)
    low, high = axes.get_ylim()
    if ends is not None:
        axes.axhspan(*(edge if e is None else e for e, edge in zip(ends, (low, high), strict=True)), **drawing.SHADE)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    title = "Shots in their order" + ", with the interval of V50" * (ends is not None)
    axes.set(xlabel="shot", ylabel="velocity, m/s", title=title)


def draw_shots(axes: Axes, shots: Shots) -> None:
    """Draw the shots over velocity: those stopped at 0, those that perforated at 1."""
    for kind, complete, colour, marker in PENETRATIONS:
        if velocities := shots.of(complete=complete):
            drawing.points(axes, velocities, [complete] * len(velocities), marker=marker, label=kind, color=colour)
