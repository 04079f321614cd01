"""Commands that answer a question about a scenario, or about many armours like it."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any
from xml.etree.ElementTree import Element

import typer

import armour
from armour.analysis.quantities import ANSWERS, QUANTITIES, VERDICT, WORDS, Answer, reads_of, with_round
from armour.cli import completion, options, runner
from armour.cli.console import progress, say, show, show_json
from armour.cli.folders import scenario_paths
from armour.cli.runner import CSV, PICTURE, Files, answer, check_outputs, read_scenario
from armour.design.against import NO_BASE, Moved, moved
from armour.files import read_json, read_toml, shell_line, shipped_suites
from armour.reporting.junit import junit_xml
from armour.reporting.table import rows_csv
from armour.scenario.inputs import VELOCITY
from armour.scenario.keys import changes_of
from armour.scenario.scenario import scenario_file

SCENARIOS = "Scenario files (TOML), folders of them, or shipped scenarios; - reads standard input."
SUBJECT = "Scenario or suite (TOML), or name of a shipped one; - reads standard input."
AXES = "Key and its values, as MIN:MAX:STEP or V,V,...; repeat for a grid."
NAMES = "Quantities to compute, from the list below; by default the ballistic limit."
ONE_SCENARIO = "must be given with one scenario, not with several or a folder"
BEST = "best.toml"


def simulate(
    scenario: Path = options.SCENARIO,
    history: Path | None = options.file("Write the state over time as CSV."),
    plot: Path | None = options.PLOT,
    velocity: str | None = options.text("Impact velocity, m/s; by default the scenario's.", metavar="NUMBER"),
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
    verbose: bool = options.VERBOSE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Simulate one impact, stage by stage.

    Examples
    --------
    armour simulate wilkins
    armour simulate wilkins --velocity 700 --history run.csv --plot run.svg
    """
    changes = runner.with_change(changes, VELOCITY, velocity)
    loaded = read_scenario(scenario, changes, ANSWERS["simulate"])
    check_outputs((history, CSV), (plot, PICTURE), inputs=[loaded], force=force)
    with progress("impacts") as count:
        result = armour.simulate(loaded, history=history is not None or plot is not None)
        count(1, None)
        confidence = armour.confidence(loaded, on_progress=count)
    # The notes of the confidence include those of the impact.
    notes, extra_data = confidence.notes, {"warnings": confidence.warnings, "confidence": confidence.to_dict()}
    result.of(confidence=confidence)
    files: Files = {history: lambda _: rows_csv(result.history or ())}
    answer(result, loaded, files, notes, plot=plot, extra_data=extra_data, as_json=as_json, verbose=verbose)


