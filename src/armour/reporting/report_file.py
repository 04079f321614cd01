"""Reports as files, by the ending of their names."""

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from armour.analysis.progress import OnProgress, ignore_progress
from armour.errors import refuse
from armour.files import unwritable, write_atomic, wrong_ending
from armour.reporting.report import Report
from armour.scenario.scenario import Scenario

if TYPE_CHECKING:
    from armour.validation.validate import SuiteResult

ENDINGS = (".html", ".md")


def report(
    subject: "Scenario | SuiteResult",
    path: str | PathLike[str],
    *,
    as_is: bool = False,
    on_progress: OnProgress = ignore_progress,
) -> None:
    """Write a report on a scenario, or on the result of a suite.

    Parameters
    ----------
    subject : Scenario or SuiteResult
        The report on a scenario has its answer, with uncertainty, sensitivity and the sources of all values.
    path : path-like
        File to write: one self-contained .html file with charts, or .md for Markdown without them.
    as_is : bool, default False
        Whether to report on the scenario's own armour, also where the scenario asks for a design.
    on_progress : callable, optional
        Called with the number of armours computed since the last call, and None, as their total is not known.

    Raises
    ------
    InputError
        If the file has another ending or cannot be written, or the scenario cannot be computed.
    NoAnswerError
        If the question of the scenario has no answer.
    """
    path = Path(path)
    refuse(wrong_ending(path, ENDINGS) or unwritable(path))
    if isinstance(subject, Scenario):
        from armour.reporting.contents import contents_of
        from armour.reporting.scenario_report import scenario_report

        option = ", as_is=True" if as_is else ""
        contents = contents_of(subject, on_progress, as_is=as_is)
        made = scenario_report(contents, f'armour.report(scenario, "{path}"{option})')
    else:
        from armour.reporting.suite_report import suite_report

        made = suite_report(subject, f'armour.report(result, "{path}")')
    write_atomic(path, report_text(made, path).encode(errors="backslashreplace"))


def report_text(made: Report, path: Path) -> str:
    """Return a report in the format of a file, HTML or Markdown."""
    if path.suffix.lower() == ".md":
        from armour.reporting.markdown import markdown_report

        return markdown_report(made)
    from armour.reporting.html import html_report

    return html_report(made)
