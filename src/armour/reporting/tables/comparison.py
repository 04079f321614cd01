"""Tables of a comparison with closed-form formulas."""

from typing import TYPE_CHECKING

from armour.reporting.table import Column, Table, record
from armour.reporting.tables.impact import AREAL_DENSITY

if TYPE_CHECKING:
    from armour.analysis.comparison import Comparison


def comparison_table(result: "Comparison") -> Table:
    """Return ballistic limits by the model and by Florence, with the thicknesses that are best by Florence."""
    columns = (
        Column("formula", prose=True),
        Column("ballistic limit", "m/s", ".2f"),
        Column("to the model", "%", "+.1f"),
        Column("best ceramic", "mm", ".3f"),
        Column("best back plate", "mm", ".3f"),
        Column("ratio", spec=".3f"),
        Column("limit of the best", "m/s", ".2f"),
        Column("by the model", "m/s", ".2f"),
    )
    found = result.limit.ballistic_limit_m_s
    florence = (
        (
            f"Florence, {f.projectile} ({f.mass_g:g} g, {f.diameter_mm:g} mm)",
            f.ballistic_limit_m_s,
            100.0 * (f.ballistic_limit_m_s / found - 1.0),
            f.best_ceramic_thickness_mm,
            f.best_backing_thickness_mm,
            f.best_thickness_ratio,
            f.best_ballistic_limit_m_s,
            f.model_ballistic_limit_m_s,
        )
        for f in result.florence
    )
    return Table(columns, (("this model", found, *(None,) * 6), *florence))


def fit_table(result: "Comparison") -> Table:
    """Return the fits to the model's residual velocities."""
    columns = (
        Column("residual velocity by", prose=True),
        Column("ratio", spec=".4f"),
        Column("exponent", spec=".3f"),
        Column("RMS deviation", "m/s", ".2f"),
    )
    return Table(columns, tuple((fit.name, fit.ratio, fit.exponent, fit.rms_m_s) for fit in result.fits))


def comparison_tables(result: "Comparison") -> list[Table | str]:
    """Return all tables of a comparison."""
    low, high = result.fitted_m_s
    return [
        record((AREAL_DENSITY, result.areal_density_kg_m2)),
        comparison_table(result),
        fit_table(result),
        f"fitted to the model's residual velocities from {low:.1f} to {high:.1f} m/s",
    ]
