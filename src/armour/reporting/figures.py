"""Figures of results in Python: the charts that the commands draw."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from armour.analysis.ballistic_limit import curve_velocities, residual_velocity_curve
from armour.errors import InputError, Problem
from armour.reporting import charts
from armour.reporting.chart import Chart
from armour.reporting.planned_shots_chart import shot_plan_chart
from armour.reporting.planned_tests_chart import planned_chart
from armour.reporting.plots import draw

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from armour.analysis.ballistic_limit import LimitResult
    from armour.analysis.impact import ImpactResult
    from armour.analysis.results import Result
    from armour.scenario.loading import Scenario
    from armour.statistics.v50 import FiringResult, Shots
    from armour.sweeps.columns import SweepResult


class _Source(NamedTuple):
    """What a chart shows beside the result."""

    scenario: "Scenario | None"
    shots: "Shots | None"

    @property
    def title(self) -> str:
        return "" if self.scenario is None else self.scenario.title


def plot(
    result: "Result", scenario: "Scenario | None" = None, *, shots: "Shots | None" = None, title: str | None = None
) -> "Figure":
    """Draw a result as its command does with ``--plot``.

    A notebook shows the figure; ``savefig`` writes it to a file.

    Parameters
    ----------
    result : ImpactResult, LimitResult, Comparison, DesignResult, SensitivityResult, UncertaintyResult, \
CalibrationResult, FiringResult, PlannedTests, ShotPlan, SuiteResult or SweepResult
        An impact must have its history, and a sweep one or two keys.
    scenario : Scenario, optional
        Scenario of the result, for its title; a ballistic limit and an uncertainty need it.
    shots : Shots, optional
        Shots of a V50, which needs them.
    title : str, optional
        In place of the chart's own.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        If the result cannot be drawn, or not without what is missing.

    Examples
    --------
    >>> import armour
    >>> scenario = armour.load_scenario("wilkins")
    >>> figure = armour.plot(armour.simulate(scenario, history=True), scenario)
    >>> figure.savefig("impact.png")
    """
    chart = CHARTS.get(type(result).__name__)
    if chart is None:
        raise _missing("result", f"must be one of {', '.join(CHARTS)}, found {type(result).__name__}")
    made = chart(result, _Source(scenario, shots))
    return draw(made if title is None else replace(made, title=title))


def _missing(key: str, message: str) -> InputError:
    return InputError([Problem("plot", key, message)])


def _impact(result: "ImpactResult", source: _Source) -> Chart:
    if result.history is None:
        raise _missing("result", "must have its history: simulate(scenario, history=True)")
    return charts.impact_chart(result, source.title)


def _limit(result: "LimitResult", source: _Source) -> Chart:
    scenario = _needed(source.scenario, "scenario")
    curve = residual_velocity_curve(scenario, curve_velocities(result, scenario))
    return charts.limit_chart(result, curve, scenario.title)


def _v50(result: "FiringResult", source: _Source) -> Chart:
    return charts.v50_chart(_needed(source.shots, "shots"), result)


def _sweep(result: "SweepResult", source: _Source) -> Chart:
    drawn = [result[name] for name in (*result.keys, result.quantities[0])]
    if len(result.keys) > 2 or any(values.dtype.kind not in "iuf" for values in drawn):
        raise _missing("result", "must be a sweep of numbers over one or two keys")
    return charts.sweep_chart(result.columns, result.keys, result.quantities[0], source.scenario or result.scenario)


def _needed(value: Any, key: str) -> Any:
    if value is None:
        raise _missing(key, "must be given to draw this result")
    return value


# By the name of the result's class: the modules of most need not be imported for one.
CHARTS: Mapping[str, Callable[[Any, _Source], Chart]] = {
    "CalibrationResult": lambda result, _source: charts.calibration_chart(result),
    "Comparison": lambda result, source: charts.comparison_chart(result, source.title),
    "DesignResult": lambda result, source: charts.design_chart(result, source.title),
    "FiringResult": _v50,
    "ImpactResult": _impact,
    "LimitResult": _limit,
    "PlannedTests": lambda result, source: planned_chart(result, source.title),
    "SensitivityResult": lambda result, source: charts.sensitivity_chart(result, source.title),
    "ShotPlan": lambda result, _source: shot_plan_chart(result),
    "SuiteResult": lambda result, _source: charts.parity_chart(result),
    "SweepResult": _sweep,
    "UncertaintyResult": lambda result, source: charts.uncertainty_chart(result, _needed(source.scenario, "scenario")),
}
