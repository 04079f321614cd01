"""Commands that answer a question about a scenario."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import armour
from armour.analysis.quantities import DESIGNS
from armour.cli.options import Output, PlotFile, option
from armour.cli.question import Answer, question

if TYPE_CHECKING:
    from armour.analysis.progress import OnProgress
    from armour.scenario.scenario import Scenario

# What commands read, see `armour.scenario.reach`.
LIMIT = ("impact.projectile", "armour", "ballistic_limit", "uncertainty.model")


@question(
    *("impact", "armour", "ballistic_limit", "uncertainty.model"),
    what="the simulated impact",
    first="computing",
    velocity=("impact.velocity_m_s", "Impact velocity in place of the scenario's, m/s."),
)
def simulate(
    scenario: "Scenario",
    on_progress: "OnProgress",
    history: Annotated[Path | None, option("Write the run over time as CSV.", metavar="FILE"), Output.TABLE] = None,
    plot: PlotFile = None,
) -> Answer:
    """Simulate one impact."""
    result = armour.simulate(scenario, history=history is not None or plot is not None)
    on_progress(1, None)
    sure = armour.confidence(scenario, on_progress=on_progress)
    limit = sure.ballistic_limit_m_s
    of_limit = () if limit is None else scenario.warnings(limit, "ballistic_limit")
    warnings = tuple(dict.fromkeys((*result.warnings, *of_limit)))
    more = {"warnings": list(warnings), "confidence": sure.to_dict()}
    return Answer(result._of(confidence=sure), warnings, more)


@question(*LIMIT, what="the ballistic limit", first="searching")
def ballistic_limit(scenario: "Scenario", on_progress: "OnProgress") -> Answer:
    """Find the ballistic limit."""
    from armour.analysis.ballistic_limit import not_monotonic

    result = armour.ballistic_limit(scenario, on_progress=on_progress)
    return Answer(result, (*not_monotonic(result), *result.warnings))


@question(*LIMIT, what="the ballistic limit", first="searching")
def compare(scenario: "Scenario", on_progress: "OnProgress") -> Answer:
    """Compare the model with closed-form formulas."""
    from armour.analysis.ballistic_limit import not_monotonic

    result = armour.compare(scenario, on_progress=on_progress)
    return Answer(result, (*not_monotonic(result.limit), *result.limit.warnings))


@question(
    *DESIGNS,
    what="the design",
    csv="Write the Pareto front or, where none is asked for, the frontier as CSV.",
    of_threats=True,
    confidence=("design.confidence", "Probability of defeating each threat to design for, such as 0.95."),
)
def optimise(scenario: "Scenario", on_progress: "OnProgress", **options: Any) -> Answer:
    """Find the lightest armour that defeats the threat.

    The scenario may have several threats, a catalogue of materials, and another quantity to minimise.
    """
    return Answer(armour.optimise(scenario, on_progress=on_progress, **options))


@question("impact", "armour", "ballistic_limit", "optimise", unit="designs")
def sensitivity(scenario: "Scenario", on_progress: "OnProgress") -> Answer:
    """Rank the inputs by their effect on the answers.

    The effects are elasticities: the change of ballistic limit, residual velocity and least areal density, in per cent,
    when an input grows by 1 %.
    """
    return Answer(armour.sensitivity(scenario, on_progress=on_progress))


@question(
    *("impact", "armour", "ballistic_limit", "uncertainty"),
    unit="samples",
    samples=("uncertainty.samples", "Number of samples in place of the scenario's, at least 128."),
)
def uncertainty(scenario: "Scenario", on_progress: "OnProgress") -> Answer:
    """Propagate input uncertainty to the outcome and the ballistic limit."""
    return Answer(armour.uncertainty(scenario, on_progress=on_progress))
