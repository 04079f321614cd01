"""Draw design searches and checks."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from armour.design.catalogue import Catalogue, catalogue_of
from armour.design.check import CheckResult, deciding, shown_limit
from armour.design.map import DesignMap, design_map, limits_over_sources, with_known_edges
from armour.design.optimise import Design, DesignResult, armour_in_words
from armour.design.requirements import EVEN
from armour.reporting.by_result import draw, headline, in_a_line
from armour.reporting.pictures import drawing
from armour.reporting.table import grouped, in_words, percent
from armour.reporting.views import design as view
from armour.reporting.words import chance, said_of
from armour.scenario.schema import OBJECTIVES

# Largest numbers of pairs of materials that are drawn as points and as lines; number of nodes of a map along an axis.
MAX_PAIRS_DRAWN, MAX_LINES, MAP_NODES = 12, 6, 25
# Probability of stopping that a band begins with; it ends with that of perforation.
USUAL_CHANCE = 0.95
# Opacity of a tinted region.
TINT = 0.14
# Markers of designs whose probability of stopping a shot is known, and of those by the model.
KNOWN_MARK, MODEL_MARK = "o", "s"


class _Panel(NamedTuple):
    """A panel: its height, inches, its title, the function that draws it, and a note for below the picture."""

    height: float
    title: str
    draw: Callable[[Axes], None]
    note: str


@draw.register
def draw_design(result: DesignResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw a map of the best pair of materials, with panels for the pairs and the Pareto front below it.

    If only one thickness varies, draw the ballistic limits over it instead.
    """
    layer, maps = _maps(result)
    if layer:
        return _draw_lines(result, layer, maps, sheet)
    panels = [_Panel(1.6 * drawing.PANEL, "", maps[0].draw, maps[0].note())]
    panels += [_pairs_panel(result)] if len(view.best_of_pairs(result)) > 1 else []
    panels += [_front_panel(result)] if result.pareto else []
    notes = " ".join(filter(None, (*(panel.note for panel in panels), *_caveats(result))))
    picture = sheet.panels(_title(result), *(panel.height for panel in panels), note=notes)
    for axes, panel in zip(picture.axes, panels, strict=True):
        panel.draw(axes)
        axes.set_title(panel.title)
    return picture


def _maps(result: DesignResult) -> "tuple[str, list[_Map]]":
    """Return the maps to draw, and before them "ceramic" or "backing" if the thickness of this layer alone varies.

    Without such a layer, the text is empty, and the map is that of the best pair.
    """
    catalogue = catalogue_of(drawing.recorded(result, "scenario"))
    names = [(offer.ceramic.material, offer.backing.material) for offer in catalogue.offers]
    best = names.index((result.shown.ceramic, result.shown.backing))
    probabilities = tuple({1.0 - USUAL_CHANCE, EVEN, USUAL_CHANCE, *(1.0 - catalogue.bounds).tolist()})

    def pair_map(pair: int) -> _Map:
        layers = (np.array(layer.thicknesses()) for layer in catalogue.offers[pair][:2])
        grid = with_known_edges(catalogue, pair, *(_nodes(layer) for layer in layers))
        return _Map(result, catalogue, design_map(catalogue, pair, *grid, probabilities))

    is_single_by_pair = [tuple(len(layer.thicknesses()) == 1 for layer in offer[:2]) for offer in catalogue.offers]
    if not any(is_single_by_pair[best]):
        return "", [pair_map(best)]
    layer = "backing" if is_single_by_pair[best][0] and not is_single_by_pair[best][1] else "ceramic"
    pairs = [pair for pair, is_single in enumerate(is_single_by_pair) if is_single[layer == "ceramic"]]
    pairs.sort(key=lambda pair: pair != best)
    return layer, [pair_map(pair) for pair in pairs[:MAX_LINES]]


def _nodes(offered: Any) -> Any:
    """Return evenly spaced thicknesses over the range on offer, mm."""
    return np.linspace(offered[0], offered[-1], MAP_NODES) if len(offered) > 1 else offered


