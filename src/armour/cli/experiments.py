"""Commands on tests of armours: estimates from them, and plans of further tests."""

import shlex
from contextlib import ExitStack
from os.path import exists
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import armour
from armour.cli import completion
from armour.cli.console import say
from armour.cli.question import Answer, Force, PlotFile, argument, number, option, question
from armour.cli.runner import CHECK_FAILED, check_outputs, command_line, read_scenario, wrong_option
from armour.cli.scenario_commands import LIMIT_READS, grid_of
from armour.columns import perforates
from armour.csv_files import MUST_SAY, TableRead
from armour.errors import mistake, restated
from armour.scenario.keys import describe

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from armour.analysis.results import OnProgress
    from armour.scenario.scenario import Scenario
    from armour.sweeps.cases import Cases, Grid

# Sections that a fit reads; its prior is in the distributions.
FIT = ("impact", "armour", "ballistic_limit")
# Fraction by which a measured velocity may miss the planned one without a warning.
FAR_FROM_PLAN = 0.1
Where = Annotated[
    list[str] | None,
    option("Read only the rows with this value in a column, as in panel=A; repeatable.", metavar="KEY=VALUE"),
]
Sheet = Annotated[str | None, option("Sheet of a workbook, by default the first.", metavar="NAME")]
Each = Annotated[bool, option("Give one answer for each value of the column of panels, targets or the like.", "--each")]
LIMITS = {
    "scenario": "SCENARIO",
    "limits_m_s": "--lower-m-s, --upper-m-s",
    "limits_m_s[0]": "--lower-m-s",
    "limits_m_s[1]": "--upper-m-s",
}


@question(LIMIT_READS, computed="the ballistic limit", first="fitting", tables=["csv", "curve"])
def v50(
    on_progress: "OnProgress",
    table: Annotated[
        Path,
        argument(
            "SHOTS",
            'CSV file with the columns velocity_m_s and result ("stopped" or "perforated", or partial and complete). '
            "`armour init FILE.csv --from tests/shots` writes an example.",
            autocompletion=completion.tables,
        ),
    ],
    scenario: "Scenario | None" = None,
    csv: Annotated[Path | None, option("Write the fitted curves as CSV.", metavar="FILE")] = None,
    curve: Annotated[
        Path | None, option("Write the recommended curve with its confidence band as CSV.", metavar="FILE")
    ] = None,
    plot: PlotFile = None,
    where: Where = None,
    each: Each = False,
    sheet: Sheet = None,
    **options: Any,
) -> Answer:
    """Estimate V50 from firing results.

    If a scenario with the same armour is given, its ballistic limit by the model is shown too. With a requirement, the
    exit code is 3 if it is not met or the shots do not decide it.
    """
    from armour.reporting.table import rows_csv

    if each:
        _refuse_with_each({"--csv": csv, "--curve": curve, "--plot": plot})
        firings = _each(table, where, sheet, kinds=1 if options["prior"] else 2)
        results = {name: armour.v50(fired, scenario, on_progress=on_progress, **options) for name, fired in firings}
        codes = [CHECK_FAILED * (result.decision in ("not met", "not decided")) for result in results.values()]
        from armour.analysis.results import EachResult  # imports pydantic, which help does not need

        return Answer(EachResult(results), file=str(table), exit_code=max(codes))
    fired = armour.read_shots(table, one_kind=options["prior"], where=chosen(where), sheet=sheet)
    tell(table, fired.read)
    result = armour.v50(fired, scenario, on_progress=on_progress, **options)
    exit_code = CHECK_FAILED if result.decision in ("not met", "not decided") else 0
    contents = {csv: lambda: rows_csv(result), curve: lambda: rows_csv(result.band())}
    return Answer(result, contents=contents, file="" if scenario else fired.file, exit_code=exit_code)


