"""Commands on tests of armours: estimate from them, and plan the next shot."""

from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import typer

import armour
from armour.analysis.quantities import ANSWERS
from armour.cli import completion, runner
from armour.cli.console import progress, say
from armour.cli.options import (
    AS_JSON,
    CHANGES,
    FORCE,
    OPTIONAL_SCENARIO,
    PLOT,
    SCENARIO,
    VERBOSE,
    argument,
    file_option,
    flag,
    given,
    number_option,
    option,
    share,
    word_option,
)
from armour.cli.runner import Files, answer, check_options, check_outputs, read_scenario, say_how_read, wrong_option
from armour.errors import NoAnswerError, point_hint, refuse
from armour.files import WORKBOOKS, parse_toml, shell_line, shipped_tests, wrong_ending
from armour.reporting.table import rows_csv
from armour.scenario.inputs import NAMES
from armour.scenario.keys import describe

WHERE = option("Read only the rows with this value in a column, as in panel=A; repeatable.", metavar="KEY=VALUE")
SHEET = option("Sheet of a workbook, by default the only visible one with a table.", metavar="NAME")
IGNORE = option("Count all rows whatever this column, which is not read, says of them; repeatable.", metavar="COLUMN")
EACH = option(
    "Give one answer for each value of this column, such as lot; v50 says how these differ.", metavar="COLUMN"
)
REQUIREMENT_FRACTION = number_option(
    "Fraction of shots that may perforate at the required velocity, 0.001 to 0.999; 0.5 sets the requirement on V50; "
    "by default 0.5.",
    share,
)
# Options, by the parameters of `plan_shots` that messages about the limits of V50 name.
LIMITS = {
    "scenario": "SCENARIO",
    "limits_m_s": "--lower-m-s, --upper-m-s",
    "limits_m_s[0]": "--lower-m-s",
    "limits_m_s[1]": "--upper-m-s",
}