def _draw_lines(result: DesignResult, layer: str, maps: "Sequence[_Map]", sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the ballistic limits of pairs of materials over the thickness of one layer, with a panel for each threat."""
    bands, notes = [], []
    if not all(np.isnan(pair_map.grid.stopped_m_s).all() for pair_map in maps):
        bands.append("the velocities at which a shot is stopped with 95 to 5 %")
    if any(pair_map.over_sources is not None for pair_map in maps):
        bands.append("the limits with the flow stresses that sources give for untested ceramics")
    if bands:
        notes.append(f"Bands show {' or '.join(bands)}.")
    if any(pair_map.is_far.any() for pair_map in maps):
        notes.append("Dashed lines are far from the tests.")
    note = " ".join([*notes, *_caveats(result)])
    picture = sheet.panels(_title(result), *[drawing.PANEL] * len(result.threats), note=note, sharex=True)
    for place, (axes, threat) in enumerate(zip(picture.axes, maps[0].catalogue.threats, strict=True)):
        for index, pair_map in enumerate(maps):
            pair_map.draw_line(axes, layer, place, drawing.COLOURS[index % len(drawing.COLOURS)])
        thickness, grid = getattr(result.shown, f"{layer}_thickness_mm"), maps[0].grid
        limit = np.interp(thickness, getattr(grid, f"{layer}_mm"), maps[0].shown_m_s[..., place].ravel())
        maps[0].draw_best(axes, result.shown, thickness, limit)
        axes.axhline(threat.required_m_s, linestyle="--", label=f"{threat.required_m_s:g} m/s required", **drawing.RULE)
        known = not np.isnan(maps[0].grid.by_tests_m_s).all()
        axes.set(title=result.threats[place], ylabel=f"{'expected limit' if known else 'limit by the model'}, m/s")
    picture.axes[-1].set_xlabel(in_words(f"armour.{layer}_thickness_mm"))
    return picture


@dataclass(frozen=True)
class _Map:
    """A map of the designs of a pair of materials."""

    result: DesignResult
    catalogue: Catalogue
    grid: DesignMap

    @property
    def shown_m_s(self) -> Any:
        """The expected limits or, where no tests tell, those by the model, m/s, (ceramics, back plates, threats)."""
        expected = self.grid.by_tests_m_s[..., self.grid.probabilities.index(EVEN)]
        return np.where(np.isnan(expected), self.grid.limits_m_s, expected)

    def required(self) -> tuple[Any, Any, str]:
        """Return how far each design exceeds what is required, m/s, whether that is stated, and what is, in words.

        Both are arrays, (ceramics, back plates).  The threat with the least excess counts.  A probability is not stated
        where it is not known, or greater than that so far from the tests.  If none is known or required, the model
        tells.
        """
        margins_m_s, velocities_m_s = self.catalogue.margins_m_s, self.catalogue.velocities_m_s
        excess_m_s = self.shown_m_s - velocities_m_s - margins_m_s
        asked, known = (
            [1.0 - bound for bound in self.catalogue.bounds.tolist()],
            ~np.isnan(self.grid.by_tests_m_s[..., 0]),
        )
        for threat in np.flatnonzero(self.catalogue.required):
            by_tests_m_s = self.grid.by_tests_m_s[..., threat, self.grid.probabilities.index(asked[threat])]
            by_limit_m_s = excess_m_s[..., threat] if margins_m_s[threat] > 0.0 else np.inf
            by_tests_m_s = np.minimum(by_tests_m_s - velocities_m_s[threat], by_limit_m_s)
            excess_m_s[..., threat] = np.where(known[..., threat], by_tests_m_s, excess_m_s[..., threat])
        by_model = not (known.any() or self.catalogue.required.any())
        is_stated = ((known & (self.grid.greatest >= asked)) | by_model).all(axis=-1)
        words = "stopped by the model" if by_model else f"stops a shot with {percent(asked[0])} or more"
        if margins_m_s.any() or len({*asked}) > 1:
            words = "does what is required"
        return excess_m_s.min(axis=-1), is_stated, words

    def draw(self, axes: Axes) -> None:
        """Draw the line of what is required, lines of the objective, and the best design."""
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
        drawing.contours(axes, x, y, objective, 5, at=-0.55, label=label, linestyle=":", color=drawing.SOFT)
        best = self.result.shown
        self.draw_best(axes, best, best.backing_thickness_mm, best.ceramic_thickness_mm)

    def draw_best(self, axes: Axes, best: Design, x: float, y: float) -> None:
        """Draw the best or nearest design at a place of the panel."""
        look: Any = {"markersize": 9.0, "color": drawing.VERMILION if self.result.reason else drawing.INK}
        text = _design_text(best, self.result.minimised)
        drawing.points(axes, [x], [y], [text], label=f"{_best_words(self.result)}: {text}", **look)

    @cached_property
    def over_sources(self) -> Any:
        """Ballistic limits, m/s, (sources, ceramics, back plates, threats), with the flow stress of each source.

        None without sources.
        """
        return limits_over_sources(self.catalogue, self.grid)

    def name(self, layer: str) -> str:
        """Return the name of the pair in a picture over the thickness of a layer.

        It is that of the ceramic alone, if the ceramic varies in thickness and there is only one metal.
        """
        ceramic, backing = (offer.material for offer in self.catalogue.offers[self.grid.pair][:2])
        if not ceramic:
            return backing
        ceramic += " (no test)" * self.catalogue.untested[self.grid.pair]
        one_metal = len(self.catalogue.section.backing) == 1
        return ceramic if one_metal and layer == "ceramic" else f"{ceramic} on {backing}"

    def draw_line(self, axes: Axes, layer: str, threat: int, colour: str) -> None:
        """Draw the ballistic limits against a threat over the thickness of a layer.

        Bands show the limits over the sources of the flow stress, and the model error.
        """
        x = getattr(self.grid, f"{layer}_mm")
        limits = self.shown_m_s[..., threat].ravel()
        by_source = None if self.over_sources is None else self.over_sources[..., threat].reshape(-1, len(x))
        if by_source is not None and len(by_source) > 1:
            axes.fill_between(x, by_source[0], by_source[-1], color=colour, **drawing.BAND)
        if not np.isnan(self.grid.stopped_m_s[..., threat, :]).all():
            low_m_s, high_m_s = map(self.grid.stopped_with, (USUAL_CHANCE, 1.0 - USUAL_CHANCE))
            axes.fill_between(
                x, low_m_s[..., threat].ravel(), high_m_s[..., threat].ravel(), color=colour, **drawing.BAND
            )
        label = drawing.legible(self.name(layer))
        drawing.curve(axes, x, limits, self.is_far[:, threat], color=colour, label=label)

    @cached_property
    def is_far(self) -> Any:
        """Whether each design of the map is far from the tests against each threat, (designs, threats)."""
        return np.array([list(map(bool, each)) for each in self.catalogue.far_from_tests(self.grid.candidates)])

    def note(self) -> str:
        """Return a note on what the line of a required probability includes."""
        if not self.catalogue.required.any():
            return ""
        if np.isnan(self.grid.stopped_m_s).all():
            return "No probability is known for these designs."
        line = "The line includes the model error only, not the distributions of the inputs."
        return line if self.catalogue.sampled else ""


def _title(result: DesignResult) -> str:
    """Return the design shown with the verdict on it; a note has the rest of the answer."""
    threat, verdict = deciding(result.shown.check), result.shown.check.verdict
    density = f"{result.shown.check.areal_density_kg_m2:.1f} kg/m²"
    title = (
        f"{'Nearest: ' * bool(result.reason)}{armour_in_words(result.shown)}, {density}: {view.verdict_word(verdict)}"
    )
    if threat.probability_of_stopping is not None and verdict != "fails":
        return f"{title} with {view.chance_text(threat)}"
    return f"{title} against {threat.threat}" if len(result.threats) > 1 else title


def _best_words(result: DesignResult) -> str:
    """Return what the design shown is, as the answer calls it, such as "lightest by the model"."""
    return view.found_in_a_line(result).partition(":")[0]


def _tint(axes: Axes, x: Any, y: Any, values: Any, label: str, colour: str) -> None:
    """Tint the region where values, (y, x), are positive."""
    z = np.ma.masked_invalid(np.array(values, float))
    if z.max() > 0.0:
        axes.contourf(x, y, z, levels=[0.0, z.max() + 1.0], colors=[colour], alpha=TINT)
        axes.fill([], [], facecolor=(colour, TINT), label=label, linewidth=0.0)


def _pairs_panel(result: DesignResult) -> _Panel:
    """Return the panel with the best design of each pair of materials, over the objective."""
    best = view.best_of_pairs(result)
    shown = best[:MAX_PAIRS_DRAWN]
    names = [view.pair_words(design) for design in shown]

    def draw_pairs(axes: Axes) -> None:
        drawing.name_rows(axes, names)
        looks = [(deciding(each.check).model_error is None, bool(each.far_from_tests)) for each in shown]
        for look in dict.fromkeys(looks):
            places = [place for place, each in enumerate(looks) if each == look]
            values = [getattr(shown[place], result.minimised) for place in places]
            by_model, is_far = look
            label = ", ".join(["by the model"] * by_model + ["far from the tests"] * is_far)
            mark = MODEL_MARK if by_model else KNOWN_MARK
            drawing.points(
                axes, values, places, filled=not is_far, label=label, marker=mark, markersize=6.0, color=drawing.BLUE
            )
        axes.set_xlabel(view.OBJECTIVE_WORDS[result.minimised].heading)

    notes = [f"The best {MAX_PAIRS_DRAWN} of {len(best)} pairs of materials are shown."] * (len(best) > MAX_PAIRS_DRAWN)
    note = " ".join([*notes, *(f"{words[:1].upper()}{words[1:]}." for words in view.pair_caveats(result))])
    heading = f"{OBJECTIVES[result.minimised].least.capitalize()} design of each pair of materials"
    return _Panel(drawing.rows_height(names, titled=True), heading, draw_pairs, note)


def _front_panel(result: DesignResult) -> _Panel:
    """Return the panel with the Pareto front over its first two criteria, with a series for each pair of materials."""
    keys = result.criteria[:2]

    def draw_designs(axes: Axes, designs: Sequence[Design], name: str, **look: Any) -> None:
        x, y = ([getattr(design, key) for design in designs] for key in keys)
        words = [f"{name}\n{_design_text(design, *result.criteria)}" for design in designs]
        drawing.points(axes, x, y, words, label=drawing.legible(name), **look)

    def draw_all(axes: Axes) -> None:
        for index, (name, designs) in enumerate(grouped(result.pareto, view.pair_words).items()):
            for far, some in grouped(designs, lambda design: bool(design.far_from_tests)).items():
                draw_designs(axes, some, name + " (far from the tests)" * far, filled=not far, **drawing.look_of(index))
        shown = [each for each in result.pareto if view.layers_of(each) == view.layers_of(result.shown)]
        draw_designs(axes, shown, _best_words(result), markersize=3.0, color=drawing.INK)
        axes.set(xlabel=view.OBJECTIVE_WORDS[keys[0]].heading, ylabel=view.OBJECTIVE_WORDS[keys[1]].heading)

    notes = []
    if len(result.criteria) > 2:
        hidden = " and ".join(view.OBJECTIVE_WORDS[key].label for key in result.criteria[2:])
        notes.append(f"Designs that others beat in both criteria drawn are better in {hidden}.")
    if view.COST.key in keys:
        notes.append("Costs are in the currency of the scenario.")
    return _Panel(drawing.PANEL, "Pareto front", draw_all, " ".join(notes))


def _design_text(design: Design, *criteria: str) -> str:
    """Return the thicknesses of a design and its values of the given criteria, as text."""
    words = view.OBJECTIVE_WORDS
    values = (f"{words[key].label} {words[key].with_unit(getattr(design, key))}" for key in criteria)
    return ", ".join([f"{design.ceramic_thickness_mm:.4g} on {design.backing_thickness_mm:.4g} mm", *values])


def _caveats(result: CheckResult | DesignResult) -> list[str]:
    """Return as sentences the answer of a search, what is far from the tests, and the caveats of the model."""
    far = deciding(result if isinstance(result, CheckResult) else result.shown.check).far_from_tests
    texts = [in_a_line(result)] * isinstance(result, DesignResult)
    texts += [f"far from the tests: {', '.join(far)}"] * bool(far) + said_of(result.notes)
    return [f"{text[:1].upper()}{text[1:]}." for text in texts]


@draw.register
def draw_check(result: CheckResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the ballistic limits in a panel for each threat, with a row for the armour as given and for each change."""
    by_threat = [(threat.as_given(), *threat.what_ifs) for threat in result.threats]
    names = [[f"{row.change}: {chance(row.probability_of_stopping)}" for row in what_ifs] for what_ifs in by_threat]
    heights = [drawing.rows_height(changes, titled=True) for changes in names]
    note = " ".join(["Percentages: probability that the armour stops a shot.", *_caveats(result)])
    picture = sheet.panels(headline(result), *heights, note=note)
    for axes, threat, what_ifs, changes in zip(picture.axes, result.threats, by_threat, names, strict=True):
        last = axes is picture.axes[-1]
        drawing.name_rows(axes, changes)
        places = range(len(changes))
        limits = np.array([shown_limit(row.ballistic_limit_m_s, row.expected_limit_m_s) for row in what_ifs], float)
        # An unknown interval is drawn as the limit alone.
        ends = [row.interval_m_s or (limit, limit) for row, limit in zip(what_ifs, limits, strict=True)]
        drawing.ranges(axes, places, ends, drawing.BLUE)
        is_known = any(row.interval_m_s for row in what_ifs)
        label = ("expected limit, 95 % interval" if is_known else "limit by the model") if last else ""
        drawing.points(axes, limits, places, color=drawing.BLUE, label=label)
        velocities = [row.velocity_m_s for row in what_ifs]
        label = "velocity of the round" if last else ""
        drawing.points(axes, velocities, places, marker="D", color=drawing.VERMILION, label=label)
        axes.set(xlabel="velocity, m/s", title=f"{threat.threat}: {view.verdict_word(threat.verdict)}")
    return picture
