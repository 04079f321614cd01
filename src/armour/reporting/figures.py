"""Figures of results in Python: the charts that the commands draw."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

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
    from armour.scenario.scenario import Scenario
    from armour.statistics.uncertainty import UncertaintyResult
    from armour.statistics.v50 import FiringResult, Shots
    from armour.sweeps.columns import SweepResult


# Texts of a scenario that no result depends on.
TEXTS = {"title", "author", "project", "date"}


class _Source(NamedTuple):
    """What a chart shows beside the result."""

    scenario: "Scenario | None"
    shots: "Shots | None"


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
        Scenario of the result, perhaps with another title.  Only a result that is made by hand needs it.
    shots : Shots, optional
        Shots of a V50.  Only a result that is made by hand needs them.
    title : str, optional
        In place of the chart's own.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        If the result cannot be drawn, or not without what is missing, or the scenario or the shots are of another one.

    Examples
    --------
    >>> import armour
    >>> scenario = armour.load_scenario("wilkins")
    >>> figure = armour.plot(armour.simulate(scenario, history=True))
    >>> figure.savefig("impact.png")
    """
    chart = CHARTS.get(type(result).__name__)
    if chart is None:
        raise _missing("result", f"must be one of {', '.join(CHARTS)}, found {type(result).__name__}")
    own = result._question
    other = own.get("scenario")
    if scenario is not None and other is not None and not _same(scenario, other):
        raise _missing("scenario", "must be the scenario of the result, found another; it can be left out")
    if shots is not None and shots != own.get("shots", shots):
        raise _missing("shots", "must be the shots of the result, found others; they can be left out")
    made = chart(result, _Source(scenario or own.get("scenario"), shots or own.get("shots")))
    return draw(made.headed(result._heading(scenario)) if title is None else replace(made, title=title))


def _same(scenario: "Scenario", other: "Scenario") -> bool:
    """Return whether two scenarios give the same results."""
    first, second = (item.model_dump(exclude=TEXTS | {"library"}) for item in (scenario, other))
    return first == second and scenario.inputs() == other.inputs()


def _missing(key: str, message: str) -> InputError:
    return InputError([Problem("plot", key, message)])


def _impact(result: "ImpactResult", _source: _Source) -> Chart:
    if result.history is None:
        raise _missing("result", "must have its history: simulate(scenario, history=True)")
    return charts.impact_chart(result)


def _limit(result: "LimitResult", source: _Source) -> Chart:
    scenario = _needed(source.scenario, "scenario")
    curve = residual_velocity_curve(scenario, curve_velocities(result, scenario))
    return charts.limit_chart(result, curve)


def _v50(result: "FiringResult", source: _Source) -> Chart:
    return charts.v50_chart(_needed(source.shots, "shots"), result)


def _uncertainty(result: "UncertaintyResult", source: _Source) -> Chart:
    return charts.uncertainty_chart(result, _needed(source.scenario, "scenario"))


def _sweep(result: "SweepResult", source: _Source) -> Chart:
    if len(result.keys) > 2:
        raise _missing("result", f"must be a sweep over one or two keys, found {len(result.keys)}")
    numbers = [name for name in result.quantities if result[name].dtype.kind in "iuf"]
    if not numbers:
        raise _missing("result", f"must have a quantity that is a number, found only {', '.join(result.quantities)}")
    if np.isnan(result[numbers[0]]).all():
        raise _missing("result", f"must have a value of {numbers[0]} in at least one row, found none")
    return charts.sweep_chart(result.columns, result.keys, numbers[0], source.scenario or result.scenario)


def _needed(value: Any, key: str) -> Any:
    if value is None:
        raise _missing(key, "must be given to draw this result")
    return value


# By the name of the result's class: the modules of most need not be imported for one.
CHARTS: Mapping[str, Callable[[Any, _Source], Chart]] = {
    "CalibrationResult": lambda result, _source: charts.calibration_chart(result),
    "Comparison": lambda result, _source: charts.comparison_chart(result),
    "DesignResult": lambda result, _source: charts.design_chart(result),
    "FiringResult": _v50,
    "ImpactResult": _impact,
    "LimitResult": _limit,
    "PlannedTests": lambda result, _source: planned_chart(result),
    "SensitivityResult": lambda result, _source: charts.sensitivity_chart(result),
    "ShotPlan": lambda result, _source: shot_plan_chart(result),
    "SuiteResult": lambda result, _source: charts.parity_chart(result),
    "SweepResult": _sweep,
    "UncertaintyResult": _uncertainty,
}
