"""Steps that commands share, in this order: read, check the outputs, compute, show, write files, warn."""

import json
import os
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, chdir, contextmanager, suppress
from functools import cache
from os.path import exists, isfile
from pathlib import Path
from typing import Any, TypeVar

import armour
from armour.analysis.quantities import ANSWERS, Answer
from armour.analysis.results import made_by
from armour.cli.console import emit, say, show, show_json
from armour.errors import ArmourError, InputError, Note, Problem, mistake, refuse, restated
from armour.files import decoded, parse_toml, read_text, shell_line, unwritable, write_file, wrong_ending
from armour.reporting.by_result import by_result, tables_of
from armour.reporting.junit import TestCase, is_junit_of_armour, junit_suite, junit_xml
from armour.reporting.report import Report
from armour.reporting.table import Table
from armour.scenario.effect import check_effect
from armour.scenario.keys import changes_of, is_read, line_of, lines_of, upwards, values_by_key
from armour.scenario.scenario import Scenario, files_of, parse_changed, scenario_file

Content = TypeVar("Content", bound=Any)
# Exit codes: a question without an answer, and a check that failed.
NO_ANSWER, CHECK_FAILED = 1, 3
STANDARD_INPUT = "standard input"
# Endings that files may have.
CSV, PICTURE = (".csv",), (".png", ".svg", ".pdf")
# By path of a file to write, a function that returns its content, or None to write nothing.  The path None stands for a
# file that is not asked for.
Files = Mapping[Path | None, Callable[[Path], str | bytes | None]]


def wrong_option(option: str, message: str) -> InputError:
    """Return the error of a wrong option of the command line."""
    return mistake("command line", option, message)


def check_options(*mistakes: tuple[str, object, str]) -> None:
    """Raise the error of the first wrong option.

    Each of ``mistakes`` has an option, whether it is wrong, and the condition that it must meet.
    """
    for option, is_wrong, message in mistakes:
        if is_wrong:
            raise wrong_option(option, message)


def check_outputs(
    *outputs: tuple[Path | None, Sequence[str]],
    inputs: Iterable[Scenario | str | Path | None] = (),
    junit: Path | None = None,
    updated: Path | None = None,
    force: bool = False,
) -> None:
    """Check that all outputs can be written and differ from inputs; raise an error otherwise.

    Each of ``outputs`` has the endings that it may have, () for any.  Only with ``force`` may an output replace a file,
    except that ``junit`` may replace JUnit XML written by this program.  ``updated`` is both an input and an output.
    """
    new = [path for path in (*(path for path, _ in outputs), junit) if path is not None]
    refuse(Problem("-", "", "must be the name of a file to write") for path in new if str(path) == "-")
    problems: list[Problem] = []
    for output, endings in outputs:
        # A stream or a pipe, to which a table may be written, has no ending.
        if output is not None and endings and (endings != CSV or isfile(output) or not exists(output)):
            problems += wrong_ending(output, endings)
    problems += (problem for path in [*new, *([updated] if updated else [])] for problem in unwritable(path))
    read = [file for each in inputs if each for file in (files_of(each) if isinstance(each, Scenario) else [each])]
    sources = [0 if str(file) in ("-", STANDARD_INPUT) else file for file in read]  # its descriptor
    for path in filter(isfile, new):
        if any(exists(source) and os.path.samefile(path, source) for source in sources):
            problems.append(Problem(str(path), "", "must not be the file that is read; choose another name"))
        elif not (force or (path == junit and is_junit_of_armour(path))):
            problems.append(Problem(str(path), "", "exists already; choose another name, or --force"))
    refuse(problems)


def with_lines(problems: Iterable[Problem]) -> Iterator[tuple[Problem, int | None]]:
    """Yield each problem with the line of the TOML file where its key is; None if there is no such line."""

    @cache
    def lines(file: str) -> dict[str, int]:
        try:
            # A pipe has been read already, and would block forever.
            return lines_of(read_text(file)) if file.lower().endswith(".toml") and isfile(file) else {}
        except ArmourError:
            return {}

    for problem in problems:
        yield problem, line_of(problem.key, lines(problem.file)) if problem.key else None


@contextmanager
def mistakes_in(junit: Path | None, inputs: Sequence[Path], *, force: bool) -> Iterator[None]:
    """If the block raises an InputError, also write its problems to ``junit``, if given and possible.

    ``inputs`` are files that it must not replace.
    """
    try:
        yield
    except InputError as error:
        if junit is not None:
            found = with_lines(error.problems)
            cases = [
                TestCase(each.file, each.key or "file", "error", str(each), None, each.file, at) for each, at in found
            ]
            with suppress(InputError):
                check_outputs(junit=junit, inputs=[*inputs, *(problem.file for problem in error.problems)], force=force)
                suite = junit_suite("invalid input", cases, 0.0, origin_of())
                write({junit: lambda _: junit_xml([suite])})
        raise


