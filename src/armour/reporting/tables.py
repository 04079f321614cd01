"""Results as rows: what tables and CSV files show."""

import csv
from collections.abc import Iterable, Sequence
from dataclasses import fields
from io import StringIO
from math import floor, log10
from typing import TYPE_CHECKING, Any

from armour.analysis.ballistic_limit import LimitResult
from armour.analysis.comparison import Comparison, FlorenceResult
from armour.analysis.impact import ImpactResult
from armour.analysis.least_thickness import Design
from armour.analysis.quantities import QUANTITIES
from armour.design.catalogue import ParetoPoint, StudyResult
from armour.design.optimisation import OptimumResult
from armour.scenario.library import Kind, Library, LibraryEntry
from armour.statistics.calibration import CalibrationResult
from armour.statistics.sensitivity import SensitivityResult
from armour.statistics.uncertainty import UncertaintyResult
from armour.statistics.v50 import FiringResult
from armour.validation.figures import Chart
from armour.validation.suite import Case
from armour.validation.validate import Check, SuiteResult, Update

if TYPE_CHECKING:
    from armour.analysis.history import History

# A quantity, its number in words and its unit.
Row = tuple[str, str, str]

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


def impact_rows(result: ImpactResult) -> list[Row]:
    """An impact's result, quantity by quantity."""
    return [
        ("outcome", result.outcome, ""),
        ("impact velocity", f"{result.impact_velocity_m_s:.2f}", "m/s"),
        ("residual velocity", f"{result.residual_velocity_m_s:.2f}", "m/s"),
        ("residual length", f"{result.residual_length_mm:.3f}", "mm"),
        ("residual mass", f"{result.residual_mass_g:.3f}", "g"),
        ("plug velocity", f"{result.plug_velocity_m_s:.2f}", "m/s"),
        ("penetration depth", f"{result.penetration_depth_mm:.3f}", "mm"),
        ("bulge height", f"{result.bulge_height_mm:.3f}", "mm"),
        ("duration", f"{result.duration_us:.2f}", "us"),
        ("areal density", f"{result.areal_density_kg_m2:.2f}", "kg/m^2"),
    ]


def stage_rows(result: ImpactResult) -> list[tuple[str, ...]]:
    """The stages of an impact, with what each took from the projectile."""
    return [
        (
            record.stage,
            STAGES[record.stage],
            f"{record.start_us:.3f}",
            f"{record.end_us:.3f}",
            f"{record.velocity_lost_m_s:.2f}",
            f"{record.length_lost_mm:.3f}",
            f"{record.energy_lost_J:.1f}",
        )
        for record in result.stages
    ]


STAGE_COLUMNS = (
    "stage",
    "what holds",
    "start us",
    "end us",
    "velocity lost m/s",
    "length lost mm",
    "energy lost J",
)


def limit_rows(result: LimitResult) -> list[Row]:
    """A ballistic limit, quantity by quantity."""
    low, high = result.bracket_m_s
    return [
        ("ballistic limit", f"{result.ballistic_limit_m_s:.2f}", "m/s"),
        ("defeated at", f"{low:.4f}", "m/s"),
        ("perforated at", f"{high:.4f}", "m/s"),
        ("runs", str(result.runs), ""),
        ("areal density", f"{result.areal_density_kg_m2:.2f}", "kg/m^2"),
    ]


def crossing_rows(result: LimitResult) -> list[tuple[str, ...]]:
    """Every change of the outcome."""
    return [
        (f"{crossing.bracket_m_s[0]:.4f}", f"{crossing.bracket_m_s[1]:.4f}", crossing.above)
        for crossing in result.crossings
    ]


CROSSING_COLUMNS = ("below m/s", "above m/s", "outcome above")


def design_rows(result: OptimumResult) -> list[tuple[str, ...]]:
    """The frontier of an optimisation, the lightest design marked."""
    return [
        (
            f"{design.backing_thickness_mm:g}",
            f"{design.ceramic_thickness_mm:g}",
            f"{design.areal_density_kg_m2:.2f}",
            "lightest" if _same(design, result.best) else "",
        )
        for design in result.frontier
    ]


