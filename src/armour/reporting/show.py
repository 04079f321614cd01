"""Show results as figures, as reports and in notebooks."""

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from armour.analysis.results import OnProgress, Result, ignore_progress
from armour.errors import mistake, refuse, restated
from armour.files import unwritable, write_file, wrong_ending
from armour.reporting.by_result import by_result, draw, drawing_of, tables_of
from armour.scenario.checked import usual_errors
from armour.scenario.scenario import Scenario

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from armour.statistics.v50 import FiringResult
    from armour.validation.validate import SuiteResult


@usual_errors()
def plot(result: Result, *, title: str | None = None, ax: "Axes | None" = None) -> "Figure":
    """Draw a result as its command does with ``--plot``.

    A notebook shows the figure; ``savefig`` writes it to a file.

    Parameters
    ----------
    result : Result
        An ImpactResult with its history, a SweepResult of one or two keys, or any LimitResult, DesignResult,
        CheckResult, SensitivityResult, UncertaintyResult, CalibrationResult, FiringResult, ShotPlan or SuiteResult.
    title : str, optional
        Title in place of the picture's own.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into, in place of a new figure; only for a picture with one panel.  They get no subject and no note
        below: what is hollow or dashed lies outside the tests.

    Returns
    -------
    matplotlib.figure.Figure
        A new one, or that of the axes given.

    Raises
    ------
    InputError
        If the result cannot be drawn.

    Examples
    --------
    >>> import armour
    >>> scenario = armour.load_scenario("wilkins")
    >>> figure = armour.plot(armour.simulate(scenario, history=True))
    >>> figure.savefig("impact.png")
    """
    if not isinstance(result, Result) or by_result(draw, result) is None:
        raise mistake("plot", "result", f"must be one that help(armour.plot) lists, found {type(result).__name__}")
    from matplotlib.axes import Axes  # slow to import

    from armour.reporting.pictures.drawing import Sheet, drawn

    if not isinstance(ax, Axes | None):
        raise mistake("plot", "ax", f"must be axes of matplotlib, found {type(ax).__name__}")
    figure: Figure = drawn(drawing_of(result), Sheet(ax=ax), result.subject(), title=title).figure
    return figure


@usual_errors()
def in_html(result: Result) -> str | None:
    """Return tables and warnings of a result as HTML, for a notebook; None if its class has no tables."""
    from armour.reporting.formats import rendered

    if (tables := by_result(tables_of, result)) is None:
        return None
    return rendered("notebook.html", tables=[*tables(result), *map("warning: {}".format, result.warnings)])


@usual_errors()
def report(
    subject: "Scenario | SuiteResult | FiringResult",
    path: str | PathLike[str],
    *,
    as_is: bool = False,
    probability: float | None = None,
    confidence: float | None = None,
    on_progress: OnProgress = ignore_progress,
) -> None:
    """Write a report on a scenario or on the result of a suite, or the record of a firing.

    Parameters
    ----------
    subject : Scenario, SuiteResult or FiringResult
        The report on a scenario has its answer, with uncertainty, sensitivity and the sources of all values.  The
        record of a firing has its shots, those not used with the reason, V50, the mean of the standard, and lines to
        sign.
    path : path-like
        File to write: one self-contained .html file with pictures, or .md for Markdown without them.
    as_is : bool, default False
        Whether to report on the scenario's own armour even if the scenario asks for a design.
    probability : float, optional
        Least probability of stopping each threat, such as 0.95; a higher one that the scenario requires stays.
    confidence : float, optional
        Another name of `probability`.
    on_progress : callable, optional
        Called with the number of armours computed since the last call, and None, as their total is not known.

    Raises
    ------
    InputError
        If the file has another ending or cannot be written, or the scenario cannot be computed.
    NoAnswerError
        If the question of the scenario has no answer.
    """
    from armour.reporting.formats import REPORT_ENDINGS, report_text
    from armour.reporting.record import firing_report
    from armour.reporting.scenario_report import scenario_report
    from armour.reporting.views.validation import suite_report
    from armour.statistics.v50 import FiringResult
    from armour.validation.validate import SuiteResult

    path = Path(path)
    refuse(wrong_ending(path, REPORT_ENDINGS) or unwritable(path))
    if isinstance(subject, Scenario):
        least = confidence if probability is None else probability
        options = (", as_is=True" if as_is else "") + (f", probability={least}" if least is not None else "")
        with restated(lambda problem: problem._replace(file="report") if problem.file == "requiring" else problem):
            scenario = subject.requiring(least)
        command = f'armour.report(scenario, "{path}"{options})'
        content = scenario_report(scenario, command, on_progress, as_is=as_is)
    elif isinstance(subject, SuiteResult):
        content = suite_report(subject, f'armour.report(result, "{path}")')
    elif isinstance(subject, FiringResult):
        content = firing_report(subject, f'armour.report(result, "{path}")')
    else:
        message = f"must be a Scenario or the result of validate or v50, found a {type(subject).__name__}"
        raise mistake("report", "subject", message)
    write_file(path, report_text(content, path).encode(errors="backslashreplace"))
