"""Commands that answer a question, made of functions: their options and what they do.

`question` makes a command of a function on a scenario; `options_of` makes options of the signature and the docstring of
a public function.
"""

import inspect
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from enum import Enum, auto
from functools import wraps
from pathlib import Path
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

import typer

import armour
from armour.cli import completion
from armour.cli.console import emit, progress
from armour.cli.runner import (
    as_options,
    check_outputs,
    read_scenario,
    respond,
    warnings_of,
    wrong_option,
)
from armour.csv_files import number as read_number

if TYPE_CHECKING:
    from armour.scenario.scenario import Scenario

# Options of shares of 1.
SHARES = ("confidence", "requirement_fraction")
# The name of a parameter in a docstring, and the lines on it.
MEANING = re.compile(r"^(\w+) : .*\n((?:    .+\n)+)", re.MULTILINE)


def argument(metavar: str, description: str, **settings: Any) -> Any:
    """Make an argument whose default, if any, the help does not show."""
    return typer.Argument(metavar=metavar, help=description, show_default=False, **settings)


def option(description: str, *names: str, **settings: Any) -> Any:
    """Make an option whose default the help does not show."""
    return typer.Option(*names, help=description, show_default=False, **settings)


def number(text: str) -> float | str:
    """Return the number that a word gives; the word itself, which is refused later, if it is none."""
    found = read_number(text)
    if found is None:
        return text
    return int(found) if text.lstrip("+-").isdigit() else found


def share(text: str) -> float | str:
    """Return a share, which may be given in per cent; the word itself, which is refused later, if it is none."""
    found = number(text.removesuffix("%").rstrip())
    return text if isinstance(found, str) else found / 100.0 if text.endswith("%") else found


def options_of(function: Callable[..., Any]) -> Iterator[inspect.Parameter]:
    """Yield options for those parameters of a function that are numbers, words, names of inputs or switches.

    Their help is the docstring.  An option that is not given is None, for the default of the function, which also
    checks the value.
    """
    meanings = dict(MEANING.findall(f"{inspect.getdoc(function)}\n"))
    hints = get_type_hints(function)
    for name, each in inspect.signature(function).parameters.items():
        kinds = get_args(hints[name]) if get_origin(hints[name]) in (Union, UnionType) else (hints[name],)
        words = [word for kind in kinds if get_origin(kind) is Literal for word in get_args(kind)]
        told = " ".join(meanings.get(name, "").split()).replace("`", "")
        if isinstance(each.default, str | int | float) and each.default is not False and "default" not in told:
            told = f"{told} By default {each.default}." if ". " in told else f"{told[:-1]}; by default {each.default}."
        if bool in kinds:
            told = told.removeprefix("Whether to ")
            switch = option(told[:1].upper() + told[1:], f"--{name.replace('_', '-')}")
            yield parameter(name, Annotated[bool, switch], False)
        elif words:
            choices = "|".join(words)
            metavar = choices if len(choices) < 20 else name.upper()
            word = option(told, metavar=metavar, autocompletion=completion.among(words))
            yield parameter(name, Annotated[str | None, word])
        elif int in kinds or float in kinds:
            yield number_option(name, told)
        elif str in kinds:
            inputs = option(f"{told} Repeatable.", metavar="INPUT", autocompletion=completion.inputs)
            yield parameter(name, Annotated[list[str] | None, inputs])


def number_option(name: str, description: str) -> inspect.Parameter:
    """Return an option of a number."""
    reader = share if name in SHARES else number
    return parameter(name, Annotated[str | None, option(description, metavar="NUMBER", parser=reader)])


def parameter(name: str, kind: Any, default: Any = None) -> inspect.Parameter:
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
        "Scenario file (TOML), or name of a shipped scenario; - reads standard input.",
        autocompletion=completion.scenarios,
    ),
]
Changes = Annotated[
    list[str] | None,
    option(
        "Replace the value of a key; repeatable.",
        "--set",
        metavar="KEY=VALUE",
        autocompletion=completion.assignments,
    ),
]
PlotFile = Annotated[Path | None, option("Draw the result to a .png, .svg or .pdf file.", "--plot", metavar="FILE")]
Force = Annotated[bool, option("Replace existing files.", "--force")]
AsJson = Annotated[bool, option("Print one JSON object and nothing else.", "--json")]
Verbose = Annotated[bool, option("Show every row and every warning.", "--verbose", "-v")]

# Parameters of a question that are no options: a function to call, and the name of the scenario as it was given.
GIVEN = ("on_progress", "source")
# Options of every question, after its own.
COMMON = {
    "plot": (PlotFile, None),
    "force": (Force, False),
    "changes": (Changes, None),
    "verbose": (Verbose, False),
    "as_json": (AsJson, False),
}


class Answer(NamedTuple):
    """What a command shows and writes: a result, and what comes with it."""

    result: Any
    # In place of those of the result.
    warnings: Sequence[str] | None = None
    # Added to the JSON.
    more: Mapping[str, Any] = {}
    # What is written to files; without it, the CSV of the result.
    contents: Mapping[Any, Callable[[], str | bytes | None]] = {}
    # What the warnings are on; by default the scenario.
    file: str = ""
    # A command to go on with.
    then: str = ""
    # That of the command.
    exit_code: int = 0
    # A lock that is held until the files are written.
    held: AbstractContextManager[Any] = nullcontext()


