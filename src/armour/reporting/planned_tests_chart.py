"""Chart of planned tests among their candidates."""

from collections import Counter
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from armour.reporting.chart import INK, VERMILION, Axis, Chart, Contours, Line, Map, Panel, Points, Series
from armour.reporting.charts import quantity_axis
from armour.scenario.inputs import BACKING, CERAMIC, INPUTS, VELOCITY

if TYPE_CHECKING:
    from armour.planning.plan_tests import PlannedTests

GAIN = "relative gain of one more test"
NOTE = "Gains of one more test for its cost are relative to the mean of the planned tests."
# Velocities that a note names one by one.
MAX_LISTED = 6
# Looks of candidates that are tested once, twice, and so on; those tested more often look like the last.
MARKS: tuple[dict[str, Any], ...] = (
    {"marker": "o", "size": 6.0},
    {"marker": "s", "size": 7.0},
    {"marker": "^", "size": 8.0},
    {"marker": "D", "size": 8.0},
    {"marker": "*", "size": 12.0},
)


def planned_chart(result: "PlannedTests") -> Chart:
    """Describe the gain of one more test over the inputs that vary, with the planned tests and their numbers.

    It is a map over two of them, by preference the thicknesses, or a curve over one; the greatest gain is shown where
    candidates differ in more.
    """
    varied = [key for key in result.candidates if key in INPUTS and len(set(result.candidates[key])) > 1]
    keys = [key for key in (CERAMIC, BACKING) if key in varied] or varied[:2] or [next(iter(result.candidates))]
    if len(keys) == 1:
        keys += [key for key in varied if key not in keys][:1]
    columns = [np.array(result.candidates[key]) for key in keys]
    gains = np.array(result.sensitivities or [np.nan] * len(columns[0]))
    axes = [quantity_axis(key) for key in keys]
    places: list[tuple[Any, ...]] = [tuple(step.inputs[key] for key in keys) for step in result.planned[1:]]
    if len(keys) == 1:
        axes.append(Axis(GAIN, spec=".2f"))
        x = np.unique(columns[0])
        best = [float(np.nanmax(gains[columns[0] == value])) if result.sensitivities else None for value in x]
        series: list[Series] = [Line(x.tolist(), best, label="candidates", marker="." if len(x) < 40 else "")]
        where = dict(zip(x.tolist(), best, strict=True))
        points: list[tuple[Any, ...]] = [(place[0], where[float(place[0])]) for place in places]
    else:
        x, y = (np.unique(column) for column in columns)
        z = np.full((len(y), len(x)), np.nan)
        order = np.argsort(gains, kind="stable")  # the greatest is written last
        z[np.searchsorted(y, columns[1][order]), np.searchsorted(x, columns[0][order])] = gains[order]
        series = _map(x, y, z)
        points = places
    velocities = _velocities(result)
    repeats = Counter(points)
    for times in sorted(set(repeats.values())):
        some = [point for point, count in repeats.items() if count == times]
        look = MARKS[min(times, len(MARKS)) - 1]
        label = "one test" if times == 1 else f"{times} tests"
        xs, ys = zip(*some, strict=True)
        shots = [[v for place, v in zip(points, velocities, strict=False) if place == point] for point in some]
        text = tuple(f"at {velocities_in_words(of_point)}" for of_point in shots) if velocities else ()
        series.append(Points(xs, ys, label=label, colour=VERMILION, text=text, **look))
    note = NOTE if result.sensitivities else "The planned tests do not determine the inputs, so that no gain is shown."
    if velocities:
        note += f" The planned shots are at {velocities_in_words(velocities)}."
    return Chart("", (Panel(axes[0], axes[1], tuple(series), height=1.2),), note)


def _velocities(result: "PlannedTests") -> list[float]:
    """Return the impact velocities of planned shots, m/s; none where the limit is measured."""
    return [float(step.inputs[VELOCITY]) for step in result.planned[1:]] if result.measure == "outcome" else []


def velocities_in_words(velocities: Iterable[float]) -> str:
    """Return different velocities in words, or their range where they are many."""
    found = [f"{velocity:.4g}" for velocity in sorted(set(velocities))]
    if len(found) > MAX_LISTED:
        return f"{len(found)} velocities, {found[0]} to {found[-1]} m/s"
    return f"{', '.join([*found[:-2], ' and '.join(found[-2:])])} m/s"


def _map(x: Any, y: Any, z: Any) -> list[Series]:
    """Describe gains over a full grid as colours with contours, and those of other candidates as points."""
    rows = [[float(value) if np.isfinite(value) else None for value in row] for row in z]
    if np.isfinite(z).all() and min(z.shape) > 1:
        gains: list[Series] = [Map(x.tolist(), y.tolist(), rows, GAIN)]
        if z.min() < z.max():
            gains.append(Contours(x.tolist(), y.tolist(), rows, levels=6, label="lines of equal gain", colour=INK))
        return gains
    js, i = np.nonzero(np.isfinite(z)) if np.isfinite(z).any() else np.nonzero(np.isnan(z))
    words = tuple(f"gain {value:.2f}" for value in z[js, i])
    return [Points(x[i].tolist(), y[js].tolist(), label="candidates", filled=False, text=words)]