def v50(
    table: Path = argument(
        "SHOTS",
        'CSV file with the columns velocity_m_s and result ("stopped" or "perforated", or partial and complete). '
        "`armour init FILE.csv --from tests/shots` writes an example.",
        autocompletion=completion.tables,
    ),
    scenario: Path | None = OPTIONAL_SCENARIO,
    pairs: Any = number_option(
        "Number of shots of each kind in the MIL-STD-662F mean, at least 1; by default the greatest of 5, 3 and 2 "
        "whose span is allowed."
    ),
    span_m_s: Any = number_option(
        "Greatest span of their velocities, m/s, at most 10,000; by default the usual one for 5, 3 or 2 shots of "
        "each kind: 38.1, 27.432 or 18.288 (125, 90 or 60 ft/s). Required for other numbers of shots."
    ),
    confidence: Any = number_option("Confidence level of the intervals, 0.5 to 0.9999; by default 0.95.", share),
    prior: bool = flag("Add the posterior of V50, whose prior is the scenario's expected limit.", "--prior"),
    at_m_s: Any = number_option("Velocity, m/s, at which to give the probability of complete penetration."),
    fraction: Any = number_option(
        "Fraction of shots, 0.001 to 0.999, for which to give the velocity at which it perforates; 0.01 gives V01.",
        share,
    ),
    requirement_m_s: Any = number_option(
        "Required velocity, m/s. Whether the armour's velocity exceeds it is decided by the shots alone, "
        "with a risk of about 1 minus the confidence."
    ),
    requirement_fraction: Any = REQUIREMENT_FRACTION,
    csv: Path | None = file_option("Write the fitted curves as CSV."),
    curve: Path | None = file_option("Write the recommended curve with its confidence band as CSV."),
    plot: Path | None = PLOT,
    report: Path | None = file_option("Write the record of the firing, a page for each lot, as .html or .md."),
    where: list[str] | None = WHERE,
    ignore: list[str] | None = IGNORE,
    each: str | None = EACH,
    sheet: str | None = SHEET,
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
    verbose: bool = VERBOSE,
    as_json: bool = AS_JSON,
) -> None:
    """Estimate V50 from shots.

    If a scenario with the same armour is given, its ballistic limit by the model is shown too. With a requirement, the
    exit code is 3 if it is not met or the shots do not decide it, with --each at any panel.

    Examples
    --------
    armour v50 tests/shots wilkins --plot v50.svg
    """
    from armour.analysis.estimates import CONFIDENCE
    from armour.cli.firings import each_result
    from armour.statistics.v50 import compared

    if scenario is not None and is_table(scenario):
        table, scenario = scenario, table
    loaded = _scenario_of(scenario, changes, "v50")
    tables = [csv, curve]
    check_outputs(report, tables=tables, inputs=[table, scenario], scenarios=[loaded], plot=plot, force=force)
    if report is not None:
        from armour.reporting.formats import REPORT_ENDINGS

        refuse(wrong_ending(report, REPORT_ENDINGS))
    options = given(
        pairs=pairs,
        span_m_s=span_m_s,
        confidence=confidence,
        prior=prior,
        at_m_s=at_m_s,
        fraction=fraction,
        requirement_m_s=requirement_m_s,
        requirement_fraction=requirement_fraction,
    )
    files: Files = {}
    with progress("impacts") as count, runner.as_options("v50"):

        def estimate(fired: armour.Shots) -> armour.FiringResult:
            return armour.v50(fired, loaded, on_progress=count, **options)

        if each is not None:
            files_of_one = {"--csv": csv, "--curve": curve, "--plot": plot}
            check_options(*((name, file, "must not be given with --each") for name, file in files_of_one.items()))
            parts: Any = each_result(estimate, table, each, chosen(where), sheet, ignore or ())
            found: Any = compared(parts.results, parts.unanswered)
            results, unanswered, file = [*found.results.values()], found.unanswered, str(table)
        else:
            fired = armour.read_shots(table, one_kind=prior, where=chosen(where), sheet=sheet, ignore=ignore or ())
            found = estimate(say_how_read(table, fired))
            results, unanswered = [found], {}
            file = ", ".join([fired.file, *([loaded.file] if loaded else [])])
            files = {csv: lambda _: rows_csv(found), curve: lambda _: rows_csv(found.band())}
    if report is not None:
        files = {**files, report: lambda path: _record(found, path)}
    answer(found, loaded, files, plot=plot, file=file, as_json=as_json, verbose=verbose)
    if each is None and found.decision == "not decided":
        required = ["--requirement-m-s", f"{requirement_m_s:g}"]
        runner.propose(shell_line(["armour", "plan", "shots", runner.source_word(table), *required]))
    elif each is None and loaded is not None and not found.decision and found.bounded_confidence == CONFIDENCE:
        low, high = found.bounded_interval_m_s
        measured = f"{found.recommended.v50_m_s:.0f} ± {0.25 * (high - low):.0f} m/s"
        runner.propose(f"armour calibrate, with this V50 as a test: {measured}")
    if requirement_m_s is not None and (unanswered or any(result.decision != "met" for result in results)):
        raise typer.Exit(runner.CHECK_FAILED)
    if unanswered:
        raise typer.Exit(runner.NO_ANSWER)


def _record(result: Any, path: Path) -> str:
    """Return the record of a firing as the text of a file."""
    from armour.reporting.formats import report_text
    from armour.reporting.record import firing_report

    if path.suffix.lower() == ".html":
        runner.drawing()
    return report_text(firing_report(result, runner.command_line()), path)


