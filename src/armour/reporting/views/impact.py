"""An impact: its result, stages, history and energy."""

from dataclasses import fields, replace
from math import inf

import numpy as np

from armour.analysis.history import History
from armour.analysis.impact import EnergyBalance, ImpactResult
from armour.analysis.quantities import OUTCOMES
from armour.errors import InputError, Problem
from armour.reporting import charts
from armour.reporting.table import Column, Table, column_of, csv_text, listing, record
from armour.reporting.text import Verdict
from armour.reporting.views.confidence import SAMPLED_ALONE
from armour.reporting.views.confidence import tables as confidence_tables
from armour.units import MM

STAGES = {
    "i": "intact ceramic, penetrated; rod erodes",
    "ii.1": "fragmented ceramic, penetrated; rod erodes",
    "ii.2": "ceramic carried along or held (dwell); rod erodes",
    "ii.3": "ceramic, penetrated; rod rigid",
    "iii.1": "plate, penetrated; rod erodes",
    "iii.2": "plate carried along or held (dwell); rod erodes",
    "iii.3": "plate, penetrated; rod rigid",
    "iii.4": "plate carried along; rod rigid",
    "iii.5": "fragmented ceramic carried along; rod rigid",
}


# Words of the stages above their bands, where there is room.
SHORT = {
    "i": "intact ceramic",
    "ii.1": "fragmented ceramic",
    "ii.2": "ceramic carried or held",
    "ii.3": "ceramic, rod rigid",
    "iii.1": "plate, rod erodes",
    "iii.2": "plate carried or held",
    "iii.3": "plate, rod rigid",
    "iii.4": "plug carried along",
    "iii.5": "ceramic carried along",
}


def tables(result: ImpactResult) -> list[Table | str]:
    """Return the outcome of an impact, its probability where that was computed, and what remains, stage by stage."""
    found: list[Table | str] = [verdict(result)]
    if (confidence := result.question.get("confidence")) is not None:
        found += confidence_tables(confidence)
        distributed = result.question["scenario"].uncertainty
        if confidence.model_error is None and distributed is not None and distributed.inputs():
            found.append(f"{SAMPLED_ALONE}: armour uncertainty")
    return [*found, impact_table(result), stage_table(result)]


def verdict(result: ImpactResult) -> Verdict:
    """Return the outcome in a line."""
    stopped = result.outcome == "defeated"
    residual = "" if stopped else f", residual velocity {result.residual_velocity_m_s:.0f} m/s"
    return Verdict.of(OUTCOMES[result.outcome] + residual, good=stopped)


def impact_table(result: ImpactResult) -> Table:
    """Return the result of an impact, quantity by quantity."""
    return record(
        result,
        column_of("residual_length_mm"),
        column_of("residual_mass_g"),
        (column_of("plug_velocity_m_s"), result.plug_velocity_m_s or None),
        column_of("penetration_depth_mm"),
        column_of("bulge_height_mm"),
        column_of("duration_us"),
        column_of("areal_density_kg_m2"),
    )


def stage_table(result: ImpactResult) -> Table:
    """Return the stages of an impact with the projectile's losses in each."""
    return listing(
        result.stages,
        column_of("stage"),
        (Column("description", prose=True), lambda record: STAGES[record.stage]),
        column_of("start_us", ".1f"),
        column_of("end_us", ".1f"),
        column_of("velocity_lost_m_s", ".0f"),
        column_of("length_lost_mm", ".1f"),
        (Column("energy lost", "J", ".0f"), lambda record: record.energy_lost_J),
    )


def history_table(history: History) -> Table:
    """Return a run over time, an instant a row."""
    names = [field.name for field in fields(history)]
    values = [getattr(history, name).tolist() for name in names]
    return Table(tuple(Column(name, key=name) for name in names), tuple(zip(*values, strict=True)))


def csv(result: ImpactResult) -> str | None:
    """Return the run over time as CSV; None where it was not kept."""
    return None if result.history is None else csv_text(history_table(result.history))


