"""What every command does: check the outputs, read, compute, write files, show, warn, in this order.

Files are written before anything is printed, so that a reader that closes the pipe loses none.
"""

import os
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from os.path import exists
from pathlib import Path
from typing import TYPE_CHECKING, Any

from armour.cli.console import say, show, show_json
from armour.errors import ArmourError, InputError, Problem, in_two_lines, mistake, refuse
from armour.files import (
    check_unreserved,
    decoded,
    parse_toml,
    read_text,
    reserve,
    unwritable,
    write_files,
    wrong_ending,
)

if TYPE_CHECKING:
    from armour.reporting.table import Table
    from armour.scenario.scenario import Scenario

# Exit codes of a question without an answer, and of a check that failed.
NO_ANSWER, CHECK_FAILED = 1, 3
STANDARD_INPUT = "standard input"
PLOT_ENDINGS = (".png", ".svg", ".pdf")


def wrong_option(option: str, message: str) -> InputError:
    """Return the error of a wrong option."""
    return mistake("command line", option, message)


def check_outputs(
    *writes: Path | None,
    tables: Iterable[Path | None] = (),
    plot: Path | None = None,
    updated: Path | None = None,
    force: bool = False,
) -> None:
    """Check that all outputs can be written, that none is another one, and that none replaces a file unless forced to.

    Of what is written, ``tables`` are CSV.  An output that is found to be read later is refused then, but for the
    updated one, which may exist.
    """
    problems = [] if plot is None else wrong_ending(plot, PLOT_ENDINGS)
    for table in tables:
        # Streams and pipes have no ending.
        if table is not None and (_is_kept(table) or not exists(table)):
            problems += wrong_ending(table, (".csv",))
    fresh = [path for path in (*writes, plot) if path is not None]
    paths = fresh if updated is None else [*fresh, updated]
    problems += (problem for path in paths for problem in unwritable(path))
    there = [path for path in fresh if not force and _is_kept(path)]
    problems += (Problem(str(path), "", "exists already; choose another name, or --force") for path in there)
    if not problems:
        resolved = [path.resolve() for path in paths]
        twice = dict.fromkeys(str(path) for path in resolved if resolved.count(path) > 1)
        problems += (Problem(path, "", "must not be written twice; choose another name") for path in twice)
    refuse(problems)
    reserve(fresh)


def _is_kept(path: Path) -> bool:
    """Return whether a path is that of a file, other than one to which the shell sends a stream of this process."""
    return (
        exists(path)
        and path.is_file()
        and not any(os.path.samestat(path.stat(), os.fstat(stream)) for stream in (1, 2))
    )


def read_scenario(
    path: Path,
    assignments: Sequence[str] | None,
    reads: Collection[str],
    more: Mapping[str, tuple[str, float | None]] | None = None,
    what: str = "the answer",
) -> "Scenario":
    """Read the scenario of a file, of a shipped one by its name, or, for "-", of standard input.

    ``assignments`` are those of ``--set``, which must set keys below those that the command ``reads``; ``more`` are the
    keys and values of other options, None if one is not given; ``what`` is what it computes, in words.  A wrong
    value of an option is a problem of the command line.
    """
    from armour.scenario.changes import changes_of
    from armour.scenario.inputs import VELOCITY
    from armour.scenario.reach import check_read, check_used, read_of
    from armour.scenario.scenario import parse_changed, scenario_file

    changes = changes_of(assignments or ())
    options = {key: f"--set {key}" for key in changes}
    for option, (key, value) in (more or {}).items():
        if value is not None:
            if key in changes and changes[key] != value:
                raise wrong_option(option, f"must not be given with {options[key]}")
            changes[key], options[key] = value, option
    if str(path) == "-":
        with suppress(OSError):  # a stream that is no file
            check_unreserved(sys.stdin.fileno())
        file, folder, text = STANDARD_INPUT, Path(), decoded(sys.stdin.buffer, STANDARD_INPUT)
    else:
        found = scenario_file(path)
        file, folder, text = str(path), found.parent, read_text(found)
    data = parse_toml(text, file)
    try:
        loaded = parse_changed(data, changes, file=file, folder=folder)
    except InputError as error:
        raise InputError([_blamed(each, options) if each.file == file else each for each in error.problems]) from None
    read = read_of(loaded, reads)
    if VELOCITY in changes and "ballistic_limit" in reads and "impact" not in reads:
        # Who looks at an armour with simulate goes on with the same command line.
        say(f"note: --set {VELOCITY}: has no effect: {what} does not depend on it")
        read.add(VELOCITY)
    check_read(changes, read, what)
    check_used(changes, loaded)
    return loaded


