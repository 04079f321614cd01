"""Arguments and options that several commands have."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any

import typer

from armour.cli import completion
from armour.errors import InputError, Problem, suggestion


def argument(metavar: str, description: str, **settings: Any) -> Any:
    """Make an argument whose default, if any, the help does not show."""
    return typer.Argument(metavar=metavar, help=description, show_default=False, **settings)


def option(description: str, *names: str, **settings: Any) -> Any:
    """Make an option whose default the help does not show."""
    return typer.Option(*names, help=description, show_default=False, **settings)


def setting(description: str, parser: Callable[[Any], Any], metavar: str = "NUMBER") -> Any:
    """Make the type of an option of a number in place of the scenario's."""
    return Annotated[float | None, option(description, parser=parser, metavar=metavar)]


def number(name: str, kind: type[float] = float, least: float | None = None) -> Callable[[Any], Any]:
    """Make the parser of an option of a number, which refuses a text with its value."""

    def parsed(text: Any) -> float:
        with suppress(ValueError):
            value = kind(text)
            if least is None or value >= least:
                return value
        must = "a whole number" if kind is int else "a number"
        bound = "" if least is None else f" of at least {least:g}"
        raise InputError([Problem("command line", name, f'must be {must}{bound}, found "{text}"')])

    return parsed


def probability(name: str) -> Callable[[Any], Any]:
    """Make the parser of an option of a probability, which is not given in per cent."""

    def parsed(text: Any) -> float:
        percent = str(text).removesuffix("%")
        value = number(name)(percent)
        if 50.0 <= value < 100.0 or percent != str(text):
            message = f'must be a probability, found "{text}"; did you mean {value / 100.0:g}?'
            raise InputError([Problem("command line", name, message)])
        return float(value)

    return parsed


def one_of(name: str, words: Sequence[str]) -> Callable[[Any], Any]:
    """Make the parser of an option of one of some words."""

    def parsed(text: Any) -> str:
        if text not in words:
            message = f'must be one of {", ".join(words)}, found "{text}"{suggestion(text, words)}'
            raise InputError([Problem("command line", name, message)])
        return str(text)

    return parsed


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
