"""Arguments and options that several commands have."""

from pathlib import Path
from typing import Annotated, Any

import typer


def argument(metavar: str, description: str) -> Any:
    """Make an argument whose default, if any, the help does not show."""
    return typer.Argument(metavar=metavar, help=description, show_default=False)


def option(description: str, *names: str, **settings: Any) -> Any:
    """Make an option whose default the help does not show."""
    return typer.Option(*names, help=description, show_default=False, **settings)


def output(description: str, *names: str, metavar: str = "FILE") -> Any:
    """Make an option for a file that a command writes."""
    return option(description, *names, metavar=metavar)


def _changes(description: str) -> Any:
    return option(f"{description}; may be given several times.", "--set", metavar="KEY=VALUE")


ScenarioFile = Annotated[Path, argument("SCENARIO", "Scenario file (TOML); - for standard input.")]
Changes = Annotated[list[str] | None, _changes("Change a value of the scenario")]
SuiteChanges = Annotated[
    list[str] | None, _changes("Change a value of every scenario, such as model.shear_perimeter=projectile")
]
PLOT = "Draw to a .png, .svg or .pdf file."
PlotFile = Annotated[Path | None, output(PLOT, "--plot")]
# Of commands that write no other file.
OnlyPlotFile = Annotated[Path | None, output(PLOT, "--plot", "-o")]
AsJson = Annotated[bool, option("Print one JSON object and nothing else.", "--json")]