@question(FIT, unit="tests", prior_reads=["uncertainty"], outputs=["library", "fitted"], tables=["csv"])
def calibrate(
    on_progress: "OnProgress",
    table: Annotated[
        Path,
        argument(
            "TESTS",
            "CSV file of tests. Its columns are test (a name); keys and inputs that differ, such as armour.ceramic; "
            "and measurements: ballistic_limit_m_s, residual_velocity_m_s, residual_mass_g or outcome. "
            "`armour init FILE.csv --from tests/wilkins` writes an example.",
            autocompletion=completion.tables,
        ),
    ],
    scenario: "Scenario",
    library: Annotated[
        Path | None, option("Write a library file with the fitted entries.", "--write", metavar="LIB.toml")
    ] = None,
    fitted: Annotated[
        Path | None,
        option(
            "Write the scenario with the fitted entries and their uncertainty.", "--write-scenario", metavar="FILE.toml"
        ),
    ] = None,
    lot: Annotated[
        str | None, option("Lot tested, after which written entries are named; required with them.", metavar="NAME")
    ] = None,
    csv: Annotated[Path | None, option("Write measured and computed values as CSV.", metavar="FILE")] = None,
    where: Where = None,
    sheet: Sheet = None,
    **options: Any,
) -> Answer:
    """Fit model inputs to tests."""
    from armour.reporting.table import rows_csv
    from armour.statistics.fitted_library import library_text, scenario_text

    lot = (lot or "").strip()
    if (not lot) != (library is None and fitted is None):
        raise wrong_option("--lot", "must be given with --write or --write-scenario, and only then: the lot tested")

    tests = armour.read_tests(table, scenario, where=chosen(where), sheet=sheet)
    tell(table, tests.read)
    result = armour.calibrate(tests, scenario, on_progress=on_progress, **options)
    contents = {
        csv: lambda: rows_csv(result),
        library: lambda: library_text(result, tests, scenario, lot),
        fitted: lambda: None if fitted is None else scenario_text(result, tests, scenario, lot, fitted),
    }
    then = shlex.join(["armour", "check", str(fitted)]) if fitted else ""
    if result.evidence is not None and library is None and fitted is None:
        then = f"{command_line()} --write-scenario fitted.toml --lot 'lot 1'"
    return Answer(result, contents=contents, file=tests.file, then=then)


def chosen(where: list[str] | None) -> dict[str, str]:
    """Return the columns and values of ``--where``."""
    if wrong := [text for text in where or () if "=" not in text]:
        raise wrong_option("--where", f"must be COLUMN=VALUE, found {describe(wrong[0])}")
    return {key.strip(): value.strip() for key, _, value in (text.partition("=") for text in where or ())}


def tell(table: object, read: TableRead | None) -> None:
    """Say how a table was read, unless it is as plain as can be."""
    if read is not None and not read.plain:
        say(f"read {table}: {read.words}")


def _refuse_with_each(options: "Mapping[str, object]") -> None:
    """Refuse options of one answer."""
    for name, value in options.items():
        if value is not None:
            raise wrong_option(name, "must not be given with --each")


def _each(table: Path, where: list[str] | None, sheet: str | None, kinds: int) -> "Iterator[tuple[str, armour.Shots]]":
    """Yield the shots for each value of the column that tells targets apart, by column and value."""
    from armour.statistics.v50 import firings_of

    is_any = False
    for name, value, found in firings_of(table, chosen(where), sheet):
        if found < kinds:
            say(f"note: {table}: {name} {value}: left out, as its shots have only one result")
            continue
        fired = armour.read_shots(table, one_kind=kinds == 1, where={**chosen(where), name: value}, sheet=sheet)
        tell(table, fired.read)
        is_any = True
        yield f"{name} {value}", fired
    if not is_any:
        raise wrong_option("--each", "must be given with shots of both results for one value at least")


def limit_option(end: str) -> Any:
    """Make the option of one end of the range in which V50 is expected."""
    description = f"{end} limit of V50, m/s, for langlie and neyer, or without a scenario."
    return option(description, metavar="NUMBER", parser=number)


