"""What makes an option, with its help, in the signature of a command, and the options that commands share.

An option that is not given is None or False; a default that matters to a computation is that of the Python function.
"""

from collections.abc import Callable
from typing import Any

import typer

import armour.lazy as lazy
from armour.cli import completion


def argument(metavar: str, description: str, default: Any = ..., **settings: Any) -> Any:
    """Make an argument, which must be given if it has no default; the help does not show it."""
    return typer.Argument(default, metavar=metavar, help=description, show_default=False, **settings)


def option(description: str, *names: str, default: Any = None, **settings: Any) -> Any:
    """Make an option whose default the help does not show; with ``...`` in its place it must be given."""
    return typer.Option(default, *names, help=description, show_default=False, **settings)


def flag(description: str, *names: str, **settings: Any) -> Any:
    """Make an option without a value."""
    return option(description, *names, default=False, **settings)


def number(text: str) -> float | str:
    """Return the number in a word or, if there is none, the word itself, which is refused later."""
    value = lazy.number(text)
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


SCENARIO_WORDS = "Scenario file (TOML), or name of a shipped scenario; - reads standard input."
SCENARIO = argument("SCENARIO", SCENARIO_WORDS, autocompletion=completion.scenarios)
OPTIONAL_SCENARIO = argument("SCENARIO", SCENARIO_WORDS, default=None, autocompletion=completion.scenarios)
CHANGES = option(
    "Replace the value of a key; repeatable.", "--set", metavar="KEY=VALUE", autocompletion=completion.assignments
)
REQUIRED_PROBABILITY = number_option("Required probability of stopping each threat, such as 0.95.", share)
PLOT = file_option("Draw the result to a .png, .svg or .pdf file.")
FORCE = flag("Replace existing files.", "--force")
AS_JSON = flag("Print one JSON object and nothing else.", "--json")
VERBOSE = flag("Show every row and every warning.", "--verbose", "-v")
