"""``armour report``."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from armour.cli.common import Changes, changes_of, check_outputs, counting, read_scenario, tell_of_compiling, write


def report(
    source: Annotated[
        Path, typer.Argument(metavar="SCENARIO|SUITE", help="Scenario or suite file (TOML).", show_default=False)
    ],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="HTML file to write.")] = Path(
        "report.html"
    ),
    changes: Changes = None,
) -> None:
    """Write a report to hand over: one HTML file with the answer, charts, how sure it is and where it comes from."""
    from armour.files import read_toml
    from armour.pages import scenario_page, suite_page

    check_outputs(output, source=source)
    options = [word for change in changes or () for word in ("--set", change)]
    command = shlex.join(["armour", "report", str(source), "--output", str(output), *options])
    tell_of_compiling()
    if str(source) != "-" and {"case", "table"} & read_toml(source).keys():
        from armour.suite import load_suite
        from armour.validation import validate

        with counting("cases") as show:
            result = validate(load_suite(source, changes_of(changes or ())), on_check=lambda _check, total: show(total))
        page = suite_page(result, command)
    else:
        from armour.dossier import dossier_of

        page = scenario_page(dossier_of(read_scenario(source, changes)), command)
    write(output, page)
