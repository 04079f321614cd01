"""Commands on tests of armours: estimate from them, and plan the next shot."""

from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import typer

import armour
from armour.analysis.quantities import ANSWERS
from armour.cli import completion, options, runner
from armour.cli.console import progress, say
from armour.cli.runner import CSV, PICTURE, Files, answer, check_options, check_outputs, read_scenario, wrong_option
from armour.errors import NoAnswerError, point_hint
from armour.files import WORKBOOKS, parse_toml, shell_line, shipped_tests
from armour.reporting.table import rows_csv
from armour.scenario.inputs import NAMES
from armour.scenario.keys import describe
from armour.scenario.scenario import ANY_VELOCITY, Scenario, parse_scenario

SHOTS = (
    "CSV file with the columns velocity_m_s and result (stopped or perforated, or partial and complete). "
    "`armour init FILE.csv --from tests/shots` writes an example."
)
TESTS = "CSV file of tests. `armour init FILE.csv --from tests/wilkins` writes an example."
FIT = "Input to fit, by default the ceramic's flow stress; repeatable."
WHERE = options.text("Read only rows with this value in a column, as in panel=A; repeatable.", metavar="KEY=VALUE")
IGNORE = options.text("Do not read this column, and count all rows whatever it says; repeatable.", metavar="COLUMN")
EACH = options.text("Give an answer for each value of this column, such as lot.", metavar="COLUMN")
REQUIREMENT_FRACTION = options.share("Fraction that may perforate at the required velocity; by default 0.5, for V50.")
# Options, by the parameters of `plan_shots` that messages about the limits of V50 name.
LIMITS = {
    "scenario": "SCENARIO",
    "limits_m_s": "--lower-m-s, --upper-m-s",
    "limits_m_s[0]": "--lower-m-s",
    "limits_m_s[1]": "--upper-m-s",
}


