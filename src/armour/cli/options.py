"""Arguments and options that several commands have."""

from pathlib import Path
from typing import Annotated, Any

import typer

ScenarioFile = Annotated[
    Path, typer.Argument(metavar="SCENARIO", help="Scenario file (TOML); - for standard input.", show_default=False)
]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change a value of the scenario; may be given several times.",
        show_default=False,
    ),
]
PLOT = "Draw to a .png, .svg or .pdf file."
PlotFile = Annotated[Path | None, typer.Option("--plot", metavar="FILE", help=PLOT, show_default=False)]
# Of commands that write no other file.
OnlyPlotFile = Annotated[Path | None, typer.Option("--plot", "-o", metavar="FILE", help=PLOT, show_default=False)]


def flag(name: str, description: str, **more: Any) -> Any:
    """Make an option without a value."""
    return typer.Option(name, help=description, show_default=False, **more)


def output(name: str, description: str, metavar: str = "FILE") -> Any:
    """Make an option for the file that a command writes its result to."""
    return typer.Option(name, "-o", metavar=metavar, help=description, show_default=False)


AsJson = Annotated[bool, flag("--json", "Print one JSON object and nothing else.")]
