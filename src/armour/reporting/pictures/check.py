"""Picture of a check: ballistic limits with their intervals, change by change, beside the velocity of each threat."""

from armour.design.check import CheckResult
from armour.reporting.pictures import drawing
from armour.reporting.pictures.drawing import Picture, Sheet
from armour.reporting.views.check import outcome, verdict
from armour.reporting.words import chance


def draw(result: CheckResult, sheet: Sheet) -> Picture:
    """Draw a panel for each threat, with a row for the armour as it is given and for every change."""
    rows = [(threat.as_given(), *threat.what_ifs) for threat in result.threats]
    names = [[f"{each.change}: {chance(each.probability_of_stopping)}" for each in of_threat] for of_threat in rows]
    heights = [drawing.rows_height(of_threat, titled=True) for of_threat in names]
    note = "Percentages: probability that the armour stops the projectile."
    picture = sheet.panels(outcome(result), *heights, note=note)
    for axes, threat, of_threat, changes in zip(picture.axes, result.threats, rows, names, strict=True):
        last = axes is picture.axes[-1]
        drawing.name_rows(axes, changes)
        # An interval that is not known is drawn as the limit.
        limits = [
            (limit, place, each.interval_m_s or (limit, limit))
            for place, each in enumerate(of_threat)
            if (limit := each.ballistic_limit_m_s) is not None
        ]
        if limits:
            values, places, ends = zip(*limits, strict=True)
            drawing.ranges(axes, values, places, ends, drawing.BLUE)
            drawing.points(
                axes, values, places, color=drawing.BLUE, label="ballistic limit, 95 % interval" if last else ""
            )
        velocities = [each.velocity_m_s for each in of_threat]
        label = "velocity of the round" if last else ""
        drawing.points(axes, velocities, range(len(velocities)), marker="D", color=drawing.VERMILION, label=label)
        axes.set(xlabel="velocity, m/s", title=f"{threat.threat}: {verdict(threat)}")
    return picture