DESIGN_COLUMNS = ("backing mm", "ceramic mm", "areal density kg/m^2", "")


def _same(design: Design, other: Design) -> bool:
    return (design.ceramic_thickness_mm, design.backing_thickness_mm) == (
        other.ceramic_thickness_mm,
        other.backing_thickness_mm,
    )


def best_rows(result: OptimumResult) -> list[tuple[str, ...]]:
    """The lightest designs: of the grid and, where it was asked for, of continuous thicknesses."""
    designs = [("of the grid", result.best)]
    if result.refined is not None:
        designs.append(("refined", result.refined))
    return [
        (
            name,
            f"{design.ceramic_thickness_mm:.3f}",
            f"{design.backing_thickness_mm:.3f}",
            f"{design.areal_density_kg_m2:.3f}",
            "outside the range" if design.ballistic_limit_m_s is None else f"{design.ballistic_limit_m_s:.2f}",
        )
        for name, design in designs
    ]


BEST_COLUMNS = (
    "lightest",
    "ceramic mm",
    "backing mm",
    "areal density kg/m^2",
    "ballistic limit m/s",
)


def study_rows(result: StudyResult) -> list[Row]:
    """The best design of a study."""
    best = result.best
    rows = [
        ("ceramic", f"{best.ceramic_thickness_mm:g}", f"mm {best.ceramic}"),
        ("backing", f"{best.backing_thickness_mm:g}", f"mm {best.backing}"),
        ("areal density", f"{best.areal_density_kg_m2:.2f}", "kg/m^2"),
        ("thickness", f"{best.thickness_mm:g}", "mm"),
    ]
    if best.cost_per_m2 > 0.0:
        rows.append(("cost", f"{best.cost_per_m2:.2f}", "per m^2"))
    return [*rows, ("examined", f"{result.examined:,}", f"of {result.designs:,} designs on offer")]


def margin_rows(result: StudyResult) -> list[tuple[str, ...]]:
    """What the best design has in reserve against each threat, the governing one marked."""
    best = result.best
    rows: list[tuple[str, ...]] = []
    for threat, margin in best.margins_m_s.items():
        estimate = best.probabilities.get(threat)
        sampled = "" if estimate is None else f"{estimate.value:.4f}, {interval(estimate.low, estimate.high, '.4f')}"
        rows.append((threat, f"{margin:+.1f}", sampled, "governs" if threat == best.governing else ""))
    return rows


MARGIN_COLUMNS = ("threat", "margin m/s", "probability of perforation", "")


def pair_rows(result: StudyResult) -> list[tuple[str, ...]]:
    """Every pair of materials with its best design, or why it has none."""
    rows: list[tuple[str, ...]] = []
    for pair in result.pairs:
        best = pair.best
        numbers = ("", "", "", "", "", "")
        if best is not None:
            numbers = (
                f"{best.ceramic_thickness_mm:g}",
                f"{best.backing_thickness_mm:g}",
                f"{best.areal_density_kg_m2:.2f}",
                f"{best.thickness_mm:g}",
                f"{best.cost_per_m2:.2f}" if best.cost_per_m2 > 0.0 else "",
                best.governing,
            )
        rows.append((pair.ceramic, pair.backing, *numbers, pair.reason or "best"))
    return rows


PAIR_COLUMNS = (
    "ceramic",
    "backing",
    "ceramic mm",
    "backing mm",
    "areal density kg/m^2",
    "thickness mm",
    "cost per m^2",
    "governed by",
    "",
)


