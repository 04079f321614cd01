"""``armour report``."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from armour.cli.runner import Changes, changes_of, check_outputs, counting, read_scenario, tell_of_compiling, write
from armour.errors import InputError


def report(
    source: Annotated[
        Path, typer.Argument(metavar="SCENARIO|SUITE", help="Scenario or suite file (TOML).", show_default=False)
    ],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="File to write, .html or .md.")] = Path(
        "report.html"
    ),
    changes: Changes = None,
) -> None:
    """Write a report to hand over: the answer, charts, how sure it is and where it comes from, in one HTML file."""
    from armour.files import read_toml, wrong_ending
    from armour.reporting.html import scenario_markdown, scenario_page, suite_page
    from armour.reporting.markdown import suite_markdown

    check_outputs(output, source=source)
    if problems := wrong_ending(output, (".html", ".md")):
        raise InputError(problems)
    as_markdown = output.suffix.lower() == ".md"
    options = [word for change in changes or () for word in ("--set", change)]
    command = shlex.join(["armour", "report", str(source), "--output", str(output), *options])
    tell_of_compiling()
    if str(source) != "-" and {"case", "table"} & read_toml(source).keys():
        from armour.validation.suite import load_suite
        from armour.validation.validate import validate

        with counting("cases") as show:
            result = validate(load_suite(source, changes_of(changes or ())), on_check=lambda _check, total: show(total))
        page = suite_markdown(result) if as_markdown else suite_page(result, command)
    else:
        from armour.reporting.contents import contents_of

        contents = contents_of(read_scenario(source, changes))
        page = scenario_markdown(contents, command) if as_markdown else scenario_page(contents, command)
    write(output, page)