def read_scenario(
    path: Path, assignments: Iterable[str] | None, asked: Answer, probability: Any = None, *, by_model: bool = False
) -> Scenario:
    """Read a scenario from a file, from a shipped scenario by its name or, for "-", from standard input.

    ``assignments`` are those of ``--set``; they must set keys that the answer ``asked`` for reads, or keys below these.
    The scenario requires at least the ``probability`` of stopping each threat, if one is given; ``by_model`` excludes
    the model error, and then none may be required.
    """
    changes = changes_of(assignments or ())
    if str(path) == "-":
        file, folder, text = STANDARD_INPUT, Path(), decoded(sys.stdin.buffer, STANDARD_INPUT)
    else:
        real_path = scenario_file(path)
        file, folder, text = str(path), real_path.parent, read_text(real_path)
    data = parse_toml(text, file)
    with restated(lambda problem: _as_set_option(problem, changes) if problem.file == file else problem):
        loaded = parse_changed(data, changes, file=file, folder=folder)
    check_effect(values_by_key(changes), [(loaded, asked.reads)], "command line", asked.computed, "--set ")
    with as_options("requiring"):
        required = loaded.requiring(probability)
    if not by_model:
        return required
    if any(required.required_probabilities()):
        message = "must not be combined with a required probability, which the model alone cannot tell"
        way_on = "leave out --by-model, or --probability and the probabilities that the scenario requires"
        raise wrong_option("--by-model", f"{message}; {way_on}")
    return required.replaced({"uncertainty.model": None}).replaced({"uncertainty.model.included": False})


def read_each(paths: Iterable[Path], read: Callable[[Path], Scenario]) -> list[Scenario]:
    """Read several scenarios, and raise one error with the mistakes in all of them."""
    scenarios: list[Scenario] = []
    problems: list[Problem] = []
    for path in paths:
        try:
            scenarios.append(read(path))
        except InputError as error:
            problems += error.problems
    refuse(dict.fromkeys(problems))
    return scenarios


def with_change(changes: Iterable[str] | None, key: str, value: str | None) -> list[str]:
    """Return the changes of ``--set`` and, if an option of the command gives a value of a key, this change too."""
    return [*(changes or ()), *([] if value is None else [f"{key}={value}"])]


def say_how_read(table: object, content: Content) -> Content:
    """Say how the shots or tests of a table were read, if that was not obvious, and return them."""
    if content.read is not None and not content.read.plain:
        say(f"read {table}: {content.read.words}")
    return content


def accepted(changes: Iterable[str], reads: Collection[str]) -> list[str]:
    """Return the changes of ``--set`` whose keys are among those that a command ``reads``, or below them."""
    return [text for text in changes if all(is_read(key, reads) for key in values_by_key(changes_of([text])))]


def repeated(command: str, changes: Iterable[str] | None, **asked: Any) -> list[str]:
    """Return options as words of the command to go on with; omit changes of keys that it does not read."""
    words, read = list[str](), accepted(changes or (), ANSWERS[command].reads)
    for name, value in {**asked, "set": read}.items():
        for each in value if isinstance(value, list) else [value]:
            # None and False are options that are not given.
            words += [f"--{name.replace('_', '-')}", *[str(each)] * (each is not True)] * (each not in (None, False))
    return words


def source_word(file: str | Path) -> str:
    """Return a file as a word to type on a command line; "./" precedes a hyphen, which would begin an option."""
    return f"./{file}" if str(file).startswith("-") and str(file) != "-" else str(file)


def _as_set_option(problem: Problem, changed: Iterable[str]) -> Problem:
    """Return a problem under ``--set`` if this changed its key, a table around the key, or a value within it."""
    if any(key in upwards(problem.key) or problem.key in upwards(key) for key in changed):
        return Problem("command line", f"--set {problem.key}", problem.message)
    return problem


def answer(
    result: Any,
    scenario: Scenario | None,
    files: Files | None = None,
    notes: Iterable[Note] | None = None,
    *,
    plot: Path | None = None,
    file: str = "",
    extra_data: Mapping[str, Any] = {},
    as_json: bool,
    verbose: bool,
) -> None:
    """Show a result as tables or, with ``extra_data``, as JSON; write its files and its picture; print warnings.

    The warnings are the notes of the result, unless ``notes`` are given; ``file`` is the file that they name.
    """
    result.of(every_row=verbose)
    tables = () if as_json else by_result(tables_of, result)(result)
    data = {**result.to_dict(), **extra_data} if as_json else {}
    show_answer(data, tables, scenario, as_json=as_json)
    shown = warnings_of(scenario, result.notes if notes is None else notes, file, verbose=verbose)
    write({**(files or {}), plot: picture(lambda: armour.plot(result), scenario)}, shown)