def energy_table(energy: EnergyBalance) -> Table:
    """Return the projectile's loss of kinetic energy, stage by stage; the last row is the sum."""
    found = [(f"{row.stage}: {STAGES[row.stage]}", row.eroded, row.braked) for row in energy.rows]
    found.append(("all stages", sum(row.eroded for row in energy.rows), sum(row.braked for row in energy.rows)))
    percent = 100.0 / energy.before if energy.before else 0.0
    columns = (
        Column("stage", prose=True),
        Column("carried by eroded material", "J", ".0f"),
        Column("lost in braking the rod", "J", ".0f"),
        Column("sum", "J", ".0f"),
        Column("share of the impact energy", "%", ".1f"),
    )
    rows = ((name, eroded, braked, eroded + braked, percent * (eroded + braked)) for name, eroded, braked in found)
    return Table(columns, tuple(rows))


def chart(result: ImpactResult) -> charts.Chart:
    """Describe an impact over time, from its history: velocities, rod length, depth and bulge, with its stages."""
    history = result.history
    if history is None:
        raise InputError([Problem("plot", "result", "must have its history: simulate(scenario, history=True)")])
    # Below 5 % of the impact velocity the projectile hardly moves; 1.5 times the time until then is shown.
    slow = history.time_us[history.velocity_m_s <= 0.05 * result.impact_velocity_m_s]
    shown = min(result.duration_us, 1.5 * float(slow[0])) if slow.size else result.duration_us
    seen = history.time_us <= shown
    time = history.time_us[seen].tolist()
    velocities = {
        "projectile V": history.velocity_m_s,
        "penetration U": history.penetration_velocity_m_s,
        "target W": history.target_velocity_m_s,
    }
    depths = {"depth Z": history.depth_mm, "bulge h": history.bulge_height_mm}
    x = charts.Axis("time since impact", "µs", limits=(0.0, max(shown, 1e-9)), spec=".2f")
    stages = [stage for stage in result.stages if stage.start_us < shown]
    words = (f"stage {s.stage}: {STAGES[s.stage]}\n{s.start_us:.4g} to {s.end_us:.4g} µs" for s in stages)
    ends = [min(stage.end_us, shown) for stage in stages]
    names = tuple(f"{stage.stage}: {SHORT[stage.stage]}" for stage in stages)
    spans = charts.Spans([stage.start_us for stage in stages], ends, names, text=tuple(words))
    panels: list[charts.Panel] = []
    colours = iter(("blue", "orange", "green", "ink", "purple", "vermilion"))
    for y, height, curves in (
        (charts.Axis("velocity", "m/s", spec=".1f"), 1.1, velocities),
        (charts.Axis("rod length", "mm", from_zero=True, spec=".2f"), 0.65, {"rod length L": history.length_mm}),
        (charts.Axis("depth, bulge", "mm", spec=".2f"), 0.75, depths),
    ):
        lines = (
            charts.Line(time, values[seen].tolist(), style, label=label, colour=next(colours))
            for (label, values), style in zip(curves.items(), charts.STYLES, strict=False)
        )
        panels.append(charts.Panel(x, y, (spans, *lines), height=height, shares_x=bool(panels)))
        # The first panel alone names the stages.
        spans = replace(spans, names=(), text=())
    scene = () if result.question.get("scenario") is None else (_scene(result, history),)
    outcome = f"Impact: {OUTCOMES[result.outcome]} at {result.impact_velocity_m_s:g} m/s"
    if result.outcome == "perforated":
        outcome += f", residual velocity {result.residual_velocity_m_s:.1f} m/s"
    # The caption names every stage: some are too narrow for a name above the panel, or start after the time shown.
    parts = (f"{s.stage} from {s.start_us:.3g} µs, {_stage_words(s.stage)}" for s in result.stages)
    caption = f"Stages: {'; '.join(parts)}."
    if shown < result.duration_us:
        caption = f"Drawn up to {shown:.3g} µs of {result.duration_us:.3g} µs. {caption}"
    return charts.Chart(outcome, (*scene, *panels), caption, width=6.0)


# Pictures of an impact at most, and the height of armour that they show, diameters of the rod.
PICTURES, SHOWN_DIAMETERS = 6, 5.0


