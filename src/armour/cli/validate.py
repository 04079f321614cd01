"""``armour validate``."""

from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from armour.cli import completion
from armour.cli.console import progress, say, show
from armour.cli.options import AsJson, Force, argument, option
from armour.cli.runner import CHECK_FAILED, check_outputs, respond, say_if_compiling
from armour.errors import Problem, refuse
from armour.files import suite_file

if TYPE_CHECKING:
    from armour.validation.suite import Suite
    from armour.validation.validate import Check, SuiteResult


def validate(
    suite: Annotated[
        Path | None,
        argument(
            "SUITE",
            "Suite file (TOML), or a shipped suite: paper, the default, or plates. A [[case]] has name, scenario, "
            "quantity, expected, and band or band_percent. `armour init FILE.toml --from paper` writes an example.",
            autocompletion=completion.suites,
        ),
    ] = None,
    only: Annotated[str, option("Check only cases whose name contains the text.", metavar="TEXT")] = "",
    changes: Annotated[
        list[str] | None,
        option(
            "Change a value of every scenario; may be given several times.",
            "--set",
            metavar="KEY=VALUE",
            autocompletion=completion.assignments,
        ),
    ] = None,
    update: Annotated[
        bool, option("Write the computed values in place of the suite's regression values.", "--update")
    ] = False,
    markdown: Annotated[Path | None, option("Write the result as Markdown.", "--markdown", metavar="FILE")] = None,
    junit: Annotated[Path | None, option("Write the result as JUnit XML.", "--junit", metavar="FILE")] = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Check the model against a suite of cases.

    Exits with 3 where a value lies outside its band. With --update, the tables have the values before the update, and
    only values that it keeps count.
    """
    from armour.reporting.report import markdown_report
    from armour.reporting.views import suite as view
    from armour.scenario.changes import changes_of
    from armour.validation.suite import load_suite
    from armour.validation.validate import kept_by_update

    path = suite_file("paper" if suite is None else suite)
    if update:
        _check_update(suite if path == suite else None, changes)
    updated = suite if update else None
    check_outputs(markdown, junit, updated=updated, force=force)
    chosen = load_suite(path, changes_of(changes or ())).only(only)
    if update and not any(case.regression for case in chosen.cases):
        message = "must be true for the suite, or a case or table without source, to be updated; other values stay"
        refuse([Problem(str(chosen.file), "regression", message)])
    say_if_compiling()
    start = perf_counter()
    result = _computed(chosen, quiet=as_json)
    seconds = perf_counter() - start
    respond(
        result.to_dict(),
        view.tables(result),
        as_json=as_json,
        title="values before the update" if update else "",
        files=[
            (markdown, lambda: markdown_report(view.report(result))),
            (junit, lambda: view.junit(result, seconds)),
            (updated, lambda: _updated(chosen.file, result)),
        ],
    )
    if not (kept_by_update(result) if update else result).passed:
        raise typer.Exit(CHECK_FAILED)


def _check_update(suite: Path | None, changes: Sequence[str] | None) -> None:
    """Refuse to update the shipped suite, or a suite with values that only hold with ``--set``."""
    problems = []
    if suite is None:
        problems.append(Problem("validate", "--update", "must be given a suite; what is published stays"))
    if changes:
        message = "must not be given with --set: the suite would not hold without"
        problems.append(Problem("validate", "--update", message))
    refuse(problems)


def _computed(suite: "Suite", *, quiet: bool) -> "SuiteResult":
    """Compute the cases; where this is interrupted, show those that are done."""
    from armour.reporting.views import suite as view
    from armour.validation.validate import result_of
    from armour.validation.validate import validate as run_suite

    done: list[Check] = []
    try:
        with progress("cases", len(suite.cases)) as count:

            def on_check(check: "Check", _total: int) -> None:
                done.append(check)
                count(1)

            return run_suite(suite, on_check=on_check)
    except KeyboardInterrupt:
        if done and not quiet:
            show(*view.tables(result_of(suite, done)))
        raise


def _updated(suite: Path, result: "SuiteResult") -> bytes | None:
    """Return the suite with computed values, which are listed on standard error; None where nothing changes."""
    from armour.reporting.views.suite import update_table
    from armour.validation.validate import kept_by_update, updated_file, updates_of

    if kept := kept_by_update(result).checks:
        say(f"kept, as no regression values: {len(kept)} of {len(result.checks)} expected values")
    updates = updates_of(result)
    if not updates:
        say("every regression value is the computed one")
        return None
    show(update_table(updates), stderr=True)
    return updated_file(suite.read_bytes(), updates)
