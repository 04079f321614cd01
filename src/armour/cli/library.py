"""``armour library``."""

from typing import Annotated

import typer

from armour.cli import completion
from armour.cli.options import AsJson, argument
from armour.cli.runner import Command, Reporting, respond
from armour.errors import InputError, Problem

app = typer.Typer(cls=Reporting, invoke_without_command=True, no_args_is_help=False)


@app.callback()
def list_library(ctx: typer.Context, as_json: AsJson = False) -> None:
    """List materials and projectiles."""
    if ctx.invoked_subcommand is not None:
        return
    from armour.reporting.views.library import library_tables
    from armour.scenario.library import shipped_library

    library = shipped_library()
    respond(library.to_dict(), library_tables(library), as_json=as_json)


@app.command(cls=Command)
def show(
    ctx: typer.Context,
    name: Annotated[str, argument("NAME", "Name of the entry.", autocompletion=completion.entries)],
    as_json: AsJson = False,
) -> None:
    """Show an entry with the source of every value."""
    from armour.reporting.views.library import entry_tables
    from armour.scenario.library import shipped_library

    try:
        entries = shipped_library().find(name)
    except KeyError as error:
        raise InputError([Problem("library", name, error.args[0])]) from None
    as_json = as_json or (ctx.parent is not None and ctx.parent.params["as_json"])
    for entry in entries:
        respond(entry.to_dict(), entry_tables(entry), as_json=as_json, title=f"{entry.name} ({entry.kind})")
