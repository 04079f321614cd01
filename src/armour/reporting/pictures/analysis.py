"""Draw impacts and ballistic limits."""

from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.transforms import offset_copy

from armour.analysis.ballistic_limit import LimitResult, residual_velocity_curve
from armour.analysis.impact import History, ImpactResult
from armour.core import equations
from armour.core.state import Parameters
from armour.errors import mistake
from armour.reporting.by_result import draw, headline
from armour.reporting.pictures import drawing
from armour.reporting.table import in_words, sentence, wrapped
from armour.reporting.views.analysis import STAGES
from armour.reporting.words import chance, far_line, said_of
from armour.scenario.inputs import VELOCITY
from armour.units import MM

VELOCITIES = {
    "projectile V": "velocity_m_s",
    "penetration U": "penetration_velocity_m_s",
    "target W": "target_velocity_m_s",
}
# Panels over time: label of the y axis, height, inches, and attribute of the history for each curve, by its label.
PANELS: Any = (
    ("velocity, m/s", 1.1 * drawing.PANEL, VELOCITIES),
    ("penetrator length L, mm", 0.75 * drawing.PANEL, {"": "length_mm"}),
    ("depth, bulge, mm", 0.75 * drawing.PANEL, {"depth Z": "depth_mm", "bulge h": "bulge_height_mm"}),
)
CERAMIC_COLOUR, METAL_COLOUR, ROD_COLOUR = "#d9c48f", "#a9b8c6", "#5c6875"
EDGE: Any = {"edgecolor": drawing.INK, "linewidth": 0.5}
# Largest number of pictures of an impact; height of armour that each shows, at least so many penetrator diameters and
# this fraction of the length of rod and armour; length of the scale bar, mm.
PICTURES, SHOWN_DIAMETERS, SHOWN_PART, SCALE_MM = 6, 3.6, 0.6, 10.0
# Least fraction of the width of a figure that a panel takes.
PART = 0.8
# Characters in a line of text above a picture; events closer in time than AT_ONCE_US, µs, count as one.
EVENT_CHARACTERS, AT_ONCE_US = 12, 1e-3
# Height of the text and of the scale bar below the pictures of an impact, as a multiple of the font size.
BELOW = 4.9


