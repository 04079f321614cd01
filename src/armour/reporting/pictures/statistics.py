"""Draw uncertainties, sensitivities, calibrations and V50 from firing results."""

import numpy as np
from matplotlib.axes import Axes

from armour.errors import mistake
from armour.reporting.by_result import draw, headline
from armour.reporting.pictures import drawing
from armour.reporting.table import Column, between, grouped, in_words, interval, percent
from armour.reporting.views.statistics import MEANS, velocity_name
from armour.reporting.words import sampled_percents
from armour.scenario.inputs import VELOCITY
from armour.statistics.calibration import CalibrationResult
from armour.statistics.sensitivity import SensitivityResult
from armour.statistics.uncertainty import UncertaintyResult
from armour.statistics.v50 import FiringResult, Shots

# Kinds of shots: label, whether the penetration is complete, colour and marker.
PENETRATIONS = (("stopped", False, drawing.GREEN, "o"), ("perforated", True, drawing.VERMILION, "^"))


@draw.register
def draw_uncertainty(result: UncertaintyResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the probability of stopping a shot over velocity, and the limits at two quantiles of each input.

    Where it is not known, draw the share of samples that stop by the distributions alone, with the model as exact.
    """
    curve, level = result.curve, percent(result.confidence)
    p, probability = result.probability_of_perforation or result.perforated_by_distributions, curve.probability
    assert p is not None
    velocity = result.question["scenario"].impact.velocity_m_s
    names = [Column.of(each.input).label for each in result.inputs]
    stopped = 1.0 - p.value
    percents, low, high = sampled_percents(stopped, (1.0 - p.high, 1.0 - p.low))
    note = f"{level} intervals by sampling: {low:.1f} to {high:.1f} % at {velocity:g} m/s; the band for the curve."
    heights = [drawing.PANEL, *([drawing.rows_height(names, titled=True)] if names else [])]
    picture = sheet.panels(headline(result), *heights, note=note, sharex=True)
    axes = picture.axes[0]
    axes.set(ylabel="stops a shot" if probability else "stopped, with the model taken as exact", ylim=(0.0, 1.0))
    stops, below, above = (
        1.0 - np.array(ends) for ends in (probability or curve.by_distributions, curve.high, curve.low)
    )
    axes.fill_between(curve.velocity_m_s, below, above, color=drawing.BLUE, **drawing.BAND)
    axes.plot(curve.velocity_m_s, stops, color=drawing.BLUE)
    limits = {"limit by the model": result.deterministic_m_s}
    limits |= {f"limit, {100 * float(key):g} % below": each.value for key, each in result.limit_quantiles_m_s.items()}
    for (name, limit), style in zip(limits.items(), (":", "-.", "-", "--"), strict=True):
        drawing.velocity_line(axes, limit, drawing.INK, style, name)
    drawing.points(axes, [velocity], [stopped], color=drawing.VERMILION, label=f"{percents:.1f} % at {velocity:g} m/s")
    if names:
        lows, highs = zip(*(each.limits_m_s for each in result.inputs), strict=True)
        swings = {"input at its 5 % quantile": lows, "input at its 95 % quantile": highs}
        drawing.rows(picture.axes[1], names, swings, result.deterministic_m_s)
        picture.axes[1].set_title("Ballistic limit with one input changed")
    changed = [limit for each in result.inputs for limit in each.limits_m_s]
    picture.axes[-1].set(xlabel="velocity, m/s", xlim=drawing.widened([velocity, *limits.values(), *changed], 0.2))
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


# What a test measured, by its bound.
WORDS = {"": "tests", "at least": "stopped at", "at most": "perforated at"}


@draw.register
def draw_calibration(result: CalibrationResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw computed over measured values, with a panel for each quantity measured."""
    by_quantity = grouped(result.residuals, lambda residual: residual.quantity)
    has_uncertainties = any(residual.uncertainty for residual in result.residuals)
    note = "Error bars: ± one standard deviation of the measured value." if has_uncertainties else ""
    picture = sheet.panels(headline(result), *[sheet.width - 0.3] * len(by_quantity), note=note)
    for axes, (quantity, residuals) in zip(picture.axes, by_quantity.items(), strict=True):
        ordered = sorted(residuals, key=lambda residual: [*WORDS].index(residual.bound))
        by_word = grouped(ordered, lambda residual: WORDS[residual.bound])
        groups = {
            word: [(r.measured, r.computed, r.uncertainty or 0.0) for r in some] for word, some in by_word.items()
        }
        drawing.agreement(axes, quantity, "measured", groups)
    return picture


# Height, on the axis of the part that perforate, of the posterior interval of V50; that from the shots alone is at 0.5.
POSTERIOR = 0.4


@draw.register
def draw_firing(result: FiringResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the part of shots that perforate over velocity, the shots, and V50 with its interval."""
    shots = result.question["shots"]
    if not result.fits:
        raise mistake(shots.file, "", "must have a curve to draw, and these shots have none")
    fit, posterior = result.recommended or result.fits[0], result.posterior
    level, ends = percent(result.confidence), fit.v50_interval_m_s
    shown = [*shots.velocities_m_s, *(posterior.v50_interval_m_s if posterior else ())]
    shown += [each for each in (result.model_ballistic_limit_m_s, result.requirement_m_s) if each is not None]
    low, high = drawing.widened(shown, 0.3)
    # At one level, that of the band.
    at_level = f"V50 {fit.v50_m_s:.0f} m/s, {level} interval {interval(ends, '.0f')}"
    picture = sheet.panels(headline(result) if result.extrapolated else at_level, 1.1 * drawing.PANEL)
    [axes] = picture.axes
    axes.set(xlabel=in_words(VELOCITY), ylabel="part of shots that perforate", xlim=(low, high), ylim=(-0.02, 1.02))
    x = np.linspace(low, high, 400).tolist()
    if fit is result.recommended:
        band = np.array([row["probability_interval"] for row in result.band(x)])
        axes.fill_between(x, band[:, 0], band[:, 1], color=drawing.BLUE, label=f"{level} band", **drawing.BAND)
    draw_shots(axes, shots)
    axes.plot(x, [fit.probability(v) for v in x], color=drawing.BLUE, label=f"{fit.curve}, {fit.method}")
    if low <= fit.v50_m_s <= high:
        if ends != (None, None):
            start, end = (edge if e is None else e for e, edge in zip(ends, (low, high), strict=True))
            drawing.ranges(axes, [0.5], [(start, end)], drawing.BLUE)
        drawing.points(axes, [fit.v50_m_s], [0.5], color=drawing.BLUE)
    if posterior is not None:
        words = between(result.confidence, posterior.v50_interval_m_s, ".1f")
        name = f"posterior, V50 {posterior.v50_m_s:.1f} m/s ({words})"
        drawing.ranges(axes, [POSTERIOR], [posterior.v50_interval_m_s], drawing.PURPLE)
        drawing.points(axes, [posterior.v50_m_s], [POSTERIOR], marker="D", color=drawing.PURPLE, label=name)
    if result.mean is not None:
        drawing.velocity_line(axes, result.mean.v50_m_s, drawing.SOFT, "-", MEANS[result.mean.rule])
    name = f"{result.decision}: {velocity_name(result.requirement_fraction)} required"
    drawing.velocity_line(axes, result.requirement_m_s, drawing.VERMILION, "--", name)
    drawing.velocity_line(axes, result.model_ballistic_limit_m_s, drawing.INK, ":", "limit by the model")
    return picture


def draw_shots(axes: Axes, shots: Shots) -> None:
    """Draw the shots over velocity, in a panel of the part that perforate: stopped ones at 0, the others at 1."""
    for kind, complete, colour, marker in PENETRATIONS:
        if velocities := shots.of(complete=complete):
            drawing.points(axes, velocities, [complete] * len(velocities), marker=marker, label=kind, color=colour)