def accepted(changes: Iterable[str], reads: Collection[str]) -> Iterator[str]:
    """Yield those changes of ``--set`` that a command with such ``reads`` accepts."""
    from armour.scenario.changes import changes_of
    from armour.scenario.reach import check_read

    for change in changes:
        with suppress(InputError):
            check_read(changes_of([change]), reads)
            yield change


def set_options(changes: Iterable[str]) -> list[str]:
    """Return changes as words of a command line."""
    return [word for change in changes for word in ("--set", change)]


def _blamed(problem: Problem, options: Mapping[str, str]) -> Problem:
    """Return a problem with the option that sets its key, one below or one above it, if there is one."""
    from armour.scenario.keys import upwards

    for key, option in sorted(options.items(), reverse=True):
        if key in upwards(problem.key) or problem.key in upwards(key):
            where = f"--set {problem.key}" if option.startswith("--set") else option
            return Problem("command line", where, problem.message)
    return problem


def respond(
    data: Mapping[str, Any],
    tables: "Iterable[Table | str]",
    *,
    as_json: bool,
    of: Sequence[str] = (),
    files: Iterable[tuple[Path | None, Callable[[], str | bytes | None]]] = (),
    plot: Path | None = None,
    draw: Callable[[], Any] | None = None,
    warnings: Iterable[str] = (),
) -> None:
    """Write the files that are asked for, show an answer as tables or JSON, and warn.

    ``files`` are paths with functions that make the contents, or None if there is nothing to write.  ``draw`` makes
    the picture for ``plot``.  ``of`` are the lines above the tables that say what was computed.
    """

    def drawn() -> bytes | None:
        from armour.reporting.pictures import drawing

        return None if plot is None or draw is None else drawing.saved(draw(), plot.suffix.lower())

    contents: dict[Path, bytes] = {}
    failed: ArmourError | None = None
    try:
        for path, content in [*files, (plot, drawn)]:
            if path is not None and (made := content()) is not None:
                contents[path] = _encoded(made)
        write_files(contents)
    except ArmourError as error:
        failed = error
    # The answer is shown even if a file cannot be made or written.
    if as_json:
        show_json(data)
    elif shown := [*tables]:
        show(*of[1:], *shown, title=of[0] if of else "")
    say(*(f"wrote {path}" for path in contents if not failed), *warnings)
    if failed:
        raise failed


def write(contents: Mapping[Path, str | bytes]) -> None:
    """Write outputs, all or none, and report them on standard error."""
    write_files({path: _encoded(content) for path, content in contents.items()})
    say(*(f"wrote {path}" for path in contents))


def _encoded(content: str | bytes) -> bytes:
    """Encode a text; what is no Unicode, such as bytes of the name of a file, is escaped."""
    return content.encode(errors="backslashreplace") if isinstance(content, str) else content


def warnings_of(
    scenario: "Scenario | None",
    warnings: Iterable[str],
    file: str = "",
    *,
    of_threats: bool = False,
    verbose: bool = True,
) -> list[str]:
    """Return warnings as lines for standard error, with those on parts of the scenario that an answer ignores.

    Unless all are asked for, there are two lines at most: those on what the model was compared with in one line, and
    the first other one.
    """
    unused = () if of_threats or scenario is None else scenario.unused_threats()
    notes = () if scenario is None else (f"note: {note}" for note in scenario.notes)
    where = file or (scenario.file if scenario else "")
    every = list(dict.fromkeys((*unused, *warnings)))
    if not verbose:
        every = in_two_lines(every, "with -v")
    return [*notes, *(f"warning: {where}: {warning}" for warning in every)]


@contextmanager
def as_options(function: str, named: Mapping[str, str] = {}) -> Iterator[None]:
    """Name the parameters of a function, in the messages on them, as options; some are ``named`` otherwise."""
    try:
        yield
    except InputError as error:
        raise InputError(
            [_as_option(each, named) if each.file == function else each for each in error.problems]
        ) from None


def _as_option(problem: Problem, named: Mapping[str, str]) -> Problem:
    name, space, rest = problem.key.partition(" ")
    option = named.get(name, f"--{name.replace('_', '-')}" if name.isidentifier() else "")
    return Problem("command line", option + space + rest, problem.message) if option else problem
