"""What the commands share: arguments, tables, files written, errors and exit codes."""

import json
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from armour.errors import ArmourError, InputError, NoAnswerError, Problem
from armour.files import check_writable, write_atomic, wrong_ending

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import Console

    from armour.scenario.loading import Scenario

NO_ANSWER = 1
WRONG_INPUT = 2
CHECK_FAILED = 3
INTERRUPTED = 130

STANDARD_INPUT = "standard input"

ScenarioFile = Annotated[
    Path, typer.Argument(metavar="SCENARIO", help="Scenario file (TOML); - for standard input.", show_default=False)
]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a value of the scenario.", show_default=False),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.", show_default=False)]
PlotFile = Annotated[
    Path | None,
    typer.Option("--plot", metavar="FILE", help="Draw to a .png, .svg or .pdf file.", show_default=False),
]


class Reporting(TyperGroup):
    """Commands whose errors end in a message and an exit code."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command; turn what it raises into a message and an exit code."""
        try:
            return super().invoke(ctx)
        except ArmourError as error:
            told = located(error.problems) if isinstance(error, InputError) else [str(error)]
            print(*told, sep="\n", file=sys.stderr)
            ctx.exit(NO_ANSWER if isinstance(error, NoAnswerError) else WRONG_INPUT)
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
            ctx.exit(INTERRUPTED)
        except BrokenPipeError:
            # The reader has gone; so does what is still in the buffer.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            ctx.exit(0)


def located(problems: Sequence[Problem]) -> list[str]:
    """Messages of problems, with the line of the TOML file where there is one."""
    from armour.files import read_text
    from armour.scenario.toml_lines import line_of, lines_of

    lines: dict[str, dict[str, int]] = {}
    told = []
    for problem in problems:
        line = None
        if problem.key and problem.file.endswith(".toml"):
            if problem.file not in lines:
                try:
                    lines[problem.file] = lines_of(read_text(Path(problem.file)))
                except InputError:
                    lines[problem.file] = {}
            line = line_of(problem.key, lines[problem.file])
        told.append(f"{problem}" + ("" if line is None else f" (line {line})"))
    return told


def read_scenario(
    path: Path, assignments: Sequence[str] | None, more: Mapping[str, object] | None = None
) -> "Scenario":
    """The scenario of a file, or of standard input where it is "-", with changes.

    Raises
    ------
    InputError
        With every mistake in it.
    """
    from armour.files import decoded, parse_toml
    from armour.scenario.loading import changed, load_scenario, parse_scenario

    changes = changed(changes_of(assignments or ()), more or {})
    if str(path) != "-":
        return load_scenario(path, changes)
    data = parse_toml(decoded(sys.stdin.buffer, STANDARD_INPUT), STANDARD_INPUT)
    return parse_scenario(changed(data, changes), file=STANDARD_INPUT)


def check_outputs(*paths: Path | None, plot: Path | None = None, source: Path | None = None) -> None:
    """Make sure that all files asked for can be written before the work begins, and not over the one that is read.

    Raises
    ------
    InputError
        With everything that is wrong with them.
    """
    problems: list[Problem] = []
    if plot is not None:
        problems += wrong_ending(plot, (".png", ".svg", ".pdf"))
    for path in (*paths, plot):
        try:
            if path is not None:
                check_writable(path)
                if source is not None and path.exists() and source.exists() and path.samefile(source):
                    problems.append(Problem(str(path), "", "must not be the file that is read; choose another name"))
        except InputError as error:
            problems.extend(error.problems)
    asked = [path.resolve() for path in (*paths, plot) if path is not None]
    twice = dict.fromkeys(str(path) for path in asked if asked.count(path) > 1)
    if not problems:
        problems += (Problem(path, "", "must not be written twice; choose another name") for path in twice)
    if problems:
        raise InputError(problems)


def write(path: Path, content: str | bytes) -> None:
    """Write a file that was asked for, and say so on stderr."""
    write_atomic(path, content.encode() if isinstance(content, str) else content)
    print(f"wrote {path}", file=sys.stderr)


def write_plot(path: Path, figure: "Figure") -> None:
    """Draw a figure to a file that was asked for."""
    from armour.reporting.plots import rendered

    write(path, rendered(figure, path.suffix.lower()))


def print_json(data: Mapping[str, Any]) -> None:
    """Print one JSON object."""
    print(json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False))


def changes_of(assignments: Sequence[str]) -> dict[str, Any]:
    """Changes of a scenario from texts such as ``armour.ceramic_thickness_mm=8``.

    A text is read as a line of TOML; a value that is not TOML stands for its text.

    Raises
    ------
    InputError
        With every text that is no assignment.
    """
    from armour.scenario.loading import changed

    changes: dict[str, Any] = {}
    problems = []
    for assignment in assignments:
        found = _assignment(assignment)
        if found is None:
            message = f"must be KEY=VALUE, such as impact.velocity_m_s=900, found {json.dumps(assignment)}"
            problems.append(Problem("command line", "--set", message))
        else:
            changes = changed(changes, found)
    if problems:
        raise InputError(problems)
    return changes


def _assignment(text: str) -> dict[str, Any] | None:
    """The line of TOML as data; None where it is none."""
    import tomllib

    key, equals, value = text.partition("=")
    for line in (text, f"{key}{equals}{json.dumps(value.strip())}"):
        try:
            return tomllib.loads(line) if equals and "\n" not in line else None
        except (tomllib.TOMLDecodeError, RecursionError):
            continue
    return None


def warn(scenario: "Scenario", warnings: Sequence[str]) -> None:
    """Say on stderr what of a scenario is outside the data that the model was tested on."""
    for warning in warnings:
        print(f"warning: {scenario.file}: {warning}", file=sys.stderr)


def tell_of_compiling() -> None:
    """Say on stderr that the first use after an installation takes its time."""
    from armour.engine import cache

    if not cache.is_compiled():
        print("compiling, once after an installation: some ten seconds", file=sys.stderr)


@contextmanager
def counting(what: str) -> Iterator[Callable[[int], None]]:
    """Give a function that counts one more of a total: a progress bar on a terminal, nothing elsewhere."""
    if not sys.stderr.isatty():
        yield lambda _total: None
        return
    from rich.progress import Progress

    with Progress(console=console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None)
        yield lambda total: bar.update(task, total=total, advance=1)


def console(*, stderr: bool = False) -> "Console":
    """A console as wide as the terminal; in a pipe as wide as it takes to keep every row on one line."""
    from rich.console import Console

    made = Console(stderr=stderr, highlight=False, soft_wrap=False)
    if not made.is_terminal:
        made.width = max(made.width, 160)
    return made


def print_table(
    columns: Sequence[str], rows: Sequence[Sequence[str]], *, numbers: Sequence[int] = (), stderr: bool = False
) -> None:
    """Print rows under their headings, columns of numbers to the right."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for index, column in enumerate(columns):
        table.add_column(column, justify="right" if index in numbers else "left", overflow="fold")
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    console(stderr=stderr).print(table)


def print_quantities(title: str, rows: Sequence[tuple[str, str, str]]) -> None:
    """Print quantities with their units below a title."""
    from rich.table import Table
    from rich.text import Text

    out = console()
    if title:
        out.print(Text(title, style="bold"))
    table = Table.grid(padding=(0, 2))
    table.add_column()
    table.add_column(justify="right")
    table.add_column()
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    out.print(table)
