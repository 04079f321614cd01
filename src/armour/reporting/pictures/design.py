"""Draw design searches and checks."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from armour.design.catalogue import Catalogue, catalogue_of
from armour.design.check import CheckedThreat, CheckResult, deciding, shown_limit
from armour.design.map import DesignMap, design_map, with_known_edges
from armour.design.optimise import Design, DesignResult
from armour.design.requirements import EVEN
from armour.errors import Note
from armour.reporting.by_result import draw, headline
from armour.reporting.pictures import drawing
from armour.reporting.table import grouped, in_words, percent, sentence
from armour.reporting.views import design as view
from armour.reporting.words import chance, far_line, said_of

# Number of nodes of a map along an axis.
MAP_NODES = 25
# Probability of stopping that a band begins with; it ends with that of perforation.
USUAL_CHANCE = 0.95
# Opacity of a tinted region.
TINT = 0.14


@draw.register
def draw_design(result: DesignResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw a map of the best pair of materials and, if there is one, the Pareto front below it.

    If only one thickness of this pair varies, draw the ballistic limits over it instead of the map.
    """
    designs = _map_of(result)
    panels = 1 if designs.varying is None else len(result.threats)
    heights = [drawing.PANEL if designs.varying else 1.6 * drawing.PANEL] * panels
    heights += [drawing.PANEL] * bool(result.pareto)
    threat = deciding(result.shown.check)
    notes = [designs.note(), *_front_notes(result) * bool(result.pareto), *_caveats(threat, result.notes)]
    picture = sheet.panels(headline(result), *heights, note=" ".join(filter(None, notes)))
    if designs.varying is None:
        designs.draw(picture.axes[0])
    else:
        for place, axes in enumerate(picture.axes[:panels]):
            designs.draw_limits(axes, designs.varying, place)
    if result.pareto:
        _draw_front(picture.axes[-1], result)
    return picture


def _map_of(result: DesignResult) -> "_Map":
    """Return the map of the best pair of materials or, without one, of the nearest."""
    catalogue = catalogue_of(result.question["scenario"])
    names = [(offer.ceramic.material, offer.backing.material) for offer in catalogue.offers]
    pair = names.index((result.shown.ceramic, result.shown.backing))
    probabilities = tuple({1.0 - USUAL_CHANCE, EVEN, USUAL_CHANCE, *(1.0 - catalogue.bounds).tolist()})
    offered = [np.array(layer.thicknesses()) for layer in catalogue.offers[pair][:2]]
    nodes = [np.linspace(mm[0], mm[-1], MAP_NODES) if len(mm) > 1 else mm for mm in offered]
    grid = with_known_edges(catalogue, pair, *nodes)
    return _Map(result, catalogue, design_map(catalogue, pair, *grid, probabilities))