def pareto_table(result: StudyResult) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Columns and rows of a Pareto front."""
    margins = any(item.margin_m_s is not None for item in result.pareto)
    columns = ("Pareto front", "backing", "ceramic mm", "backing mm", "areal density kg/m^2", "thickness mm")
    rows = [
        (
            item.ceramic,
            item.backing,
            f"{item.ceramic_thickness_mm:g}",
            f"{item.backing_thickness_mm:g}",
            f"{item.areal_density_kg_m2:.2f}",
            f"{item.thickness_mm:g}",
            f"{item.cost_per_m2:.2f}",
            *(() if item.margin_m_s is None else (f"{item.margin_m_s:+.1f}",)),
        )
        for item in result.pareto
    ]
    return (*columns, "cost per m^2", *(("margin m/s",) if margins else ())), rows


def study_csv(result: StudyResult) -> str:
    """The Pareto front of a study, or the frontier of its best pair, as a CSV file."""
    if not result.pareto:
        return frontier_csv(result.frontier)
    names = [field.name for field in fields(ParetoPoint)]
    return csv_text(names, ([getattr(item, name) for name in names] for item in result.pareto))


def library_table(library: Library, kind: Kind) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Columns and rows of the library's entries of a kind: name, numbers and description."""
    entries = library.entries[kind].values()
    keys = list(dict.fromkeys(key for entry in entries for key in entry.values))
    rows = [
        (
            entry.name,
            *(f"{entry[key]:g}" if key in entry.values else "" for key in keys),
            entry.description,
        )
        for entry in entries
    ]
    return (kind, *(key.replace("_", " ") for key in keys), "description"), rows


def entry_rows(entry: LibraryEntry) -> list[tuple[str, str, str, str]]:
    """An entry of the library, value by value, with status and source."""
    return [(key, f"{value.value:g}", value.status, value.source) for key, value in entry.values.items()]


ENTRY_COLUMNS = ("value", "number", "status", "source")


def check_groups(result: SuiteResult) -> list[tuple[str, list[Check]]]:
    """The checks of a suite, table by table and then those of their own, each with the heading."""
    groups: dict[str, list[Check]] = {}
    for check in result.checks:
        groups.setdefault(check.case.group, []).append(check)
    return [(name or "cases", rows) for name, rows in groups.items()]


def check_rows(checks: Sequence[Check]) -> list[tuple[str, ...]]:
    """What was expected, what is computed and how that stands to the band."""
    return [
        (
            check.case.name,
            QUANTITIES[check.case.quantity].unit,
            _plain(check.case.expected),
            _decimal(check.computed, _decimals(check.case)),
            _decimal(check.deviation, _decimals(check.case), sign="+"),
            "" if check.deviation_percent is None else f"{check.deviation_percent:+.2f}",
            "" if check.case.band is None else f"{check.case.band:.4g}",
            check.status,
        )
        for check in checks
    ]


CHECK_COLUMNS = ("case", "unit", "expected", "computed", "deviation", "%", "band ±", "status")


def _plain(number: float | str) -> str:
    return number if isinstance(number, str) else f"{number:.10g}"


def _decimals(case: Case) -> int:
    """Decimals worth showing of a computed value: one more than the expected one has, and than its band is wide."""
    given = len(_plain(case.expected).partition(".")[2])
    of_band = -floor(log10(case.band)) if case.band else 0
    return min(max(given, of_band) + 1, 12)


def _decimal(value: float | str | None, decimals: int, sign: str = "") -> str:
    return f"{value:{sign}.{decimals}f}" if isinstance(value, float) else value or ""


def summary_rows(result: SuiteResult) -> list[tuple[str, ...]]:
    """The tables of a suite, each as a whole."""
    return [
        (
            summary.name,
            str(summary.count),
            summary.unit,
            f"{summary.mean:+.2f}",
            f"{summary.rms:.2f}",
            f"{summary.largest:.2f}",
            "" if summary.rms_band is None else f"{summary.rms_band:g}",
            summary.status,
        )
        for summary in result.summaries
    ]


SUMMARY_COLUMNS = ("table", "rows", "unit", "mean", "RMS", "largest", "RMS band", "status")


def error_rows(result: SuiteResult) -> list[tuple[str, ...]]:
    """Errors of every way of prediction that a table compares."""
    return [
        (error.table, error.predictor, str(error.count), f"{error.mean_percent:.1f}", f"{error.largest_percent:.1f}")
        for error in result.errors
    ]


