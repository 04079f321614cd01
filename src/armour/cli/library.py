"""``armour library``."""

from typing import Annotated

import typer

from armour.cli.runner import AsJson, print_json, print_table
from armour.errors import InputError, Problem

app = typer.Typer(invoke_without_command=True, no_args_is_help=False)


@app.callback()
def list_library(ctx: typer.Context, as_json: AsJson = False) -> None:
    """List the projectiles and materials that come with armour."""
    if ctx.invoked_subcommand is not None:
        return
    from armour.reporting.tables import library_table
    from armour.scenario.library import KINDS, shipped_library

    library = shipped_library()
    if as_json:
        print_json(library.to_dict())
        return
    for kind in KINDS:
        columns, rows = library_table(library, kind)
        print_table(columns, rows, numbers=range(1, len(columns) - 1))
        print()


@app.command()
def show(
    name: Annotated[str, typer.Argument(help="Name of the entry.", show_default=False)],
    as_json: AsJson = False,
) -> None:
    """Show an entry with the source of every value."""
    from armour.reporting.tables import ENTRY_COLUMNS, entry_rows
    from armour.scenario.library import shipped_library

    try:
        entries = shipped_library().find(name)
    except KeyError as error:
        raise InputError([Problem("library", name, error.args[0])]) from None
    for entry in entries:
        if as_json:
            print_json(entry.to_dict())
        else:
            print(f"{entry.name} ({entry.kind}): {entry.description}\n")
            print_table(ENTRY_COLUMNS, entry_rows(entry), numbers=(1,))
