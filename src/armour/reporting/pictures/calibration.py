"""Picture of a calibration: computed over measured values, and the deviations test by test, fitted and left out."""

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes

from armour.analysis.quantities import label_and_unit
from armour.reporting.pictures import drawing
from armour.reporting.table import deviation_percent
from armour.reporting.text import number
from armour.reporting.views.suite import grouped
from armour.scenario.inputs import BACKING, CERAMIC
from armour.statistics.calibration import CalibrationResult, Residual

# Rows of deviations.
MAX_ROWS = 40
WORDS = {"": "measured", "at least": "stopped at", "at most": "perforated at"}


def draw(result: CalibrationResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw both for each quantity that was measured."""
    names = _test_names(result)
    title = f"Calibration to {len(names)} tests"
    if result.mean_error_percent is not None:
        title += f": mean error {result.mean_error_percent:.1f} %"
    if result.left_out_error_percent is not None:
        title += f", {result.left_out_error_percent:.1f} % leave-one-out"
    given = any(residual.uncertainty for residual in result.residuals)
    by_quantity = grouped(result.residuals, lambda residual: residual.quantity)
    measured = {quantity: [r for r in residuals if not r.bound] for quantity, residuals in by_quantity.items()}
    heights = []
    for residuals in measured.values():
        tests = [names[residual.test] for residual in _largest(residuals)]
        heights += [sheet.across() - 0.3, *([drawing.rows_height(tests, titled=True)] if tests else [])]
    note = "Error bars: ± one standard deviation of the measured value." if given else ""
    picture = sheet.panels(title, *heights, note=note)
    panels = iter(picture.axes)
    for quantity, residuals in by_quantity.items():
        groups: dict[str, list[drawing.Compared]] = {}
        for r in sorted(residuals, key=lambda residual: list(WORDS).index(residual.bound)):
            pair = drawing.Compared(names[r.test], WORDS[r.bound], r.measured, r.computed, r.uncertainty or 0.0)
            groups.setdefault(WORDS[r.bound] if r.bound else "tests", []).append(pair)
        drawing.agreement(next(panels), quantity, "measured", groups)
        if measured[quantity]:
            _draw_deviations(next(panels), quantity, measured[quantity], names)
    return picture


def _test_names(result: CalibrationResult) -> dict[str, str]:
    """Return the name of each test or, where it has none, its armour."""
    names = {residual.test: residual.test for residual in result.residuals}
    tests = result.question.get("tests")
    for name, place, cells in zip(tests.names, tests.places, tests.cells, strict=True) if tests else ():
        layers = [number(float(cells[key]), "g") for key in (CERAMIC, BACKING) if key in cells]
        if name == place and layers:
            names[name] = f"{' on '.join(layers)} mm"
    return names


def _largest(residuals: Sequence[Residual]) -> list[Residual]:
    """Return the residuals with the largest deviations from measured values."""
    return sorted(residuals, key=lambda r: -abs(deviation_percent(r.computed, r.measured) or 0.0))[:MAX_ROWS]


def _draw_deviations(axes: Axes, quantity: str, residuals: Sequence[Residual], names: Mapping[str, str]) -> None:
    """Draw deviations from measured values; of many tests those with the largest."""
    title, shown = f"Deviation of the computed {label_and_unit(quantity)[0]}", _largest(residuals)
    if len(shown) < len(residuals):
        title += f", the {MAX_ROWS} largest of {len(residuals)}"
    values = {
        "fitted": [deviation_percent(residual.computed, residual.measured) for residual in shown],
        "leave-one-out": [deviation_percent(residual.left_out, residual.measured) for residual in shown],
    }
    drawing.rows(axes, [names[residual.test] for residual in shown], values, 0.0)
    axes.set(title=title, xlabel="deviation, %")
