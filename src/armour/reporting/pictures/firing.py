"""Picture of a V50: shots, the recommended curve with its band, V50, and the model's ballistic limit."""

import numpy as np

from armour.errors import mistake
from armour.reporting.pictures import drawing
from armour.reporting.pictures.shot_plan import draw_shots
from armour.reporting.table import in_words
from armour.reporting.text import interval, percent
from armour.scenario.inputs import VELOCITY
from armour.statistics.curves import FittedCurve, penalised_band
from armour.statistics.v50 import FiringResult, Shots

# Height of the posterior's interval of V50, below that of the shots alone.
POSTERIOR = 0.4


def draw(result: FiringResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the probability of a complete penetration over the velocity."""
    shots = drawing.needed(result, "shots")
    if not result.fits:
        raise mistake(shots.file, "", "must have a curve to draw, and these shots have none")
    fit, after, model = result.recommended or result.fits[0], result.posterior, result.model_ballistic_limit_m_s
    low, high = _velocities(result, fit, shots)
    level, notes = percent(result.confidence), []
    confidence, ends = level, fit.v50_interval_m_s
    if fit is result.recommended:
        notes.append(f"Band: {level} band of the curve.")
        if result.bounded_confidence is not None and result.bounded_interval_m_s is not None:
            confidence, ends = percent(result.bounded_confidence), result.bounded_interval_m_s
    bounded = ends != (None, None)
    words = f"V50 {fit.v50_m_s:.1f} m/s, {confidence} interval {interval(ends, '.1f')}" + (" m/s" if bounded else "")
    if after is not None:
        after_ends = interval(after.v50_interval_m_s, ".1f")
        notes.append(f"Posterior, with the model as prior: {level} interval {after_ends} m/s.")
    if model is not None and not low <= model <= high:
        notes.append(f"The model's ballistic limit, {model:.1f} m/s, lies outside the axis.")
    picture = sheet.panels(words, 1.1 * drawing.PANEL, note=" ".join(notes))
    [axes] = picture.axes
    axes.set(xlabel=in_words(VELOCITY), ylabel="probability of complete penetration")
    axes.set(xlim=(low, high), ylim=(-0.02, 1.02))
    x = np.linspace(low, high, 400).tolist()
    if fit is result.recommended:
        band = penalised_band(shots.of(complete=False), shots.of(complete=True), fit.curve, x, result.confidence)
        axes.fill_between(x, *band, color=drawing.BLUE, **drawing.BAND)
    draw_shots(axes, shots)
    axes.plot(x, [fit.probability(v) for v in x], color=drawing.BLUE, label=f"{fit.curve}, {fit.method}")
    if low <= fit.v50_m_s <= high:
        if bounded:
            start, end = (edge if e is None else e for e, edge in zip(ends, (low, high), strict=True))
            drawing.ranges(axes, [0.5], [(start, end)], drawing.BLUE)
        drawing.points(axes, [fit.v50_m_s], [0.5], [words], color=drawing.BLUE)
    if after is not None:
        name = f"posterior, V50 {after.v50_m_s:.1f} m/s"
        drawing.ranges(axes, [POSTERIOR], [after.v50_interval_m_s], drawing.PURPLE)
        drawing.points(axes, [after.v50_m_s], [POSTERIOR], [name], marker="D", color=drawing.PURPLE, label=name)
    if result.mean is not None:
        name = "mean of shots" if result.mean.rule == "no usual rule" else "MIL-STD-662F"
        drawing.velocities(axes, [(name, result.mean.v50_m_s, drawing.SOFT, "-")])
    required = (f"{result.decision}: required", result.requirement_m_s, drawing.VERMILION, "--")
    drawing.velocities(axes, [required, ("limit by this model", model, drawing.INK, ":")])
    return picture


def _velocities(result: FiringResult, fit: FittedCurve, shots: Shots) -> tuple[float, float]:
    """Return the range of velocities to draw: that of the shots, and of V50 and limits near them."""
    slowest, fastest = min(shots.velocities_m_s), max(shots.velocities_m_s)
    reach, margin = fastest - slowest or 0.01 * fastest, 0.1 * (fastest - slowest)
    limits = (fit.v50_m_s, *fit.v50_interval_m_s, result.model_ballistic_limit_m_s)
    shown = [slowest, fastest, *(limit for limit in limits if limit is not None)]
    low, high = max(slowest - reach, min(shown) - margin), min(fastest + reach, max(shown) + margin)
    if result.posterior is None:
        return low, high
    start, end = result.posterior.v50_interval_m_s
    return min(low, start - margin), max(high, end + margin)
