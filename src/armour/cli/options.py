"""Arguments and options that several commands have."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Annotated, Any

import typer

from armour.cli import completion
from armour.errors import InputError, Problem, suggestion
from armour.files import located, shipped_tests


def argument(metavar: str, description: str, **settings: Any) -> Any:
    """Make an argument whose default, if any, the help does not show."""
    return typer.Argument(metavar=metavar, help=description, show_default=False, **settings)


def option(description: str, *names: str, **settings: Any) -> Any:
    """Make an option whose default the help does not show."""
    return typer.Option(*names, help=description, show_default=False, **settings)


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


@contextmanager
def named_as_options(command: str, *names: str) -> Iterator[None]:
    """Name the arguments of a function of a command, in the messages on them, as the options that give them."""
    try:
        yield
    except InputError as error:
        raise InputError([_named_as_option(problem, command, names) for problem in error.problems]) from None


def _named_as_option(problem: Problem, command: str, names: Sequence[str]) -> Problem:
    name, *rest = problem.key.split(" ")
    if problem.file != command or name not in names:
        return problem
    return Problem("command line", " ".join([f"--{name.replace('_', '-')}", *rest]), problem.message)


def table_file(path: Path) -> Path:
    """Return the file of a path or, where there is none, of the shipped table of tests or shots of that name."""
    known = shipped_tests()
    return located(path, known, f"; shipped are {', '.join(known)}")


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