def show_answer(
    data: Mapping[str, Any], tables: Iterable[Table | str], scenario: Scenario | None = None, *, as_json: bool
) -> None:
    """Show an answer as tables or, as JSON, with the command and versions that made it."""
    if as_json:
        show_json({**data, "made_by": origin_of(scenario)})
    elif shown := [*tables]:
        show(*shown)


def write(files: Files, warnings: Iterable[str] = ()) -> None:
    """Write the files that are asked for, and say so; print the warnings even if a file cannot be written."""
    try:
        # Make all contents before writing any.
        contents = [(path, content(path)) for path, content in files.items() if path is not None]
        for path, content in contents:
            if content is not None:
                # File names in the content may have bytes that are not Unicode; escape them.
                write_file(path, content.encode(errors="backslashreplace") if isinstance(content, str) else content)
                say(f"wrote {path}")
    finally:
        say(*warnings)


def picture(draw: Callable[[], Any], scenario: Scenario | None) -> Callable[[Path], bytes]:
    """Return a function that makes the content of a picture's file, with a record of what made it."""
    return lambda path: drawing().saved(draw(), path.suffix.lower(), json.dumps(origin_of(scenario)))


def propose(command: str) -> None:
    """Print the command to go on with on a single line, so that it can be copied."""
    emit(f"next: {command}\n", sys.stderr)


def drawing() -> Any:
    """Import and return the module that draws, `armour.reporting.pictures.drawing`.

    During the import, the current folder is that of this file, as matplotlib would read settings there.
    """
    os.environ |= {"MPLBACKEND": "agg", "MATPLOTLIBRC": os.devnull}
    if folder := os.environ.get("MPLCONFIGDIR"):
        os.environ["MPLCONFIGDIR"] = os.path.abspath(folder)
    try:
        with chdir(Path(__file__).parent):
            from armour.reporting.pictures import drawing
    except OSError:
        message = "must be a folder that can be written to, where there is neither a home nor a temporary folder"
        raise mistake("environment", "MPLCONFIGDIR", message) from None
    return drawing


def page(report: Report, path: Path) -> str:
    """Return a report as the text of a file, HTML or Markdown, by its ending."""
    from armour.reporting.formats import report_text

    if path.suffix.lower() == ".html":
        drawing()
    return report_text(report, path)


def origin_of(scenario: Scenario | None = None) -> dict[str, str]:
    """Return what outputs record about their origin: the command line, the versions, and the scenario."""
    return made_by(scenario, command_line())


def command_line() -> str:
    """Return the command line as it was typed, without the folders of absolute paths."""
    return shell_line(["armour", *map(_without_folders, sys.argv[1:])])


def _without_folders(word: str) -> str:
    """Return a word of a command line; reduce an absolute path to its name, as its folders are nobody's business."""
    option, equals, text = word.rpartition("=")
    return option + equals + Path(text).name if Path(text).is_absolute() else word


def warnings_of(scenario: Scenario | None, warnings: Iterable[Note], file: str = "", *, verbose: bool) -> list[str]:
    """Return the notes on a scenario, and the warnings, as lines for standard error.

    ``file`` is the file that the warnings name, by default the scenario's.  What the answer contains is left out;
    without ``verbose``, only the first warning remains.
    """
    notes = () if scenario is None else (f"note: {note}" for note in scenario.notes)
    where = file or (scenario.file if scenario else "")
    unsaid = [note for note in dict.fromkeys(warnings) if note.said in ("", "detail")]
    more = "; more with -v" * (len(unsaid) > 1)
    shown = map(str, unsaid) if verbose else [f"{note}{more}" for note in unsaid if not note.said][:1]
    return [*notes, *(": ".join(filter(None, ("warning", where, warning))) for warning in shown)]


def as_options(function: str, named: Mapping[str, str] = {}) -> AbstractContextManager[None]:
    """Make errors in the block name options instead of the parameters of a function.

    A parameter "a_b" is the option "--a-b", unless ``named`` has another name for it.
    """
    return restated(lambda problem: _as_option(problem, named) if problem.file == function else problem)


def _as_option(problem: Problem, named: Mapping[str, str]) -> Problem:
    """Return a problem whose key begins with a parameter under the name of the option instead."""
    name, space, rest = problem.key.partition(" ")
    option = named.get(name, f"--{name.replace('_', '-')}" if name.isidentifier() else "")
    return Problem("command line", option + space + rest, problem.message) if option else problem