def calibrate(
    table: Path = argument(
        "TESTS",
        "CSV file of tests. Its columns are test (a name); keys and inputs that differ, such as armour.ceramic; "
        "and measurements: ballistic_limit_m_s, residual_velocity_m_s, residual_mass_g or outcome. "
        "`armour init FILE.csv --from tests/wilkins` writes an example.",
        autocompletion=completion.tables,
    ),
    scenario: Path = SCENARIO,
    fit: list[str] | None = option(
        "Input to fit, or several; by default the ceramic's flow stress. Repeatable.",
        metavar="INPUT",
        autocompletion=completion.inputs,
    ),
    law: str | None = word_option(
        "Law of the ceramic's flow stress, whose coefficients are fitted too: constant, ceramic (linear in its "
        "thickness), backing (a power of the back plate's thickness), product (a power of the product of both) or "
        "linear (in both). By default the scenario's law.",
        *("constant", "ceramic", "backing", "product", "linear"),
        metavar="LAW",
    ),
    library: Path | None = file_option("Write a library file with the fitted entries.", "--write", metavar="LIB.toml"),
    fitted: Path | None = file_option(
        "Write the scenario with the fitted entries and their uncertainty.", "--write-scenario", metavar="FILE.toml"
    ),
    lot: str | None = option("Lot tested, after which written entries are named; required with them.", metavar="NAME"),
    csv: Path | None = file_option("Write measured and computed values as CSV."),
    where: list[str] | None = WHERE,
    ignore: list[str] | None = IGNORE,
    sheet: str | None = SHEET,
    plot: Path | None = PLOT,
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
    verbose: bool = VERBOSE,
    as_json: bool = AS_JSON,
) -> None:
    """Fit the model to your tests.

    Examples
    --------
    armour calibrate tests/wilkins wilkins --write mine.toml --lot 'lot 7' --plot fit.svg
    armour calibrate tests/wilkins wilkins --law backing --write-scenario fitted.toml --lot 'lot 7'
    """
    from armour.scenario.scenario import parse_scenario
    from armour.statistics.fitted_library import library_text, scenario_text
    from armour.statistics.own_tests import repeated

    if is_table(scenario):
        table, scenario = scenario, table
    loaded = read_scenario(scenario, changes, ANSWERS["calibrate"])
    check_outputs(library, fitted, tables=[csv], inputs=[table, scenario], scenarios=[loaded], plot=plot, force=force)
    lot = (lot or "").strip()
    if (not lot) != (library is None and fitted is None):
        raise wrong_option("--lot", "must be given with --write or --write-scenario, and only then: the lot tested")

    with progress("tests") as count, runner.as_options("calibrate"):
        tests = armour.read_tests(table, loaded, where=chosen(where), sheet=sheet, ignore=ignore or ())
        say_how_read(table, tests)
        result = armour.calibrate(tests, loaded, on_progress=count, **given(fit=fit, law=law))
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


def is_table(path: Path) -> bool:
    """Return whether a file is a table, by its name; commands accept a table before or after a scenario."""
    return path.suffix.lower() in (".csv", ".tsv", ".txt", ".parquet", *WORKBOOKS) or path.as_posix() in shipped_tests()


def _scenario_of(path: Path | None, changes: list[str] | None, command: str) -> "armour.Scenario | None":
    """Read a scenario for a command, with the changes of ``--set``; return None without a path."""
    if path is not None:
        return read_scenario(path, changes, ANSWERS[command])
    if changes:
        raise wrong_option("--set", "must be given with a scenario")
    return None


def chosen(where: list[str] | None) -> dict[str, str]:
    """Return the values by column from the texts "COLUMN=VALUE" of ``--where``."""
    if wrong := [text for text in where or () if "=" not in text]:
        raise wrong_option("--where", f"must be COLUMN=VALUE, found {describe(wrong[0])}")
    return {key.strip(): value.strip() for key, _, value in (text.partition("=") for text in where or ())}


