"""Make options and arguments, with their help, for the signatures of commands; and the options that commands share.

An option that is not given is None or False; the Python function that a command calls has the defaults of numbers.
"""

from decimal import Decimal
from typing import Any

import typer

from armour.cli import completion


def argument(metavar: str, description: str, default: Any = ..., *, words: Any = None) -> Any:
    """Make a positional argument, which must be given if it has no default; the shell completes it with `words`."""
    return typer.Argument(default, metavar=metavar, help=description, show_default=False, autocompletion=words)


def text(description: str, *names: str, default: Any = None, words: Any = None, **settings: Any) -> Any:
    """Make an option whose value is a text, or several; the shell completes it with `words`."""
    return typer.Option(default, *names, help=description, show_default=False, autocompletion=words, **settings)


def flag(description: str, *names: str, **settings: Any) -> Any:
    """Make an option without a value."""
    return text(description, *names, default=False, **settings)


def file(description: str, *names: str, metavar: str = "FILE") -> Any:
    """Make an option whose value is the name of a file."""
    return text(description, *names, metavar=metavar)


def number(description: str) -> Any:
    """Make an option whose value is a number."""
    return text(description, metavar="NUMBER", parser=parsed_number)


def share(description: str, *names: str) -> Any:
    """Make an option whose value is a fraction, which may be given in per cent."""
    return text(description, *names, metavar="NUMBER", parser=parsed_share)


def parsed_number(word: str) -> float | str:
    """Convert a word to a number; return other words as they are, since the function called refuses them."""
    from armour.csv_files import number

    value = number(word)
    if value is None:
        return word
    return int(value) if word.lstrip("+-").isdigit() else value


def parsed_share(word: str) -> float | str:
    """Convert a word to a fraction: "0.95" and "95%" give 0.95; return other words as they are, to be refused later."""
    value = parsed_number(word.removesuffix("%").rstrip())
    if isinstance(value, str):
        return word
    return float(Decimal(str(value)) / 100) if word.endswith("%") else value


def given(**options: Any) -> dict[str, Any]:
    """Return the options that are not None."""
    return {name: value for name, value in options.items() if value is not None}


SCENARIO_WORDS = "Scenario file (TOML), or name of a shipped scenario; - reads standard input."
SCENARIO = argument("SCENARIO", SCENARIO_WORDS, words=completion.scenarios)
OPTIONAL_SCENARIO = argument("SCENARIO", SCENARIO_WORDS, None, words=completion.scenarios)
CHANGES = text("Change a key; repeatable.", "--set", metavar="KEY=VALUE", words=completion.assignments)
PROBABILITY = share("Least probability of stopping each threat, such as 0.95.", "--probability", "--confidence")
BY_MODEL = flag("Answer by the model alone, as if no tests were known; no probability may be required.", "--by-model")
SHEET = text("Sheet of a workbook, by default the only visible one with a table.", metavar="NAME")
KEEP = text("Column of the cases to keep as a label, such as the name of an offer; repeatable.", metavar="COLUMN")
PLOT = file("Draw the result to a .png, .svg or .pdf file.")
FORCE = flag("Replace existing files.", "--force")
JUNIT = file("Write the result as JUnit XML; JUnit XML that armour wrote is replaced without --force.")
AS_JSON = flag("Print one JSON object and nothing else.", "--json")
VERBOSE = flag("Show every row and every warning.", "--verbose", "-v")
