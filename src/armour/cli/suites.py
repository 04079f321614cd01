"""Commands on suites of published values, and on the paper's figures."""

import os
from collections.abc import Callable
from functools import partial
from itertools import groupby, pairwise
from operator import attrgetter
from pathlib import Path
from time import perf_counter
from typing import Any, Literal

import typer

import armour
from armour.cli import completion, runner
from armour.cli.console import progress, say, show
from armour.cli.options import AS_JSON, CHANGES, FORCE, argument, file_option, flag, option
from armour.cli.runner import CHECK_FAILED, Files, check_outputs, mistakes_in, origin_of, picture, show_answer, write
from armour.errors import Problem, mistake, refuse
from armour.files import reason, suite_file
from armour.reporting.table import Table, csv_text
from armour.scenario.keys import changes_of


def validate(
    suite: Path | None = argument(
        "SUITE",
        "Suite file (TOML), or a shipped suite, such as paper (the default) or plates. A [[case]] has name, "
        "scenario, quantity, expected, and band or band_percent. `armour init FILE.toml --from SCENARIO.toml` writes "
        "one.",
        autocompletion=completion.suites,
        default=None,
    ),
    only: str = option("Check only cases whose name contains the text.", metavar="TEXT", default=""),
    changes: list[str] | None = CHANGES,
    update: bool = flag("Replace the suite's regression values with the computed ones.", "--update"),
    verbose: bool = flag("Show every case, and why some are not scored.", "--verbose", "-v"),
    markdown: Path | None = file_option("Write the result as Markdown."),
    junit: Path | None = file_option("Write the result as JUnit XML; such a file is replaced."),
    force: bool = FORCE,
    as_json: bool = AS_JSON,
) -> None:
    """Check the model against a suite of cases.

    The exit code is 3 if a value lies outside its band, with --update a value that is not replaced; or if no case is
    scored.

    Examples
    --------
    armour validate
    armour validate paper --junit junit.xml
    """
    from armour.reporting.formats import markdown_report
    from armour.reporting.views import validation as views
    from armour.validation import suite as suites
    from armour.validation import validate as judging

    path = suite_file("paper" if suite is None else suite)
    wrong = ["must be given a suite of your own; published values are not replaced"] if path != suite else []
    wrong += ["must not be given with --set, whose changes are not in the suite"] if changes else []
    refuse(Problem("validate", "--update", message) for message in wrong if update)
    updated = suite if update else None
    with mistakes_in(junit, [path], force=force):
        loaded = armour.load_suite(path, changes_of(changes or ()))
    check_outputs(markdown, junit=junit, inputs=suites.suite_files(loaded), updated=updated, force=force)
    chosen = loaded.only(only)
    if update and not any(case.regression for case in chosen.cases):
        message = "must be true for the suite, or a case or table without source, to be updated; other values stay"
        raise mistake(chosen.file, "regression", message)

    def show_done(checks: "list[armour.Check]") -> None:
        if not as_json:
            show(*views.tables_of_suite(judging.result_of(chosen, checks)))

    def updated_content(_path: Path) -> bytes | None:
        if judged.checks:
            say(f"kept, as no regression values: {len(judged.checks)} of {len(result.checks)} expected values")
        updates = judging.updates_of(result)
        if not updates:
            say("every regression value is the computed one")
            return None
        show(views.update_table(updates), stderr=True)
        return judging.updated_file(chosen.file.read_bytes(), updates)

    result, seconds = _computed(chosen, show_done)
    judged = judging.kept_by_update(result) if update else result
    tables = views.tables_of_suite(judged.of(every_row=verbose)) if judged.checks else ()
    show_answer(result.to_dict(), tables, as_json=as_json)
    write(
        {
            markdown: lambda _: markdown_report(views.suite_report(result)),
            junit: lambda _: views.suite_junit(result, seconds, origin_of()),
            updated: updated_content,
        },
        [f"warning: {text}" for text in result.warnings],
    )
    if judged.count(*judging.FAILED) or not result.is_scored:
        raise typer.Exit(CHECK_FAILED)


def _computed(
    suite: "armour.Suite", show_done: "Callable[[list[armour.Check]], None]"
) -> tuple["armour.SuiteResult", list[float]]:
    """Compute the cases of a suite; return the result and the time of each, s.

    If interrupted, call `show_done` with the checks that are done, if there are any.
    """
    done: list[armour.Check] = []
    times = [perf_counter()]
    try:
        with progress("cases", len(suite.cases)) as count:

            def on_check(check: "armour.Check", _total: int) -> None:
                done.append(check)
                times.append(perf_counter())
                count(1)

            return armour.validate(suite, on_check=on_check), [end - start for start, end in pairwise(times)]
    except KeyboardInterrupt:
        if done:
            show_done(done)
        raise


def figures(
    folder: Path = argument("DIR", "Folder to write to."),
    only: str = option(
        "Draw only the figure of this number, or those whose name contains the text.", metavar="TEXT", default=""
    ),
    image: Literal["png", "svg"] = typer.Option("png", "--format", help="Format of the figures."),
    force: bool = FORCE,
) -> None:
    """Draw the paper's figures.

    These are figs. 3 to 14, and parity plots of table 3 and of bare plates. The values of each are also written as CSV.

    Examples
    --------
    armour figures . --only fig09
    """
    drawing = runner.drawing()

    from armour.reporting.pictures import validation as pictures
    from armour.reporting.views import validation as views
    from armour.validation import figures as paper

    path = paper.paper_figures()
    panels = {name: list(group) for name, group in groupby(paper.read_figures(path), attrgetter("name"))}
    names = [*panels, *paper.PARITIES]
    number = f"fig{only.zfill(2)}" if only.isdecimal() else ""
    chosen = [name for name in names if (name == number if number else only in name)]
    if not chosen:
        message = f'must be a number or part of a name, found "{only}"; there are {", ".join(names)}'
        raise mistake("figures", "--only", message)
    try:
        os.listdir(folder)
        check_outputs(*(folder / f"{name}.{ending}" for name in chosen for ending in ("csv", image)), force=force)
    except FileNotFoundError:
        pass  # the folder is made with the first figure
    except OSError as error:
        raise mistake(folder, "", f"cannot be written to: {reason(error)}") from None
    # Write each figure as soon as it is computed, as all of them take a while.
    with progress("figures", len(chosen)) as count:
        for name in chosen:
            if name in paper.PARITIES:
                result = paper.parity(name)
                table, draw = views.parity_table(result), partial(pictures.draw_suite, result)
            else:
                figures = [paper.compute_figure(section, path.parent) for section in panels[name]]
                table, draw = views.figure_table(figures), partial(pictures.draw_figure, figures)
            figure = drawing.drawn(draw, drawing.Sheet()).figure
            folder.mkdir(parents=True, exist_ok=True)
            write(_files_of(folder, name, image, table, figure))
            count(1)


def _files_of(folder: Path, name: str, image: str, table: Table, figure: Any) -> Files:
    """Return the files of a figure, its table and its picture, with functions that make their contents."""
    return {
        folder / f"{name}.csv": lambda _: csv_text(table),
        folder / f"{name}.{image}": picture(lambda: figure, None),
    }
