"""``armour plan shots``."""

from contextlib import nullcontext
from functools import partial
from os.path import exists
from pathlib import Path
from typing import Annotated, Literal

import typer

from armour.cli import completion
from armour.cli.console import progress
from armour.cli.options import AsJson, Changes, Force, PlotFile, ScenarioFile, argument, option
from armour.cli.runner import check_outputs, named_as_options, read_scenario, respond, warnings_of
from armour.cli.scenario_commands import LIMIT
from armour.errors import InputError, Problem

EXAMPLES = (
    "plan shots wilkins",
    "plan shots wilkins firing.csv --result partial --plot plan.svg",
    "plan shots wilkins --simulate --true-v50-m-s 770 --true-scatter-m-s 15",
)
# Part by which a measured velocity may miss the planned one without a warning.
FAR_FROM_PLAN = 0.1
# Arguments of plan_shots that options give.
SETTINGS = (
    "half_width_m_s",
    "confidence",
    "requirement_m_s",
    "requirement_fraction",
    "scatter_percent",
    "scatter_factor",
    "true_v50_m_s",
    "true_scatter_m_s",
    "seed",
)
LIMITS = {"limits_m_s": "--lower-m-s, --upper-m-s", "limits_m_s[0]": "--lower-m-s", "limits_m_s[1]": "--upper-m-s"}


def plan_of_shots(
    scenario: ScenarioFile,
    table: Annotated[
        Path | None,
        argument(
            "SHOTS",
            'CSV file of the shots so far, with the columns velocity_m_s and result ("partial" or "complete").',
            autocompletion=completion.tables,
        ),
    ] = None,
    procedure: Annotated[
        Literal["bayesian", "neyer", "langlie", "up-and-down"], typer.Option(help="Rule for the next velocity.")
    ] = "bayesian",
    half_width_m_s: Annotated[
        float | None,
        option(
            "Half width of the interval of V50 at which the firing ends, m/s, at least 0.1; by default 15, or the rule "
            "of MIL-STD-662F of up-and-down."
        ),
    ] = None,
    confidence: Annotated[
        float, typer.Option(help="Confidence of the interval and of the requirement, 0.5 to 0.9999.")
    ] = 0.95,
    requirement_m_s: Annotated[
        float | None,
        option(
            "Required velocity, m/s: bayesian ends the firing when it is known whether V50 exceeds it, up-and-down "
            "only starts above it; not with neyer or langlie."
        ),
    ] = None,
    requirement_fraction: Annotated[
        float, typer.Option(help="Fraction of shots that may perforate at the required velocity, 0.001 to 0.999.")
    ] = 0.5,
    scatter_percent: Annotated[
        float, typer.Option(help="Expected scatter, the standard deviation of the response curve, % of V50.")
    ] = 2.0,
    scatter_factor: Annotated[
        float, typer.Option(help="Factor by which the scatter may differ from it, 1.01 to 10.")
    ] = 2.0,
    lower_m_s: Annotated[float | None, option("Lower limit of V50, m/s, for langlie and neyer.")] = None,
    upper_m_s: Annotated[float | None, option("Upper limit of V50, m/s, for langlie and neyer.")] = None,
    result: Annotated[
        Literal["partial", "complete", "P", "C", "PP", "CP"] | None,
        option("Result of the shot just fired, which is added to SHOTS.", case_sensitive=False),
    ] = None,
    velocity_m_s: Annotated[
        float | None, option("Measured velocity of this shot, m/s; by default the planned one.")
    ] = None,
    simulate: Annotated[bool, option("Simulate all shots until the firing ends.", "--simulate")] = False,
    true_v50_m_s: Annotated[float | None, option("V50 to simulate, m/s; by default drawn from the posterior.")] = None,
    true_scatter_m_s: Annotated[float | None, option("Scatter to simulate, m/s.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of the simulation, for --simulate.")] = 0,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Plan the next shot of a V50 firing, given the shots so far."""
    from armour.planning.firing import ABSURD_FACTOR, added, content_of, locked, plan_shots, with_shot
    from armour.reporting.views import shot_plan as view
    from armour.statistics.v50 import RESULTS, Shots, read_shots

    updated = table if result is not None else None
    if result is not None and table is None:
        raise _problem("--result", "adds a shot to SHOTS, which is not given")
    if velocity_m_s is not None and result is None:
        raise _problem("--velocity-m-s", "is the velocity of the shot of --result, which is not given")
    if simulate and result is not None:
        raise _problem("--result", "is of a shot that was fired; it must not be given with --simulate")
    if (lower_m_s is None) != (upper_m_s is None):
        raise _problem("--upper-m-s" if upper_m_s is None else "--lower-m-s", "must be given with the other limit")
    check_outputs(plot=plot, updated=updated, force=force)
    loaded = read_scenario(scenario, changes, LIMIT)
    plan_of = partial(
        plan_shots,
        loaded,
        procedure=procedure,
        half_width_m_s=half_width_m_s,
        confidence=confidence,
        requirement_m_s=requirement_m_s,
        requirement_fraction=requirement_fraction,
        scatter_percent=scatter_percent,
        scatter_factor=scatter_factor,
        limits_m_s=None if lower_m_s is None or upper_m_s is None else (lower_m_s, upper_m_s),
        seed=seed,
    )
    content: bytes | None = None
    far: list[str] = []
    with locked(updated) if updated is not None else nullcontext():
        read = None if updated is None else content_of(updated)
        fired = Shots((), (), str(table or "shots"))
        if table is not None and exists(table):
            fired = read_shots(table, one_kind=True)
        elif table is not None and updated is None:
            # A shipped table of this name is of another firing.
            raise InputError([Problem(str(table), "", "cannot be read: no such file; --result makes it")])
        with (
            progress("impacts", first="searching") as count,
            named_as_options("plan_shots", *SETTINGS, **LIMITS),
        ):
            if updated is not None and result is not None:
                before = plan_of(fired, on_progress=count)
                planned, limit = before.next_velocity_m_s, before.model_ballistic_limit_m_s
                velocity = planned if velocity_m_s is None else velocity_m_s
                if velocity is None:
                    raise _problem("--velocity-m-s", "must be given: no further shot was planned")
                if velocity < limit / ABSURD_FACTOR or velocity > limit * ABSURD_FACTOR:
                    message = f"must be near the model's limit, {limit:.0f} m/s: a third to three times it"
                    raise _problem("--velocity-m-s", f"{message}, found {velocity:g}; is it in m/s?")
                if planned is not None and abs(velocity - planned) > FAR_FROM_PLAN * planned:
                    far.append(f"the shot, at {velocity:g} m/s, is far from the planned velocity, {planned:g} m/s")
                word = RESULTS[result.lower()]
                content = with_shot(updated, velocity, word)
                fired = added(fired, velocity, word == "complete")
            plan = plan_of(
                fired,
                simulate=simulate,
                true_v50_m_s=true_v50_m_s,
                true_scatter_m_s=true_scatter_m_s,
                on_progress=count,
            )

        def longer() -> bytes | None:
            if updated is not None and content_of(updated) != read:
                message = "cannot be written: it has changed since it was read; repeat the command"
                raise InputError([Problem(str(updated), "", message)])
            return content

        respond(
            plan.to_dict(),
            view.tables(plan),
            as_json=as_json,
            of=plan._heading(),
            files=[(updated, longer)],
            plot=plot,
            chart=lambda: view.chart(plan),
            warnings=warnings_of(loaded, (*far, *plan.warnings)),
        )


def _problem(option: str, message: str) -> InputError:
    return InputError([Problem("command line", option, message)])
