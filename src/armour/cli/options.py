"""Arguments and options of commands: those that several have, and those made of the parameters of a public function."""

import inspect
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from enum import Enum, auto
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import typer

from armour.cli import completion

# The name of a parameter in a docstring, and the lines on it.
MEANING = re.compile(r"^(\w+) : .*\n((?:    .+\n)+)", re.MULTILINE)


def argument(metavar: str, description: str, **settings: Any) -> Any:
    """Make an argument whose default, if any, the help does not show."""
    return typer.Argument(metavar=metavar, help=description, show_default=False, **settings)


def option(description: str, *names: str, **settings: Any) -> Any:
    """Make an option whose default the help does not show."""
    return typer.Option(*names, help=description, show_default=False, **settings)


def number(text: str) -> float | str:
    """Return the number that a word gives, also in per cent; the word itself, which is refused later, if it is none."""
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text.removesuffix("%"))
    return text


def options_of(function: Callable[..., Any]) -> Iterator[inspect.Parameter]:
    """Yield options for those parameters of a function that are numbers, words, names of inputs or switches.

    Their help is the docstring.  An option that is not given is None, for the default of the function, which also
    checks the value.
    """
    meanings = dict(MEANING.findall(f"{inspect.getdoc(function)}\n"))
    hints = get_type_hints(function)
    for name, each in inspect.signature(function).parameters.items():
        members = get_args(hints[name]) if get_origin(hints[name]) in (Union, UnionType) else (hints[name],)
        words = [word for kind in members if get_origin(kind) is Literal for word in get_args(kind)]
        told = " ".join(meanings.get(name, "").split()).replace("`", "")
        if each.default and each.default is not each.empty and "default" not in told:
            told = f"{told.removesuffix('.')}; by default {each.default}."
        kind: Any = None
        if bool in members:
            told = told.removeprefix("Whether to ")
            kind = Annotated[bool, option(told[:1].upper() + told[1:], f"--{name.replace('_', '-')}")]
        elif words:
            choices = "|".join(words)
            metavar = choices if len(choices) < 20 else name.upper()
            kind = Annotated[str | None, option(told, metavar=metavar, autocompletion=completion.among(words))]
        elif int in members or float in members:
            yield number_option(name, told)
        elif str in members:
            kind = Annotated[list[str] | None, option(told, metavar="INPUT", autocompletion=completion.inputs)]
        if kind is not None:
            yield parameter(name, kind, False if bool in members else None)


def number_option(name: str, description: str) -> inspect.Parameter:
    """Return an option of a number."""
    return parameter(name, Annotated[str | None, option(description, metavar="NUMBER", parser=number)], None)


def parameter(name: str, kind: Any, default: Any) -> inspect.Parameter:
    """Make a parameter of a command."""
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=kind, default=default)


class Output(Enum):
    """Marks an option of a file to write, which may have to be a table, CSV."""

    FILE = auto()
    TABLE = auto()


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