ERROR_COLUMNS = ("table", "predicted by", "rows", "mean error %", "largest error %")


def note_rows(checks: Sequence[Check]) -> list[tuple[str, str]]:
    """Why a case is not scored or has no answer, or why its band is as wide as it is; for a table's rows once."""
    notes: dict[tuple[str, str], None] = {}
    for check in checks:
        case = check.case
        if check.message:
            notes[case.full_name, check.message] = None
        elif case.not_scored or case.reason:
            notes[case.group or case.name, case.not_scored or case.reason] = None
    return list(notes)


def verdict(result: SuiteResult) -> str:
    """The outcome of a suite in a line."""
    scored = result.count("within", "outside", "no answer")
    parts = [f"{result.count('within')} of {scored} within their bands"]
    for status in ("outside", "no answer"):
        if result.count(status):
            parts.append(f"{result.count(status)} {status}")
    unscored = sum(check.status == "not scored" for check in result.checks)
    return ", ".join(parts) + (f"; {unscored} shown and not scored" if unscored else "")


def update_rows(updates: Sequence[Update]) -> list[tuple[str, str, str]]:
    """Expected values that an update changes."""
    return [(update.case.full_name, _plain(update.old), _plain(update.new)) for update in updates]


UPDATE_COLUMNS = ("case", "expected so far", "computed now")


def comparison_rows(result: Comparison) -> list[tuple[str, ...]]:
    """Ballistic limits by the model and by Florence, with the split of the mass that each prefers."""
    found = result.limit.ballistic_limit_m_s
    rows: list[tuple[str, ...]] = [("this model", f"{found:.2f}", "", "", "", "", "", "")]
    for florence in result.florence:
        limit = florence.ballistic_limit_m_s
        model = florence.model_ballistic_limit_m_s
        rows.append(
            (
                _florence_name(florence),
                f"{limit:.2f}",
                f"{100.0 * (limit / found - 1.0):+.1f}",
                f"{florence.best_ceramic_thickness_mm:.3f}",
                f"{florence.best_backing_thickness_mm:.3f}",
                f"{florence.best_thickness_ratio:.3f}",
                f"{florence.best_ballistic_limit_m_s:.2f}",
                "" if model is None else f"{model:.2f}",
            )
        )
    return rows


COMPARISON_COLUMNS = (
    "ballistic limit by",
    "m/s",
    "to the model %",
    "its best ceramic mm",
    "on backing mm",
    "ratio",
    "its limit m/s",
    "the model's m/s",
)


def _florence_name(florence: FlorenceResult) -> str:
    return f"Florence, {florence.projectile} ({florence.mass_g:g} g, {florence.diameter_mm:g} mm)"


def fit_rows(result: Comparison) -> list[tuple[str, ...]]:
    """Fits to the model's residual velocities."""
    return [(fit.name, f"{fit.ratio:.4f}", f"{fit.exponent:.3f}", f"{fit.rms_m_s:.2f}") for fit in result.fits]


FIT_COLUMNS = ("residual velocity by", "ratio", "exponent", "RMS left m/s")


ANSWERS = {
    "ballistic_limit_m_s": ("ballistic limit", "m/s"),
    "residual_velocity_m_s": ("residual velocity", "m/s"),
    "least_areal_density_kg_m2": ("least areal density", "kg/m^2"),
}


def calibration_rows(result: CalibrationResult) -> list[Row]:
    """How a fit to tests went."""
    tests = len({residual.test for residual in result.residuals})
    weights = "by their uncertainties" if result.weights == "uncertainties" else "by the values measured"
    rows = [("tests", str(tests), f"weighted {weights}")]
    if result.law:
        rows.append(("law of the ceramic's flow stress", result.law, ""))
    rows += [
        ("mean error", *_percent(result.mean_error_percent)),
        ("mean error left out", *_percent(result.left_out_error_percent)),
        ("degrees of freedom", str(result.degrees_of_freedom), ""),
    ]
    if result.weights == "uncertainties":
        rows.append(("chi squared", f"{result.chi_squared:.2f}", ""))
    rows.append(("starts that came to this end", f"{result.starts_agreeing} of {result.starts}", ""))
    return rows