def question(
    reads: Sequence[str],
    *,
    what: str = "the answer",
    unit: str = "impacts",
    first: str = "",
    csv: str = "",
    of_threats: bool = False,
    prior_reads: Sequence[str] = (),
    table: str = "",
    named: Mapping[str, str] = {},
    **keys: tuple[str, str],
) -> Callable[[Callable[..., Answer]], Callable[..., None]]:
    """Make a command of a function (scenario, on_progress, options) -> Answer, perhaps with the source of the scenario.

    The command checks the outputs, reads the scenario with what ``--set`` changes of the sections that it ``reads`` for
    ``what`` it answers, with ``--prior`` those of ``prior_reads`` too, computes, writes the files, shows and warns.
    Its options are those of the function, with ``**options`` those of the public function of the same name, the common
    ones, and those that set keys of the scenario: by name, the key and the help.  Some parameters of the public
    function are ``named`` otherwise in messages.  What is done ``first`` is said before the progress, which is counted
    in a ``unit``; without it, the engine is compiled.  ``csv`` is the help of ``--csv``, a file for the CSV of the
    view.  A CSV file in place of the scenario is the ``table`` of this name, and the other the scenario, if there is
    one.
    """

    def made(function: Callable[..., Answer]) -> Callable[..., None]:
        own = dict(inspect.signature(function).parameters)
        derives = own.pop("options", None) is not None
        static = {name: each.replace(kind=each.KEYWORD_ONLY) for name, each in own.items() if name not in GIVEN}
        static["scenario"] = static["scenario"].replace(annotation=ScenarioFile)
        static |= {name: number_option(name, text) for name, (_key, text) in keys.items()}
        if csv:
            static["csv"] = parameter("csv", Annotated[Path | None, option(csv, metavar="FILE"), Output.TABLE])
        static |= {name: parameter(name, *common) for name, common in COMMON.items() if name not in own}
        files = {
            name: mark for name in static for mark in get_args(static[name].annotation) if isinstance(mark, Output)
        }

        def parameters() -> list[inspect.Parameter]:
            derived = options_of(getattr(armour, function.__name__)) if derives else ()
            return [*(each for each in derived if each.name not in static), *static.values()]

        @wraps(function)
        def command(**values: Any) -> None:
            plot, changes = values["plot"], values["changes"]
            if table and values["scenario"] is not None and values["scenario"].suffix.lower() == ".csv":
                values["scenario"], values[table] = values[table], values["scenario"]
            outputs = [values[name] for name in files]
            tables = [values[name] for name, mark in files.items() if mark is Output.TABLE]
            check_outputs(*outputs, tables=tables, plot=plot, force=values["force"])
            loaded = None
            if values["scenario"] is not None:
                read = [*reads, *(prior_reads if values.get("prior") else ())]
                settings = {f"--{name}": (key, values[name]) for name, (key, _text) in keys.items()}
                loaded = read_scenario(values["scenario"], changes, read, settings, what)
            elif changes:
                raise wrong_option("--set", "must be given with a scenario")
            # An option that is not given has the default of the public function.
            given = {name for name in values if name in own or (name not in static and values[name] is not None)}
            asked = {name: values[name] for name in given} | {"scenario": loaded}
            if "source" in own:
                asked["source"] = str(values["scenario"])
            with progress(unit, first=first) as count, as_options(function.__name__, named):
                answer = function(on_progress=count, **asked)
            shown = {"plot": plot, "as_json": values["as_json"], "verbose": values["verbose"], "of_threats": of_threats}
            _respond(answer, loaded, outputs, **shown)
            if answer.exit_code:
                raise typer.Exit(answer.exit_code)

        command.__dict__.update(__signature__=inspect.Signature(), parameters=parameters)
        command.__annotations__ = {}
        return command

    return made


def _respond(
    answer: Answer,
    scenario: "Scenario | None",
    outputs: Iterable[Path | None],
    *,
    plot: Path | None,
    as_json: bool,
    verbose: bool,
    of_threats: bool,
) -> None:
    """Write and show an answer."""
    from armour.reporting.show import plot as plot_of
    from armour.reporting.show import view_of

    result = answer.result.of(every_row=verbose)
    view = view_of(result)
    warnings = result.warnings if answer.warnings is None else answer.warnings
    contents = {path: lambda: view.csv(result) for path in outputs} | {**answer.contents}
    with answer.held:
        respond(
            {**result.to_dict(), **answer.more},
            view.tables(result),
            as_json=as_json,
            of=result.heading(),
            files=contents.items(),
            plot=plot,
            draw=lambda: plot_of(result),
            warnings=warnings_of(scenario, warnings, answer.file, of_threats=of_threats, verbose=verbose),
        )
    if answer.then:
        # In one line, so that it can be copied.
        emit(f"next: {answer.then}\n", sys.stderr)
