"""``armour init``."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from armour.cli.runner import check_outputs, write
from armour.errors import InputError, Problem, suggestion
from armour.files import shipped

TEMPLATE = "template"


def init(
    file: Annotated[Path, typer.Argument(metavar="[FILE]", help="Where to write the scenario.")] = Path(
        "scenario.toml"
    ),
    source: Annotated[
        str,
        typer.Option("--from", metavar="NAME", help="Copy a shipped scenario.", show_default=False),
    ] = TEMPLATE,
    names: Annotated[bool, typer.Option("--list", help="List the shipped scenarios.", show_default=False)] = False,
    force: Annotated[bool, typer.Option("--force", help="Write over an existing file.", show_default=False)] = False,
) -> None:
    """Write a commented scenario to start from, or a copy of a shipped one."""
    folder = shipped("scenarios")
    known = {path.relative_to(folder).with_suffix("").as_posix(): path for path in sorted(folder.rglob("*.toml"))}
    if names:
        print("\n".join(known))
        return
    if source not in known:
        hint = suggestion(source, list(known)) or f"; there are {', '.join(known)}"
        message = f'must name a shipped scenario, found "{source}"{hint}'
        raise InputError([Problem("init", "--from", message)])
    check_outputs(file)
    if file.exists() and not force:
        raise InputError([Problem(str(file), "", "exists already; choose another name, or --force")])
    write(file, known[source].read_bytes())
    print(f"next: armour simulate {file}", file=sys.stderr)
