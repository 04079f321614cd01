"""``armour report``."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from armour.cli import completion
from armour.cli.console import progress
from armour.cli.options import Changes, Force, argument, option
from armour.cli.runner import check_outputs, read_scenario, say_if_compiling, write
from armour.errors import InputError, Problem, refuse
from armour.files import read_toml, shipped_suites, wrong_ending

if TYPE_CHECKING:
    from armour.reporting.report import Report

# What a report reads: keys that it shows, and what the results for the scenario's own armour depend on.
BYLINE = ("author", "project", "date")
AS_IS = ("impact", "threat", "ballistic_limit", "uncertainty", "optimise")


def report(
    source: Annotated[
        Path,
        argument(
            "SCENARIO|SUITE",
            "Scenario or suite file (TOML), or name of a shipped one; - for a scenario on standard input.",
            autocompletion=completion.scenarios_and_suites,
        ),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="File to write, .html or .md.")] = Path(
        "report.html"
    ),
    as_is: Annotated[
        bool, option("Report on the scenario's own armour, also where the scenario asks for a design.", "--as-is")
    ] = False,
    force: Force = False,
    changes: Changes = None,
) -> None:
    """Write a report.

    One self-contained file with the answer, its uncertainty, charts (in HTML) and the sources of all values.
    """
    from armour.reporting.show import REPORT_ENDINGS, report_text
    from armour.scenario.scenario import scenario_file

    check_outputs(output, force=force)
    refuse(wrong_ending(output, REPORT_ENDINGS))
    options = ["--as-is"] * as_is + [word for change in changes or () for word in ("--set", change)]
    command = shlex.join(["armour", "report", str(source), "--output", str(output), *options])
    if str(source) != "-":
        source = scenario_file(source, shipped_suites())
    is_suite = str(source) != "-" and {"case", "table"} & read_toml(source).keys()
    if is_suite and as_is:
        raise InputError([Problem("command line", "--as-is", "must be given with a scenario, found a suite")])
    if is_suite:
        made = _suite_report(source, changes or [], command)
    else:
        made = _scenario_report(source, changes or [], command, as_is=as_is)
    write({output: report_text(made, output)})


def _scenario_report(source: Path, changes: list[str], command: str, *, as_is: bool) -> "Report":
    from armour.analysis.quantities import DESIGNS
    from armour.reporting.scenario_report import contents_of, scenario_report

    loaded = read_scenario(source, changes, (*BYLINE, "armour", *(AS_IS if as_is else DESIGNS)), what="the report")
    say_if_compiling()
    with progress("armours") as count:
        contents = contents_of(loaded, count, as_is=as_is)
    return scenario_report(contents, command)


def _suite_report(source: Path, changes: list[str], command: str) -> "Report":
    from armour.reporting.views.suite import report as suite_report
    from armour.scenario.changes import changes_of
    from armour.validation.suite import load_suite
    from armour.validation.validate import validate

    suite = load_suite(source, changes_of(changes))
    say_if_compiling()
    with progress("cases", len(suite.cases)) as count:
        return suite_report(validate(suite, on_check=lambda _check, _total: count(1)), command)
