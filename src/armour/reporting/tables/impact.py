"""Tables of one impact: result, stages, history and energy."""

from dataclasses import fields
from typing import TYPE_CHECKING

from armour.reporting.table import Column, Table, record

if TYPE_CHECKING:
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
AREAL_DENSITY = Column("areal density", "kg/m²", ".2f", key="areal_density_kg_m2")


def impact_table(result: "ImpactResult") -> Table:
    """Return the result of an impact, quantity by quantity."""
    return record(
        (Column("outcome"), result.outcome),
        (Column("impact velocity", "m/s", ".2f"), result.impact_velocity_m_s),
        (Column("residual velocity", "m/s", ".2f"), result.residual_velocity_m_s),
        (Column("residual length", "mm", ".3f"), result.residual_length_mm),
        (Column("residual mass", "g", ".3f"), result.residual_mass_g),
        (Column("plug velocity", "m/s", ".2f"), result.plug_velocity_m_s),
        (Column("penetration depth", "mm", ".3f"), result.penetration_depth_mm),
        (Column("bulge height", "mm", ".3f"), result.bulge_height_mm),
        (Column("duration", "µs", ".2f"), result.duration_us),
        (AREAL_DENSITY, result.areal_density_kg_m2),
    )


def stage_table(result: "ImpactResult") -> Table:
    """Return the stages of an impact with the projectile's losses in each."""
    columns = (
        Column("stage"),
        Column("description", prose=True),
        Column("start", "µs", ".3f"),
        Column("end", "µs", ".3f"),
        Column("velocity lost", "m/s", ".2f"),
        Column("length lost", "mm", ".3f"),
        Column("energy lost", "J", ".1f"),
    )
    rows = tuple(
        (s.stage, STAGES[s.stage], s.start_us, s.end_us, s.velocity_lost_m_s, s.length_lost_mm, s.energy_lost_J)
        for s in result.stages
    )
    return Table(columns, rows)


def impact_tables(result: "ImpactResult") -> list[Table | str]:
    """Return all tables of an impact."""
    return [impact_table(result), stage_table(result)]


def history_table(history: "History") -> Table:
    """Return a run over time, an instant a row."""
    names = [field.name for field in fields(history)]
    values = [getattr(history, name).tolist() for name in names]
    return Table(tuple(Column(name, key=name) for name in names), tuple(zip(*values, strict=True)))


def energy_table(energy: "EnergyBalance") -> Table:
    """Return the projectile's loss of kinetic energy, stage by stage; the last row is the sum."""
    columns = (
        Column("stage", prose=True),
        Column("carried by eroded material", "J", ".2f"),
        Column("lost in braking the rod", "J", ".2f"),
        Column("sum", "J", ".2f"),
        Column("part of the energy at impact", "%", ".1f"),
    )
    found = [(f"{row.stage}: {STAGES[row.stage]}", row.eroded, row.braked) for row in energy.rows]
    found.append(("all stages", sum(row.eroded for row in energy.rows), sum(row.braked for row in energy.rows)))
    rows = tuple(
        (name, eroded, braked, eroded + braked, 100.0 * (eroded + braked) / energy.before if energy.before else 0.0)
        for name, eroded, braked in found
    )
    return Table(columns, rows)
