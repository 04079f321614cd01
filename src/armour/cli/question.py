"""Commands that answer a question, made from functions: their options and their steps.

`question` makes a command from a function on a scenario; `options_of` makes options from the signature and the
docstring of a public function.
"""

import inspect
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import wraps
from pathlib import Path
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

import typer

import armour
from armour.cli import completion
from armour.cli.console import emit, progress
from armour.cli.runner import as_options, check_outputs, read_scenario, respond, warnings_of, wrong_option
from armour.csv_files import WORKBOOKS
from armour.csv_files import number as read_number
from armour.files import shipped_tests

if TYPE_CHECKING:
    from armour.scenario.scenario import Scenario

# Options of shares of 1.
SHARES = ("confidence", "fraction", "requirement_fraction")
# The name of a parameter in a docstring, and the lines on it.
MEANING = re.compile(r"^(\w+) : .*\n((?:    .+\n)+)", re.MULTILINE)


def argument(metavar: str, description: str, **settings: Any) -> Any:
    """Make an argument whose default, if any, the help does not show."""
    return typer.Argument(metavar=metavar, help=description, show_default=False, **settings)


def option(description: str, *names: str, **settings: Any) -> Any:
    """Make an option whose default the help does not show."""
    return typer.Option(*names, help=description, show_default=False, **settings)


def number(text: str) -> float | str:
    """Return the number in a word or, if there is none, the word itself, which is refused later."""
    value = read_number(text)
    if value is None:
        return text
    return int(value) if text.lstrip("+-").isdigit() else value


def share(text: str) -> float | str:
    """Return a share, which may be given in per cent, or, if there is none, the word itself, which is refused later."""
    value = number(text.removesuffix("%").rstrip())
    return text if isinstance(value, str) else value / 100.0 if text.endswith("%") else value


def options_of(function: Callable[..., Any]) -> Iterator[inspect.Parameter]:
    """Yield options for those parameters of a function that are numbers, words, names of inputs or switches.

    Their help is taken from the docstring.  An option that is not given is None, which stands for the default of the
    function; the function also checks the value.
    """
    meanings = dict(MEANING.findall(f"{inspect.getdoc(function)}\n"))
    hints = get_type_hints(function)
    for name, item in inspect.signature(function).parameters.items():
        kinds = get_args(hints[name]) if get_origin(hints[name]) in (Union, UnionType) else (hints[name],)
        words = [word for kind in kinds if get_origin(kind) is Literal for word in get_args(kind)]
        description = " ".join(meanings.get(name, "").split()).replace("`", "")
        if isinstance(item.default, str | int | float) and item.default is not False and "default" not in description:
            sentence = f"{description} By" if ". " in description else f"{description[:-1]}; by"
            description = f"{sentence} default {item.default}."
        if bool in kinds:
            description = description.removeprefix("Whether to ")
            switch = option(description[:1].upper() + description[1:], f"--{name.replace('_', '-')}")
            yield parameter(name, Annotated[bool, switch], False)
        elif words:
            choices = "|".join(words)
            metavar = choices if len(choices) < 20 else name.upper()
            word = option(description, metavar=metavar, autocompletion=completion.among(words))
            yield parameter(name, Annotated[str | None, word])
        elif int in kinds or float in kinds:
            yield number_option(name, description)
        elif str in kinds:
            inputs = option(f"{description} Repeatable.", metavar="INPUT", autocompletion=completion.inputs)
            yield parameter(name, Annotated[list[str] | None, inputs])


def number_option(name: str, description: str) -> inspect.Parameter:
    """Return an option of a number."""
    reader = share if name in SHARES else number
    return parameter(name, Annotated[str | None, option(description, metavar="NUMBER", parser=reader)])


def parameter(name: str, kind: Any, default: Any = None) -> inspect.Parameter:
    """Make a parameter of a command."""
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=kind, default=default)


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
        "Replace the value of a key; repeatable.", "--set", metavar="KEY=VALUE", autocompletion=completion.assignments
    ),
]
PlotFile = Annotated[Path | None, option("Draw the result to a .png, .svg or .pdf file.", "--plot", metavar="FILE")]
Force = Annotated[bool, option("Replace existing files.", "--force")]
AsJson = Annotated[bool, option("Print one JSON object and nothing else.", "--json")]
Verbose = Annotated[bool, option("Show every row and every warning.", "--verbose", "-v")]


class Answer(NamedTuple):
    """Result of a command, and what to show and write with it."""

    result: Any
    warnings: Sequence[str] | None = None  # in place of those of the result
    extra_data: Mapping[str, Any] = {}  # added to the JSON
    contents: Mapping[Any, Callable[[], str | bytes | None]] = {}  # of the files to write
    file: str = ""  # subject of the warnings; by default the scenario
    then: str = ""  # command to go on with
    exit_code: int = 0
    held: AbstractContextManager[Any] = nullcontext()  # lock to hold until the files are written


