"""A ballistic limit."""

from collections.abc import Sequence

from armour.analysis.ballistic_limit import LimitResult, curve_velocities, residual_velocity_curve
from armour.analysis.impact import ImpactResult
from armour.reporting import charts
from armour.reporting.table import Column, Table, column_of, listing, record
from armour.reporting.text import interval
from armour.reporting.views.confidence import error_note


def limit_table(result: LimitResult) -> Table:
    """Return a ballistic limit, quantity by quantity."""
    return record(
        result,
        column_of("ballistic_limit_m_s"),
        (Column("defeated at", "m/s", ".4f"), lambda limit: limit.bracket_m_s[0]),
        (Column("perforated at", "m/s", ".4f"), lambda limit: limit.bracket_m_s[1]),
        (Column("95 % interval, with the error of the model", "m/s"), interval(result.interval_m_s, ".0f")),
        column_of("runs", "d"),
        column_of("areal_density_kg_m2"),
    )


def crossing_table(result: LimitResult) -> Table:
    """Return every change of the outcome with the velocity."""
    return listing(
        result.crossings,
        (Column("below", "m/s", ".4f"), lambda crossing: crossing.bracket_m_s[0]),
        (Column("above", "m/s", ".4f"), lambda crossing: crossing.bracket_m_s[1]),
        column_of("above", label="outcome above"),
    )


def tables(result: LimitResult) -> list[Table | str]:
    """Return all tables of a ballistic limit, and what was looked at; the changes of the outcome only where several."""
    low, high = result.scanned_range_m_s
    scanned = f"{result.scanned_velocities} velocities from {low:g} to {high:g} m/s were scanned"
    found: list[Table | str] = [limit_table(result)]
    if result.monotonic:
        found.append(f"{scanned}; all above the ballistic limit perforate")
    else:
        found += [f"{scanned}; the outcome changes {len(result.crossings)} times", crossing_table(result)]
    return [*found, error_note(result, result.model_error)]


def limit_chart(limit: LimitResult, curve: Sequence[ImpactResult]) -> charts.Chart:
    """Describe the residual velocity over impact velocity, in the order of the curve, with the ballistic limit."""
    impact = [result.impact_velocity_m_s for result in curve]
    series = (
        charts.Line(impact, impact, ":", 1.0, label="no armour", colour="ink"),
        charts.Line(impact, [result.residual_velocity_m_s for result in curve], label="projectile"),
        charts.Line(impact, [result.plug_velocity_m_s for result in curve], "--", label="plug", colour="green"),
        charts.velocity_rule("ballistic limit", limit.ballistic_limit_m_s, "vermilion"),
    )
    return charts.Chart("", (charts.residual_velocity_panel(series, limits=(impact[0], impact[-1])),))


def chart(result: LimitResult) -> charts.Chart:
    """Describe the residual velocity over impact velocity, which is computed here, with the ballistic limit."""
    scenario = charts.needed(result, "scenario")
    return limit_chart(result, residual_velocity_curve(scenario, curve_velocities(result, scenario)))
