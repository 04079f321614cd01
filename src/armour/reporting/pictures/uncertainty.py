"""Picture of a propagated uncertainty: the probability of perforation, and what each input does to the limit."""

import numpy as np

from armour.analysis.quantities import label_and_unit
from armour.reporting.pictures import drawing
from armour.reporting.text import percent
from armour.reporting.words import risk
from armour.statistics.uncertainty import UncertaintyResult

# Probabilities between which the curve is shown whole.
SHOWN_PROBABILITY = 0.002


def draw(result: UncertaintyResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the probability of perforation over velocity, and the ballistic limit at quantiles of each input."""
    curve, p, level = result.curve, result.probability_of_perforation, percent(result.confidence)
    at = drawing.needed(result, "scenario").impact.velocity_m_s
    names = [label_and_unit(index.input)[0] for index in result.inputs]
    picture = sheet.panels(
        f"Perforated with a probability of {risk(1.0 - p.value)} at {at:g} m/s",
        *(drawing.PANEL, drawing.rows_height(names, titled=True))[: 1 + bool(names)],
        note=f"{level} intervals by sampling: {p.low:.3f} to {p.high:.3f} at {at:g} m/s; the band for the curve.",
        sharex=True,
    )
    axes = picture.axes[0]
    axes.set(ylabel="probability of perforation", ylim=(0.0, 1.0))
    axes.fill_between(curve.velocity_m_s, curve.low, curve.high, color=drawing.BLUE, **drawing.BAND)
    axes.plot(curve.velocity_m_s, curve.probability, color=drawing.BLUE)
    limits = {"nominal ballistic limit": result.deterministic_m_s}
    limits |= {name: result.ballistic_limit_m_s[name].value for name in ("V05", "V50", "V95")}
    for (name, limit), style in zip(limits.items(), (":", "-.", "-", "--"), strict=True):
        colour = drawing.SOFT if name in result.ballistic_limit_m_s else drawing.INK
        axes.axvline(limit, linestyle=style, linewidth=1.0, color=colour, label=f"{name} {limit:.1f} m/s")
    interval = [[p.value - p.low], [p.high - p.value]]
    axes.errorbar([at], [p.value], interval, fmt="none", ecolor=drawing.VERMILION, capsize=drawing.CAP)
    label = f"{p.value:.3f} at {at:g} m/s"
    drawing.points(axes, [at], [p.value], color=drawing.VERMILION, label=label)
    if names:
        swings = {
            f"input at its {quantile} quantile": [index.limits_m_s[side] for index in result.inputs]
            for side, quantile in enumerate(("5 %", "95 %"))
        }
        drawing.rows(picture.axes[1], names, swings, result.deterministic_m_s)
        picture.axes[1].set_title("Ballistic limit with one input changed")
    probability = np.array(curve.probability)
    rising = (probability > SHOWN_PROBABILITY) & (probability < 1.0 - SHOWN_PROBABILITY)
    uncertain = np.array(curve.velocity_m_s)[rising].tolist()
    changed = [limit for index in result.inputs for limit in index.limits_m_s]
    picture.axes[-1].set(xlabel="velocity, m/s", xlim=drawing.widened([at, *limits.values(), *uncertain, *changed]))
    return picture