def question(
    reads: Sequence[str],
    *,
    computed: str = "the answer",
    unit: str = "impacts",
    first: str = "",
    prior_reads: Sequence[str] = (),
    named: Mapping[str, str] = {},
    outputs: Sequence[str] = (),
    tables: Sequence[str] = (),
    **keys: tuple[str, str],
) -> Callable[[Callable[..., Answer]], Callable[..., None]]:
    """Make a command from a function (scenario, on_progress, options) -> Answer.

    The command reads the scenario, with the changes by ``--set``, checks the outputs, computes, shows, writes the files
    and warns.  The changes must be in the sections that it ``reads`` or, with ``--prior``, in those of ``prior_reads``;
    ``computed`` names its result in messages.  Its options are those of the function, with ``**options`` those of the
    public function of the same name, the common ones, and those that set ``keys`` of the scenario: by name, the key and
    the help.  ``named`` has other names of parameters of the public function, for messages.  ``outputs`` and
    ``tables`` are the options for files to write, the latter as CSV.  ``first`` names the step before the progress, by
    default compiling; progress is counted in a ``unit``.  If the function has a ``table``, the table and the scenario
    may be given in either order.
    """

    def command_of(function: Callable[..., Answer]) -> Callable[..., None]:
        parameters = _parameters(function, keys)

        @wraps(function)
        def command(**values: Any) -> None:
            if "table" in values and values["scenario"] is not None and _is_table(values["scenario"]):
                values["scenario"], values["table"] = values["table"], values["scenario"]
            scenario = None
            if values["scenario"] is not None:
                read = [*reads, *(prior_reads if values.get("prior") else ())]
                settings = {f"--{name}": (key, values[name]) for name, (key, _help) in keys.items()}
                scenario = read_scenario(values["scenario"], values["changes"], read, settings, computed)
            elif values["changes"]:
                raise wrong_option("--set", "must be given with a scenario")
            _check_files(values, [*outputs, *tables], tables, scenario)
            with progress(unit, first=first) as count, as_options(function.__name__, named):
                answer = function(**_arguments(function, values, parameters, scenario, count))
            _respond(answer, scenario, values)

        def all_parameters() -> list[inspect.Parameter]:
            takes_options = "options" in inspect.signature(function).parameters
            public = options_of(getattr(armour, function.__name__)) if takes_options else ()
            return [*(item for item in public if item.name not in parameters), *parameters.values()]

        command.__dict__.update(__signature__=inspect.Signature(), parameters=all_parameters)
        command.__annotations__ = {}
        return command

    return command_of


def _is_table(path: Path) -> bool:
    return path.suffix.lower() in (".csv", ".tsv", ".txt", *WORKBOOKS) or path.as_posix() in shipped_tests()


def _parameters(function: Callable[..., Answer], keys: Mapping[str, tuple[str, str]]) -> dict[str, inspect.Parameter]:
    """Return the parameters of a question: those of its function, those that set keys, and the common ones."""
    parameters = {
        name: item.replace(kind=item.KEYWORD_ONLY)
        for name, item in inspect.signature(function).parameters.items()
        if name not in ("on_progress", "options")
    }
    parameters["scenario"] = parameters["scenario"].replace(annotation=ScenarioFile)
    parameters |= {name: number_option(name, description) for name, (_key, description) in keys.items()}
    common = (
        parameter("plot", PlotFile),
        parameter("force", Force, False),
        parameter("changes", Changes),
        parameter("verbose", Verbose, False),
        parameter("as_json", AsJson, False),
    )
    return parameters | {item.name: item for item in common if item.name not in parameters}


def _check_files(
    values: Mapping[str, Any], outputs: Sequence[str], tables: Sequence[str], scenario: "Scenario | None"
) -> None:
    """Check the outputs of a command, given the values of its options, of which others may be the names of files."""
    from armour.scenario.scenario import files_of

    words: list[Any] = []
    for name in values.keys() - {"plot", *outputs}:
        words += values[name] if isinstance(values[name], list) else [values[name]]
    check_outputs(
        *(values[name] for name in outputs),
        inputs=[*(word for word in words if isinstance(word, str | Path)), *(files_of(scenario) if scenario else ())],
        tables=[values[name] for name in tables],
        plot=values["plot"],
        force=values["force"],
    )


def _arguments(
    function: Callable[..., Answer],
    values: Mapping[str, Any],
    parameters: Mapping[str, inspect.Parameter],
    scenario: "Scenario | None",
    on_progress: Callable[..., None],
) -> dict[str, Any]:
    """Return the arguments of the function; an option that is not given has the default of the public function."""
    names = inspect.signature(function).parameters
    return {
        name: value for name, value in values.items() if name in names or (name not in parameters and value is not None)
    } | {"scenario": scenario, "on_progress": on_progress}


def _respond(answer: Answer, scenario: "Scenario | None", values: Mapping[str, Any]) -> None:
    """Show and write an answer, and end with its exit code."""
    from armour.reporting.by_result import by_result, tables_of
    from armour.reporting.show import plot as plot_of

    verbose = values["verbose"]
    result = answer.result.of(every_row=verbose)
    warnings = result.warnings if answer.warnings is None else answer.warnings
    with answer.held:
        respond(
            {**result.to_dict(), **answer.extra_data},
            by_result(tables_of, result)(result),
            as_json=values["as_json"],
            heading=result.heading(),
            files=answer.contents.items(),
            plot=values["plot"],
            draw=lambda: plot_of(result),
            scenario=scenario,
            warnings=warnings_of(scenario, warnings, answer.file, verbose=verbose),
        )
    if answer.then:
        # In one line, so that it can be copied.
        emit(f"next: {answer.then}\n", sys.stderr)
    if answer.exit_code:
        raise typer.Exit(answer.exit_code)
