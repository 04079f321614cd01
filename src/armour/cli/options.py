"""Arguments and options that several commands have."""

from pathlib import Path
from typing import Annotated, Any

import typer

from armour.cli import completion


def argument(metavar: str, description: str, **settings: Any) -> Any:
    """Make an argument whose default, if any, the help does not show."""
    return typer.Argument(metavar=metavar, help=description, show_default=False, **settings)


def option(description: str, *names: str, **settings: Any) -> Any:
    """Make an option whose default the help does not show."""
    return typer.Option(*names, help=description, show_default=False, **settings)


ScenarioFile = Annotated[
    Path,
    argument(
        "SCENARIO",
        "Scenario file (TOML), or name of a shipped scenario; - for standard input.",
        autocompletion=completion.scenarios,
    ),
]
Changes = Annotated[
    list[str] | None,
    option(
        "Change a value of the scenario; may be given several times.",
        "--set",
        metavar="KEY=VALUE",
        autocompletion=completion.assignments,
    ),
]
PlotFile = Annotated[Path | None, option("Draw to a .png, .svg or .pdf file.", "--plot", metavar="FILE")]
Force = Annotated[bool, option("Replace existing files.", "--force")]
AsJson = Annotated[bool, option("Print one JSON object and nothing else.", "--json")]
