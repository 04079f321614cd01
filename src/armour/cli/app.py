"""Assemble the commands of the program with their help and examples, and turn errors into exit codes."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from inspect import getdoc
from itertools import chain
from typing import Any

import typer
from typer.core import TyperGroup

from armour import MODEL_VERSION, __version__
from armour.analysis.quantities import QUANTITIES, REQUIRED_QUANTITIES
from armour.cli import experiments, scenario_commands, suites
from armour.cli.console import discard, emit, say
from armour.cli.library import init, library, schema
from armour.cli.options import flag
from armour.cli.runner import NO_ANSWER, command_line, propose, with_lines
from armour.errors import MAX_PROBLEMS, ArmourError, InputError, NoAnswerError, Problem, mistake
from armour.files import reason, shell_line

WRONG_INPUT, INTERRUPTED = 2, 130
# Heading, in the docstring of a command, of examples, which the tests run.
EXAMPLES = "\n\nExamples\n--------\n"


class Reporting(TyperGroup):
    """A group of commands whose errors end in a message and an exit code."""

    def make_context(self, info_name: Any, args: list[str], *others: Any, **settings: Any) -> Any:
        """Parse the command line, and refuse an empty word, which would be read as the current folder.

        It often comes from a shell variable that is not set.  Completion permits it, as a word not yet begun.
        """
        with _reported():
            if "" in args and not settings.get("resilient_parsing"):
                raise mistake("command line", "", "must not contain an empty word, such as a variable that is not set")
            return super().make_context(info_name, args, *others, **settings)

    def invoke(self, ctx: Any) -> Any:
        """Run the command."""
        with _reported():
            return super().invoke(ctx)


@contextmanager
def _reported() -> Iterator[None]:
    """Turn errors in the block into messages on standard error and exit codes."""
    try:
        yield
    except InputError as error:
        say(*_located(error.problems))
        if error.options:
            propose(f"{command_line()} {shell_line(error.options)}")
        raise typer.Exit(WRONG_INPUT) from None
    except ArmourError as error:
        say(str(error))
        raise typer.Exit(NO_ANSWER if isinstance(error, NoAnswerError) else WRONG_INPUT) from None
    except OSError as error:  # such as a full disk
        if error.filename is None:
            discard(sys.stdout)
        say(f"{error.filename or 'standard output'}: {reason(error)}")
        raise typer.Exit(WRONG_INPUT) from None
    except KeyboardInterrupt as interrupt:
        say("; ".join(("interrupted", *interrupt.args)))
        raise typer.Exit(INTERRUPTED) from None


def _located(problems: Sequence[Problem]) -> list[str]:
    """Return the messages of the first problems, each with the line of its key in a TOML file, if known."""
    shown = with_lines(problems[:MAX_PROBLEMS])
    messages = [str(problem) if line is None else f"{problem} (line {line})" for problem, line in shown]
    omitted = len(problems) - MAX_PROBLEMS
    return [*messages, f"and {omitted} more problems"] if omitted > 0 else messages


class Overview(Reporting):
    """The program: its help is a line for each command."""

    def format_help(self, _ctx: Any, _formatter: Any) -> None:
        """Print the help, which fits on a screen."""
        lines = HELP.splitlines()
        for heading, commands in COMMANDS.items():
            lines += ["", heading, *(f"  {named(each):<16} {told(each)[0].partition('.')[0]}." for each in commands)]
        emit("\n".join([*lines, "", OPTIONS, ""]))


HELP = """\
Usage: armour COMMAND [ARGS]...   (armour COMMAND -h explains one)

Does this armour stop that round, and what is the lightest that does?

  armour init mine.toml
  armour optimise mine.toml --probability 0.95 --save best.toml
  armour check best.toml
"""
OPTIONS = "Options: -v more lines, --json all numbers, --plot FILE a picture, --version."
app = typer.Typer(
    cls=Overview,
    invoke_without_command=True,
    rich_markup_mode=None,  # as rich would cut the names of options in a narrow terminal
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(is_given: bool) -> None:
    """Print the version and exit if the option is given."""
    if is_given:
        emit(f"armour {__version__}, model {MODEL_VERSION}\n")
        raise typer.Exit


@app.callback()
def _armour(
    ctx: typer.Context, _version_asked: bool = flag("Show the version.", "--version", callback=_version, is_eager=True)
) -> None:
    """Predict whether a light ceramic/metal armour stops a projectile, and find the lightest armour that does."""
    if ctx.invoked_subcommand is None:
        ctx.get_help()  # which prints it


plan = typer.Typer(
    cls=Reporting, help="Plan the next shot of a V50 firing.", no_args_is_help=True, rich_markup_mode=None
)

# Commands by their heading in the help.
COMMANDS: dict[str, tuple[Callable[..., None], ...]] = {
    "Decide": (init, scenario_commands.check, scenario_commands.optimise, scenario_commands.report, library),
    "Use your tests": (experiments.plan_shots, experiments.v50, experiments.calibrate),
    "Study the model": (
        scenario_commands.simulate,
        scenario_commands.ballistic_limit,
        scenario_commands.sensitivity,
        scenario_commands.uncertainty,
        scenario_commands.sweep,
        scenario_commands.compare,
    ),
    "For CI and developers": (suites.validate, schema, suites.figures),
}


def named(command: Callable[..., None]) -> str:
    """Return the name of a command as it is typed, such as "plan shots"."""
    name = command.__name__.replace("_", "-")
    return name.replace("-", " ") if command is experiments.plan_shots else name


def told(command: Callable[..., None]) -> tuple[str, list[str]]:
    """Return the help of a command and the lines of its examples, both from its docstring."""
    words, _, examples = (getdoc(command) or "").partition(EXAMPLES)
    return words, examples.splitlines()


for _command in chain.from_iterable(COMMANDS.values()):
    _help, _examples = told(_command)
    # A line of \b alone keeps the lines below it as they are.
    _epilog = "\n".join(("\b", "Examples:", *(f"  {example}" for example in _examples)))
    if _command is scenario_commands.sweep:
        _epilog = f"Quantities: {', '.join(QUANTITIES)}.\n\nrequired_...: {REQUIRED_QUANTITIES}.\n\n{_epilog}"
    _group, _name = (plan, "shots") if _command is experiments.plan_shots else (app, named(_command))
    _group.command(_name, help=_help, epilog=_epilog)(_command)
app.add_typer(plan, name="plan")
