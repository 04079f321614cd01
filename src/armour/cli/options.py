"""What makes an option, with its help, in the signature of a command, and the options that commands share.

An option that is not given is None or False; a default that matters to a computation is that of the Python function.
"""

from collections.abc import Callable
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


def number(text: str) -> float | str:
    """Return the number in a word or, if there is none, the word itself, which is refused later."""
    from armour.csv_files import number as read_number  # imports what reads tables

    value = read_number(text)
    if value is None:
        return text
    return int(value) if text.lstrip("+-").isdigit() else value


def share(text: str) -> float | str:
    """Return a share, which may be given in per cent, or, if there is none, the word itself, which is refused later."""
    value = number(text.removesuffix("%").rstrip())
    return text if isinstance(value, str) else value / 100.0 if text.endswith("%") else value


def number_option(description: str, parser: Callable[[str], float | str] = number) -> Any:
    """Make an option of a number, or of a share with that parser."""
    return option(description, metavar="NUMBER", parser=parser)


def file_option(description: str, *names: str, metavar: str = "FILE") -> Any:
    """Make an option of a file."""
    return option(description, *names, metavar=metavar)


def word_option(description: str, *words: str, metavar: str) -> Any:
    """Make an option that completes to one of the words; others are refused later."""
    return option(description, metavar=metavar, autocompletion=lambda: words)


def inputs_option(description: str) -> Any:
    """Make an option of names of inputs, to be given for each."""
    return option(f"{description} Repeatable.", metavar="INPUT", autocompletion=completion.inputs)


def given(**options: Any) -> dict[str, Any]:
    """Return the options that are given."""
    return {name: value for name, value in options.items() if value is not None}


SCENARIO = argument(
    "SCENARIO",
    "Scenario file (TOML), or name of a shipped scenario; - reads standard input.",
    autocompletion=completion.scenarios,
)
ScenarioFile = Annotated[Path, SCENARIO]
OptionalScenario = Annotated[Path | None, SCENARIO]
Changes = Annotated[
    list[str] | None,
    option(
        "Replace the value of a key; repeatable.", "--set", metavar="KEY=VALUE", autocompletion=completion.assignments
    ),
]
RequiredProbability = Annotated[
    Any, number_option("Required probability of stopping each threat, such as 0.95.", share)
]
PlotFile = Annotated[Path | None, file_option("Draw the result to a .png, .svg or .pdf file.")]
Force = Annotated[bool, option("Replace existing files.", "--force")]
AsJson = Annotated[bool, option("Print one JSON object and nothing else.", "--json")]
Verbose = Annotated[bool, option("Show every row and every warning.", "--verbose", "-v")]
