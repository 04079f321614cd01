"""Run a command: check outputs, read, compute, write files, show, warn, in this order.

Files are written before anything is printed, so that a reader that closes the pipe loses none.
"""

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from typer.core import TyperCommand, TyperGroup

from armour.cli.console import say, show, show_json
from armour.errors import ArmourError, InputError, NoAnswerError, Problem
from armour.files import check_writable, write_atomic, wrong_ending

if TYPE_CHECKING:
    from armour.reporting.table import Table
    from armour.scenario.loading import Scenario

NO_ANSWER = 1
WRONG_INPUT = 2
CHECK_FAILED = 3
INTERRUPTED = 130

STANDARD_INPUT = "standard input"
PLOT_ENDINGS = (".png", ".svg", ".pdf")


@dataclass(frozen=True)
class Answer:
    """What a command has computed, and how it is shown; what is not asked for is not made.

    Attributes
    ----------
    data : callable
        Gives the JSON object.
    tables : callable
        Gives what is printed: tables, and plain lines.
    title : str
        Printed above the tables.
    files : sequence of callable
        Give the contents of the files that the command writes, in the order of ``writes`` of `run`; None where there
        is nothing to write.
    chart : callable
        Gives the chart that is plotted, by the functions of `armour.reporting.charts`, which it is given.
    warnings : sequence of str
        Lines for standard error.
    exit_code : int
    """

    data: Callable[[], Mapping[str, Any]]
    tables: Callable[[], "Iterable[Table | str]"]
    title: str = ""
    files: Sequence[Callable[[], str | bytes | None]] = ()
    chart: Callable[[Any], Any] | None = None
    warnings: Sequence[str] = ()
    exit_code: int = 0


def run(
    answer: Callable[[], Answer],
    *,
    reads: Sequence[Path | None] = (),
    writes: Sequence[Path | None] = (),
    makes: Sequence[Path] = (),
    plot: Path | None = None,
    as_json: bool = False,
) -> None:
    """Run a command.

    Parameters
    ----------
    answer : callable
        Reads the input and computes.
    reads : sequence of Path or None
        Files that are read; no output may be one of them.
    writes : sequence of Path or None
        Files to write; None where one is not asked for.
    makes : sequence of Path
        Files that ``answer`` writes itself.
    plot : Path or None
        File to draw to.
    as_json : bool
        Whether to print JSON in place of the tables.

    Raises
    ------
    InputError
        If an output cannot be written, or the input is wrong.
    NoAnswerError
        If the question has no answer.
    """
    check_outputs(*writes, *makes, plot=plot, reads=reads)
    found = answer()
    try:
        for path, content in zip(writes, found.files, strict=True):
            if path is not None and (text := content()) is not None:
                write(path, text)
        if plot is not None and found.chart is not None:
            from armour.reporting import charts, plots

            write(plot, plots.rendered(found.chart(charts), plot.suffix.lower()))
    finally:
        # A file that cannot be made or written does not cost the answer.
        if as_json:
            show_json(found.data())
        else:
            show(*found.tables(), title=found.title)
    say(*found.warnings)
    if found.exit_code:
        raise typer.Exit(found.exit_code)


def read_scenario(
    path: Path, assignments: Sequence[str] | None, more: Mapping[str, object] | None = None
) -> "Scenario":
    """Read the scenario of a file, or of standard input where it is "-", with changes.

    Raises
    ------
    InputError
        With every mistake in it.
    """
    from armour.files import decoded, parse_toml
    from armour.scenario.assignments import changed, changes_of
    from armour.scenario.loading import load_scenario, parse_scenario

    changes = changed(changes_of(assignments or ()), more or {})
    if str(path) != "-":
        return load_scenario(path, changes)
    data = parse_toml(decoded(sys.stdin.buffer, STANDARD_INPUT), STANDARD_INPUT)
    return parse_scenario(changed(data, changes), file=STANDARD_INPUT)


def check_outputs(*writes: Path | None, plot: Path | None = None, reads: Sequence[Path | None] = ()) -> None:
    """Check that all outputs can be written, and that none is another one or a file that is read.

    Raises
    ------
    InputError
        With everything that is wrong with them.
    """
    problems = [] if plot is None else wrong_ending(plot, PLOT_ENDINGS)
    paths = [path for path in (*writes, plot) if path is not None]
    for path in paths:
        try:
            check_writable(path)
        except InputError as error:
            problems.extend(error.problems)
            continue
        if path.exists() and any(source is not None and source.exists() and path.samefile(source) for source in reads):
            problems.append(Problem(str(path), "", "must not be the file that is read; choose another name"))
    if not problems:
        resolved = [path.resolve() for path in paths]
        twice = dict.fromkeys(str(path) for path in resolved if resolved.count(path) > 1)
        problems += (Problem(path, "", "must not be written twice; choose another name") for path in twice)
    if problems:
        raise InputError(problems)


def write(path: Path, content: str | bytes) -> None:
    """Write an output whole or not at all, and say so on standard error."""
    write_atomic(path, content.encode() if isinstance(content, str) else content)
    say(f"wrote {path}")


def warnings_of(scenario: "Scenario", warnings: Iterable[str]) -> list[str]:
    """Return the warnings on a scenario as lines for standard error."""
    return [f"warning: {scenario.file}: {warning}" for warning in warnings]


def say_if_compiling() -> None:
    """Say on standard error that the first use after an installation compiles."""
    from armour.engine import cache

    if not cache.is_compiled():
        say("compiling, once after an installation: some ten seconds")


class Command(TyperCommand):
    """A command; its help shows no type beside an option without a value."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return arguments and options."""
        return _without_types_of_flags(super().get_params(ctx))


class Reporting(TyperGroup):
    """Commands whose errors end in a message and an exit code."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return options."""
        return _without_types_of_flags(super().get_params(ctx))

    def invoke(self, ctx: Any) -> Any:
        """Run the command; turn what it raises into a message and an exit code."""
        try:
            return super().invoke(ctx)
        except ArmourError as error:
            say(*(located(error.problems) if isinstance(error, InputError) else [str(error)]))
            ctx.exit(NO_ANSWER if isinstance(error, NoAnswerError) else WRONG_INPUT)
        except KeyboardInterrupt:
            say("interrupted")
            ctx.exit(INTERRUPTED)


def _without_types_of_flags(params: list[Any]) -> list[Any]:
    for param in params:
        if getattr(param, "is_flag", False):
            param.metavar = ""
    return params


def located(problems: Sequence[Problem]) -> list[str]:
    """Return the messages of problems, with the line of the TOML file where there is one."""
    from armour.files import read_text
    from armour.scenario.toml_lines import line_of, lines_of

    lines: dict[str, dict[str, int]] = {}
    messages = []
    for problem in problems:
        line = None
        if problem.key and problem.file.endswith(".toml"):
            if problem.file not in lines:
                try:
                    lines[problem.file] = lines_of(read_text(Path(problem.file)))
                except InputError:
                    lines[problem.file] = {}
            line = line_of(problem.key, lines[problem.file])
        messages.append(f"{problem}" + ("" if line is None else f" (line {line})"))
    return messages