def ballistic_limit(
    scenario: Path = options.SCENARIO,
    plot: Path | None = options.PLOT,
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
    verbose: bool = options.VERBOSE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Find the ballistic limit by the model.

    Examples
    --------
    armour ballistic-limit wilkins
    armour ballistic-limit wilkins --set armour.ceramic_thickness_mm=8 --json
    """
    loaded = read_scenario(scenario, changes, ANSWERS["ballistic_limit"])
    check_outputs((plot, PICTURE), inputs=[loaded], force=force)
    with progress("impacts") as count:
        result = armour.ballistic_limit(loaded, on_progress=count)
    answer(result, loaded, plot=plot, as_json=as_json, verbose=verbose)


def compare(
    scenario: Path = options.SCENARIO,
    changes: list[str] | None = options.CHANGES,
    verbose: bool = options.VERBOSE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Compare the model with simpler formulas.

    Examples
    --------
    armour compare wilkins
    """
    loaded = read_scenario(scenario, changes, ANSWERS["compare"])
    with progress("impacts") as count:
        result = armour.compare(loaded, on_progress=count)
    answer(result, loaded, as_json=as_json, verbose=verbose)


def check(
    scenario: list[Path] = options.argument("SCENARIO", SCENARIOS, words=completion.scenarios),
    cases: Path | None = options.file("Table of offers: check the armour of each row in place of the scenario's."),
    sheet: str | None = options.SHEET,
    keep: list[str] | None = options.KEEP,
    junit: Path | None = options.JUNIT,
    csv: Path | None = options.file("Write the limits as CSV, as given and changed, or a row for each offer."),
    markdown: Path | None = options.file("Write the verdicts as Markdown, as for the summary of a CI run."),
    probability: Any = options.PROBABILITY,
    by_model: bool = options.BY_MODEL,
    against: Path | None = options.file(
        "Also list what changed since an earlier check, whose --json output is FILE; exit code 3 if a threat or a "
        "requirement is weaker, one or a scenario is missing, a projectile or what the answer rests on changed, or a "
        "probability is no longer known; not for a lower limit or probability alone."
    ),
    plot: Path | None = options.PLOT,
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
    verbose: bool = options.VERBOSE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Check whether armours or offers stop their threats.

    The answer also says what a thinner layer, a faster round or an angle changes.

    An armour passes if it meets all requirements and a probability is required. The exit code is 0 if it passes, is
    expected to stop every threat or stops each by the model, and 3 otherwise. With several scenarios, a folder or
    offers, there is a line for each, and --json prints an array.

    Examples
    --------
    armour check wilkins --probability 0.9
    armour check wilkins bare_plate --junit check.xml
    armour check wilkins --probability 0.9 --cases offers.csv --keep offer --csv verdicts.csv
    """
    from armour.design.check import CheckResults, check_of
    from armour.design.offers import Offer, read_offers
    from armour.design.requirements import GOOD
    from armour.reporting.formats import markdown_report
    from armour.reporting.views import design as views

    paths = scenario_paths(scenario)
    is_one = cases is None and paths == scenario[:1]  # false for a folder, however many scenarios are in it
    runner.check_options(
        ("--plot", plot and paths != scenario[:1], ONE_SCENARIO),
        ("--cases", cases and paths != scenario[:1], ONE_SCENARIO),
        ("--cases", cases and (plot or against), "cannot be combined with --plot or --against"),
        ("--sheet", sheet and not cases, "needs --cases"),
        ("--keep", keep and not cases, "needs --cases"),
    )

    def read(path: Path) -> armour.Scenario:
        return read_scenario(path, changes, ANSWERS["check"], probability, by_model=by_model)

    with runner.mistakes_in(junit, paths, force=force):
        scenarios = runner.read_each(paths, read)
        table = None if cases is None else read_offers(scenarios[0], cases, keep or (), sheet)
    earlier = None if against is None else read_json(against, NO_BASE)
    inputs = [*scenarios, against, cases]
    check_outputs((markdown, ()), (csv, CSV), (plot, PICTURE), junit=junit, inputs=inputs, force=force)
    offers: Sequence[Offer | None] = [None] * len(scenarios)
    if table is not None:
        runner.say_how_read(cases, table)
        offers, scenarios = table.offers, [offer.scenario for offer in table.offers]
    results: list[armour.CheckResult] = []
    seconds, warnings = list[float](), list[str]()
    with progress("impacts") as count:
        for loaded, offer in zip(scenarios, offers, strict=True):
            start, is_own = perf_counter(), offer is None
            found = check_of(loaded, count, changes=is_own, needed=is_own, offer=offer).of(every_row=verbose)
            results.append(found)
            seconds.append(perf_counter() - start)
            warnings += runner.warnings_of(loaded, found.notes, verbose=verbose) if is_own or verbose else []
    data = [_checked_data(found) for found in results]
    moves = [] if against is None else [*moved(earlier, data, str(against))]
    move_tables = [] if against is None else views.tables_of_moved(moves, str(against))
    if as_json:
        data = data if against is None else _with_moves(data, moves)
        show_json(data[0] if is_one and len(data) == 1 else data)
    else:
        if not is_one:
            show(views.check_summary(results), *views.checks_table(results))
        for found in results if is_one or verbose else ():
            show(*([] if is_one else ["", views.name_of(found)]), *views.tables_of_check(found))
        if move_tables:
            show("", *move_tables)

    def suites() -> Iterator[Element]:
        for loaded, found, taken in zip(scenarios, results, seconds, strict=True):
            yield views.check_junit(found, loaded, taken, runner.origin_of(loaded))
        if against is not None:
            yield views.moved_junit(moves, str(against), runner.origin_of())

    rows = ({"scenario": views.name_of(found), **row} for found in results for row in found)
    files: Files = {
        junit: lambda _: junit_xml(suites()),
        markdown: lambda _: markdown_report(views.check_report(results, move_tables)),
        csv: lambda _: rows_csv(rows if table is None else CheckResults(results).rows()),
        plot: runner.picture(lambda: armour.plot(results[0]), scenarios[0]),
    }
    runner.write(files, warnings)
    if is_one and not as_json:
        command, words = views.next_step(results[0])
        if command:
            typed = runner.repeated(
                command, changes, probability=probability, by_model=by_model and command != "report"
            )
            _propose(command, scenarios[0], typed, words)
        elif words:
            runner.propose(words)
    if any(result.verdict not in GOOD for result in results) or any(move.weaker for move in moves):
        raise typer.Exit(runner.CHECK_FAILED)


def _checked_data(result: "armour.CheckResult") -> dict[str, Any]:
    """Return the check of an armour for --json, with the name and the labels of an offer, if it is one."""
    scenario = result.question["scenario"]
    labelled = {key: result.question[key] for key in ("name", "labels") if key in result.question}
    return {"scenario": scenario.file, **labelled, **result.to_dict(), "made_by": runner.origin_of(scenario)}


def _with_moves(data: Sequence[dict[str, Any]], moves: Sequence[Moved]) -> list[dict[str, Any]]:
    """Return the data of checks, each with what differs from the earlier check, and of scenarios that only that had."""
    found = {each["scenario"]: {**each, "moved": []} for each in data}
    for move in moves:
        found.setdefault(move.scenario, {"scenario": move.scenario, "moved": []})["moved"].append(vars(move))
    return [*found.values()]


def _propose(command: str, scenario: "armour.Scenario", typed: Sequence[str], words: str = "") -> None:
    """Print the command to go on with for a scenario; `typed` are the options given, and `words` stand at its end."""
    if scenario.file != runner.STANDARD_INPUT:
        runner.propose(f"{shell_line(['armour', command, runner.source_word(scenario.file), *typed])} {words}".rstrip())


def optimise(
    scenario: Path = options.SCENARIO,
    csv: Path | None = options.file("Write the Pareto front as CSV, or else the thinnest ceramic for each plate."),
    page: Path | None = options.file("Write an interactive map of all designs, .html.", "--map"),
    save: Path | None = options.file("Write the scenario with the best design as its armour, .toml."),
    changes: list[str] | None = options.CHANGES,
    probability: Any = options.PROBABILITY,
    by_model: bool = options.BY_MODEL,
    plot: Path | None = options.PLOT,
    force: bool = options.FORCE,
    verbose: bool = options.VERBOSE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Find the lightest armour that stops the threats.

    The scenario may define several threats, a catalogue of materials, and a quantity other than weight to minimise.
    Where no design is known to hold, the answer is the nearest one, with its verdict, and the exit code 1.

    Examples
    --------
    armour optimise panel --probability 0.95 --save best.toml
    armour optimise catalogue --plot study.svg --csv front.csv
    """
    from armour.reporting.views.design import design_csv

    loaded = read_scenario(scenario, changes, ANSWERS["optimise"], probability, by_model=by_model)
    check_outputs((page, (".html",)), (save, (".toml",)), (csv, CSV), (plot, PICTURE), inputs=[loaded], force=force)
    with progress("impacts") as count, runner.as_options("optimise"):
        result = armour.optimise(loaded, on_progress=count)
        map_page = "" if page is None else _map_page(result, loaded, changes or (), count)
    fails = result.reason == "none passes"
    saved: Files = {} if fails else {save: lambda path: result.shown.scenario.to_toml(path.parent)}
    files: Files = {csv: lambda _: design_csv(result), page: lambda _: map_page, **saved}
    answer(result, loaded, files, plot=plot, as_json=as_json, verbose=verbose)
    if save is not None and result.reason:
        words = " not written: the nearest design FAILS" if fails else ": not known whether this design holds"
        say(f"{save}{words}")
    if not as_json:
        typed = runner.repeated("optimise", changes, probability=probability, by_model=by_model)
        _propose_after(result, loaded, typed, save)
    if result.reason:
        raise typer.Exit(runner.NO_ANSWER)


def _map_page(
    result: "armour.DesignResult", scenario: "armour.Scenario", changes: Sequence[str], count: Callable[..., None]
) -> str:
    """Return the HTML page with the map of all designs; `changes` are those of ``--set``; `count` shows progress."""
    from armour.design.check import deciding
    from armour.reporting import design_page, words
    from armour.reporting.by_result import in_a_line

    source = "-" if scenario.file == runner.STANDARD_INPUT else runner.source_word(scenario.file)
    command, needed = ["armour", "simulate", source], runner.accepted(changes, ANSWERS["simulate"].reads)
    error = deciding(result.shown.check).model_error
    own_tests = words.tested_here(error) if error else []  # which the page does not show
    return design_page.design_page(scenario, command, needed, count, [in_a_line(result), *own_tests])


def _propose_after(
    result: "armour.DesignResult", scenario: "armour.Scenario", typed: Sequence[str], save: Path | None
) -> None:
    """Print what to go on with after a search: the check of the design saved, or how to save one that holds."""
    from armour.design.check import USUAL_PROBABILITY, what_tells

    verdict, name = result.shown.check.verdict, runner.source_word(save or BEST)
    if result.reason == "none passes":
        runner.propose("offer thicker layers or other materials, or ask for less")
    elif verdict == "expected to stop" and save is None:
        _propose("optimise", scenario, typed, f"--probability {USUAL_PROBABILITY:g} --save {BEST}")
    elif verdict in ("not known", "stopped by the model"):
        saved = f"save the design (--save {name}), fire a V50 of it" if save is None else f"fire a V50 of {name}"
        runner.propose(what_tells(result.shown.check, f"{saved}, then run armour calibrate"))
    else:
        checked = shell_line(["armour", "check", name])
        runner.propose(checked if save else f"add --save {name}, then {checked}")


def sensitivity(
    scenario: Path = options.SCENARIO,
    plot: Path | None = options.PLOT,
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
    verbose: bool = options.VERBOSE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Rank the inputs by their effect on the limit.

    The effects are elasticities: the change of ballistic limit and residual velocity, in per cent, when an input grows
    by 1 %.

    Examples
    --------
    armour sensitivity wilkins --plot sensitivity.svg
    """
    loaded = read_scenario(scenario, changes, ANSWERS["sensitivity"])
    check_outputs((plot, PICTURE), inputs=[loaded], force=force)
    with progress("impacts") as count:
        result = armour.sensitivity(loaded, on_progress=count)
    answer(result, loaded, plot=plot, as_json=as_json, verbose=verbose)


def uncertainty(
    scenario: Path = options.SCENARIO,
    samples: str | None = options.text("Number of samples, at least 128.", metavar="NUMBER"),
    plot: Path | None = options.PLOT,
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
    verbose: bool = options.VERBOSE,
    as_json: bool = options.AS_JSON,
) -> None:
    """Propagate uncertain inputs to the answer.

    Examples
    --------
    armour uncertainty uncertain --plot uncertainty.svg
    """
    changes = runner.with_change(changes, "uncertainty.samples", samples)
    loaded = read_scenario(scenario, changes, ANSWERS["uncertainty"])
    check_outputs((plot, PICTURE), inputs=[loaded], force=force)
    with progress("samples") as count:
        result = armour.uncertainty(loaded, on_progress=count)
    answer(result, loaded, plot=plot, as_json=as_json, verbose=verbose)


def sweep(
    scenario: Path = options.SCENARIO,
    output: Path | None = options.file("Table to write, .csv or .parquet, in place of a few rows.", "--output", "-o"),
    over: list[str] | None = options.text(AXES, metavar="KEY=VALUES", words=completion.axes),
    cases: Path | None = options.file("CSV file of cases, in place of --over: a row each, below the names of keys."),
    sheet: str | None = options.SHEET,
    keep: list[str] | None = options.KEEP,
    quantities: str | None = options.text(NAMES, metavar="NAME,...", words=completion.quantities),
    plot: Path | None = options.PLOT,
    force: bool = options.FORCE,
    scheduler: str = options.text(
        "Compute on the Dask cluster at this address; local starts one.", metavar="ADDRESS", default=""
    ),
    yes: bool = options.flag("Run a sweep even if it takes hours or more disk space than is free.", "--yes"),
    changes: list[str] | None = options.CHANGES,
    as_json: bool = options.AS_JSON,
) -> None:
    """Compute grids and tables of cases; resume if interrupted.

    Examples
    --------
    armour sweep wilkins --over armour.ceramic_thickness_mm=6,8,10,12
    armour sweep wilkins --over armour.ceramic_thickness_mm=4:12:0.1 -o limits.csv --plot limits.svg
    """
    from armour.cli import sweeping
    from armour.sweeps.cases import Grid, axis_of

    asked = sweeping.ANSWERED if output is None else (sweeping.LIMIT,)
    names = [name.strip() for name in quantities.split(",")] if quantities else [*asked]
    reads = with_round(reads_of(name for name in names if name in QUANTITIES))
    loaded = read_scenario(scenario, changes, Answer("the sweep", tuple(reads)))
    if not quantities and output is None and loaded.threat:
        names = [VERDICT]  # the others are against [impact]
    check_outputs((output, ()), (plot, PICTURE), inputs=[loaded, cases], force=force)
    keys = len(over or [])
    runner.check_options(
        ("--over", (cases is None) == (not over), "either --over or --cases must be given, and not both"),
        ("--plot", plot and keys not in (1, 2), f"must be given with one or two --over keys, found {keys or 'none'}"),
        ("--keep", cases is None and keep, "needs --cases"),
        ("--plot", plot and names[0] in WORDS, f"must be given with a number first in --quantities, found {names[0]}"),
        ("--scheduler", scheduler and output is None, "needs -o"),
    )
    with runner.as_options("sweep"):
        source = Grid(tuple(map(axis_of, over or ()))) if cases is None else sweeping.cases_of(cases, sheet, keep or ())
        if output is None:
            sweeping.show_rows(loaded, source, names, plot, as_json=as_json)
        else:
            settings: Any = {"scheduler": scheduler, "replace": force, "yes": yes, "as_json": as_json}
            sweeping.write_and_show(loaded, source, names, output, plot, **settings)


def report(
    source: Path = options.argument("SCENARIO|SUITE", SUBJECT, words=completion.scenarios_and_suites),
    output: Path = typer.Option(
        Path("report.html"), "--output", "-o", metavar="FILE", help="File to write, .html or .md."
    ),
    as_is: bool = options.flag("Report on the scenario's armour even if it asks for a design.", "--as-is"),
    probability: Any = options.PROBABILITY,
    by_model: bool = options.BY_MODEL,
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Write a report of the answer.

    The report is one self-contained file with the answer, its uncertainty, charts (HTML) and the sources of all values.

    Examples
    --------
    armour report panel --probability 0.95 -o report.html
    armour report paper -o suite.html
    """
    from armour.reporting.formats import REPORT_ENDINGS
    from armour.reporting.scenario_report import scenario_report
    from armour.reporting.views.validation import suite_report
    from armour.validation.suite import suite_files

    command = runner.command_line()
    if str(source) != "-":
        source = scenario_file(source, shipped_suites())
    is_suite = str(source) != "-" and {"case", "table"} & read_toml(source).keys()
    if is_suite:
        of_scenario = {"--as-is": as_is, "--probability": probability is not None, "--by-model": by_model}
        runner.check_options(*((*each, "needs a scenario, found a suite") for each in of_scenario.items()))
        suite = armour.load_suite(source, changes_of(changes or ()))
        check_outputs((output, REPORT_ENDINGS), inputs=suite_files(suite), force=force)
        with progress("cases", len(suite.cases)) as count:
            content = suite_report(armour.validate(suite, on_check=lambda _check, _total: count(1)), command)
    else:
        asked = ANSWERS["report --as-is" if as_is else "report"]
        scenario = read_scenario(source, changes, asked, probability, by_model=by_model)
        check_outputs((output, REPORT_ENDINGS), inputs=[scenario], force=force)
        with progress("armours") as count:
            content = scenario_report(scenario, command, count, as_is=as_is)
    runner.write({output: lambda path: runner.page(content, path)})
