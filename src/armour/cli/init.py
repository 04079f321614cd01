"""``armour init``."""

from pathlib import Path
from typing import Annotated

import typer

from armour.cli.console import say, show
from armour.cli.options import flag
from armour.cli.runner import check_outputs, write
from armour.errors import InputError, Problem, suggestion
from armour.files import shipped

TEMPLATE = "template"


def init(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="File to write the scenario to.")] = Path(
        "scenario.toml"
    ),
    source: Annotated[
        str, typer.Option("--from", metavar="NAME", help="Copy a shipped scenario.", show_default=False)
    ] = TEMPLATE,
    names: Annotated[bool, flag("--list", "List the shipped scenarios.")] = False,
    force: Annotated[bool, flag("--force", "Replace an existing file.")] = False,
) -> None:
    """Write a scenario to start from."""
    folder = shipped("scenarios")
    known = {path.relative_to(folder).with_suffix("").as_posix(): path for path in sorted(folder.rglob("*.toml"))}
    if names:
        show(*known)
        return
    if source not in known:
        hint = suggestion(source, list(known)) or f"; there are {', '.join(known)}"
        message = f'must name a shipped scenario, found "{source}"{hint}'
        raise InputError([Problem("init", "--from", message)])
    check_outputs(file)
    if file.exists() and not force:
        raise InputError([Problem(str(file), "", "exists already; choose another name, or --force")])
    write(file, known[source].read_bytes())
    say(f"next: armour simulate {file}")
