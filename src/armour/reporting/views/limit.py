"""A ballistic limit."""

from dataclasses import replace

import numpy as np

from armour.analysis.ballistic_limit import LimitResult, curve_velocities, residual_velocity_curve
from armour.reporting import charts
from armour.reporting.table import Column, Table, column_of, listing, record
from armour.reporting.text import interval
from armour.reporting.views.confidence import chance, error_note, with_error
from armour.scenario.inputs import VELOCITY

# Points of a curve of probability.
CURVE_POINTS = 200


def limit_table(result: LimitResult) -> Table:
    """Return a ballistic limit, by the model and with its error."""
    limits = column_of("ballistic_limit_m_s"), with_error(result.median_m_s, result.interval_m_s)
    return record(result, *limits, column_of("areal_density_kg_m2"))


def crossing_table(result: LimitResult) -> Table:
    """Return every change of the outcome with the velocity."""
    return listing(
        result.crossings,
        (Column("velocity", "m/s", ".1f"), lambda crossing: crossing.bracket_m_s[1]),
        (Column("outcome above"), lambda crossing: crossing.above),
    )


def tables(result: LimitResult) -> list[Table | str]:
    """Return all tables of a ballistic limit, and what was looked at; the changes of the outcome only where several."""
    low, high = result.scanned_range_m_s
    below, above = result.bracket_m_s
    scanned = f"{result.scanned_velocities} velocities from {low:g} to {high:g} m/s were scanned"
    width = f"bracket width {above - below:.1g} m/s"
    found: list[Table | str] = [limit_table(result), error_note(result, result.model_error)]
    if result.monotonic:
        return [*found, f"{scanned}, all above the limit perforate; {width}"]
    return [*found, f"{scanned}, the outcome changes {len(result.crossings)} times; {width}", crossing_table(result)]


def chart(result: LimitResult) -> charts.Chart:
    """Describe the probability that the armour stops the projectile, and its residual velocity, which is computed here.

    Both are over the impact velocity, with that of the scenario; without a model error there is no probability.
    """
    scenario = charts.needed(result, "scenario")
    limit, threat = result.ballistic_limit_m_s, scenario.impact.velocity_m_s
    curve = residual_velocity_curve(scenario, curve_velocities(result, scenario))
    impact = [each.impact_velocity_m_s for each in curve]
    reach = charts.widened([impact[0], impact[-1], threat, *(result.interval_m_s or ())])
    title = f"Ballistic limit {limit:.0f} m/s"
    panels = []
    if (error := result.model_error) is not None and result.interval_m_s is not None:
        title += f", 95 % interval {interval(result.interval_m_s, '.0f')} m/s"
        velocities = np.linspace(*reach, CURVE_POINTS)
        stops = error.probability_of_stopping(limit, velocities)
        at = float(error.probability_of_stopping(limit, threat))
        low, high = result.interval_m_s
        likely: list[charts.Series] = [
            charts.Spans([low], [high], ("95 % interval",)),
            charts.Line(velocities.tolist(), (100.0 * stops).tolist()),
            charts.Rule(limit, ":", label=f"limit {limit:.0f} m/s", colour="ink"),
            charts.Rule(threat, "--", colour="vermilion"),
            charts.Points([threat], [100.0 * at], "D", label=f"{threat:g} m/s: {chance(at)}", colour="vermilion"),
        ]
        probability = charts.Axis("probability of stopping", "%", limits=(0.0, 102.0), spec=".1f")
        panels.append(charts.Panel(charts.quantity_axis(VELOCITY, limits=reach), probability, tuple(likely)))
    series = (
        charts.Line(impact, impact, ":", 1.0, label="no armour", colour="ink"),
        charts.Line(impact, [each.residual_velocity_m_s for each in curve], label="projectile"),
        charts.Line(impact, [each.plug_velocity_m_s for each in curve], "--", label="plug", colour="green"),
        charts.Rule(limit, ":", label="" if panels else "ballistic limit", colour="ink"),
        charts.Rule(threat, "--", label="" if panels else f"{threat:g} m/s", colour="vermilion"),
    )
    residual = charts.residual_velocity_panel(series, limits=reach)
    return charts.Chart(title, (*panels, replace(residual, shares_x=bool(panels), height=1.0)))