@dataclass(frozen=True)
class _Map:
    """A picture of the designs of a pair of materials over their thicknesses: a map or, if one varies, a curve."""

    result: DesignResult
    catalogue: Catalogue
    grid: DesignMap

    @property
    def varying(self) -> str | None:
        """The layer whose thickness alone varies, "ceramic" or "backing"; None if both do."""
        ceramics, backings = len(self.grid.ceramic_mm), len(self.grid.backing_mm)
        if min(ceramics, backings) > 1:
            return None
        return "backing" if backings > ceramics else "ceramic"

    @property
    def shown_m_s(self) -> Any:
        """The expected limits or, where no tests tell, those by the model, m/s, (ceramics, back plates, threats)."""
        expected = self.grid.untruncated_m_s[..., self.grid.probabilities.index(EVEN)]
        return np.where(np.isnan(expected), self.grid.limits_m_s, expected)

    def required(self) -> tuple[Any, Any, str]:
        """Return how far each design exceeds what is required, m/s, whether this is stated, and what is required.

        The first two are arrays, (ceramics, back plates); the last is words for a legend.  The threat with the least
        excess counts.  A probability is stated, and so known, unless no tests tell or it is greater than may be stated
        so far from them.  If none is known or required, the model tells.
        """
        margins_m_s, velocities_m_s = self.catalogue.margins_m_s, self.catalogue.velocities_m_s
        excess_m_s = self.shown_m_s - velocities_m_s - margins_m_s
        asked = [1.0 - bound for bound in self.catalogue.bounds.tolist()]
        known = ~np.isnan(self.grid.untruncated_m_s[..., 0])
        for threat in np.flatnonzero(self.catalogue.required):
            by_tests_m_s = self.grid.untruncated_m_s[..., threat, self.grid.probabilities.index(asked[threat])]
            by_limit_m_s = excess_m_s[..., threat] if margins_m_s[threat] > 0.0 else np.inf
            by_tests_m_s = np.minimum(by_tests_m_s - velocities_m_s[threat], by_limit_m_s)
            excess_m_s[..., threat] = np.where(known[..., threat], by_tests_m_s, excess_m_s[..., threat])
        by_model = not (known.any() or self.catalogue.required.any())
        is_stated = ((known & (self.grid.greatest_probability >= asked)) | by_model).all(axis=-1)
        words = "stopped by the model" if by_model else f"stops a shot with {percent(asked[0])} or more"
        if margins_m_s.any() or len({*asked}) > 1:
            words = "does what is required"
        return excess_m_s.min(axis=-1), is_stated, words

    def draw(self, axes: Axes) -> None:
        """Draw the map: where designs do what is required, lines of equal objective, and the best design."""
        x, y = self.grid.backing_mm, self.grid.ceramic_mm
        axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
        axes.set(xlabel=in_words("armour.backing_thickness_mm"), ylabel=in_words("armour.ceramic_thickness_mm"))
        excess_m_s, is_stated, words = self.required()
        stated_m_s = np.where(is_stated, excess_m_s, np.nan)
        if is_stated.any():
            _tint(axes, x, y, stated_m_s, words, drawing.BLUE)
            drawing.contours(axes, x, y, stated_m_s, [0.0], linewidth=1.9, color=drawing.BLUE)
        _tint(axes, x, y, np.where(is_stated, np.minimum(excess_m_s, -1e-3), excess_m_s), "not known", drawing.SOFT)
        objective = self.catalogue.objective(self.grid.candidates).reshape(len(y), len(x))
        label = f"equal {view.OBJECTIVE_WORDS[self.result.minimised].heading}"
        drawing.contours(axes, x, y, objective, 5, numbered=True, label=label, linestyle=":", color=drawing.SOFT)
        best = self.result.shown
        self.draw_best(axes, best, best.backing_thickness_mm, best.ceramic_thickness_mm)

    def draw_best(self, axes: Axes, best: Design, x: float, y: float) -> None:
        """Draw the best or nearest design at the place x, y of a panel."""
        look: Any = {"markersize": 9.0, "color": drawing.VERMILION if self.result.reason else drawing.INK}
        label = f"{view.best_word(self.result)}: {view.sizes(best)}"
        drawing.points(axes, [x], [y], label=label, **look)

    def draw_limits(self, axes: Axes, layer: str, threat: int) -> None:
        """Draw the ballistic limits over the thickness of a layer, with a band for the model error.

        `threat` is the index of the threat.
        """
        x, limits = getattr(self.grid, f"{layer}_mm"), self.shown_m_s[..., threat].ravel()
        if not np.isnan(self.grid.stopped_m_s[..., threat, :]).all():
            low, high = map(self.grid.stopped_with, (USUAL_CHANCE, 1.0 - USUAL_CHANCE))
            look: Any = {"color": drawing.BLUE, "label": "stopped with 95 to 5 %", **drawing.BAND}
            axes.fill_between(x, low[..., threat].ravel(), high[..., threat].ravel(), **look)
        kind = "limit by the model" if np.isnan(self.grid.untruncated_m_s).all() else "expected limit"
        drawing.curve(axes, x, limits, self.is_far[:, threat], color=drawing.BLUE, label=kind)
        required = self.catalogue.threats[threat].required_m_s
        axes.axhline(required, linestyle="--", label=f"{required:g} m/s required", **drawing.RULE)
        thickness = getattr(self.result.shown, f"{layer}_thickness_mm")
        self.draw_best(axes, self.result.shown, thickness, float(np.interp(thickness, x, limits)))
        words = in_words(f"armour.{layer}_thickness_mm")
        axes.set(title=self.result.threats[threat], xlabel=words, ylabel=f"{kind}, m/s")

    @cached_property
    def is_far(self) -> Any:
        """Whether each design of the map is far from the tests against each threat, (designs, threats)."""
        return np.array([list(map(bool, each)) for each in self.catalogue.far_from_tests(self.grid.candidates)])

    def note(self) -> str:
        """Return a note on dashed curves, or on what the line of a required probability includes; else ""."""
        if self.varying is not None:
            return "Dashed lines are far from the tests." if self.is_far.any() else ""
        if not self.catalogue.required.any():
            return ""
        if np.isnan(self.grid.stopped_m_s).all():
            return "No probability is known for these designs."
        line = "The line includes the model error only, not the distributions of the inputs."
        return line if self.catalogue.sampled else ""


