"""``armour library``."""

from typing import TYPE_CHECKING, Annotated

import typer

from armour.cli.options import AsJson
from armour.cli.runner import Answer, Command, Reporting, run
from armour.errors import InputError, Problem

if TYPE_CHECKING:
    from armour.scenario.library import LibraryEntry

app = typer.Typer(cls=Reporting, invoke_without_command=True, no_args_is_help=False)


@app.callback()
def list_library(ctx: typer.Context, as_json: AsJson = False) -> None:
    """List materials and projectiles."""
    if ctx.invoked_subcommand is not None:
        return
    from armour.reporting.tables.library import library_tables
    from armour.scenario.library import shipped_library

    library = shipped_library()
    run(lambda: Answer(library.to_dict, lambda: library_tables(library)), as_json=as_json)


@app.command(cls=Command)
def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the entry.", show_default=False)],
    as_json: AsJson = False,
) -> None:
    """Show an entry with the source of every value."""
    from armour.scenario.library import shipped_library

    try:
        entries = shipped_library().find(name)
    except KeyError as error:
        raise InputError([Problem("library", name, error.args[0])]) from None
    for entry in entries:
        _show(entry, as_json=as_json)


def _show(entry: "LibraryEntry", *, as_json: bool) -> None:
    from armour.reporting.tables.library import entry_tables

    run(lambda: Answer(entry.to_dict, lambda: entry_tables(entry), f"{entry.name} ({entry.kind})"), as_json=as_json)
