"""Picture of a ballistic limit: the probability that the armour stops the projectile, and its residual velocity."""

import numpy as np

from armour.analysis.ballistic_limit import LimitResult, residual_velocity_curve
from armour.reporting.pictures import drawing
from armour.reporting.text import interval
from armour.reporting.words import chance

# Points of a curve of probability.
CURVE_POINTS = 200


def draw(result: LimitResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw both over the impact velocity; without a model error, draw the residual velocity alone."""
    scenario, limit = drawing.needed(result, "scenario"), result.ballistic_limit_m_s
    threat, error, ends = scenario.impact.velocity_m_s, result.model_error, result.interval_m_s
    curve = residual_velocity_curve(scenario, result)
    impact = [point.impact_velocity_m_s for point in curve]
    reach = drawing.widened([impact[0], impact[-1], threat, *(ends or ())])
    residual_alone = error is None or ends is None
    title = f"Ballistic limit {limit:.0f} m/s"
    title += "" if residual_alone else f", 95 % interval {interval(ends, '.0f')} m/s"
    picture = sheet.panels(title, *[drawing.PANEL] * (1 if residual_alone else 2), sharex=True)
    if error is not None and ends is not None:
        likely, velocities = picture.axes[0], np.linspace(*reach, CURVE_POINTS)
        at = float(error.probability_of_stopping(limit, threat))
        likely.set(ylabel="probability of stopping, %", ylim=(0.0, 102.0))
        likely.axvspan(*ends, **drawing.SHADE, label="95 % interval")
        likely.plot(velocities, 100.0 * error.probability_of_stopping(limit, velocities), color=drawing.BLUE)
        likely.axvline(limit, linestyle=":", label=f"limit {limit:.0f} m/s", **drawing.RULE)
        likely.axvline(threat, linestyle="--", linewidth=1.0, color=drawing.VERMILION)
        label = f"{threat:g} m/s: {chance(at)}"
        drawing.points(likely, [threat], [100.0 * at], marker="D", color=drawing.VERMILION, label=label)
    residual = picture.axes[-1]
    residual.plot(impact, impact, linestyle=":", linewidth=1.0, color=drawing.INK, label="no armour")
    residual.plot(impact, [point.residual_velocity_m_s for point in curve], color=drawing.BLUE, label="projectile")
    residual.plot(
        impact, [point.plug_velocity_m_s for point in curve], linestyle="--", color=drawing.GREEN, label="plug"
    )
    residual.axvline(limit, linestyle=":", label="ballistic limit" if residual_alone else "", **drawing.RULE)
    label = f"{threat:g} m/s" if residual_alone else ""
    residual.axvline(threat, linestyle="--", linewidth=1.0, color=drawing.VERMILION, label=label)
    drawing.residual_axes(residual, reach)
    return picture