@draw.register
def draw_impact(result: ImpactResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw armour and penetrator at several moments, and below them velocities, length and depths over time."""
    history = result.history
    if history is None:
        raise mistake("plot", "result", "must have its history: simulate(scenario, history=True)")
    # Below 5 % of the impact velocity the projectile hardly moves; show 1.5 times the time until then.
    slow = history.time_us[history.velocity_m_s <= 0.05 * result.impact_velocity_m_s]
    shown = min(result.duration_us, 1.5 * float(slow[0])) if slow.size else result.duration_us
    notes = [f"Drawn up to {shown:.3g} µs of {result.duration_us:.3g} µs."] if shown < result.duration_us else []
    notes += _caveats(result)
    scene = _Scene(result, history)
    heights = [scene.height_inches(sheet.width), *(height for _, height, _ in PANELS)]
    picture = sheet.panels(headline(result), *heights, note=" ".join(notes))
    first, *over_time = picture.axes
    seen = history.time_us <= shown
    for axes, (label, _, curves) in zip(over_time, PANELS, strict=True):
        axes.sharex(over_time[-1])
        axes.tick_params(labelbottom=axes is over_time[-1])
        for stage in result.stages[::2]:
            axes.axvspan(stage.start_us, stage.end_us, **drawing.SHADE)
        for (name, key), style, colour in zip(curves.items(), drawing.STYLES, drawing.COLOURS, strict=False):
            axes.plot(history.time_us[seen], getattr(history, key)[seen], linestyle=style, color=colour, label=name)
        axes.set_ylabel(label)
    over_time[1].set_ylim(bottom=0.0)
    over_time[-1].set(xlabel="time since impact, µs", xlim=(0.0, max(shown, 1e-9)))
    _name_stages(over_time[0], result, shown, PART * sheet.width)
    scene.draw(first, PART * sheet.width)
    return picture


def _caveats(result: ImpactResult | LimitResult) -> list[str]:
    """Return sentences for the note of a picture: what of the armour is far from the tests, and the model's caveats."""
    return [sentence(str(text)) for text in (*far_line(result.far_from_tests), *said_of(result.notes))]


def _name_stages(axes: Axes, result: ImpactResult, shown: float, inches: float) -> None:
    """Write the codes of the stages, such as "ii.1", above a panel, where there is room.

    `shown` is the last time drawn, µs, and `inches` the least width of the panel.
    """
    for stage in result.stages:
        if stage.start_us < shown:
            start, end = stage.start_us, min(stage.end_us, shown)
            room = int((end - start) / shown * inches * 72.0 / (drawing.CHARACTER * drawing.SMALL_FONT))
            if len(stage.stage) <= room:
                place: Any = {"transform": axes.get_xaxis_transform(), "ha": "center", "va": "bottom"}
                axes.text(0.5 * (start + end), 1.01, stage.stage, fontsize=drawing.SMALL_FONT, **place)


class _Scene:
    """Pictures of an impact along the line of fire, to scale and side by side: at impact and at the end of each stage.

    Lengths are in mm, times in µs; `moments` has time and event of each picture, and `words` the text above it.
    The penetrator's axis is at y = 0, and the armour is drawn up to y = `top`.
    """

    def __init__(self, result: ImpactResult, history: History) -> None:
        p = result.question["scenario"].core_armour()
        self.rod, self.diameter, self.ceramic, self.backing = (value / MM for value in (p.L0, p.D0, p.Hc0, p.Hb))
        self.fragmented_us = _fragmented_us(p, history)
        self.moments = _moments(result, self.fragmented_us)
        times = [time for time, _ in self.moments]
        curves = history.depth_mm, history.length_mm, history.bulge_height_mm, history.velocity_m_s
        states = (np.interp(times, history.time_us, values) for values in curves)
        self.depths, self.lengths, self.bulges, self.velocities = states
        left = np.minimum(self.depths - self.lengths, 0.0)
        right = self.ceramic + self.backing + self.bulges
        # Each picture takes its own width, or more if it is too narrow for its text.
        mean = (right - left).mean()
        slots = (right - left).clip(min=0.85 * mean) + 0.15 * mean
        self.middles, self.width = np.cumsum(slots) - 0.5 * slots, float(slots.sum())
        self.starts = self.middles - 0.5 * (left + right)  # x of the front face of the armour
        self.top = 0.5 * max(SHOWN_DIAMETERS * self.diameter, SHOWN_PART * (self.rod + self.ceramic + self.backing))
        events = ("\n".join(wrapped(event, EVENT_CHARACTERS)) for _, event in self.moments)
        states_with_events = zip(times, self.velocities, events, strict=True)
        self.words = [f"{time:.3g} µs\n{velocity:.0f} m/s\n{event}" for time, velocity, event in states_with_events]

    def height_inches(self, inches: float) -> float:
        """Return the height of a panel with the pictures, inches, given its width, inches."""
        lines = max(words.count("\n") + 1 for words in self.words)
        return (inches - 0.1) * 2.05 * self.top / self.width + (1.3 * lines + BELOW) * drawing.SMALL_FONT / 72.0

    def draw(self, axes: Axes, inches: float) -> None:
        """Draw the pictures in a panel of a given width, inches."""
        top, bottom = self.top, -1.05 * self.top
        hatches = ["xxx" if time >= self.fragmented_us - AT_ONCE_US else "" for time, _ in self.moments]
        for seen in zip(self.starts, self.depths, self.lengths, self.bulges, hatches, strict=True):
            self._draw_moment(axes, *seen)
        longest = max(len(line) for words in self.words for line in [*words.splitlines(), "penetrator"])
        room = 72.0 * inches / self.width * np.diff(self.middles).min(initial=self.width)
        look: Any = {"ha": "center", "fontsize": min(drawing.SMALL_FONT, room / (drawing.CHARACTER * (longest + 1)))}
        rods = [self.starts[0] - 0.5 * self.rod, *self.middles[1:]]
        for middle, words, rod, length in zip(self.middles, self.words, rods, self.lengths, strict=True):
            axes.text(middle, top, words, va="bottom", **look)
            axes.text(rod, bottom, f"penetrator\n{length:.3g} mm", va="top", **look)
        # The scale bar is below the text, whose height does not scale with the axes.
        figure: Any = axes.figure
        below = offset_copy(axes.transData, figure, y=-(BELOW - 0.5) * drawing.SMALL_FONT, units="points")
        axes.plot([0.0, SCALE_MM], [bottom] * 2, color=drawing.INK, linewidth=1.0, transform=below, clip_on=False)
        axes.text(0.5 * SCALE_MM, bottom, f"{SCALE_MM:g} mm", va="bottom", transform=below, **look)
        if self.ceramic:
            axes.fill([], [], facecolor=CERAMIC_COLOUR, label="tile", **EDGE)
        axes.fill([], [], facecolor=METAL_COLOUR, label="plate", **EDGE)
        axes.set(xlim=(0.0, self.width), ylim=(bottom, top), aspect="equal")
        axes.set_axis_off()

    def _draw_moment(self, axes: Axes, start: float, depth: float, length: float, bulge: float, hatch: str) -> None:
        """Draw the layers and the penetrator at a moment; `hatch` is the pattern of the ceramic.

        `start` is the x of the front face; depth, length and bulge are those of the moment.
        """
        half, high, total = 0.5 * self.diameter, self.top, self.ceramic + self.backing
        layers = (CERAMIC_COLOUR, 0.0, self.ceramic, hatch), (METAL_COLOUR, self.ceramic, total, "")
        for colour, near, far, pattern in layers:
            ahead = max(near + (bulge if near else 0.0), depth)
            beside = [(near, far, -high, -half), (near, far, half, high)]
            for first, last, low, top in [*beside, (ahead, far + bulge, -half, half)]:
                if far > near and last > first:
                    corner = start + first, low
                    axes.add_patch(Rectangle(corner, last - first, top - low, facecolor=colour, hatch=pattern, **EDGE))
        if length > 0.0:
            axes.add_patch(Rectangle((start + depth - length, -half), length, 2.0 * half, facecolor=ROD_COLOUR, **EDGE))


def _moments(result: ImpactResult, fragmented_us: float) -> list[tuple[float, str]]:
    """Return the moments to draw: the time of each picture, µs, and the event at this time.

    These are all events or, if there are more than `PICTURES`, the first ones and the last.
    """
    events = [(0.0, "impact")]
    for stage, after in pairwise(result.stages):
        event = STAGES[after.stage].begins
        if after.stage in ("iii.1", "iii.2", "iii.3") and stage.stage[:3] != "iii":
            event = "tile penetrated"
        elif (stage.stage, after.stage) == ("ii.2", "ii.1"):
            event = "dwell ends"
        events.append((stage.end_us, event))
    events.append((result.duration_us, result.outcome))
    if fragmented_us < result.duration_us and min(abs(time - fragmented_us) for time, _ in events) > AT_ONCE_US:
        events = sorted([*events, (fragmented_us, STAGES["ii.1"].begins)])
    return events if len(events) <= PICTURES else [*events[: PICTURES - 1], events[-1]]


def _fragmented_us(p: Parameters, history: History) -> float:
    """Return when the crack through the tile meets the penetrator, equation (7), µs; infinite if it never does.

    In dwell this begins no stage, so that the stages do not tell it.
    """
    if not p.Hc0:
        return inf
    crossed = history.depth_mm + history.time_us * 1e-6 * equations.crack_velocity(p.Ec, p.rho_c) / MM
    return float(np.interp(p.Hc0 / MM, crossed, history.time_us, right=inf))


@draw.register
def draw_limit(result: LimitResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the residual velocity over the impact velocity and, above it, the probability of stopping, if known."""
    scenario, limit = result.question["scenario"], result.ballistic_limit_m_s
    threat, error, ends = scenario.impact.velocity_m_s, result.model_error, result.interval_m_s
    curve = residual_velocity_curve(scenario, result)
    impact = [point.impact_velocity_m_s for point in curve]
    reach = drawing.widened([impact[0], impact[-1], threat, *(ends or ())])
    residual_alone = error is None or ends is None
    heights = [drawing.PANEL] * (1 if residual_alone else 2)
    picture = sheet.panels(headline(result), *heights, note=" ".join(_caveats(result)), sharex=True)
    if error is not None and ends is not None:
        stopping_axes, velocities = picture.axes[0], np.linspace(*reach, 200)
        probability = float(error.probability_of_stopping(limit, threat))
        stopping_axes.set(ylabel="stops a shot, %", ylim=(0.0, 102.0))
        stopping_axes.axvspan(*ends, **drawing.SHADE, label="limit, 95 % between")
        stopping_axes.plot(velocities, 100.0 * error.probability_of_stopping(limit, velocities), color=drawing.BLUE)
        stopping_axes.axvline(limit, linestyle=":", label=f"limit by the model {limit:.0f} m/s", **drawing.RULE)
        stopping_axes.axvline(threat, linestyle="--", linewidth=1.0, color=drawing.VERMILION)
        label = f"{threat:g} m/s: {chance(probability)}"
        drawing.points(stopping_axes, [threat], [100.0 * probability], marker="D", color=drawing.VERMILION, label=label)
    residual = picture.axes[-1]
    residual.plot(impact, impact, linestyle=":", linewidth=1.0, color=drawing.INK, label="no armour")
    residual.plot(impact, [point.residual_velocity_m_s for point in curve], color=drawing.BLUE, label="projectile")
    plug = [point.plug_velocity_m_s for point in curve]
    residual.plot(impact, plug, linestyle="--", color=drawing.GREEN, label="plug")
    residual.axvline(limit, linestyle=":", label="limit by the model" if residual_alone else "", **drawing.RULE)
    label = f"{threat:g} m/s" if residual_alone else ""
    residual.axvline(threat, linestyle="--", linewidth=1.0, color=drawing.VERMILION, label=label)
    residual.set(xlabel=in_words(VELOCITY), ylabel=in_words("residual_velocity_m_s"), xlim=reach)
    residual.set_ylim(bottom=0.0)
    return picture