def _scene(result: ImpactResult, history: History) -> charts.Panel:
    """Draw armour and rod to scale along the line of fire, at the start and at the end of each stage."""
    p = result.question["scenario"].core_armour()
    length, diameter, ceramic, backing = (value / MM for value in (p.L0, p.D0, p.Hc0, p.Hb))
    ends = [stage.end_us for stage in result.stages]
    moments = [0.0, *ends[: PICTURES - 2], *ends[PICTURES - 2 :][-1:]]
    bulge = max(0.5 * diameter, float(history.bulge_height_mm.max()))
    high, step = 0.5 * SHOWN_DIAMETERS * diameter, 1.25 * (length + ceramic + backing + bulge)
    fragmented = min((s.start_us for s in result.stages if s.stage[:3] == "iii" or s.stage == "ii.1"), default=inf)
    boxes: dict[tuple[str, bool], list[tuple[float, float, float, float]]] = {}
    words = []
    for place, moment in enumerate(moments):
        at = {
            name: float(np.interp(moment, history.time_us, getattr(history, name)))
            for name in ("depth_mm", "length_mm", "bulge_height_mm", "velocity_m_s")
        }
        front, moved = at["depth_mm"], at["bulge_height_mm"]
        broken = 0.0 < moment >= fragmented
        start, half = place * step, 0.5 * diameter
        layers = (("ceramic", broken, 0.0, ceramic), ("metal", False, ceramic, ceramic + backing))
        for name, hatched, near, far in layers:
            if far > near:
                for bottom in (-high, half):  # beside the path of the rod
                    boxes.setdefault((name, hatched), []).append((start + near, bottom, far - near, high - half))
                ahead = max(near + (moved if near else 0.0), front)
                if far + moved > ahead:  # what is left ahead of the rod
                    boxes.setdefault((name, hatched), []).append((start + ahead, -half, far + moved - ahead, diameter))
        if at["length_mm"] > 0.0:
            boxes.setdefault(("rod", False), []).append(
                (start + front - at["length_mm"], -half, at["length_mm"], diameter)
            )
        words.append(f"{moment:.3g} µs\n{at['velocity_m_s']:.0f} m/s")
    middles = [place * step + 0.5 * (ceramic + backing) for place in range(len(moments))]
    names = {"ceramic": "ceramic", "metal": "back plate", "rod": "rod"}
    series = [
        charts.Boxes(places, hatched, label=f"{names[name]}{', fragmented' if hatched else ''}", colour=name)
        for (name, hatched), places in boxes.items()
    ]
    x = charts.Axis(limits=(-1.1 * length, (len(moments) - 1) * step + 1.1 * (ceramic + backing + bulge)))
    y = charts.Axis(limits=(-1.05 * high, 1.05 * high + 2.4 * diameter))
    above = charts.Words(middles, [1.05 * high] * len(moments), tuple(words), colour="ink")
    return charts.Panel(x, y, (*series, above), to_scale=True)


def _stage_words(stage: str) -> str:
    """Return what a stage is, as a part of a list."""
    return STAGES[stage].replace(";", ",")


def energy_chart(energy: EnergyBalance) -> charts.Chart:
    """Describe the projectile's loss of kinetic energy, stage by stage."""
    categories = (*(f"{index}. stage {row.stage}" for index, row in enumerate(energy.rows, start=1)), "remaining")
    _, eroded, braked, *_ = (column.label for column in energy_table(energy).columns)
    looks = ((eroded, "orange"), (braked, "blue"), ("remaining in the projectile", "soft"))
    parts = np.array([*((row.eroded, row.braked, 0.0) for row in energy.rows), (0.0, 0.0, energy.left)])
    share = 100.0 / energy.before if energy.before > 0.0 else 0.0
    series = []
    for (label, colour), values, ends in zip(looks, parts.T, parts.cumsum(axis=1).T, strict=True):
        shown = zip(categories, values, strict=True)
        text = tuple(f"{name}: {label}\n{value:.2f} J, {share * value:.1f} %" for name, value in shown)
        series.append(charts.Bars((ends - values).tolist(), ends.tolist(), label=label, colour=colour, text=text))
    x = charts.Axis("kinetic energy", "J", from_zero=True)
    panel = charts.Panel(x, charts.Axis(categories=categories), tuple(series))
    codes = dict.fromkeys(f"{row.stage}, {_stage_words(row.stage)}" for row in energy.rows)
    return charts.Chart("Where the projectile's energy went", (panel,), f"Stages: {'; '.join(codes)}.")
