"""Commands on suites of published values, and on the paper's figures."""

import os
from functools import partial
from itertools import pairwise
from operator import attrgetter
from pathlib import Path
from time import perf_counter
from typing import Any, Literal

import typer

import armour
from armour.cli import completion, options, runner
from armour.cli.console import progress, say, show
from armour.cli.runner import check_outputs
from armour.files import suite_file
from armour.reporting.table import Table, csv_text, grouped
from armour.scenario.keys import changes_of

SUITE = "Suite file (TOML), or a shipped suite, such as paper (the default) or plates."


def validate(
    suite: Path | None = options.argument("SUITE", SUITE, None, words=completion.suites),
    only: str = options.text("Check only cases whose name contains the text.", metavar="TEXT", default=""),
    changes: list[str] | None = options.CHANGES,
    update: bool = options.flag("Replace the suite's regression values with the computed ones.", "--update"),
    verbose: bool = options.flag("Show every case, and why some are not scored.", "--verbose", "-v"),
    markdown: Path | None = options.file("Write the result as Markdown."),
    junit: Path | None = options.JUNIT,
    force: bool = options.FORCE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Check the model against a suite of cases.

    The exit code is 3 if a value lies outside its band (with --update, a value that is not replaced) or if no case is
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
    runner.check_options(
        ("--update", update and path != suite, "must be given a suite of your own; published values are not replaced"),
        ("--update", update and changes, "must not be given with --set, whose changes are not in the suite"),
    )
    updated = suite if update else None
    with runner.mistakes_in(junit, [path], force=force):
        loaded = armour.load_suite(path, changes_of(changes or ()))
    check_outputs((markdown, ()), junit=junit, inputs=suites.suite_files(loaded), updated=updated, force=force)
    with runner.as_options("only", {"text": "--only"}):
        chosen = loaded.only(only)
    needs = "needs regression = true in the suite, or in a case or table that has no source; other values are kept"
    runner.check_options(("--update", update and not any(case.regression for case in chosen.cases), needs))

    def updated_content(_path: Path) -> bytes | None:
        if judged.checks:
            say(f"kept {len(judged.checks)} of {len(result.checks)} expected values, which are not regression values")
        updates = judging.updates_of(result)
        if not updates:
            say("every regression value is the computed one")
            return None
        show(views.update_table(updates), stderr=True)
        return judging.updated_file(chosen.file.read_bytes(), updates)

    times = [perf_counter()]
    with progress("cases", len(chosen.cases)) as count:

        def on_check(_check: armour.Check, _total: int) -> None:
            times.append(perf_counter())
            count(1)

        result = armour.validate(chosen, on_check=on_check)
    seconds = [end - start for start, end in pairwise(times)]
    judged = judging.kept_by_update(result) if update else result
    tables = views.tables_of_suite(judged.of(every_row=verbose)) if judged.checks else ()
    runner.show_answer(result.to_dict(), tables, as_json=as_json)
    outputs: runner.Files = {
        markdown: lambda _: markdown_report(views.suite_report(result)),
        junit: lambda _: views.suite_junit(result, seconds, runner.origin_of()),
        updated: updated_content,
    }
    runner.write(outputs, [f"warning: {text}" for text in result.warnings])
    if judged.count(*judging.FAILED) or not result.is_scored:
        raise typer.Exit(runner.CHECK_FAILED)


def figures(
    folder: Path = options.argument("DIR", "Folder to write to."),
    only: str = options.text("Draw only figures whose name contains the text.", metavar="TEXT", default=""),
    image: Literal["png", "svg"] = typer.Option("png", "--format", metavar="FORMAT", help="Format, png or svg."),
    force: bool = options.FORCE,
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
    panels = grouped(paper.read_figures(path), attrgetter("name"))
    names = [*panels, *paper.PARITIES]
    chosen = [name for name in names if only in name]
    message = f'must be part of a name, found "{only}"; there are {", ".join(names)}'
    runner.check_options(("--only", not chosen, message))
    if os.path.isdir(folder):  # or else it is made with the first figure
        check_outputs(*((folder / f"{name}.{ending}", ()) for name in chosen for ending in ("csv", image)), force=force)
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
            runner.write(_files_of(folder / name, image, table, figure))
            count(1)


def _files_of(stem: Path, image: str, table: Table, figure: Any) -> runner.Files:
    """Return the files of a figure, .csv with its table and `image` with its picture, as `runner.write` takes them."""
    return {
        stem.with_suffix(".csv"): lambda _: csv_text(table),
        stem.with_suffix(f".{image}"): runner.picture(lambda: figure, None),
    }
