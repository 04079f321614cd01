"""Picture of planned tests among their candidates."""

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from armour.analysis.quantities import label_and_unit
from armour.errors import counted, listed
from armour.planning.plan_tests import PlannedTests
from armour.reporting.pictures import drawing
from armour.reporting.table import in_words
from armour.scenario.inputs import BACKING, CERAMIC, INPUTS, VELOCITY

GAIN = "relative gain of one more test"
GAINS = "Gain of one more test{}, relative to the average planned test (1: as good)."
# Candidates up to which each has its gain as a number.
MAX_NUMBERS = 60
# Markers of candidates that are tested once, twice, and so on; those tested more often have the last.
MARKERS = "os^D*"


def draw(result: PlannedTests, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the gain of one more test over the inputs that vary, with the planned tests and their numbers.

    It is a map over two of them, by preference the thicknesses, or a curve over one; the greatest gain is shown where
    candidates differ in more.
    """
    varied = [key for key in result.candidates if key in INPUTS and len(set(result.candidates[key])) > 1]
    keys = [key for key in (CERAMIC, BACKING) if key in varied] or varied[:1] or [next(iter(result.candidates))]
    keys += [key for key in varied if key not in keys][: 2 - len(keys)]
    columns = [np.array(result.candidates[key]) for key in keys]
    gains = np.array(result.sensitivities or [np.nan] * len(columns[0]))
    steps = result.planned[1:]
    places: list[tuple[Any, ...]] = [tuple(step.inputs[key] for key in keys) for step in steps]
    velocities = [float(step.inputs[VELOCITY]) for step in steps] if result.measure == "outcome" else []
    picture = sheet.panels(_title(result), 1.2 * drawing.PANEL, note=_note(result, velocities))
    [axes] = picture.axes
    axes.set(xlabel=in_words(keys[0]), ylabel=GAIN if len(keys) == 1 else in_words(keys[1]))
    if len(keys) == 1:
        x = np.unique(columns[0])
        greatest = [float(np.nanmax(gains[columns[0] == value])) if result.sensitivities else np.nan for value in x]
        axes.plot(x, greatest, color=drawing.BLUE, marker="." if len(x) < 40 else "", label="candidates")
        places = [(value, greatest[int(np.searchsorted(x, value))]) for (value,) in places]
    else:
        axes.set(xlim=drawing.widened(columns[0], 0.15), ylim=drawing.widened(columns[1], 0.15))
        order = np.argsort(gains, kind="stable")  # the greatest is written last
        _draw_candidates(axes, *drawing.on_grid(columns[0][order], columns[1][order], gains[order]))
    _draw_planned(axes, places, velocities)
    return picture


def _title(result: PlannedTests) -> str:
    """Return how many tests are planned, and what is known after them."""
    title = f"Planned: {counted(len(result.planned) - 1, 'test')}"
    for name, half_width in result.planned[-1].half_widths.items():
        if half_width is not None:
            words, unit = label_and_unit(name)
            return f"{title}, after which {words} ± {half_width:.2g} {unit}".rstrip()
    return title


def _note(result: PlannedTests, velocities: Sequence[float]) -> str:
    """Return what a gain is, and the velocities of shots."""
    note = GAINS.format("" if result.planned[-1].total_cost is None else " per unit cost")
    if not result.sensitivities:
        note = "The planned tests do not determine the inputs, so no gain is shown."
    return f"{note} The planned shots are at {velocities_in_words(velocities)}." if velocities else note


def _draw_planned(axes: Axes, places: Sequence[tuple[Any, ...]], velocities: Sequence[float]) -> None:
    """Draw the points of planned tests, those with the same number of tests together, and the velocities of shots."""
    repeats = Counter(places)
    for times in sorted(set(repeats.values())):
        alike = [place for place, count in repeats.items() if count == times]
        shots = [[v for other, v in zip(places, velocities, strict=False) if other == place] for place in alike]
        words = [f"at {velocities_in_words(velocities_here)}" for velocities_here in shots] if velocities else []
        rank = min(times, len(MARKERS))
        look: Any = {"label": "one test" if times == 1 else f"{times} tests", "color": drawing.VERMILION}
        x, y = zip(*alike, strict=True)
        drawing.points(axes, x, y, words, marker=MARKERS[rank - 1], markersize=5.0 + rank, **look)


def velocities_in_words(velocities: Iterable[float]) -> str:
    """Return different velocities in words, the first of them where they are many."""
    return listed([f"{velocity:.4g} m/s" for velocity in sorted(set(velocities))])


def _draw_candidates(axes: Axes, x: Any, y: Any, z: Any) -> None:
    """Draw the gains of candidates: numbers beside points or, where they are many and a grid, colours."""
    if len(x) * len(y) > MAX_NUMBERS and np.isfinite(z).all():
        drawing.colours_of(axes, x, y, z, GAIN)
        return
    rows, columns = np.nonzero(np.isfinite(z) if np.isfinite(z).any() else np.isnan(z))
    words = [f"{value:.2f}" if np.isfinite(value) else "" for value in z[rows, columns]]
    drawing.points(axes, x[columns], y[rows], words, filled=False, label=GAIN, color=drawing.SOFT)
    if len(words) <= MAX_NUMBERS:
        for column, row, name in zip(columns, rows, words, strict=True):
            drawing.name_point(axes, x[column], y[row], name, above=False)
