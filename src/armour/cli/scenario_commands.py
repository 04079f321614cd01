"""Commands that answer a question about a scenario."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from armour.analysis.quantities import DESIGNS
from armour.cli.console import progress
from armour.cli.options import AsJson, Changes, Force, PlotFile, ScenarioFile, number, option, probability, setting
from armour.cli.question import question
from armour.cli.runner import check_outputs, read_scenario, respond, warnings_of

if TYPE_CHECKING:
    from armour.analysis.progress import OnProgress
    from armour.scenario.scenario import Scenario

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


@question(*LIMIT, what="the ballistic limit", first="searching")
def ballistic_limit(scenario: "Scenario", on_progress: "OnProgress") -> tuple[Any, Sequence[str]]:
    """Find the ballistic limit."""
    from armour.analysis import ballistic_limit as analysis

    result = analysis.ballistic_limit(scenario, on_progress=on_progress)
    return result, (*analysis.not_monotonic(result), *result.warnings)


@question(*LIMIT, what="the ballistic limit", first="searching")
def compare(scenario: "Scenario", on_progress: "OnProgress") -> tuple[Any, Sequence[str]]:
    """Compare the model with closed-form formulas."""
    from armour.analysis.ballistic_limit import not_monotonic
    from armour.validation import comparison

    result = comparison.compare(scenario, on_progress=on_progress)
    return result, (*not_monotonic(result.limit), *result.limit.warnings)


@question(
    *DESIGNS,
    what="the design",
    csv_help="Write the Pareto front or, where none is asked for, the frontier as CSV.",
    of_threats=True,
    confidence=(
        "design.confidence",
        setting(
            "Probability of defeating each threat to design for, such as 0.95.",
            probability("--confidence"),
            metavar="PROBABILITY",
        ),
    ),
)
def optimise(
    scenario: "Scenario",
    on_progress: "OnProgress",
    *,
    refine: Annotated[bool, option("Also find the best design between the values of the grid.", "--refine")] = False,
) -> tuple[Any, Sequence[str]]:
    """Find the lightest armour that defeats the threat.

    The scenario may have several threats, a catalogue of materials, and another quantity to minimise.
    """
    from armour.design import optimise as design

    result = design.optimise(scenario, refine=refine, on_progress=on_progress)
    return result, result.warnings


@question("impact", "armour", "ballistic_limit", "optimise", unit="designs")
def sensitivity(scenario: "Scenario", on_progress: "OnProgress") -> tuple[Any, Sequence[str]]:
    """Rank the inputs by their effect on the answers.

    The effects are elasticities: the change of ballistic limit, residual velocity and least areal density, in per cent,
    when an input grows by 1 %.
    """
    from armour.statistics import sensitivity as statistics

    result = statistics.sensitivity(scenario, on_progress=on_progress)
    return result, result.warnings


@question(
    "impact",
    "armour",
    "ballistic_limit",
    "uncertainty",
    unit="samples",
    samples=(
        "uncertainty.samples",
        setting("Number of samples in place of the scenario's, at least 128.", number("--samples", int)),
    ),
)
def uncertainty(scenario: "Scenario", on_progress: "OnProgress") -> tuple[Any, Sequence[str]]:
    """Propagate input uncertainty to the outcome and the ballistic limit."""
    from armour.statistics import uncertainty as statistics

    result = statistics.uncertainty(scenario, on_progress=on_progress)
    return result, result.warnings
