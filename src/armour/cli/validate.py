"""``armour validate``."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from armour.cli.runner import (
    CHECK_FAILED,
    AsJson,
    changes_of,
    check_outputs,
    counting,
    print_json,
    print_table,
    tell_of_compiling,
    write,
)
from armour.errors import InputError, Problem

if TYPE_CHECKING:
    from armour.validation.suite import Suite
    from armour.validation.validate import Check, SuiteResult


def validate(
    suite: Annotated[
        Path | None,
        typer.Argument(metavar="[SUITE]", help="Suite file (TOML); left out: what the paper publishes."),
    ] = None,
    only: Annotated[
        str, typer.Option(metavar="TEXT", help="Only cases whose name holds the text.", show_default=False)
    ] = "",
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Another value in every scenario, such as [bold]model.shear_perimeter=projectile[/].",
            show_default=False,
        ),
    ] = None,
    update: Annotated[
        bool,
        typer.Option("--update", help="Show, then write the computed values into the suite.", show_default=False),
    ] = False,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the outcome as Markdown.", show_default=False)
    ] = None,
    junit: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the outcome as JUnit's XML.", show_default=False)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Hold a suite of cases, or what the paper publishes, against the model; exit code 3 where a band is left."""
    from armour.validation.suite import load_suite
    from armour.validation.validate import paper_suite

    check_outputs(suite if update else None)
    check_outputs(markdown, junit, source=suite)
    if update:
        _check_update(suite, changes)
    chosen = load_suite(suite or paper_suite(), changes_of(changes or ()))
    tell_of_compiling()
    result = _computed(chosen.only(only), quiet=as_json)
    if as_json:
        print_json(result.to_dict())
    else:
        _print(result)
    _write(result, markdown, junit)
    if update and suite is not None:
        _update(suite, result)
    elif not result.passed:
        raise typer.Exit(CHECK_FAILED)


def _check_update(suite: Path | None, changes: Any) -> None:
    """Refuse an update that would write what nobody published, or what only holds with other values."""
    problems = []
    if suite is None:
        problems.append(Problem("validate", "--update", "must be given a suite; what is published stays"))
    if changes:
        problems.append(
            Problem("validate", "--update", "must not be given with --set: the suite would not hold without")
        )
    if problems:
        raise InputError(problems)


def _computed(suite: "Suite", *, quiet: bool) -> "SuiteResult":
    """The outcome; interrupted, what there is of it is printed first."""
    from armour.validation.validate import result_of
    from armour.validation.validate import validate as run_suite

    done: list[Check] = []
    try:
        with counting("cases") as show:

            def on_check(check: "Check", total: int) -> None:
                done.append(check)
                show(total)

            return run_suite(suite, on_check=on_check)
    except KeyboardInterrupt:
        if done and not quiet:
            _print(result_of(suite, done))
        raise


def _print(result: "SuiteResult") -> None:
    from armour.reporting.tables import (
        CHECK_COLUMNS,
        ERROR_COLUMNS,
        SUMMARY_COLUMNS,
        check_groups,
        check_rows,
        error_rows,
        note_rows,
        summary_rows,
        verdict,
    )

    for name, checks in check_groups(result):
        print(f"{name}:")
        print_table(CHECK_COLUMNS, check_rows(checks), numbers=(2, 3, 4, 5, 6))
        print()
    if result.summaries:
        print_table(SUMMARY_COLUMNS, summary_rows(result), numbers=(1, 3, 4, 5, 6))
        print()
    if result.errors:
        print_table(ERROR_COLUMNS, error_rows(result), numbers=(2, 3, 4))
        print()
    for name, note in note_rows([check for check in result.checks if check.status != "within"]):
        print(f"{name}: {note}")
    print(verdict(result))


def _write(result: "SuiteResult", markdown: Path | None, junit: Path | None) -> None:
    from armour.reporting.markdown import suite_junit, suite_markdown

    if markdown is not None:
        write(markdown, suite_markdown(result))
    if junit is not None:
        write(junit, suite_junit(result))


def _update(suite: Path, result: "SuiteResult") -> None:
    from armour.reporting.tables import UPDATE_COLUMNS, update_rows
    from armour.validation.validate import updated_text, updates_of

    updates = updates_of(result)
    if not updates:
        print("every expected value is the computed one", file=sys.stderr)
        return
    print_table(UPDATE_COLUMNS, update_rows(updates), numbers=(1, 2), stderr=True)
    write(suite, updated_text(suite.read_text(encoding="utf-8"), updates))
