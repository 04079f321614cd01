"""Picture of a check: ballistic limits with their intervals, change by change, beside the velocity of each threat."""

import numpy as np

from armour.design.check import CheckResult
from armour.reporting.pictures import drawing
from armour.reporting.views.check import outcome, verdict
from armour.reporting.words import chance


def draw(result: CheckResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw a panel for each threat, with a row for the armour as given and one for every change."""
    rows = [(threat.as_given(), *threat.what_ifs) for threat in result.threats]
    names = [
        [f"{row.change}: {chance(row.probability_of_stopping)}" for row in rows_of_threat] for rows_of_threat in rows
    ]
    heights = [drawing.rows_height(changes, titled=True) for changes in names]
    note = "Percentages: probability that the armour stops the projectile."
    picture = sheet.panels(outcome(result), *heights, note=note)
    for axes, threat, rows_of_threat, changes in zip(picture.axes, result.threats, rows, names, strict=True):
        last = axes is picture.axes[-1]
        drawing.name_rows(axes, changes)
        places = range(len(changes))
        limits = np.array([row.ballistic_limit_m_s for row in rows_of_threat], float)
        # An unknown interval is drawn as the limit alone.
        ends = [row.interval_m_s or (limit, limit) for row, limit in zip(rows_of_threat, limits, strict=True)]
        drawing.ranges(axes, places, ends, drawing.BLUE)
        label = "ballistic limit, 95 % interval" if last else ""
        drawing.points(axes, limits, places, color=drawing.BLUE, label=label)
        velocities = [row.velocity_m_s for row in rows_of_threat]
        label = "velocity of the round" if last else ""
        drawing.points(axes, velocities, places, marker="D", color=drawing.VERMILION, label=label)
        axes.set(xlabel="velocity, m/s", title=f"{threat.threat}: {verdict(threat)}")
    return picture
