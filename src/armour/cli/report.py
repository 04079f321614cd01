"""``armour report``."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from armour.cli.console import progress
from armour.cli.options import Changes, argument
from armour.cli.runner import check_outputs, read_scenario, say_if_compiling, write
from armour.errors import InputError
from armour.files import read_toml, wrong_ending


def report(
    source: Annotated[Path, argument("SCENARIO|SUITE", "Scenario or suite file (TOML).")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="File to write, .html or .md.")] = Path(
        "report.html"
    ),
    changes: Changes = None,
) -> None:
    """Write a report.

    It is one file: the answer, its uncertainty, charts (in HTML) and the sources of all values.
    """
    check_outputs(output, reads=[source])
    if problems := wrong_ending(output, (".html", ".md")):
        raise InputError(problems)
    options = [word for change in changes or () for word in ("--set", change)]
    command = shlex.join(["armour", "report", str(source), "--output", str(output), *options])
    is_suite = str(source) != "-" and {"case", "table"} & read_toml(source).keys()
    page = _suite_page if is_suite else _scenario_page
    write(output, page(source, changes or [], command, as_markdown=output.suffix.lower() == ".md"))


def _scenario_page(source: Path, changes: list[str], command: str, *, as_markdown: bool) -> str:
    from armour.reporting.contents import contents_of

    loaded = read_scenario(source, changes)
    say_if_compiling()
    contents = contents_of(loaded)
    if as_markdown:
        from armour.reporting.markdown_report import scenario_markdown

        return scenario_markdown(contents, command)
    from armour.reporting.html import scenario_page

    return scenario_page(contents, command)


def _suite_page(source: Path, changes: list[str], command: str, *, as_markdown: bool) -> str:
    from armour.scenario.assignments import changes_of
    from armour.validation.suite import load_suite
    from armour.validation.validate import validate

    suite = load_suite(source, changes_of(changes))
    say_if_compiling()
    with progress("cases", len(suite.cases)) as count:
        result = validate(suite, on_check=lambda _check, _total: count(1))
    if as_markdown:
        from armour.reporting.markdown import suite_markdown

        return suite_markdown(result)
    from armour.reporting.html import suite_page

    return suite_page(result, command)
