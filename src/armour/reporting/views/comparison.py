"""A comparison with closed-form formulas."""

from typing import TYPE_CHECKING

from armour.analysis.closed_forms import residual_velocity
from armour.reporting.chart import COLOURS, ORANGE, PURPLE, STYLES, Chart, Line, Series
from armour.reporting.panels import residual_velocity_panel, velocity_rule
from armour.reporting.table import Column, Table, column_of, listing, record
from armour.reporting.views.suite import error_table

if TYPE_CHECKING:
    from armour.validation.comparison import Comparison


def comparison_table(result: "Comparison") -> Table:
    """Return ballistic limits by the model, by Florence, with the thicknesses that are best by his, and by the rule."""
    found = result.limit.ballistic_limit_m_s
    table = listing(
        result.florence,
        (
            Column("formula", prose=True),
            lambda f: f"Florence, {f.projectile} ({f.mass_g:g} g, {f.diameter_mm:g} mm)",
        ),
        column_of("ballistic_limit_m_s", ".1f"),
        (Column("difference from the model", "%", "+.1f"), lambda f: 100.0 * (f.ballistic_limit_m_s / found - 1.0)),
        column_of("best_ceramic_thickness_mm", ".2f", "optimal ceramic thickness"),
        column_of("best_backing_thickness_mm", ".2f", "optimal back plate thickness"),
        column_of("best_thickness_ratio", ".2f", "thickness ratio"),
        column_of("best_ballistic_limit_m_s", ".1f", "Florence's limit of the optimum"),
        column_of("model_ballistic_limit_m_s", ".1f", "model's limit of the optimum"),
    )
    empty = (None,) * 5
    rules = [
        (f"areal density rule, p = {rule.p:.4g}", limit, 100.0 * (limit / found - 1.0), *empty)
        for rule in result.rules
        for limit in [rule.ballistic_limit_m_s]
    ]
    return Table(table.columns, (("this model", found, None, *empty), *table.rows, *rules))


def rule_note(result: "Comparison") -> str:
    """Return what the rule of areal density is fitted to, or why it is not."""
    if not result.rules:
        return f"areal density rule: none, without tests of this round and these materials; there are {result.tests}"
    factors = " and ".join(f"k = {rule.k:.2f} with p = {rule.p:.4g}" for rule in result.rules)
    return f"areal density rule: k A^p, {factors} (m/s, kg/m²), fitted to the {result.tests}"


def fit_table(result: "Comparison") -> Table:
    """Return the fits to the model's residual velocities."""
    return listing(
        result.fits,
        column_of("name", label="residual velocity by", prose=True),
        column_of("ratio", ".4f", "velocity ratio a"),
        column_of("exponent", ".3f"),
        column_of("rms_m_s", ".1f", "RMS deviation"),
    )


def tables(result: "Comparison") -> list[Table | str]:
    """Return all tables of a comparison."""
    low, high = result.fitted_m_s
    return [
        record(result, column_of("areal_density_kg_m2")),
        comparison_table(result),
        *([f"Florence's limit: none, without {', '.join(result.florence_missing)}"] if result.florence_missing else []),
        rule_note(result),
        *([error_table(result.errors)] if result.errors else []),
        fit_table(result),
        f"fitted to the model's residual velocities from {low:.1f} to {high:.1f} m/s",
    ]


def chart(result: "Comparison") -> Chart:
    """Describe the residual velocity by the model and by fits to it, with Florence's ballistic limits."""
    found = result.limit.ballistic_limit_m_s
    impact = [impact.impact_velocity_m_s for impact in result.curve]
    residual = [impact.residual_velocity_m_s for impact in result.curve]
    series: list[Series] = [Line(impact, residual, label=f"this model: ballistic limit {found:.1f} m/s")]
    for fit, colour, style in zip(result.fits, COLOURS[1:], STYLES[1:], strict=False):
        fitted = [residual_velocity(velocity, found, fit.ratio, fit.exponent) for velocity in impact]
        label = f"{fit.name}: ratio {fit.ratio:.3f}, exponent {fit.exponent:.2f}"
        series.append(Line(impact, fitted, style, label=label, colour=colour))
    for florence, colour, style in zip(result.florence, (ORANGE, PURPLE), (":", "--"), strict=False):
        label = f"Florence, {florence.projectile}: ballistic limit"
        series.append(velocity_rule(label, florence.ballistic_limit_m_s, colour, style))
    return Chart("", (residual_velocity_panel(series),))
