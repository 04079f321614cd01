"""A comparison with closed-form formulas."""

from armour.reporting.table import Column, Table, column_of, deviation_percent, listing, record
from armour.reporting.views.suite import error_tables
from armour.reporting.words import BALLISTIC_LIMIT
from armour.validation.comparison import Comparison
from armour.validation.rivals import FlorenceResult


def comparison_table(result: Comparison) -> Table:
    """Return ballistic limits by the model, by Florence and by the rule."""
    limit = result.limit.ballistic_limit_m_s
    limits = {_florence(florence): florence.ballistic_limit_m_s for florence in result.florence}
    limits |= {f"areal density rule, p = {rule.p:.4g}": rule.ballistic_limit_m_s for rule in result.rules}
    rows = [(name, other, deviation_percent(other, limit)) for name, other in limits.items()]
    return listing(
        [("this model", limit, None), *rows],
        (Column("formula", prose=True), lambda row: row[0]),
        (BALLISTIC_LIMIT, lambda row: row[1]),
        (Column("difference from the model", "%", "+.0f"), lambda row: row[2]),
    )


def optimum_table(result: Comparison) -> Table:
    """Return the thicknesses of the same areal density that are best by Florence, with their ballistic limits."""
    return listing(
        result.florence,
        (Column("optimum by Florence", prose=True), _florence),
        column_of("best_ceramic_thickness_mm", ".1f", "ceramic"),
        column_of("best_backing_thickness_mm", ".1f", "back plate"),
        column_of("best_thickness_ratio", ".1f", "ratio"),
        column_of("best_ballistic_limit_m_s", ".0f", "limit by Florence"),
        column_of("model_ballistic_limit_m_s", ".0f", "by the model"),
    )


def _florence(result: FlorenceResult) -> str:
    return f"Florence, {result.projectile} ({result.mass_g:g} g, {result.diameter_mm:g} mm)"


def rule_note(result: Comparison) -> str:
    """Return what the rule of areal density is fitted to, or why it is not."""
    if not result.rules:
        return f"areal density rule: none, without tests of this round and these materials; there are {result.tests}"
    factors = " and ".join(f"k = {rule.k:.2f} with p = {rule.p:.4g}" for rule in result.rules)
    return f"areal density rule: k A^p, {factors} (m/s, kg/m²), fitted to the {result.tests}"


def fit_table(result: Comparison) -> Table:
    """Return the fits to the model's residual velocities."""
    return listing(
        result.fits,
        column_of("name", label="residual velocity by", prose=True),
        column_of("ratio", ".4f", "velocity ratio a"),
        column_of("exponent", ".3f"),
        column_of("rms_m_s", ".1f", "RMS deviation"),
    )


def tables(result: Comparison) -> list[Table | str]:
    """Return all tables of a comparison."""
    low, high = result.fitted_m_s
    return [
        comparison_table(result),
        *([f"Florence's limit: none, without {', '.join(result.florence_missing)}"] if result.florence_missing else []),
        rule_note(result),
        record(result, column_of("areal_density_kg_m2")),
        *([optimum_table(result)] if result.florence else []),
        *error_tables(result.errors),
        fit_table(result),
        f"fitted to the model's residual velocities from {low:.0f} to {high:.0f} m/s",
    ]
