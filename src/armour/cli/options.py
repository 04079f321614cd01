"""Make options and arguments, with their help, for the signatures of commands; and the options that commands share.

An option that is not given is None or False; the Python function that a command calls has the defaults of numbers.
"""

from collections.abc import Callable
from decimal import Decimal
from typing import Any

import typer

from armour.cli import completion


def argument(metavar: str, description: str, default: Any = ..., **settings: Any) -> Any:
    """Make a positional argument; it must be given if it has no default, which the help does not show."""
    return typer.Argument(default, metavar=metavar, help=description, show_default=False, **settings)


def option(description: str, *names: str, default: Any = None, **settings: Any) -> Any:
    """Make an option; it must be given if its default is ``...``, and the help does not show the default."""
    return typer.Option(default, *names, help=description, show_default=False, **settings)


def flag(description: str, *names: str, **settings: Any) -> Any:
    """Make an option without a value."""
    return option(description, *names, default=False, **settings)


def number(text: str) -> float | str:
    """Convert a word to a number; return other words as they are, since the function called refuses them."""
    from armour.csv_files import number as parsed

    value = parsed(text)
    if value is None:
        return text
    return int(value) if text.lstrip("+-").isdigit() else value


def share(text: str) -> float | str:
    """Convert a word to a fraction: "0.95" and "95%" give 0.95; return other words as they are, to be refused later."""
    value = number(text.removesuffix("%").rstrip())
    if isinstance(value, str):
        return text
    return float(Decimal(str(value)) / 100) if text.endswith("%") else value


def number_option(description: str, parser: Callable[[str], float | str] = number) -> Any:
    """Make an option whose value is a number or, with `parser=share`, a fraction."""
    return option(description, metavar="NUMBER", parser=parser)


def file_option(description: str, *names: str, metavar: str = "FILE") -> Any:
    """Make an option whose value is the name of a file."""
    return option(description, *names, metavar=metavar)


def word_option(description: str, *words: str, metavar: str) -> Any:
    """Make an option whose value is one of the words, which the shell completes; others are refused later."""
    return option(description, metavar=metavar, autocompletion=lambda: words)


def given(**options: Any) -> dict[str, Any]:
    """Return the options that are not None."""
    return {name: value for name, value in options.items() if value is not None}


def either(probability: Any, confidence: Any) -> Any:
    """Return the value of ``--probability``, or else that of its other name."""
    return confidence if probability is None else probability


SCENARIO_WORDS = "Scenario file (TOML), or name of a shipped scenario; - reads standard input."
SCENARIO = argument("SCENARIO", SCENARIO_WORDS, autocompletion=completion.scenarios)
OPTIONAL_SCENARIO = argument("SCENARIO", SCENARIO_WORDS, default=None, autocompletion=completion.scenarios)
CHANGES = option(
    "Replace the value of a key; repeatable.", "--set", metavar="KEY=VALUE", autocompletion=completion.assignments
)
REQUIRED_PROBABILITY = number_option(
    "Least probability of stopping each threat, such as 0.95; a higher one that the scenario requires stays.",
    share,
)
BY_MODEL = flag("Answer by the model alone, as if no tests were known; no probability may be required.", "--by-model")
CONFIDENCE = option("Another name of --probability.", metavar="NUMBER", parser=share, hidden=True)
SHEET = option("Sheet of a workbook of cases, by default the first.", metavar="NAME")
KEEP = option("Column of the cases to keep as a label, such as the name of an offer; repeatable.", metavar="COLUMN")
PLOT = file_option("Draw the result to a .png, .svg or .pdf file.")
FORCE = flag("Replace existing files.", "--force")
AS_JSON = flag("Print one JSON object and nothing else.", "--json")
VERBOSE = flag("Show every row and every warning.", "--verbose", "-v")