def _tint(axes: Axes, x: Any, y: Any, values: Any, label: str, colour: str) -> None:
    """Tint the region of a map where values, (y, x), are positive, and name it in the legend."""
    z = np.ma.masked_invalid(np.array(values, float))
    if z.max() > 0.0:
        axes.contourf(x, y, z, levels=[0.0, z.max() + 1.0], colors=[colour], alpha=TINT)
        axes.fill([], [], facecolor=(colour, TINT), label=label, linewidth=0.0)


def _draw_front(axes: Axes, result: DesignResult) -> None:
    """Draw the Pareto front over its first two criteria, with a series for each pair of materials."""
    keys, words = result.criteria[:2], view.OBJECTIVE_WORDS
    for index, (name, designs) in enumerate(grouped(result.pareto, view.pair_words).items()):
        for is_far, some in grouped(designs, lambda design: bool(design.far_from_tests)).items():
            x, y = ([getattr(design, key) for design in some] for key in keys)
            label = drawing.legible(name) + " (far from the tests)" * is_far
            drawing.points(axes, x, y, filled=not is_far, label=label, **drawing.look_of(index))
    shown = [each for each in result.pareto if view.layers_of(each) == view.layers_of(result.shown)]
    x, y = ([getattr(design, key) for design in shown] for key in keys)
    drawing.points(axes, x, y, label=view.best_word(result), markersize=3.0, color=drawing.INK)
    axes.set(title="Pareto front", xlabel=words[keys[0]].heading, ylabel=words[keys[1]].heading)


def _front_notes(result: DesignResult) -> list[str]:
    """Return a sentence on the criteria of a Pareto front that are not drawn, none if all are."""
    hidden = " and ".join(view.OBJECTIVE_WORDS[key].label for key in result.criteria[2:])
    return [f"Designs that others beat in both criteria drawn are better in {hidden}."] if hidden else []


def _caveats(threat: CheckedThreat, notes: Iterable[Note]) -> list[str]:
    """Return as sentences what is far from the tests against a threat, and the caveats of the model."""
    return [sentence(str(line)) for line in (*far_line(threat.far_from_tests), *said_of(notes))]


@draw.register
def draw_check(result: CheckResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the ballistic limits in a panel for each threat, with a row for the armour as given and for each change."""
    by_threat = [(threat.as_given(), *threat.what_ifs) for threat in result.threats]
    names = [[f"{row.change}: {chance(row.probability_of_stopping)}" for row in what_ifs] for what_ifs in by_threat]
    heights = [drawing.rows_height(changes, titled=True) for changes in names]
    notes = ["Percentages: probability that the armour stops a shot.", *_caveats(deciding(result), result.notes)]
    picture = sheet.panels(headline(result), *heights, note=" ".join(notes))
    for axes, threat, what_ifs, changes in zip(picture.axes, result.threats, by_threat, names, strict=True):
        limits = [shown_limit(row.ballistic_limit_m_s, row.expected_limit_m_s) for row in what_ifs]
        ends = {place: row.interval_m_s for place, row in enumerate(what_ifs) if row.interval_m_s is not None}
        name = "expected limit, 95 % interval" if ends else "limit by the model"
        drawing.rows(axes, changes, {name: limits, "velocity of the round": [row.velocity_m_s for row in what_ifs]})
        if ends:
            drawing.ranges(axes, list(ends), list(ends.values()), drawing.BLUE)
        axes.set(xlabel="velocity, m/s", title=f"{threat.threat}: {view.verdict_word(threat.verdict)}")
    return picture
