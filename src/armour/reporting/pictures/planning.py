"""Draw plans of shots and of tests."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from armour.errors import counted, listed
from armour.planning.firing import ShotPlan
from armour.planning.plan_tests import PlannedTests
from armour.reporting.by_result import draw, headline
from armour.reporting.pictures import drawing
from armour.reporting.pictures.statistics import draw_shots
from armour.reporting.table import Column, in_words, percent
from armour.scenario.inputs import BACKING, CERAMIC, INPUTS, VELOCITY


@draw.register
def draw_shot_plan(plan: ShotPlan, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the probability density of V50, and below it the shots or, if computed, the operating characteristic."""
    simulated = bool(plan.operating_characteristic)
    note = f"{plan.stopped}." if plan.stopped else ""
    picture = sheet.panels(headline(plan), drawing.PANEL, drawing.PANEL, note=note, sharex=not simulated)
    densities, last = picture.axes
    _draw_densities(densities, plan)
    if simulated:
        densities.set_xlabel(in_words(VELOCITY))
        _draw_operating(last, plan)
        return picture
    x = plan.curve.velocity_m_s
    last.set(xlabel=in_words(VELOCITY), xlim=(x[0], x[-1]))
    last.set(ylabel="probability of complete penetration", ylim=(-0.05, 1.05))
    label = "by the posterior" if plan.fired.complete else "by the prior"
    last.plot(x, plan.curve.probability, color=drawing.BLUE, label=label)
    draw_shots(last, plan.fired)
    _draw_velocities(last, plan, named=False)
    return picture


def _draw_densities(axes: Axes, plan: ShotPlan) -> None:
    """Draw the probability densities of V50 before and after the shots."""
    x = plan.curve.velocity_m_s
    label = "prior, the model with its error" if plan.model_error else "prior"
    axes.plot(x, plan.curve.prior, linestyle="--", color=drawing.PURPLE, label=label)
    if plan.fired.complete:
        axes.plot(x, plan.curve.posterior, color=drawing.BLUE, label="posterior, with the shots")
    axes.set(ylabel="probability density of V50, s/m", xlim=(x[0], x[-1]))
    _draw_velocities(axes, plan, named=True)
    axes.set_ylim(bottom=0.0)


def _draw_operating(axes: Axes, plan: ShotPlan) -> None:
    """Draw the operating characteristic: the fractions of simulated firings that accept and that reject an armour.

    It is over the true V50 of the armour, around the required velocity.
    """
    armours = plan.operating_characteristic
    v50 = [armour.v50_m_s for armour in armours]
    look: Any = {"marker": "o", "markerfacecolor": "none"}
    axes.plot(v50, [armour.met for armour in armours], color=drawing.GREEN, label="met", **look)
    not_met = [armour.not_met for armour in armours]
    axes.plot(v50, not_met, linestyle="--", color=drawing.VERMILION, label="not met", **look)
    if (accepted := plan.consumers_risk) is not None:
        label = f"either risk {percent(accepted)}"
        axes.axhline(accepted, linestyle=":", linewidth=1.0, color=drawing.SOFT, label=label)
    if (at := plan.requirement_m_s) is not None and v50[0] <= at <= v50[-1]:
        axes.axvline(at, linestyle="-.", linewidth=1.0, color=drawing.SOFT)
    axes.set(xlabel="V50 of the armour, m/s", ylabel="fraction of firings", ylim=(-0.05, 1.05))
    axes.set_title(f"operating characteristic at a scatter of {armours[0].scatter_m_s:.0f} m/s")


def _draw_velocities(axes: Axes, plan: ShotPlan, *, named: bool) -> None:
    """Draw lines at the next velocity and the required one."""
    drawing.velocity_line(axes, plan.next_velocity_m_s, drawing.INK, ":", "next shot" * named)
    drawing.velocity_line(axes, plan.requirement_m_s, drawing.SOFT, "-.", "requirement" * named)


GAIN = "relative gain of one more test"
GAINS = "Gain of one more test{}, relative to the average planned test (1: as good)."
# Largest number of candidates whose gains are written as numbers.
MAX_NUMBERS = 60