def plan_shots(
    scenario: Path | None = OPTIONAL_SCENARIO,
    table: Path | None = argument(
        "SHOTS",
        "CSV file of the shots so far, with the columns velocity_m_s and result (stopped or perforated).",
        autocompletion=completion.tables,
        default=None,
    ),
    procedure: str | None = word_option(
        "Rule for the next velocity: bayesian, neyer, langlie or up-and-down; by default bayesian.",
        *("bayesian", "neyer", "langlie", "up-and-down"),
        metavar="PROCEDURE",
    ),
    half_width_m_s: Any = number_option(
        "Half width of the interval of V50 at which the firing ends, 0.1 to 10,000 m/s; by default 15. The "
        "up-and-down rule ends by default as in MIL-STD-662F, with three shots of each kind within 27.432 m/s."
    ),
    confidence: Any = number_option(
        "Confidence level of the interval, and of the requirement, 0.5 to 0.9999; by default 0.95.", share
    ),
    requirement_m_s: Any = number_option(
        "Required velocity, m/s. The Bayesian procedure then ends when the shots show that the requirement is met "
        "or not met, with the consumer's and the producer's risk each at most 1 minus the confidence; the "
        "up-and-down rule starts above it."
    ),
    requirement_fraction: Any = REQUIREMENT_FRACTION,
    scatter_percent: Any = number_option(
        "Expected scatter, the standard deviation of the response curve, 0.01 to 50 % of V50: the median of its "
        "prior, and the initial guess of Neyer's procedure; by default 2.0."
    ),
    scatter_factor: Any = number_option(
        "Factor by which the scatter may differ from the expected one, 1.01 to 10: one standard deviation of its "
        "logarithm; by default 2.0."
    ),
    lower_m_s: Any = number_option("Lower limit of V50, m/s, for langlie and neyer, or without a scenario."),
    upper_m_s: Any = number_option("Upper limit of V50, m/s, for langlie and neyer, or without a scenario."),
    result: str | None = option(
        "Result of the shot just fired: stopped (or partial, P, PP, no) or perforated (or complete, C, CP, yes); "
        "it is appended to SHOTS.",
        metavar="RESULT",
    ),
    velocity_m_s: Any = number_option("Measured velocity of this shot, m/s; by default the planned one."),
    undo: bool = flag("Take the last shot back from SHOTS.", "--undo"),
    where: list[str] | None = WHERE,
    ignore: list[str] | None = IGNORE,
    each: str | None = EACH,
    sheet: str | None = SHEET,
    plot: Path | None = PLOT,
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
    verbose: bool = VERBOSE,
    as_json: bool = AS_JSON,
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

    if scenario is not None and is_table(scenario):
        table, scenario = scenario, table
    loaded = _scenario_of(scenario, changes, "plan_shots")
    check_outputs(inputs=[scenario, table], scenarios=[loaded], plot=plot, force=force)
    is_fired, is_divided = result is not None, each is not None or sheet is not None
    check_options(
        ("--upper-m-s", upper_m_s is None and lower_m_s is not None, "must be given with the other limit"),
        ("--lower-m-s", lower_m_s is None and upper_m_s is not None, "must be given with the other limit"),
        (
            "--velocity-m-s",
            isinstance(velocity_m_s, str),
            f"must be a number, found {describe(velocity_m_s)}{point_hint(velocity_m_s)}",
        ),
        ("--where", table is None and where, "must be given with SHOTS"),
        ("--sheet" if each is None else "--each", table is None and is_divided, "must be given with SHOTS"),
        ("--velocity-m-s", velocity_m_s is not None and not is_fired, "must be given with --result"),
        ("--plot", plot and each is not None and not is_fired, "must not be given with --each"),
        ("--undo", undo and table is None, "must be given with SHOTS, from which it takes a shot back"),
        ("--undo", undo and (is_fired or is_divided), "must be given without --result and the like"),
        ("--result", is_fired and table is None, "must be given with SHOTS, to which it adds a shot"),
        ("--result", is_fired and is_divided, f"must not be given with {'--sheet' if each is None else '--each'}"),
    )
    if is_fired or undo:
        check_outputs(plot=plot, updated=table, force=force)
    options = given(
        procedure=procedure,
        half_width_m_s=half_width_m_s,
        confidence=confidence,
        requirement_m_s=requirement_m_s,
        requirement_fraction=requirement_fraction,
        scatter_percent=scatter_percent,
        scatter_factor=scatter_factor,
        limits_m_s=None if lower_m_s is None else (lower_m_s, upper_m_s),
    )
    with progress("impacts") as count, runner.as_options("plan_shots", LIMITS):
        plan = partial(armour.plan_shots, loaded, on_progress=count, **options)
        files: Files = {}
        planned: Any
        if undo and table is not None:
            planned, notes, files = firings.plan_without_last(plan, table, chosen(where), ignore or ())
        elif result is None or table is None:
            planned = firings.next_plan(plan, table, chosen(where), sheet, ignore or (), each)
            notes = planned.notes
        else:
            from armour.scenario.scenario import ANY_VELOCITY

            target = "" if loaded is None else loaded.subject(ANY_VELOCITY)
            change = (table, result, velocity_m_s, chosen(where), ignore or (), target)
            planned, notes, files = firings.plan_after(plan, *change)
    file = ", ".join([*([str(table)] if table else []), *([loaded.file] if loaded else [])])
    answer(planned, loaded, files, notes, plot=plot, file=file, as_json=as_json, verbose=verbose)
    if each is None and planned.next_velocity_m_s is not None and not is_fired and not undo:
        shot = f"--velocity-m-s {planned.next_velocity_m_s:.0f} --result stopped (or perforated)"
        runner.propose(f"add {'' if table else 'shots.csv '}{shot}")
    elif each is None and planned.next_velocity_m_s is None and table is not None:
        command = ["armour", "v50", runner.source_word(table)]
        runner.propose(shell_line([*command, *([runner.source_word(loaded.file)] if loaded else [])]))
    if each is not None and planned.unanswered:
        raise typer.Exit(runner.NO_ANSWER)
