"""An impact: its result, stages, history and energy."""

from collections.abc import Iterator
from dataclasses import fields, replace
from itertools import pairwise
from math import inf
from typing import Any, NamedTuple

import numpy as np

from armour.analysis.history import History
from armour.analysis.impact import ImpactResult
from armour.core.equations import crack_velocity
from armour.core.state import Parameters
from armour.errors import InputError, Problem
from armour.reporting import charts
from armour.reporting.table import Column, Table, column_of, csv_text, listing, record
from armour.reporting.text import Verdict, wrapped
from armour.reporting.views.confidence import SAMPLED_ALONE
from armour.reporting.views.confidence import tables as confidence_tables
from armour.units import MM


class StageWords(NamedTuple):
    """A stage in words: what it begins with, its name, and what it is."""

    begins: str
    name: str
    words: str


STAGES = {
    "i": StageWords("impact", "intact ceramic", "intact ceramic; penetrator erodes"),
    "ii.1": StageWords("ceramic fragments", "fragmented ceramic", "fragmented ceramic; penetrator erodes"),
    "ii.2": StageWords("front held", "ceramic carried or held", "ceramic carried or held (dwell); penetrator erodes"),
    "ii.3": StageWords("erosion ends", "ceramic, rigid penetrator", "ceramic; penetrator rigid"),
    "iii.1": StageWords("penetrator erodes", "plate, eroding penetrator", "plate; penetrator erodes"),
    "iii.2": StageWords("front held", "plate carried or held", "plate carried or held (dwell); penetrator erodes"),
    "iii.3": StageWords("erosion ends", "plate, rigid penetrator", "plate; penetrator rigid"),
    "iii.4": StageWords("plug moves along", "plug carried along", "plate carried; penetrator rigid"),
    "iii.5": StageWords("ceramic moves along", "ceramic carried along", "fragmented ceramic carried; penetrator rigid"),
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
    stopped = result.outcome == "stopped"
    residual = "" if stopped else f", residual velocity {result.residual_velocity_m_s:.0f} m/s"
    return Verdict.of(result.outcome + residual, good=stopped)


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
        (Column("description", prose=True), lambda record: STAGES[record.stage].words),
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


# Panels over time: y axis, height, and curves by label.
PANELS: tuple[tuple[charts.Axis, float, dict[str, str]], ...] = (
    (
        charts.Axis("velocity", "m/s", spec=".1f"),
        1.1,
        {
            "projectile V": "velocity_m_s",
            "penetration U": "penetration_velocity_m_s",
            "target W": "target_velocity_m_s",
        },
    ),
    (charts.Axis("penetrator length L", "mm", from_zero=True, spec=".2f"), 0.75, {"": "length_mm"}),
    (charts.Axis("depth, bulge", "mm", spec=".2f"), 0.75, {"depth Z": "depth_mm", "bulge h": "bulge_height_mm"}),
)


def chart(result: ImpactResult) -> charts.Chart:
    """Describe an impact: penetrator and armour at the ends of its stages, and its history."""
    history = result.history
    if history is None:
        raise InputError([Problem("plot", "result", "must have its history: simulate(scenario, history=True)")])
    # Below 5 % of the impact velocity the projectile hardly moves; 1.5 times the time until then is shown.
    slow = history.time_us[history.velocity_m_s <= 0.05 * result.impact_velocity_m_s]
    shown = min(result.duration_us, 1.5 * float(slow[0])) if slow.size else result.duration_us
    seen = history.time_us <= shown
    x = charts.Axis("time since impact", "µs", limits=(0.0, max(shown, 1e-9)), spec=".2f")
    spans = _spans(result, shown)
    colours = iter(("blue", "orange", "green", "ink", "purple", "vermilion"))
    panels: list[charts.Panel] = []
    for y, height, curves in PANELS:
        lines = []
        for (label, name), style in zip(curves.items(), charts.STYLES, strict=False):
            times, values = (of[seen].tolist() for of in (history.time_us, getattr(history, name)))
            lines.append(charts.Line(times, values, style, label=label, colour=next(colours)))
        panels.append(charts.Panel(x, y, (spans, *lines), height=height, shares_x=bool(panels)))
        # The first panel alone names the stages.
        spans = replace(spans, names=(), text=())
    if result.question.get("scenario") is not None:
        panels.insert(0, _scene(result, history))
    title = f"Stopped at a depth of {result.penetration_depth_mm:.3g} mm"
    if result.outcome == "perforated":
        title = f"Perforated: residual velocity {result.residual_velocity_m_s:.0f} m/s"
    note = f"Drawn up to {shown:.3g} µs of {result.duration_us:.3g} µs." if shown < result.duration_us else ""
    return charts.Chart(title, tuple(panels), note, width=6.0)


def _spans(result: ImpactResult, shown: float) -> charts.Spans:
    """Describe the stages up to a time, µs."""
    stages = [stage for stage in result.stages if stage.start_us < shown]
    return charts.Spans(
        [stage.start_us for stage in stages],
        [min(stage.end_us, shown) for stage in stages],
        tuple(f"{stage.stage}: {STAGES[stage.stage].name}" for stage in stages),
        text=tuple(f"stage {s.stage}: {STAGES[s.stage].words}\n{s.start_us:.4g} to {s.end_us:.4g} µs" for s in stages),
    )


# Pictures of an impact at most, the least height of armour that they show, in diameters of the penetrator and as a part
# of their length, and the scale drawn, mm.
PICTURES, SHOWN_DIAMETERS, SHOWN_PART, SCALE_MM = 6, 3.6, 0.6, 10.0
# Characters in a line of words above a picture, and the time between events of one picture at most, µs.
EVENT_CHARACTERS, AT_ONCE_US = 12, 1e-3


def _scene(result: ImpactResult, history: History) -> charts.Panel:
    """Draw armour and penetrator to scale along the line of fire, at the start and at the end of each stage."""
    p = result.question["scenario"].core_armour()
    length, diameter, ceramic, backing = (value / MM for value in (p.L0, p.D0, p.Hc0, p.Hb))
    fragmented = _fragmented_us(p, history)
    moments = _moments(result, fragmented)
    times = [time for time, _ in moments]
    depths, lengths, bulges, velocities = (
        np.interp(times, history.time_us, values).tolist()
        for values in (history.depth_mm, history.length_mm, history.bulge_height_mm, history.velocity_m_s)
    )
    left, right = np.minimum(np.subtract(depths, lengths), 0.0), ceramic + backing + np.array(bulges)
    middles, width = _side_by_side(right - left)
    starts = (middles - 0.5 * (left + right)).tolist()
    high = 0.5 * max(SHOWN_DIAMETERS * diameter, SHOWN_PART * (length + ceramic + backing))
    boxes = [
        replace(box, left=start + box.left, right=start + box.right)
        for time, start, *state in zip(times, starts, depths, lengths, bulges, strict=True)
        for box in _picture(0.5 * diameter, high, (ceramic, backing), *state, broken=time >= fragmented - AT_ONCE_US)
    ]
    above = (
        f"{time:.3g} µs\n{velocity:.0f} m/s\n" + "\n".join(wrapped(event, EVENT_CHARACTERS))
        for (time, event), velocity in zip(moments, velocities, strict=True)
    )
    layers = "ceramic, plate" if ceramic else "plate"
    series = (
        *boxes,
        charts.Box(0.0, SCALE_MM, -2.6 * high, -2.58 * high, colour="ink"),
        charts.Words(middles.tolist(), high, tuple(above)),
        charts.Words([0.5 * SCALE_MM], -2.6 * high, (f"{SCALE_MM:g} mm",)),
        charts.Words(
            [starts[0] - 0.5 * length, *middles[1:]],
            -1.05 * high,
            tuple(f"penetrator\n{left:.3g} mm" for left in lengths),
            above=False,
        ),
        charts.Words([starts[0] + 0.5 * (ceramic + backing)], -1.8 * high, (layers,), above=False),
    )
    x, y = charts.Axis(limits=(0.0, width)), charts.Axis(limits=(-2.65 * high, high))
    return charts.Panel(x, y, series, to_scale=True)


def _moments(result: ImpactResult, fragmented_us: float) -> list[tuple[float, str]]:
    """Return the times of the pictures, µs, and what happens then: the first events, and the last."""
    found = [(0.0, "impact"), *_events(result)]
    if fragmented_us < result.duration_us and min(abs(time - fragmented_us) for time, _ in found) > AT_ONCE_US:
        found = sorted([*found, (fragmented_us, STAGES["ii.1"].begins)])
    return [*found[: PICTURES - 1], *found[PICTURES - 1 :][-1:]]


def _side_by_side(widths: Any) -> tuple[Any, float]:
    """Return the middles of pictures in slots of their widths, but for those too narrow for words, and their sum."""
    slots = widths.clip(min=0.85 * widths.mean()) + 0.15 * widths.mean()
    return np.cumsum(slots) - 0.5 * slots, float(slots.sum())


def _fragmented_us(p: Parameters, history: History) -> float:
    """Return when the crack meets the penetrator (7), µs, which begins no stage in dwell; infinite if it does not."""
    if not p.Hc0:
        return inf
    crossed = history.depth_mm + history.time_us * 1e-6 * crack_velocity(p.Ec, p.rho_c) / MM
    return float(np.interp(p.Hc0 / MM, crossed, history.time_us, right=inf))


def _events(result: ImpactResult) -> Iterator[tuple[float, str]]:
    """Give the times at which stages end, µs, and what happens then."""
    for stage, after in pairwise(result.stages):
        event = STAGES[after.stage].begins
        if after.stage in ("iii.1", "iii.2", "iii.3") and stage.stage[:3] != "iii":
            event = "ceramic penetrated"
        elif (stage.stage, after.stage) == ("ii.2", "ii.1"):
            event = "dwell ends"
        yield stage.end_us, event
    yield result.duration_us, result.outcome


def _picture(
    half: float, high: float, layers: tuple[float, float], front: float, length: float, bulge: float, *, broken: bool
) -> Iterator[charts.Box]:
    """Give what is seen of layers and penetrator, given half of both heights, depth, length and bulge, mm."""
    ceramic, total = layers[0], sum(layers)
    for name, near, far, is_broken in (("ceramic", 0.0, ceramic, broken), ("metal", ceramic, total, False)):
        ahead = max(near + (bulge if near else 0.0), front)
        parts = [(near, far, -high, -half), (near, far, half, high)]  # beside its path
        parts += [(ahead, far + bulge, -half, half)] if far + bulge > ahead else []  # what is left ahead
        if far > near:
            yield from (charts.Box(*part, is_broken, colour=name) for part in parts)
    if length > 0.0:
        yield charts.Box(front - length, front, -half, half, colour="rod")
