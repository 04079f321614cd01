"""Draw plans of shots."""

from armour.planning.firing import ShotPlan
from armour.reporting.by_result import draw, headline
from armour.reporting.pictures import drawing
from armour.reporting.pictures.statistics import draw_shots
from armour.reporting.table import in_words
from armour.scenario.inputs import VELOCITY


@draw.register
def draw_shot_plan(plan: ShotPlan, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the probability density of V50, and below it the shots."""
    picture = sheet.panels(headline(plan), drawing.PANEL, drawing.PANEL, sharex=True)
    densities, last = picture.axes
    x = plan.curve.velocity_m_s
    label = "prior, the model with its error" if plan.model_error else "prior"
    densities.plot(x, plan.curve.prior, linestyle="--", color=drawing.PURPLE, label=label)
    if plan.fired.complete:
        densities.plot(x, plan.curve.posterior, color=drawing.BLUE, label="posterior, with the shots")
    last.set(xlabel=in_words(VELOCITY), ylabel="part of shots that perforate", ylim=(-0.05, 1.05))
    label = "by the posterior" if plan.fired.complete else "by the prior"
    last.plot(x, plan.curve.probability, color=drawing.BLUE, label=label)
    draw_shots(last, plan.fired)
    for axes, named in (densities, True), (last, False):
        drawing.velocity_line(axes, plan.next_velocity_m_s, drawing.INK, ":", "next shot" * named)
        drawing.velocity_line(axes, plan.requirement_m_s, drawing.SOFT, "-.", "requirement" * named)
    densities.set(ylabel="probability density of V50, s/m", ylim=(0.0, None))
    return picture