def _percent(value: float | None) -> tuple[str, str]:
    return ("none", "too few tests") if value is None else (f"{value:.2f}", "%")


def coefficient_rows(result: CalibrationResult) -> list[tuple[str, ...]]:
    """Fitted coefficients with their intervals, or why there is none."""
    return [
        (
            c.name,
            "not identified" if c.estimate is None else f"{c.estimate:.4g}",
            c.reason if c.interval is None else interval(*c.interval, ".4g"),
        )
        for c in result.coefficients
    ]


COEFFICIENT_COLUMNS = ("coefficient", "estimate", "95 % interval")


def correlation_table(result: CalibrationResult) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Columns and rows of the correlations of the coefficients."""
    numbered = list(enumerate(zip(result.coefficients, result.correlation, strict=True), start=1))
    columns = ("correlation", *(str(number) for number, _ in numbered))
    return columns, [(f"{number} {c.name}", *(f"{value:+.3f}" for value in values)) for number, (c, values) in numbered]


def residual_rows(result: CalibrationResult) -> list[tuple[str, ...]]:
    """Measured and computed, test by test."""
    rows: list[tuple[str, ...]] = []
    for r in result.residuals:
        percent = 100.0 * (r.computed / r.measured - 1.0)
        left_out = "" if r.left_out is None else f"{100.0 * (r.left_out / r.measured - 1.0):+.2f}"
        exact = not r.bound
        rows.append(
            (
                r.test,
                QUANTITIES[r.quantity].words,
                r.bound,
                f"{r.measured:g} {QUANTITIES[r.quantity].unit}",
                f"{r.computed:.2f}",
                f"{percent:+.2f}" if exact else "",
                left_out if exact else "",
                "" if exact or r.met else "not met",
            )
        )
    return rows


RESIDUAL_COLUMNS = ("test", "quantity", "", "measured", "computed", "%", "% left out", "")


def sensitivity_rows(result: SensitivityResult) -> list[Row]:
    """The answers whose elasticities are given."""
    return [
        (ANSWERS[name][0], "none" if value is None else f"{value:.2f}", "" if value is None else ANSWERS[name][1])
        for name, value in result.answers.items()
    ]


def elasticity_columns(result: SensitivityResult) -> tuple[str, ...]:
    """Columns of a table of elasticities."""
    return ("% per % of", "value", *(ANSWERS[name][0] for name in result.answers))


def elasticity_rows(result: SensitivityResult) -> list[tuple[str, ...]]:
    """By how many per cent each answer changes when an input grows by one."""
    return [
        (
            item.input,
            f"{item.value:g}",
            *("" if value is None else f"{value:+.3f}" for value in item.elasticities.values()),
        )
        for item in result.inputs
    ]


def firing_rows(result: FiringResult) -> list[Row]:
    """What firing results say of the ballistic limit, but for the curves."""
    rows = [
        ("shots", str(result.shots), f"{result.complete} of them complete penetrations"),
        ("highest partial", f"{result.highest_partial_m_s:.1f}", "m/s"),
        ("lowest complete", f"{result.lowest_complete_m_s:.1f}", "m/s"),
    ]
    mean = result.mean
    if mean is None:
        rows.append(("V50, MIL-STD-662F", "none", "too few shots of each kind within the span allowed"))
    else:
        span = f"m/s, mean of {mean.pairs} + {mean.pairs} within {mean.span_m_s:.1f} of {mean.span_allowed_m_s:g} m/s"
        rows.append(("V50, MIL-STD-662F", f"{mean.v50_m_s:.1f}", span))
    if result.model_ballistic_limit_m_s is not None:
        rows.append(("ballistic limit by the model", f"{result.model_ballistic_limit_m_s:.1f}", "m/s"))
    return rows


def firing_fit_rows(result: FiringResult) -> list[tuple[str, ...]]:
    """The curves by maximum likelihood, with their intervals."""
    return [
        (
            fit.curve,
            f"{fit.v50_m_s:.1f}",
            interval(*fit.v50_interval_m_s, ".1f"),
            f"{fit.scale_m_s:.1f}",
            interval(*fit.scale_interval_m_s, ".1f"),
            f"{100.0 * result.confidence:g} %",
        )
        for fit in result.fits
    ]


FIRING_COLUMNS = ("maximum likelihood", "V50 m/s", "interval", "scale m/s", "interval", "confidence")


def uncertainty_rows(result: UncertaintyResult) -> list[Row]:
    """What was sampled, and the ballistic limit with and without it."""
    return [
        ("samples", f"{result.samples:,}", f"{result.method}, seed {result.seed}"),
        ("ballistic limit as it stands", f"{result.deterministic_m_s:.1f}", "m/s"),
        ("its mean over the samples", f"{result.mean_m_s:.1f}", "m/s"),
        ("its standard deviation", f"{result.standard_deviation_m_s:.1f}", "m/s"),
    ]


def estimate_rows(result: UncertaintyResult) -> list[tuple[str, ...]]:
    """Probability and quantiles with their intervals, and whether the samples settle the last digit."""
    found = [("probability of perforation", result.probability_of_perforation, 3)]
    found += [(f"{name}, m/s", estimate, 1) for name, estimate in result.ballistic_limit_m_s.items()]
    rows: list[tuple[str, ...]] = []
    for name, estimate, decimals in found:
        needed = estimate.samples_for(10.0**-decimals, result.samples)
        settled = "yes" if needed <= result.samples else f"no, about {float(f'{needed:.2g}'):,.0f} samples would"
        low_high = interval(estimate.low, estimate.high, f".{decimals}f")
        rows.append((name, f"{estimate.value:.{decimals}f}", low_high, settled))
    return rows


ESTIMATE_COLUMNS = ("", "estimate", "95 % interval", "last digit settled")


def index_rows(result: UncertaintyResult) -> list[tuple[str, ...]]:
    """How much each input matters for the ballistic limit."""
    rows = []
    for index in result.inputs:
        indices = []
        for estimate in (index.first, index.total):
            if estimate is None:
                indices += ["", ""]
            else:
                indices += [f"{estimate.value:.3f}", interval(estimate.low, estimate.high, ".3f")]
        rows.append((index.input, *indices, *(f"{limit:.1f}" for limit in index.limits_m_s)))
    return rows


INDEX_COLUMNS = ("input", "first-order index", "interval", "total", "interval", "limit at its 5 %", "at its 95 %, m/s")


def interval(low: float | None, high: float | None, form: str) -> str:
    """An interval in words; an end that is None is not bounded."""
    if low is None and high is None:
        return "not bounded"
    if low is None:
        return f"up to {high:{form}}"
    return f"from {low:{form}}" if high is None else f"{low:{form}} to {high:{form}}"


def csv_text(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Rows as a CSV file, numbers in full."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()


def history_csv(history: "History") -> str:
    """A run over time as a CSV file."""
    names = [field.name for field in fields(history)]
    columns = [getattr(history, name).tolist() for name in names]
    return csv_text(names, zip(*columns, strict=True))


def frontier_csv(frontier: Sequence[Design]) -> str:
    """The frontier of an optimisation as a CSV file."""
    names = [field.name for field in fields(Design)]
    return csv_text(names, ([getattr(design, name) for name in names] for design in frontier))


def chart_csv(chart: Chart) -> str:
    """The curves of a figure as a CSV file, a column each; empty where there is no answer."""
    columns = [curve.values for curve in chart.curves]
    header = [chart.x_label, *(f"{curve.label}: {chart.y_label}" for curve in chart.curves)]
    return csv_text(header, zip(chart.x, *columns, strict=True))


def parity_csv(result: SuiteResult) -> str:
    """Expected and computed values of a suite's tables as a CSV file."""
    header = ("table", "row", "quantity", "expected", "computed")
    return csv_text(
        header, ((c.case.group, c.case.name, c.case.quantity, c.case.expected, c.computed) for c in result.checks)
    )
