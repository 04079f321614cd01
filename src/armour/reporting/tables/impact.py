"""Tables of an impact (result, stages, history and energy) and of a ballistic limit."""

from dataclasses import fields
from typing import TYPE_CHECKING

from armour.reporting.table import Column, Table, column_of, listing, record
from armour.reporting.tables.confidence import DEFEAT, chance, confidence_note, error_note
from armour.reporting.text import interval

if TYPE_CHECKING:
    from armour.analysis.ballistic_limit import LimitResult
    from armour.analysis.confidence import ConfidenceResult
    from armour.analysis.energy import EnergyBalance
    from armour.analysis.history import History
    from armour.analysis.impact import ImpactResult

STAGES = {
    "i": "intact ceramic, penetrated; rod erodes",
    "ii.1": "fragmented ceramic, penetrated; rod erodes",
    "ii.2": "ceramic carried along or held (dwell); rod erodes",
    "ii.3": "ceramic, penetrated; rod rigid",
    "iii.1": "plate, penetrated; rod erodes",
    "iii.2": "plate carried along or held (dwell); rod erodes",
    "iii.3": "plate, penetrated; rod rigid",
    "iii.4": "plate carried along; rod rigid",
    "iii.5": "fragmented ceramic carried along; rod rigid",
}
# Columns of several kinds of table.
AREAL_DENSITY = column_of("areal_density_kg_m2", ".2f")
BALLISTIC_LIMIT = column_of("ballistic_limit_m_s", ".2f")


def impact_table(result: "ImpactResult") -> Table:
    """Return the result of an impact, quantity by quantity."""
    return record(
        result,
        column_of("outcome"),
        column_of("impact_velocity_m_s", ".2f"),
        column_of("residual_velocity_m_s", ".2f"),
        column_of("residual_length_mm", ".3f"),
        column_of("residual_mass_g", ".3f"),
        column_of("plug_velocity_m_s", ".2f"),
        column_of("penetration_depth_mm", ".3f"),
        column_of("bulge_height_mm", ".3f"),
        column_of("duration_us", ".2f"),
        AREAL_DENSITY,
    )


def stage_table(result: "ImpactResult") -> Table:
    """Return the stages of an impact with the projectile's losses in each."""
    return listing(
        result.stages,
        column_of("stage"),
        (Column("description", prose=True), lambda record: STAGES[record.stage]),
        column_of("start_us", ".3f"),
        column_of("end_us", ".3f"),
        column_of("velocity_lost_m_s", ".2f"),
        column_of("length_lost_mm", ".3f"),
        (Column("energy lost", "J", ".1f"), lambda record: record.energy_lost_J),
    )


def impact_tables(result: "ImpactResult", confidence: "ConfidenceResult") -> list[Table | str]:
    """Return all tables of an impact, and the confidence that the armour defeats the projectile."""
    return [impact_table(result), stage_table(result), confidence_table(confidence), confidence_note(confidence)]


def history_table(history: "History") -> Table:
    """Return a run over time, an instant a row."""
    names = [field.name for field in fields(history)]
    values = [getattr(history, name).tolist() for name in names]
    return Table(tuple(Column(name, key=name) for name in names), tuple(zip(*values, strict=True)))


def energy_table(energy: "EnergyBalance") -> Table:
    """Return the projectile's loss of kinetic energy, stage by stage; the last row is the sum."""
    found = [(f"{row.stage}: {STAGES[row.stage]}", row.eroded, row.braked) for row in energy.rows]
    found.append(("all stages", sum(row.eroded for row in energy.rows), sum(row.braked for row in energy.rows)))
    percent = 100.0 / energy.before if energy.before else 0.0
    columns = (
        Column("stage", prose=True),
        Column("carried by eroded material", "J", ".2f"),
        Column("lost in braking the rod", "J", ".2f"),
        Column("sum", "J", ".2f"),
        Column("share of the impact energy", "%", ".1f"),
    )
    rows = ((name, eroded, braked, eroded + braked, percent * (eroded + braked)) for name, eroded, braked in found)
    return Table(columns, tuple(rows))


def confidence_table(result: "ConfidenceResult") -> Table:
    """Return the ballistic limit and the probability that it exceeds the impact velocity."""
    return record(result, BALLISTIC_LIMIT, (DEFEAT, chance(result.probability_of_defeat)))


def limit_table(result: "LimitResult") -> Table:
    """Return a ballistic limit, quantity by quantity."""
    return record(
        result,
        BALLISTIC_LIMIT,
        (Column("defeated at", "m/s", ".4f"), lambda limit: limit.bracket_m_s[0]),
        (Column("perforated at", "m/s", ".4f"), lambda limit: limit.bracket_m_s[1]),
        (Column("95 % interval, with the error of the model", "m/s"), _interval(result)),
        column_of("runs", "d"),
        AREAL_DENSITY,
    )


def _interval(result: "LimitResult") -> str | None:
    return None if result.interval_m_s is None else interval(result.interval_m_s, ".0f")


def crossing_table(result: "LimitResult") -> Table:
    """Return every change of the outcome with the velocity."""
    return listing(
        result.crossings,
        (Column("below", "m/s", ".4f"), lambda crossing: crossing.bracket_m_s[0]),
        (Column("above", "m/s", ".4f"), lambda crossing: crossing.bracket_m_s[1]),
        column_of("above", label="outcome above"),
    )


def limit_tables(result: "LimitResult", *, excluded: bool | None = None) -> list[Table | str]:
    """Return all tables of a ballistic limit, and what was looked at; the changes of the outcome only where several."""
    low, high = result.scanned_range_m_s
    scanned = f"{result.scanned_velocities} velocities from {low:g} to {high:g} m/s were scanned"
    error = error_note(result.model_error, excluded=excluded)
    if result.monotonic:
        return [limit_table(result), f"{scanned}; all above the ballistic limit perforate", error]
    return [
        limit_table(result),
        f"{scanned}; the outcome changes {len(result.crossings)} times",
        crossing_table(result),
        error,
    ]
