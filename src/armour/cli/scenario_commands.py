"""Commands that answer a question about a scenario, or about many armours like it."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any
from xml.etree.ElementTree import Element

import typer

import armour
from armour.analysis.quantities import ANSWERS, QUANTITIES, VERDICT, WORDS, Answer, reads_of, with_round
from armour.cli import completion, runner
from armour.cli.console import emit, progress, say, show, show_json
from armour.cli.folders import YES, scenario_paths
from armour.cli.options import (
    AS_JSON,
    BY_MODEL,
    CHANGES,
    CONFIDENCE,
    FORCE,
    KEEP,
    PLOT,
    REQUIRED_PROBABILITY,
    SCENARIO,
    SHEET,
    VERBOSE,
    argument,
    either,
    file_option,
    flag,
    number_option,
    option,
)
from armour.cli.runner import Files, answer, check_outputs, picture, read_scenario, warnings_of, write
from armour.errors import InputError, Problem, refuse
from armour.files import read_json, read_toml, shell_line, shipped_suites, wrong_ending
from armour.reporting.junit import junit_xml
from armour.reporting.table import rows_csv
from armour.scenario.inputs import VELOCITY
from armour.scenario.keys import changes_of, describe

ONE_SCENARIO = "must be given with one scenario, not with several or a folder"
# Longest command that fits on a line of 80 columns after "next: "; name of a file for the best design.
LONGEST_NEXT, BEST = 74, "best.toml"


def simulate(
    scenario: Path = SCENARIO,
    history: Path | None = file_option("Write the state over time as CSV."),
    plot: Path | None = PLOT,
    velocity: Any = number_option("Impact velocity, m/s; by default the scenario's."),
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
    verbose: bool = VERBOSE,
    as_json: bool = AS_JSON,
) -> None:
    """Simulate one impact, stage by stage.

    Examples
    --------
    armour simulate wilkins
    armour simulate wilkins --velocity 700 --history run.csv --plot run.svg
    """
    from armour.reporting.views.analysis import history_csv

    settings = {"--velocity": (VELOCITY, velocity)}
    loaded = read_scenario(scenario, changes, ANSWERS["simulate"], settings)
    check_outputs(tables=[history], inputs=[scenario], scenarios=[loaded], plot=plot, force=force)
    with progress("impacts") as count:
        result = armour.simulate(loaded, history=history is not None or plot is not None)
        count(1, None)
        confidence = armour.confidence(loaded, on_progress=count)
    notes = tuple(dict.fromkeys((*result.notes, *confidence.notes)))
    extra_data = {"warnings": list(map(str, notes)), "confidence": confidence.to_dict()}
    result.of(confidence=confidence)
    files: Files = {history: lambda _: history_csv(result)}
    answer(result, loaded, files, notes, plot=plot, extra_data=extra_data, as_json=as_json, verbose=verbose)


def ballistic_limit(
    scenario: Path = SCENARIO,
    plot: Path | None = PLOT,
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
    verbose: bool = VERBOSE,
    as_json: bool = AS_JSON,
) -> None:
    """Find the ballistic limit by the model.

    Examples
    --------
    armour ballistic-limit wilkins
    armour ballistic-limit wilkins --set armour.ceramic_thickness_mm=8 --json
    """
    loaded = read_scenario(scenario, changes, ANSWERS["ballistic_limit"])
    check_outputs(inputs=[scenario], scenarios=[loaded], plot=plot, force=force)
    with progress("impacts") as count:
        result = armour.ballistic_limit(loaded, on_progress=count)
    answer(result, loaded, plot=plot, as_json=as_json, verbose=verbose)


def compare(
    scenario: Path = SCENARIO,
    plot: Path | None = PLOT,
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
    verbose: bool = VERBOSE,
    as_json: bool = AS_JSON,
) -> None:
    """Compare the model with simpler formulas.

    Examples
    --------
    armour compare wilkins
    """
    loaded = read_scenario(scenario, changes, ANSWERS["compare"])
    check_outputs(inputs=[scenario], scenarios=[loaded], plot=plot, force=force)
    with progress("impacts") as count:
        result = armour.compare(loaded, on_progress=count)
    answer(result, loaded, plot=plot, as_json=as_json, verbose=verbose)


def check(
    scenario: list[Path] = argument(
        "SCENARIO",
        "Scenario files (TOML), folders with scenarios in them or below, or names of shipped scenarios; - reads "
        "standard input.",
        autocompletion=completion.scenarios,
    ),
    cases: Path | None = file_option(
        "Table of offers: check, in place of the armour of the scenario, that of each row: ceramic, metal, their "
        "thicknesses and the price per m².",
    ),
    sheet: str | None = SHEET,
    keep: list[str] | None = KEEP,
    junit: Path | None = file_option("Write the results as JUnit XML; such a file is replaced."),
    csv: Path | None = file_option("Write the limits as CSV, as given and with each change, or a row for each offer."),
    markdown: Path | None = file_option("Write the verdicts as Markdown, as for the summary of a CI run."),
    probability: Any = REQUIRED_PROBABILITY,
    confidence: Any = CONFIDENCE,
    by_model: bool = BY_MODEL,
    against: Path | None = file_option(
        "Also list what moved since an earlier check of the same scenarios, whose --json this file has; exit code 3 if "
        "a requirement or threat is weaker or missing, or if [uncertainty], own tests or own materials changed."
    ),
    plot: Path | None = PLOT,
    yes: bool = YES,
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
    verbose: bool = VERBOSE,
    as_json: bool = AS_JSON,
) -> None:
    """Does an armour stop its threats? Also several, or offers.

    The answer also says what a thinner layer, a faster round or an angle changes.

    An armour passes if it has all that is required, a probability among it. The exit code is 0 if it passes, is
    expected to stop every threat or stops it by the model, and 3 otherwise. With several scenarios, a folder or offers,
    there is a line for each, and --json prints an array.

    Examples
    --------
    armour check wilkins --probability 0.9
    armour check wilkins bare_plate --junit check.xml
    armour check wilkins --probability 0.9 --cases offers.csv --keep offer --csv verdicts.csv
    """
    from armour.design.against import moved
    from armour.design.check import CheckResults, check_of
    from armour.design.offers import Offer, read_offers
    from armour.design.requirements import GOOD
    from armour.reporting.formats import markdown_report
    from armour.reporting.views import design as views

    paths = scenario_paths(scenario, yes=yes)
    is_one = cases is None and paths == scenario[:1]  # false for a folder, however many scenarios are in it
    runner.check_options(
        *(
            (name, value and paths != scenario[:1], ONE_SCENARIO)
            for name, value in (("--plot", plot), ("--cases", cases))
        ),
        ("--cases", cases and (plot or against), "must be given without --plot and --against"),
        ("--sheet", sheet and not cases, "must be given with --cases"),
        ("--keep", keep and not cases, "must be given with --cases"),
    )
    with runner.mistakes_in(junit, paths, force=force):
        scenarios = _read_each(paths, changes, either(probability, confidence), by_model=by_model)
        table = None if cases is None else read_offers(scenarios[0], cases, keep or (), sheet)
    earlier = None if against is None else read_json(against)
    inputs = [*paths, against, cases]
    check_outputs(markdown, tables=[csv], junit=junit, inputs=inputs, scenarios=scenarios, plot=plot, force=force)
    offers: Sequence[Offer | None] = [None] * len(scenarios) if table is None else table.offers
    if table is not None:
        scenarios = [offer.scenario for offer in table.offers]
        say(*[f"read {cases}: {table.read.words}"] * (not table.read.plain))
    results: list[armour.CheckResult] = []
    seconds, warnings = list[float](), list[str]()
    with progress("impacts") as count:
        for loaded, offer in zip(scenarios, offers, strict=True):
            start, is_own = perf_counter(), offer is None
            found = check_of(loaded, count, changes=is_own, needed=is_own, offer=offer).of(every_row=verbose)
            results.append(found)
            seconds.append(perf_counter() - start)
            warnings += warnings_of(loaded, found.notes, verbose=verbose) if is_own or verbose else []
    data = [_checked_data(found) for found in results] if as_json or against is not None else []
    moves = [] if against is None else [*moved(earlier, data, str(against))]
    of_moved = [] if against is None else views.tables_of_moved(moves, str(against))
    if as_json:
        if against is not None:
            by_scenario = {
                move.scenario: [vars(other) for other in moves if other.scenario == move.scenario] for move in moves
            }
            data = [{**each, "moved": by_scenario.pop(each["scenario"], [])} for each in data]
            data += [{"scenario": missing, "moved": found} for missing, found in by_scenario.items()]
        show_json(data[0] if is_one and len(data) == 1 else data)
    else:
        if not is_one:
            show(views.check_summary(results), *views.checks_table(results))
        for found in results if is_one or verbose else ():
            show(*([] if is_one else ["", views.name_of(found)]), *views.tables_of_check(found))
        if of_moved:
            emit("\n")
            show(*of_moved)

    def suites() -> Iterator[Element]:
        for loaded, found, taken in zip(scenarios, results, seconds, strict=True):
            yield views.check_junit(found, loaded, taken, runner.origin_of(loaded))
        if against is not None:
            yield views.moved_junit(moves, str(against), runner.origin_of())

    def rows() -> list[dict[str, object]]:
        if table is not None:
            return CheckResults(results).rows()
        return [{"scenario": views.name_of(found), **row} for found in results for row in found]

    files: Files = {
        junit: lambda _: junit_xml(suites()),
        markdown: lambda _: markdown_report(views.check_report(results, of_moved)),
        csv: lambda _: rows_csv(rows()),
        plot: picture(lambda: armour.plot(results[0]), scenarios[0]),
    }
    write(files, warnings)
    if is_one and not as_json:
        command, words = views.next_step(results[0])
        if command:
            typed = _typed(command, changes, either(probability, confidence), by_model=by_model and command != "report")
            _propose(command, scenarios[0], typed, words)
        else:
            runner.propose(words)
    if any(result.verdict not in GOOD for result in results) or any(move.weaker for move in moves):
        raise typer.Exit(runner.CHECK_FAILED)


def _checked_data(result: "armour.CheckResult") -> dict[str, Any]:
    """Return the check of an armour as plain data, with the name and the labels of an offer."""
    scenario, offer = result.question["scenario"], {"name", "labels"} & result.question.keys()
    labelled = {key: result.question[key] for key in sorted(offer, reverse=True)}
    return {"scenario": scenario.file, **labelled, **result.to_dict(), "made_by": runner.origin_of(scenario)}


def _propose(command: str, scenario: "armour.Scenario", typed: Sequence[str], words: str = "") -> None:
    """Print the command to go on with for a scenario; `typed` are the options given, and `words` stand at its end.

    Where the line would be too long to copy, it says that the options stay.
    """
    if scenario.file == runner.STANDARD_INPUT:
        return
    source = runner.source_word(scenario.file)
    line = f"{shell_line(['armour', command, source, *typed])} {words}".rstrip()
    longer = " ".join(filter(None, ("armour", command, words, "with the same scenario and options")))
    runner.propose(line if len(line) <= LONGEST_NEXT else longer)


def _typed(command: str, changes: Sequence[str] | None, probability: Any, *, by_model: bool) -> list[str]:
    """Return the options given as words of another command, without changes that it does not read."""
    asked = [] if probability is None else ["--probability", f"{probability:g}"]
    return [
        *asked,
        *["--by-model"] * by_model,
        *runner.set_options(runner.accepted(changes or (), ANSWERS[command].reads)),
    ]


def _read_each(
    paths: Sequence[Path], changes: Sequence[str] | None, probability: Any, *, by_model: bool
) -> list["armour.Scenario"]:
    """Read the scenarios of a check, and raise one error with the mistakes in all of them.

    `changes` are those of ``--set``, `probability` and `by_model` the values of these options.
    """
    scenarios: list[armour.Scenario] = []
    problems: list[Problem] = []
    for path in paths:
        try:
            scenarios.append(read_scenario(path, changes, ANSWERS["check"], probability=probability, by_model=by_model))
        except InputError as error:
            problems += error.problems
    refuse(dict.fromkeys(problems))
    return scenarios


def optimise(
    scenario: Path = SCENARIO,
    csv: Path | None = file_option(
        "Write the Pareto front as CSV or, without one, the thinnest ceramic for each back plate."
    ),
    page: Path | None = file_option("Write an interactive map of all designs, .html.", "--map"),
    save: Path | None = file_option("Write the scenario with the best design as its armour, .toml."),
    changes: list[str] | None = CHANGES,
    probability: Any = REQUIRED_PROBABILITY,
    confidence: Any = CONFIDENCE,
    by_model: bool = BY_MODEL,
    plot: Path | None = PLOT,
    force: bool = FORCE,
    verbose: bool = VERBOSE,
    as_json: bool = AS_JSON,
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

    asked = either(probability, confidence)
    loaded = read_scenario(scenario, changes, ANSWERS["optimise"], probability=asked, by_model=by_model)
    check_outputs(page, save, tables=[csv], inputs=[scenario], scenarios=[loaded], plot=plot, force=force)
    for output, ending in ((page, ".html"), (save, ".toml")):
        refuse([] if output is None else wrong_ending(output, (ending,)))
    source = "-" if loaded.file == runner.STANDARD_INPUT else runner.source_word(loaded.file)
    with progress("impacts") as count, runner.as_options("optimise"):
        result = armour.optimise(loaded, on_progress=count)
        map_page = "" if page is None else _map(result, loaded, source, changes or (), count)
    fails = result.reason == "none passes"
    saved: Files = {} if fails else {save: lambda path: result.shown.scenario.to_toml(path.parent)}
    files: Files = {csv: lambda _: design_csv(result), page: lambda _: map_page, **saved}
    answer(result, loaded, files, plot=plot, as_json=as_json, verbose=verbose)
    if save is not None and result.reason:
        say(
            f"{save} not written: the nearest design FAILS" if fails else f"{save}: not known whether this design holds"
        )
    if not as_json:
        _propose_after(result, loaded, _typed("optimise", changes, asked, by_model=by_model), save)
    if result.reason:
        raise typer.Exit(runner.NO_ANSWER)


def _map(
    result: "armour.DesignResult",
    scenario: "armour.Scenario",
    source: str,
    changes: Sequence[str],
    on_progress: Callable[[int, int | None], None],
) -> str:
    """Return the HTML page with the map of all designs.

    `source` is the scenario as a word of a command line, and `changes` are those of ``--set``.
    """
    from armour.design.check import deciding
    from armour.reporting import design_page, words
    from armour.reporting.by_result import in_a_line

    command, needed = ["armour", "simulate", source], runner.accepted(changes, ANSWERS["simulate"].reads)
    error = deciding(result.shown.check).model_error
    own_tests = words.tested_here(error) if error else []  # which the page does not show
    return design_page.design_page(scenario, command, needed, on_progress, [in_a_line(result), *own_tests])


def _propose_after(
    result: "armour.DesignResult", scenario: "armour.Scenario", typed: Sequence[str], save: Path | None
) -> None:
    """Print what to go on with after a search: the check of the design saved, or how to save one that holds."""
    from armour.design.check import USUAL_PROBABILITY

    verdict, name = result.shown.check.verdict, runner.source_word(save or BEST)
    if result.reason == "none passes":
        runner.propose("offer thicker layers or other materials, or ask for less")
    elif verdict == "expected to stop" and save is None:
        _propose("optimise", scenario, typed, f"--probability {USUAL_PROBABILITY:g} --save {BEST}")
    elif verdict in ("not known", "stopped by the model") and scenario.excludes_error():
        runner.propose("without --by-model or uncertainty.model.included = false, tests may tell")
    elif verdict in ("not known", "stopped by the model"):
        runner.propose(f"a V50 of {name} decides: armour calibrate" + f" (--save {name})" * (save is None))
    else:
        checked = shell_line(["armour", "check", name])
        runner.propose(checked if save else f"add --save {name}, then {checked}")


def sensitivity(
    scenario: Path = SCENARIO,
    plot: Path | None = PLOT,
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
    verbose: bool = VERBOSE,
    as_json: bool = AS_JSON,
) -> None:
    """Rank the inputs by their effect on the limit.

    The effects are elasticities: the change of ballistic limit and residual velocity, in per cent, when an input grows
    by 1 %.

    Examples
    --------
    armour sensitivity wilkins --plot sensitivity.svg
    """
    loaded = read_scenario(scenario, changes, ANSWERS["sensitivity"])
    check_outputs(inputs=[scenario], scenarios=[loaded], plot=plot, force=force)
    with progress("impacts") as count:
        result = armour.sensitivity(loaded, on_progress=count)
    answer(result, loaded, plot=plot, as_json=as_json, verbose=verbose)


def uncertainty(
    scenario: Path = SCENARIO,
    samples: Any = number_option("Number of samples, at least 128; by default the scenario's."),
    plot: Path | None = PLOT,
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
    verbose: bool = VERBOSE,
    as_json: bool = AS_JSON,
) -> None:
    """Propagate uncertain inputs to the answer.

    Examples
    --------
    armour uncertainty uncertain --plot uncertainty.svg
    """
    loaded = read_scenario(scenario, changes, ANSWERS["uncertainty"], {"--samples": ("uncertainty.samples", samples)})
    check_outputs(inputs=[scenario], scenarios=[loaded], plot=plot, force=force)
    with progress("samples") as count:
        result = armour.uncertainty(loaded, on_progress=count)
    answer(result, loaded, plot=plot, as_json=as_json, verbose=verbose)


def sweep(
    scenario: Path = SCENARIO,
    output: Path | None = file_option(
        "Table to write, .csv or .parquet; without it, the first rows are printed and none are kept.",
        "--output",
        "-o",
    ),
    over: list[str] | None = option(
        "Key and its values, as MIN:MAX:STEP or V,V,...; repeat to span a grid.",
        metavar="KEY=VALUES",
        autocompletion=completion.numbers,
    ),
    cases: Path | None = file_option(
        "CSV file of cases, in place of --over: the header names the keys, such as armour.ceramic, and each row "
        "gives their values, such as SiC."
    ),
    sheet: str | None = SHEET,
    keep: list[str] | None = KEEP,
    quantities: str | None = option(
        "Quantities to compute, from the list below; by default the ballistic limit or, without -o, limits, "
        "probability and verdict.",
        metavar="NAME,...",
        autocompletion=completion.quantities,
    ),
    plot: Path | None = PLOT,
    force: bool = FORCE,
    threads: Any = number_option("Threads, at least 1; by default one per core."),
    scheduler: str = option(
        'Compute on the Dask cluster at this address; "local" starts one on this machine.',
        metavar="ADDRESS",
        default="",
    ),
    yes: bool = flag("Run a sweep even if it takes hours or more disk space than is free.", "--yes"),
    changes: list[str] | None = CHANGES,
    as_json: bool = AS_JSON,
) -> None:
    """Compute grids and tables of cases; resume if interrupted.

    Examples
    --------
    armour sweep wilkins --over armour.ceramic_thickness_mm=6,8,10,12
    armour sweep wilkins --over armour.ceramic_thickness_mm=4:12:0.1 -o limits.csv --plot limits.svg
    """
    from armour.cli import sweeping

    asked = sweeping.ANSWERED if output is None else (sweeping.LIMIT,)
    names = [name.strip() for name in quantities.split(",")] if quantities else [*asked]
    reads = with_round(reads_of(name for name in names if name in QUANTITIES))
    loaded = read_scenario(scenario, changes, Answer("the sweep", tuple(reads)))
    if not quantities and output is None and loaded.threat:
        names = [VERDICT]  # the others are against [impact]
    check_outputs(output, inputs=[scenario, cases], scenarios=[loaded], plot=plot, force=force)
    keys, is_count = len(over or []), threads is None or (type(threads) is int and threads > 0)
    runner.check_options(
        ("--over", (cases is None) == (not over), "must be given, or --cases, but not both"),
        ("--threads", not is_count, f"must be a whole number of at least 1, found {describe(threads)}"),
        ("--plot", plot and keys not in (1, 2), f"must be given with one or two --over keys, found {keys or 'none'}"),
        ("--keep", cases is None and keep, "must be given with --cases"),
        ("--plot", plot and names[0] in WORDS, f"must be given with a number first in --quantities, found {names[0]}"),
        ("--scheduler", scheduler and output is None, "must be given with -o"),
    )
    with runner.as_options("sweep"):
        source = sweeping.grid_of(over or []) if cases is None else sweeping.cases_of(cases, sheet, keep or ())
        if output is None:
            sweeping.show_rows(loaded, source, names, plot, threads=threads, as_json=as_json)
            return
        options: Any = {"scheduler": scheduler, "threads": threads, "replace": force, "yes": yes, "as_json": as_json}
        sweeping.write_and_show(loaded, source, names, output, plot, **options)


def report(
    source: Path = argument(
        "SCENARIO|SUITE",
        "Scenario or suite file (TOML), or name of a shipped one; - reads a scenario from standard input.",
        autocompletion=completion.scenarios_and_suites,
    ),
    output: Path = typer.Option(
        Path("report.html"), "--output", "-o", metavar="FILE", help="File to write, .html or .md."
    ),
    as_is: bool = flag("Report on the scenario's own armour even if the scenario asks for a design.", "--as-is"),
    probability: Any = REQUIRED_PROBABILITY,
    confidence: Any = CONFIDENCE,
    by_model: bool = BY_MODEL,
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
) -> None:
    """Write the answer as a page to hand over.

    The report is one self-contained file with the answer, its uncertainty, charts (HTML) and the sources of all values.

    Examples
    --------
    armour report panel --probability 0.95 -o report.html
    armour report paper -o suite.html
    """
    from armour.reporting import formats, scenario_report
    from armour.reporting.views.validation import suite_report
    from armour.scenario.scenario import files_of, scenario_file
    from armour.validation.suite import suite_files

    probability = either(probability, confidence)
    required = [] if probability is None else ["--probability", str(probability)]
    changes = changes or []
    command = runner.command_line()
    set_words = runner.set_options(runner.accepted(changes, ANSWERS["optimise"].reads))
    optimise_words = ["armour", "optimise", runner.source_word(source), *required, *set_words]
    map_command = shell_line([*optimise_words, "--map", "map.html"])
    if str(source) != "-":
        source = scenario_file(source, shipped_suites())
    is_suite = str(source) != "-" and {"case", "table"} & read_toml(source).keys()
    runner.check_options(
        ("--as-is", is_suite and as_is, "must be given with a scenario, found a suite"),
        ("--probability", is_suite and required, "must be given with a scenario, found a suite"),
        ("--by-model", is_suite and by_model, "must be given with a scenario, found a suite"),
    )
    if is_suite:
        suite = armour.load_suite(source, changes_of(changes))
        inputs = suite_files(suite)
    else:
        asked = ANSWERS["report --as-is" if as_is else "report"]
        scenario = read_scenario(source, changes, asked, probability=probability, by_model=by_model)
        inputs = [source, *files_of(scenario)]
    check_outputs(output, inputs=inputs, force=force)
    refuse(wrong_ending(output, formats.REPORT_ENDINGS))
    if is_suite:
        with progress("cases", len(suite.cases)) as count:
            content = suite_report(armour.validate(suite, on_check=lambda _check, _total: count(1)), command)
    else:
        with progress("armours") as count:
            content = scenario_report.scenario_report(scenario, command, count, as_is=as_is, map_command=map_command)
    if output.suffix.lower() == ".html":
        runner.drawing()
    write({output: lambda path: formats.report_text(content, path)})