def v50(
    table: Path = options.argument("SHOTS", SHOTS, words=completion.tables),
    scenario: Path | None = options.OPTIONAL_SCENARIO,
    pairs: Any = options.number("Shots of each kind in the MIL-STD-662F mean; by default the most of 5, 3, 2 allowed."),
    span_m_s: Any = options.number("Greatest span of their velocities, m/s; by default the usual one for 5, 3 or 2."),
    confidence: Any = options.share("Confidence level of the intervals; by default 0.95."),
    prior: bool = options.flag("Add the posterior of V50, whose prior is the scenario's expected limit.", "--prior"),
    at_m_s: Any = options.number("Velocity, m/s, at which to give the probability of complete penetration."),
    fraction: Any = options.share("Fraction of shots for which to give the velocity that perforates; 0.01 gives V01."),
    requirement_m_s: Any = options.number("Required velocity, m/s; the shots decide whether the armour meets it."),
    requirement_fraction: Any = REQUIREMENT_FRACTION,
    csv: Path | None = options.file("Write the fitted curves as CSV."),
    plot: Path | None = options.PLOT,
    report: Path | None = options.file("Write the record of the firing, a page for each lot, as .html or .md."),
    where: list[str] | None = WHERE,
    ignore: list[str] | None = IGNORE,
    each: str | None = EACH,
    sheet: str | None = options.SHEET,
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
    verbose: bool = options.VERBOSE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Estimate V50 from shots.

    If a scenario with the same armour is given, its expected limit, or else its limit by the model, is shown too. With
    a requirement, the exit code is 3 if it is not met or the shots do not decide it or, with --each, if this holds for
    any of the lots.

    Examples
    --------
    armour v50 tests/shots wilkins --plot v50.svg
    """
    from armour.analysis.estimates import CONFIDENCE
    from armour.cli.firings import Choice, each_result
    from armour.reporting.formats import REPORT_ENDINGS
    from armour.reporting.record import firing_report
    from armour.statistics.v50 import compared

    table, scenario = _table_and_scenario(table, scenario)
    check_options(("--set", changes and scenario is None, "needs a scenario"))
    loaded = None if scenario is None else read_scenario(scenario, changes, ANSWERS["v50"])
    outputs = (csv, CSV), (plot, PICTURE), (report, REPORT_ENDINGS)
    check_outputs(*outputs, inputs=[table, loaded], force=force)
    only_one = "cannot be combined with --each"
    check_options(("--csv", csv and each is not None, only_one), ("--plot", plot and each is not None, only_one))
    required = {"requirement_m_s": requirement_m_s, "requirement_fraction": requirement_fraction}
    asked = options.given(**required, confidence=confidence)
    settings = asked | options.given(pairs=pairs, span_m_s=span_m_s, prior=prior, at_m_s=at_m_s, fraction=fraction)
    choice = Choice(chosen(where), ignore or (), sheet)
    with progress("impacts") as count, runner.as_options("v50"):
        estimate: Any = partial(armour.v50, scenario=loaded, on_progress=count, **settings)
        if each is not None:
            parts: Any = each_result(estimate, table, each, choice)
            found: Any = compared(parts.results, parts.unanswered)
            results, unanswered = [*found.results.values()], found.unanswered
        else:
            found = estimate(choice.read(table, one_kind=prior))
            results, unanswered = [found], {}

    files: Files = {
        csv: lambda _: rows_csv(found),
        report: lambda path: runner.page(firing_report(found, runner.command_line()), path),
    }
    answer(found, loaded, files, plot=plot, file=_files_read(table, loaded), as_json=as_json, verbose=verbose)
    if each is None and found.decision == "not decided":
        _propose("plan_shots", table, scenario, changes, {**asked, "where": where, "ignore": ignore, "sheet": sheet})
    elif each is None and loaded is not None and not found.decision and found.bounded_confidence == CONFIDENCE:
        low, high = found.bounded_interval_m_s
        measured = f"{found.recommended.v50_m_s:.0f} ± {0.25 * (high - low):.0f} m/s"
        runner.propose(f"armour calibrate, with this V50 as a test: {measured}")
    if requirement_m_s is not None and (unanswered or any(result.decision != "met" for result in results)):
        raise typer.Exit(runner.CHECK_FAILED)
    if unanswered:
        raise typer.Exit(runner.NO_ANSWER)


def calibrate(
    table: Path = options.argument("TESTS", TESTS, words=completion.tables),
    scenario: Path = options.SCENARIO,
    fit: list[str] | None = options.text(FIT, metavar="INPUT", words=completion.inputs),
    law: str | None = options.text(
        "Law of the flow stress to fit: constant, ceramic, backing, product or linear.",
        metavar="LAW",
        words=lambda: ["constant", "ceramic", "backing", "product", "linear"],
    ),
    library: Path | None = options.file("Write a library file with the fitted entries.", "--write"),
    fitted: Path | None = options.file("Write the scenario with the fitted entries.", "--write-scenario"),
    lot: str | None = options.text("Lot tested, after which written entries are named.", metavar="NAME"),
    csv: Path | None = options.file("Write measured and computed values as CSV."),
    where: list[str] | None = WHERE,
    ignore: list[str] | None = IGNORE,
    sheet: str | None = options.SHEET,
    plot: Path | None = options.PLOT,
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
    verbose: bool = options.VERBOSE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Fit the model to your tests.

    Examples
    --------
    armour calibrate tests/wilkins wilkins --write mine.toml --lot 'lot 7' --plot fit.svg
    armour calibrate tests/wilkins wilkins --law backing --write-scenario fitted.toml --lot 'lot 7'
    """
    from armour.statistics.fitted_library import library_text, scenario_text
    from armour.statistics.own_tests import repeated

    table, scenario = _table_and_scenario(table, scenario)
    loaded = read_scenario(scenario, changes, ANSWERS["calibrate"])
    outputs = (library, ()), (fitted, ()), (csv, CSV), (plot, PICTURE)
    check_outputs(*outputs, inputs=[table, loaded], force=force)
    lot = (lot or "").strip()
    if (not lot) != (library is None and fitted is None):
        raise wrong_option("--lot", "the name of the lot tested; --write and --write-scenario need it, and only they")

    with progress("tests") as count, runner.as_options("calibrate"):
        tests = armour.read_tests(table, loaded, where=chosen(where), sheet=sheet, ignore=ignore or ())
        runner.say_how_read(table, tests)
        result = armour.calibrate(tests, loaded, on_progress=count, **options.given(fit=fit, law=law))
    files: Files = {
        csv: lambda _: rows_csv(result),
        library: lambda _: library_text(result, tests, loaded, lot),
        fitted: lambda path: scenario_text(result, tests, loaded, lot, path),
    }
    if fitted is not None:
        with suppress(NoAnswerError):  # which `answer` raises when it writes the file
            data = parse_toml(scenario_text(result, tests, loaded, lot, fitted), str(fitted))
            now = armour.confidence(parse_scenario(data, file=str(fitted), folder=fitted.parent))
            result.of(before=armour.confidence(loaded), now=now)
    answer(result, loaded, files, plot=plot, file=tests.file, as_json=as_json, verbose=verbose)
    if fitted is not None:
        for role in dict.fromkeys(each.name.partition(".")[0] for each in result.coefficients):
            own, tested = loaded.name_of(role), tests.groups[0].scenario.name_of(role)
            if own != tested:
                say(f"note: {fitted}: {NAMES[role]}: is {tested}, {lot}, as tested, in place of {own}")
        runner.propose(shell_line(["armour", "check", runner.source_word(fitted)]))
    elif result.evidence is not None and library is None and not repeated(tests):
        runner.propose("add --write-scenario fitted.toml --lot 'lot 1'")


def _table_and_scenario(first: Any, second: Any) -> tuple[Any, Any]:
    """Return the paths of a table and a scenario, given in either order; the table is recognised by its name."""
    endings = (".csv", ".tsv", ".txt", ".parquet", *WORKBOOKS)
    is_table = second is not None and (second.suffix.lower() in endings or second.as_posix() in shipped_tests())
    return (second, first) if is_table else (first, second)


def _propose(command: str, table: Any, scenario: Any, changes: list[str] | None, asked: dict[str, Any]) -> None:
    """Print the command to go on with on the same files; `asked` are the options given that its question repeats."""
    files = [runner.source_word(file) for file in (table, scenario) if file]
    if "-" not in files:
        runner.propose(shell_line(["armour", *command.split("_"), *files, *runner.repeated(command, changes, **asked)]))


def _files_read(table: Path | None, scenario: Scenario | None) -> str:
    """Return the names of the files that a command has read, for its warnings."""
    return ", ".join(filter(None, (str(table or ""), scenario.file if scenario else "")))


def chosen(where: list[str] | None) -> dict[str, str]:
    """Return the values by column from the texts "COLUMN=VALUE" of ``--where``."""
    if wrong := [text for text in where or () if "=" not in text]:
        raise wrong_option("--where", f"must be COLUMN=VALUE, found {describe(wrong[0])}")
    return {key.strip(): value.strip() for key, _, value in (text.partition("=") for text in where or ())}


def plan_shots(
    scenario: Path | None = options.OPTIONAL_SCENARIO,
    table: Path | None = options.argument("SHOTS", SHOTS, None, words=completion.tables),
    procedure: str | None = options.text(
        "Rule for the next velocity: bayesian (the default), neyer, langlie or up-and-down.",
        metavar="PROCEDURE",
        words=lambda: ["bayesian", "neyer", "langlie", "up-and-down"],
    ),
    half_width_m_s: Any = options.number("Half width of the interval of V50 that ends the firing, m/s; by default 15."),
    confidence: Any = options.share("Confidence level of the interval, and of the requirement; by default 0.95."),
    requirement_m_s: Any = options.number("Required velocity, m/s; the firing ends once the shots decide on it."),
    requirement_fraction: Any = REQUIREMENT_FRACTION,
    scatter_percent: Any = options.number("Expected scatter, the standard deviation, in % of V50; by default 2.0."),
    scatter_factor: Any = options.number("Geometric standard deviation of the expected scatter; by default 2.0."),
    lower_m_s: Any = options.number("Lower limit of V50, m/s, for langlie and neyer, or without a scenario."),
    upper_m_s: Any = options.number("Upper limit of V50, m/s, for langlie and neyer, or without a scenario."),
    result: str | None = options.text(
        "Result of the shot just fired, stopped or perforated (or P and C): append it to SHOTS.", metavar="RESULT"
    ),
    velocity_m_s: Any = options.number("Measured velocity of this shot, m/s; by default the planned one."),
    undo: bool = options.flag("Take the last shot back from SHOTS.", "--undo"),
    where: list[str] | None = WHERE,
    ignore: list[str] | None = IGNORE,
    each: str | None = EACH,
    sheet: str | None = options.SHEET,
    plot: Path | None = options.PLOT,
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
    verbose: bool = options.VERBOSE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Plan the next shot of a V50 firing.

    The scenario's expected limit is the prior of V50. Without a scenario, V50 is expected
    within the limits given or, without these, within 30 % of the middle of the shots.

    Examples
    --------
    armour plan shots wilkins
    armour plan shots wilkins firing.csv --result complete --plot plan.svg
    armour plan shots wilkins --requirement-m-s 700
    """
    from armour.cli import firings
    from armour.planning.shot_file import locked

    table, scenario = _table_and_scenario(table, scenario)
    check_options(("--set", changes and scenario is None, "needs a scenario"))
    loaded = None if scenario is None else read_scenario(scenario, changes, ANSWERS["plan_shots"])
    is_fired, change = result is not None, "--undo" if result is None else "--result"
    inputs, updated = [loaded, table], table if is_fired or undo else None
    check_outputs((plot, PICTURE), inputs=inputs, updated=updated, force=force)
    needing_table = {"--where": where, "--sheet": sheet, "--each": each, "--result": result, "--undo": undo}
    not_a_number = f"must be a number, found {describe(velocity_m_s)}{point_hint(velocity_m_s)}"
    excluded_by_change = {"--sheet": sheet, "--each": each, "--undo": undo and is_fired}
    check_options(
        ("--lower-m-s, --upper-m-s", (lower_m_s is None) != (upper_m_s is None), "must be given together"),
        *((name, table is None and value, "needs SHOTS") for name, value in needing_table.items()),
        *((name, updated and value, f"cannot be combined with {change}") for name, value in excluded_by_change.items()),
        ("--velocity-m-s", velocity_m_s is not None and not is_fired, "needs --result"),
        ("--velocity-m-s", isinstance(velocity_m_s, str), not_a_number),
        ("--plot", plot and each is not None, "cannot be combined with --each"),
    )
    settings = options.given(procedure=procedure, half_width_m_s=half_width_m_s, confidence=confidence)
    settings |= options.given(requirement_m_s=requirement_m_s, requirement_fraction=requirement_fraction)
    settings |= options.given(scatter_percent=scatter_percent, scatter_factor=scatter_factor)
    settings |= options.given(limits_m_s=None if lower_m_s is None else (lower_m_s, upper_m_s))
    choice = firings.Choice(chosen(where), ignore or (), sheet)
    with locked(updated):
        with progress("impacts") as count, runner.as_options("plan_shots", LIMITS):
            plan = partial(armour.plan_shots, loaded, on_progress=count, **settings)
            planned: Any
            if table is not None and result is not None:
                shot = result, velocity_m_s, "" if loaded is None else loaded.subject(ANY_VELOCITY)
                planned, notes, files = firings.plan_after(plan, table, shot, choice)
            elif table is not None and undo:
                planned, notes, files = firings.plan_without_last(plan, table, choice)
            else:
                planned = firings.next_plan(plan, table, each, choice)
                notes, files = planned.notes, {}
        read = _files_read(table, loaded)
        answer(planned, loaded, files, notes, plot=plot, file=read, as_json=as_json, verbose=verbose)
    if each is not None:
        if planned.unanswered:
            raise typer.Exit(runner.NO_ANSWER)
    elif planned.next_velocity_m_s is None and len({*planned.fired.complete}) == 2:
        asked = {"confidence": confidence, "where": where, "ignore": ignore, "sheet": sheet}
        _propose("v50", table, scenario, changes, asked)
    elif planned.next_velocity_m_s is not None and updated is None:
        shot_words = f"--velocity-m-s {planned.next_velocity_m_s:.0f} --result stopped (or perforated)"
        runner.propose(f"fire, add {'' if table else 'shots.csv '}{shot_words}")