@question(LIMIT_READS, first="searching", named=LIMITS)
def plan_shots(
    on_progress: "OnProgress",
    scenario: "Scenario | None" = None,
    table: Annotated[
        Path | None,
        argument(
            "SHOTS",
            "CSV file of the shots so far, with the columns velocity_m_s and result (stopped or perforated).",
            autocompletion=completion.tables,
        ),
    ] = None,
    lower_m_s: Annotated[Any, limit_option("Lower")] = None,
    upper_m_s: Annotated[Any, limit_option("Upper")] = None,
    earlier: Annotated[
        list[Path] | None,
        option(
            "CSV file of an earlier firing at similar armour; its scatter is pooled with the expected one; repeatable.",
            metavar="SHOTS",
            autocompletion=completion.tables,
        ),
    ] = None,
    result: Annotated[
        str | None,
        option(
            "Result of the shot just fired: stopped (or partial, P, PP, no) or perforated (or complete, C, CP, yes); "
            "it is appended to SHOTS.",
            metavar="RESULT",
        ),
    ] = None,
    velocity_m_s: Annotated[
        Any,
        option("Measured velocity of this shot, m/s; by default the planned one.", metavar="NUMBER", parser=number),
    ] = None,
    where: Where = None,
    each: Each = False,
    sheet: Sheet = None,
    plot: PlotFile = None,
    force: Force = False,
    **options: Any,
) -> Answer:
    """Plan the next shot of a V50 firing, given the shots so far.

    The scenario's ballistic limit, with the model error, is the prior of V50. Without a scenario, V50 is expected
    within the limits given or, without these, within 30 % of the middle of the shots.
    """
    if (lower_m_s is None) != (upper_m_s is None):
        raise wrong_option("--upper-m-s" if upper_m_s is None else "--lower-m-s", "must be given with the other limit")
    if isinstance(velocity_m_s, str):
        raise wrong_option("--velocity-m-s", f"must be a number, found {describe(velocity_m_s)}")
    if table is None and (where or each or sheet is not None):
        raise wrong_option("--where" if where else "--each" if each else "--sheet", "must be given with SHOTS")
    options["earlier"] = [armour.read_shots(path) for path in earlier or []]
    for path, firing in zip(earlier or [], options["earlier"], strict=True):
        tell(path, firing.read)
    if lower_m_s is not None:
        options["limits_m_s"] = (lower_m_s, upper_m_s)
    if result is None:
        if velocity_m_s is not None:
            raise wrong_option("--velocity-m-s", "must be given with --result")
        is_new = table is not None and table.suffix == ".csv" and not exists(table)
        if is_new:
            say(f"note: {table}: no such file, so no shot has been fired; --result makes the file")
        if each:
            _refuse_with_each({"--plot": plot})
            firings = _each(table, where, sheet, kinds=1) if table else ()
            plans = {
                name: armour.plan_shots(scenario, fired, on_progress=on_progress, **options) for name, fired in firings
            }
            from armour.analysis.results import EachResult

            return Answer(EachResult(plans))
        fired = None
        if table is not None and not is_new:
            fired = armour.read_shots(table, one_kind=True, where=chosen(where), sheet=sheet)
            tell(table, fired.read)
        return Answer(armour.plan_shots(scenario, fired, on_progress=on_progress, **options))
    if table is None:
        raise wrong_option("--result", "must be given with SHOTS, to which it adds a shot")
    if options["simulate"]:
        raise wrong_option("--result", "must not be given with --simulate: it records a shot that was fired")
    check_outputs(plot=plot, updated=table, force=force)
    if each or sheet is not None:
        raise wrong_option("--result", f"must not be given with {'--each' if each else '--sheet'}")
    return _with_result(scenario, on_progress, table, result, velocity_m_s, chosen(where), options)


