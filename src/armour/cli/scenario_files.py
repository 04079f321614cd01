"""Commands that help to write a scenario file."""

from pathlib import Path
from typing import Annotated

import typer

from armour.cli import completion
from armour.cli.console import say, show, show_json
from armour.cli.options import Force, option
from armour.cli.runner import check_outputs, write
from armour.errors import InputError, Problem, suggestion
from armour.files import shipped_files


def init(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="File to write the scenario to.")] = Path(
        "scenario.toml"
    ),
    source: Annotated[
        str, option("Copy a shipped scenario.", "--from", metavar="NAME", autocompletion=completion.shipped_names)
    ] = "template",
    names: Annotated[bool, option("List the shipped scenarios, suites and tables of tests.", "--list")] = False,
    force: Force = False,
) -> None:
    """Write a scenario to start from."""
    known = shipped_files("scenarios", ".toml")
    if names:
        from armour.reporting.tables.library import shipped_tables

        show(*shipped_tables())
        return
    if source not in known:
        hint = suggestion(source, list(known)) or f"; there are {', '.join(known)}"
        message = f'must name a shipped scenario, found "{source}"{hint}'
        raise InputError([Problem("init", "--from", message)])
    if str(file) == "-":
        raise InputError([Problem("init", "FILE", "must be the name of a file to write, found -")])
    check_outputs(file, force=force)
    write({file: known[source].read_bytes()})
    say(f"next: armour simulate {file}")


def schema() -> None:
    """Print the JSON Schema of a scenario.

    Editors complete and check scenario files with it.
    """
    from armour.scenario.loading import scenario_schema

    show_json(scenario_schema())
