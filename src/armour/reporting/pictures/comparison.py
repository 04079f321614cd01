"""Picture of a comparison: the residual velocity by the model and by fits to it, with the limits of formulas."""

from armour.reporting.pictures import drawing
from armour.validation.comparison import Comparison
from armour.validation.rivals import residual_velocity


def draw(result: Comparison, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the curves, and the limits within their range."""
    limit = result.limit.ballistic_limit_m_s
    impact = [point.impact_velocity_m_s for point in result.curve]
    limits = {f"Florence, {formula.projectile}": formula.ballistic_limit_m_s for formula in result.florence}
    limits |= {f"areal density rule, p = {rule.p:.4g}": rule.ballistic_limit_m_s for rule in result.rules}
    beyond = [f"{name} {at:.0f} m/s" for name, at in limits.items() if not impact[0] <= at <= impact[-1]]
    title = f"Ballistic limit {limit:.0f} m/s by this model"
    if limits:
        title += f", {min(limits.values()):.0f} to {max(limits.values()):.0f} m/s by formulas"
    picture = sheet.panels(title, 1.2 * drawing.PANEL, note=f"Not drawn: {', '.join(beyond)}." if beyond else "")
    [axes] = picture.axes
    residual = [point.residual_velocity_m_s for point in result.curve]
    axes.plot(impact, residual, color=drawing.COLOURS[0], label="this model")
    for fit, colour, style in zip(result.fits, drawing.COLOURS[1:], drawing.STYLES[1:], strict=False):
        fitted = [residual_velocity(velocity, limit, fit.ratio, fit.exponent) for velocity in impact]
        label = f"{fit.name}: ratio {fit.ratio:.3f}, exponent {fit.exponent:.2f}"
        axes.plot(impact, fitted, linestyle=style, color=colour, label=label)
    for (name, at), style in zip(limits.items(), drawing.STYLES[1:], strict=False):
        if impact[0] <= at <= impact[-1]:
            axes.axvline(at, linestyle=style, label=drawing.legible(f"{name}: {at:.0f} m/s"), **drawing.RULE)
    drawing.residual_axes(axes, drawing.widened([impact[0], impact[-1]]))
    return picture