def _with_result(
    scenario: "Scenario | None",
    on_progress: "OnProgress",
    table: Path,
    result: str,
    velocity_m_s: float | None,
    where: dict[str, str],
    options: dict[str, Any],
) -> Answer:
    """Plan the next shot after one that is added to the table, which stays locked until it is written."""
    from armour.csv_files import open_table
    from armour.planning.firing import far_from
    from armour.planning.shot_file import content_of, locked, with_shot
    from armour.statistics.v50 import is_of_shots, shots_of

    if perforates(result) is None:
        raise wrong_option("--result", f"{MUST_SAY}, found {describe(result)}")

    with ExitStack() as stack:
        stack.enter_context(locked(table))
        earlier_content = content_of(table)
        fired = armour.Shots((), (), str(table))
        if exists(table):
            fired = armour.read_shots(table, one_kind=True, where=where)
        before = armour.plan_shots(scenario, fired, on_progress=on_progress, **options)
        planned, limit = before.next_velocity_m_s, before.prior.v50_m_s
        velocity = planned if velocity_m_s is None else velocity_m_s
        if velocity is None:
            raise wrong_option("--velocity-m-s", "must be given: no further shot was planned")
        if message := far_from(limit, velocity):
            raise wrong_option("--velocity-m-s", message)
        warnings = []
        if planned is not None and abs(velocity - planned) > FAR_FROM_PLAN * planned:
            warnings.append(
                f"the shot added to {table}, at {velocity:g} m/s, is far from the planned velocity, {planned:g} m/s"
            )
        content = with_shot(table, velocity, result, where)
        fired = shots_of(open_table(table, is_of_shots, content=content), one_kind=True, where=where)
        tell(table, fired.read)
        plan = armour.plan_shots(scenario, fired, on_progress=on_progress, **options)
        if velocity_m_s is None:
            say(f"note: {table}: records the planned {velocity:g} m/s")

        def content_with_shot() -> bytes:
            if content_of(table) != earlier_content:
                raise mistake(table, "", "cannot be written: it has changed since it was read; repeat the command")
            return content

        return Answer(plan, (*warnings, *plan.warnings), contents={table: content_with_shot}, held=stack.pop_all())


@question(FIT, unit="armours", prior_reads=["uncertainty"], named={"designs": "--design"}, tables=["csv"])
def plan_tests(
    scenario: "Scenario",
    on_progress: "OnProgress",
    candidates: Annotated[
        list[str],
        option(
            "Armours available for testing: KEY=MIN:MAX:STEP or KEY=V,V,..., repeated to span a grid; or a CSV file "
            "whose header names keys and, if targets differ in cost, cost.",
            metavar="KEY=VALUES|FILE",
            autocompletion=completion.numbers,
        ),
    ],
    tests: Annotated[
        Path | None,
        option("CSV file of earlier tests.", metavar="FILE", autocompletion=completion.tables),
    ] = None,
    design: Annotated[
        list[Path] | None,
        option(
            "Scenario of the intended design, repeatable; by default SCENARIO.",
            metavar="SCENARIO",
            autocompletion=completion.scenarios,
        ),
    ] = None,
    csv: Annotated[
        Path | None,
        option("Write the earlier tests and the planned ones, to be filled in, as CSV.", metavar="FILE"),
    ] = None,
    **options: Any,
) -> Answer:
    """Choose the armours to test that best determine model inputs, or the ballistic limit of a design."""
    from armour.reporting.table import csv_text
    from armour.reporting.views.planning import form_table

    source = _source(candidates)
    earlier_tests = None if tests is None else armour.read_tests(tests, scenario)
    if earlier_tests is not None:
        tell(tests, earlier_tests.read)
    designs = [read_scenario(path, None, FIT) for path in design or []]
    result = armour.plan_tests(
        scenario, source, tests=earlier_tests, designs=designs, on_progress=on_progress, **options
    )
    return Answer(result, contents={csv: lambda: csv_text(form_table(result))})


def _source(candidates: list[str]) -> "Grid | Cases":
    """Return the candidates."""
    from armour.planning.plan_tests import of_candidates
    from armour.sweeps.cases import Cases

    if all("=" in text for text in candidates):
        with restated(of_candidates):
            return grid_of("--candidates", candidates)
    if len(candidates) > 1:
        raise wrong_option("--candidates", "must be one CSV file, or keys with values")
    [file] = candidates
    if not file.endswith(".csv") and not exists(file):
        raise wrong_option("--candidates", f'must be KEY=VALUES or a CSV file, found "{file}"')
    cases = Cases(file)
    if cases.read:
        say(f"read {file}: {cases.read}")
    return cases
