"""Charts of plans of tests."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from armour.reporting.chart import (
    BLUE,
    GREEN,
    INK,
    PURPLE,
    SOFT,
    VERMILION,
    Axis,
    Chart,
    Line,
    Panel,
    Points,
    Rule,
    Series,
)
from armour.reporting.text import interval, percent

if TYPE_CHECKING:
    from armour.planning.shot_plan import ShotPlan

KINDS = (("partial penetration", False, GREEN, "o"), ("complete penetration", True, VERMILION, "^"))


def shot_plan_chart(plan: "ShotPlan") -> Chart:
    """Describe prior and posterior of V50, the shots, and the next velocity."""
    known = [*plan.fired.velocities_m_s, plan.model_ballistic_limit_m_s, *(plan.limits_m_s or ())]
    x = list(plan.curve.velocity_m_s) if plan.curve else np.linspace(0.9 * min(known), 1.1 * max(known), 201).tolist()
    limits = (x[0], x[-1])
    shots: list[Series] = []
    for kind, complete, colour, marker in KINDS:
        velocities = plan.fired.of(complete=complete)
        if velocities:
            words = tuple(f"{kind} at {velocity:g} m/s" for velocity in velocities)
            heights = [float(complete)] * len(velocities)
            shots.append(Points(velocities, heights, marker, label=kind, colour=colour, text=words))
    if plan.curve:
        shots.insert(0, Line(x, plan.curve.probability, label="probability by the posterior", colour=BLUE))
    elif plan.recommended:
        fit = plan.recommended
        shots.insert(0, Line(x, [fit.probability(v) for v in x], label=f"{fit.curve}, {fit.method}", colour=BLUE))
    shots += _rules(plan, limits, label=not plan.curve)
    probability = Axis("probability of complete penetration", limits=(-0.05, 1.05))
    panels = [
        Panel(Axis("impact velocity", "m/s", limits=limits), probability, tuple(shots), shares_x=bool(plan.curve))
    ]
    note = ""
    if plan.curve and plan.posterior:
        v50: list[Series] = [
            Line(x, plan.curve.prior, label="prior: the model with its error", colour=PURPLE, style="--"),
            Line(x, plan.curve.posterior, label="posterior: with the shots", colour=BLUE),
            *_rules(plan, limits, label=True),
        ]
        density = Axis("probability density of V50", "s/m", from_zero=True)
        panels.insert(0, Panel(Axis("impact velocity", "m/s", limits=limits), density, tuple(v50)))
        ends = interval(plan.posterior.v50_interval_m_s, ".1f")
        note = f"Posterior: V50 {plan.posterior.v50_m_s:.1f} m/s, {percent(plan.confidence)} interval {ends} m/s."
    fired = len(plan.fired.complete)
    file = f" in {Path(plan.fired.file).name}" if fired and plan.fired.file != "shots" else ""
    title = f"V50 firing, {plan.procedure}: {fired} shots{file}"
    return Chart(title, tuple(panels), " ".join(filter(None, (note, f"{plan.stopped}." if plan.stopped else ""))))


def _rules(plan: "ShotPlan", limits: tuple[float, float], *, label: bool) -> list[Series]:
    """Return lines at the next velocity and the required one, named once."""
    lines = (
        ("next shot", plan.next_velocity_m_s, INK, ":"),
        ("requirement", plan.requirement_m_s, SOFT, "-."),
    )
    return [
        Rule(at, style, label=f"{name} {at:.1f} m/s" if label else "", colour=colour)
        for name, at, colour, style in lines
        if at is not None and limits[0] <= at <= limits[1]
    ]