@draw.register
def draw_planned_tests(result: PlannedTests, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the gain of one more test over the inputs that vary, and mark the planned tests.

    It is a curve over one input, or a map over two, preferably the thicknesses.  Where several candidates share these
    inputs, the greatest gain is shown.
    """
    varied = [key for key in result.candidates if key in INPUTS and len(set(result.candidates[key])) > 1]
    keys = [key for key in (CERAMIC, BACKING) if key in varied] or varied[:1] or [next(iter(result.candidates))]
    keys += [key for key in varied if key not in keys][: 2 - len(keys)]
    columns = [np.array(result.candidates[key]) for key in keys]
    gains = np.array(result.sensitivities or [np.nan] * len(columns[0]))
    steps = result.planned[1:]
    places: list[tuple[Any, ...]] = [tuple(step.inputs[key] for key in keys) for step in steps]
    velocities = [float(step.inputs[VELOCITY]) for step in steps] if result.measure == "outcome" else []
    picture = sheet.panels(_tests_title(result), 1.2 * drawing.PANEL, note=_note(result, velocities))
    [axes] = picture.axes
    axes.set(xlabel=in_words(keys[0]), ylabel=GAIN if len(keys) == 1 else in_words(keys[1]))
    if len(keys) == 1:
        x = np.unique(columns[0])
        greatest = [float(np.nanmax(gains[columns[0] == value])) if result.sensitivities else np.nan for value in x]
        axes.plot(x, greatest, color=drawing.BLUE, marker="." if len(x) < 40 else "", label="candidates")
        places = [(value, greatest[int(np.searchsorted(x, value))]) for (value,) in places]
    else:
        axes.set(xlim=drawing.widened(columns[0], 0.15), ylim=drawing.widened(columns[1], 0.15))
        order = np.argsort(gains, kind="stable")  # `on_grid` keeps the last, which is the greatest
        _draw_candidates(axes, *drawing.on_grid(columns[0][order], columns[1][order], gains[order]))
    repeats = Counter(places)
    drawing.points(axes, *zip(*repeats, strict=True), label="planned", markersize=7.0, color=drawing.VERMILION)
    for (x, y), times in repeats.items():
        if times > 1:
            drawing.name_point(axes, x, y, f"{times} tests")
    return picture


def _tests_title(result: PlannedTests) -> str:
    """Return how many tests are planned, and the half-width of the first coefficient expected after them."""
    title = f"Planned: {counted(len(result.planned) - 1, 'test')}"
    for name, half_width in result.planned[-1].half_widths.items():
        if half_width is not None:
            column = Column.of(name, ".2g")
            return f"{title}, after which {column.label} ± {column.with_unit(half_width)}"
    return title


def _note(result: PlannedTests, velocities: Sequence[float]) -> str:
    """Return a note on what a gain is, and on the velocities of the planned shots, if there are any."""
    note = GAINS.format("" if result.planned[-1].total_cost is None else " per unit cost")
    if not result.sensitivities:
        note = "The planned tests do not determine the inputs, so no gain is shown."
    different = listed([f"{velocity:.4g} m/s" for velocity in sorted(set(velocities))])
    return f"{note} The planned shots are at {different}." if velocities else note


def _draw_candidates(axes: Axes, x: Any, y: Any, z: Any) -> None:
    """Draw the gains of candidates, z, (y, x): as numbers beside points or, on a large complete grid, as colours."""
    if len(x) * len(y) > MAX_NUMBERS and np.isfinite(z).all():
        drawing.colours_of(axes, x, y, z, GAIN)
        return
    rows, columns = np.nonzero(np.isfinite(z) if np.isfinite(z).any() else np.isnan(z))
    words = [f"{value:.2f}" if np.isfinite(value) else "" for value in z[rows, columns]]
    drawing.points(axes, x[columns], y[rows], filled=False, label=GAIN, color=drawing.SOFT)
    if len(words) <= MAX_NUMBERS:
        for column, row, name in zip(columns, rows, words, strict=True):
            drawing.name_point(axes, x[column], y[row], name, above=False)
