"""Commands that answer a question about a scenario."""

from pathlib import Path
from typing import Annotated

from armour.cli.console import progress
from armour.cli.options import AsJson, Changes, Force, PlotFile, ScenarioFile, number, option, probability
from armour.cli.runner import check_outputs, read_scenario, respond, say_if_compiling, warnings_of

# What commands read, see `armour.scenario.reach`.
LIMIT = ("impact.projectile", "armour", "ballistic_limit", "uncertainty.model")


def simulate(
    scenario: ScenarioFile,
    velocity: Annotated[
        float | None,
        option(
            "Impact velocity in place of the scenario's, m/s.",
            "--velocity",
            parser=number("--velocity"),
            metavar="NUMBER",
        ),
    ] = None,
    history: Annotated[Path | None, option("Write the run over time as CSV.", "--history", metavar="FILE")] = None,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Simulate one impact."""
    from armour.analysis import confidence, impact
    from armour.reporting.views import impact as view

    check_outputs(csv=history, plot=plot, force=force)
    reads = ("impact", "armour", "ballistic_limit", "uncertainty.model")
    loaded = read_scenario(
        scenario, changes, reads, {"--velocity": ("impact.velocity_m_s", velocity)}, "the simulated impact"
    )
    with progress("impacts", first="computing") as count:
        result = impact.simulate(loaded, history=history is not None or plot is not None)
        count(1)
        sure = confidence.confidence(loaded, on_progress=count)
    result._of(confidence=sure)
    limit = sure.ballistic_limit_m_s
    of_limit = () if limit is None else loaded.warnings(limit, "ballistic_limit")
    warnings = tuple(dict.fromkeys((*result.warnings, *of_limit)))
    respond(
        {**result.to_dict(), "warnings": list(warnings), "confidence": sure.to_dict()},
        view.tables(result),
        as_json=as_json,
        of=result._heading(),
        files=[(history, lambda: view.csv(result))],
        plot=plot,
        chart=lambda: view.chart(result),
        warnings=warnings_of(loaded, warnings),
    )


def ballistic_limit(
    scenario: ScenarioFile,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Find the ballistic limit."""
    from armour.analysis import ballistic_limit as analysis
    from armour.reporting.views import ballistic_limit as view

    check_outputs(plot=plot, force=force)
    loaded = read_scenario(scenario, changes, LIMIT, what="the ballistic limit")
    with progress("impacts", first="searching") as count:
        result = analysis.ballistic_limit(loaded, on_progress=count)
    respond(
        result.to_dict(),
        view.tables(result),
        as_json=as_json,
        of=result._heading(),
        plot=plot,
        chart=lambda: view.chart(result),
        warnings=warnings_of(loaded, (*analysis.not_monotonic(result), *result.warnings)),
    )


def compare(
    scenario: ScenarioFile,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Compare the model with closed-form formulas."""
    from armour.analysis.ballistic_limit import not_monotonic
    from armour.reporting.views import comparison as view
    from armour.validation import comparison

    check_outputs(plot=plot, force=force)
    loaded = read_scenario(scenario, changes, LIMIT, what="the ballistic limit")
    with progress("impacts", first="searching") as count:
        result = comparison.compare(loaded, on_progress=count)
    respond(
        result.to_dict(),
        view.tables(result),
        as_json=as_json,
        of=result._heading(),
        plot=plot,
        chart=lambda: view.chart(result),
        warnings=warnings_of(loaded, (*not_monotonic(result.limit), *result.limit.warnings)),
    )


def optimise(
    scenario: ScenarioFile,
    refine: Annotated[bool, option("Also find the best design between the values of the grid.", "--refine")] = False,
    confidence: Annotated[
        float | None,
        option(
            "Probability of defeating each threat to design for, such as 0.95.",
            "--confidence",
            parser=probability("--confidence"),
            metavar="PROBABILITY",
        ),
    ] = None,
    csv: Annotated[
        Path | None,
        option("Write the Pareto front or, where none is asked for, the frontier as CSV.", "--csv", metavar="FILE"),
    ] = None,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Find the lightest armour that defeats the threat.

    The scenario may have several threats, a catalogue of materials, and another quantity to minimise.
    """
    from armour.design import optimise as design
    from armour.reporting.views import design as view
    from armour.scenario.reach import DESIGNS

    check_outputs(csv=csv, plot=plot, force=force)
    loaded = read_scenario(
        scenario, changes, DESIGNS, {"--confidence": ("design.confidence", confidence)}, "the design"
    )
    say_if_compiling()
    with progress("impacts") as count:
        result = design.optimise(loaded, refine=refine, on_progress=count)
    respond(
        result.to_dict(),
        view.tables(result),
        as_json=as_json,
        of=result._heading(),
        files=[(csv, lambda: view.csv(result))],
        plot=plot,
        chart=lambda: view.chart(result),
        warnings=warnings_of(loaded, result.warnings, of_threats=True),
    )


def sensitivity(
    scenario: ScenarioFile,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Rank the inputs by their effect on the answers.

    The effects are elasticities: the change of ballistic limit, residual velocity and least areal density, in per cent,
    when an input grows by 1 %.
    """
    from armour.reporting.views import sensitivity as view
    from armour.statistics import sensitivity as statistics

    check_outputs(plot=plot, force=force)
    loaded = read_scenario(scenario, changes, ("impact", "armour", "ballistic_limit", "optimise"))
    say_if_compiling()
    with progress("designs") as count:
        result = statistics.sensitivity(loaded, on_progress=count)
    respond(
        result.to_dict(),
        view.tables(result),
        as_json=as_json,
        of=result._heading(),
        plot=plot,
        chart=lambda: view.chart(result),
        warnings=warnings_of(loaded, result.warnings),
    )


def uncertainty(
    scenario: ScenarioFile,
    samples: Annotated[
        int | None,
        option(
            "Number of samples in place of the scenario's, at least 128.",
            "--samples",
            parser=number("--samples", int),
            metavar="NUMBER",
        ),
    ] = None,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Propagate input uncertainty to the outcome and the ballistic limit."""
    from armour.reporting.views import uncertainty as view
    from armour.statistics import uncertainty as statistics

    check_outputs(plot=plot, force=force)
    loaded = read_scenario(
        scenario,
        changes,
        ("impact", "armour", "ballistic_limit", "uncertainty"),
        {"--samples": ("uncertainty.samples", samples)},
    )
    say_if_compiling()
    with progress("samples") as count:
        result = statistics.uncertainty(loaded, on_progress=count)
    respond(
        result.to_dict(),
        view.tables(result),
        as_json=as_json,
        of=result._heading(),
        plot=plot,
        chart=lambda: view.chart(result),
        warnings=warnings_of(loaded, result.warnings),
    )
