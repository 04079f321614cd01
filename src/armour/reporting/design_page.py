"""Write the designs of a scenario as one interactive HTML page, which needs no network and no JavaScript library."""

import json
from base64 import b64encode
from collections.abc import Iterable, Iterator, Sequence
from hashlib import sha256
from itertools import pairwise
from typing import Any

import numpy as np

from armour import __version__
from armour.analysis.ballistic_limit import limit_and_error
from armour.analysis.results import OnProgress, ignore_progress
from armour.analysis.variants import Floats
from armour.core.state import Parameters
from armour.design.catalogue import COST_COLUMN, Catalogue, catalogue_of
from armour.design.check import USUAL_PROBABILITY
from armour.design.map import DesignMap, design_map, with_known_edges
from armour.design.requirements import VERDICTS, Requirement
from armour.errors import InputError, Problem
from armour.evidence.caveats import is_limit_too_low
from armour.evidence.tests import LAYERS, LEAST_SOURCES, against_each, limits_of_model, what_was_tested
from armour.reporting.formats import TEMPLATES, rendered
from armour.reporting.table import sentence
from armour.reporting.views.design import METALS, verdict_word
from armour.reporting.words import requirement_words
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Layer
from armour.units import MM

# The page has the velocity that each design stops with each of these probabilities and of those required, and
# interpolates between them.  Probabilities of 1 to 99 % are then right to 0.002, even where the laws of the flow stress
# differ widely.
PROBABILITIES = (0.99, 0.975, 0.95, 0.9, 0.85, 0.77, 0.68, 0.59, 0.5, 0.41, 0.32, 0.23, 0.15, 0.08, 0.04, 0.02, 0.01)
# Largest number of designs times threats on a page, which then takes less than 1.5 MB.
MOST_DESIGNS = 25_000
# Numbers of nodes along an axis, of which the first with which the page is not too large is used; 0 adds none between
# the thicknesses on offer.
PAGE_NODES = (31, 21, 13, 0)


def design_page(
    scenario: Scenario,
    command: Sequence[str],
    changes: Iterable[str] = (),
    on_progress: OnProgress = ignore_progress,
    answer: Sequence[str] = (),
) -> str:
    """Return the page of the designs of a scenario.

    Parameters
    ----------
    scenario : Scenario
    command : sequence of str
        Words of the command that simulates the scenario.
    changes : iterable of str
        Changes to the scenario that the command needs, such as "ceramic.flow_stress_GPa=5".
    on_progress : callable, optional
        Called with the impacts computed since the last call, and their total.
    answer : sequence of str
        What `armour optimise` says if it names no best design, such as the flow stress that is needed.

    Raises
    ------
    InputError
        If more designs are on offer than a page can hold.
    """
    catalogue = catalogue_of(scenario)
    probabilities = tuple(sorted({*PROBABILITIES, *np.round(1.0 - catalogue.bounds, 9).tolist()}, reverse=True))
    data = _question(catalogue) | {"probabilities": probabilities}
    data["pairs"] = _pairs(catalogue, probabilities, on_progress)
    data |= {"answer": list(answer), "command": list(command), "changes": list(changes)}
    # In JSON within HTML, no "<" may begin a tag.
    content = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    texts = {ending: (TEMPLATES / f"map.{ending}").read_text() for ending in ("js", "css")}
    hashes = {ending: b64encode(sha256(text.encode()).digest()).decode() for ending, text in texts.items()}
    return rendered("map.html", title=_subject(catalogue), data=content, texts=texts, hashes=hashes)


def _question(catalogue: Catalogue) -> dict[str, Any]:
    """Return the data of the page other than designs: requirements, the scenario's own armour, threats and notes.

    "most" and "thickest" are the greatest areal density, kg/m², and thickness, mm, that [design] allows, if any;
    "added" is what layers other than tile and plate add to both, and "usual" the probability if none is required.
    """
    section, scenario = catalogue.section, catalogue.scenario
    return {
        "verdicts": list(map(verdict_word, VERDICTS)),
        "usual": USUAL_PROBABILITY,
        "probability": section.probability_of_stopping,
        "most": section.areal_density_max_kg_m2,
        "thickest": section.thickness_max_mm,
        "limited": section.cost_max_per_m2 is not None,
        "added": {"areal": scenario.inert("areal_density_kg_m2"), "thickness": scenario.inert("thickness_mm")},
        "layers": [
            [("inert", layer.thickness_mm, layer.name) for layer in scenario.armour.layer if layer.place == place]
            for place in ("front", "between", "behind")
        ],
        "own": {
            "ceramic": scenario.armour.ceramic,
            "backing": scenario.armour.backing,
            "projectile": scenario.impact.projectile,
            "velocity": scenario.impact.velocity_m_s,
            "obliquity": scenario.impact.obliquity_deg,
        },
        "threats": [_threat(catalogue, index) for index in range(len(catalogue.threats))],
        "notes": list(_notes(catalogue)),
        "exact": catalogue.sampled,
    }


def _subject(catalogue: Catalogue) -> str:
    """Return the title of the page, such as "AD85 on 6061-T6 against 7.62 mm AP"."""
    layers = catalogue.section.ceramic, catalogue.section.backing
    materials = (" or ".join(dict.fromkeys(layer.material for layer in options)) for options in layers)
    armour = " on ".join(filter(None, materials))
    return f"{armour} against {' and '.join(threat.title for threat in catalogue.threats)}"


def _threat(catalogue: Catalogue, index: int) -> dict[str, Any]:
    """Return the data of the threat with an index: its name, velocity and requirements.

    "own" is the required probability of stopping, if the threat has one, "rod" the penetrator's length and diameter in
    mm, and "words" are what stands before and after the velocity.
    """
    threat = catalogue.threats[index]
    most, speed = threat.probability_of_perforation, f" at {threat.velocity_m_s:g} m/s"
    before, _, after = threat.title.partition(speed)
    rows = catalogue.against_each(catalogue.candidates(0, np.ones(1), np.ones(1)))
    core = Parameters(*rows.parameters[index].tolist())
    return {
        "name": threat.round_name,
        "words": [before, after],
        "projectile": threat.projectile,
        "velocity": threat.velocity_m_s,
        "obliquity": threat.obliquity_deg,
        "margin": threat.margin_m_s,
        "own": None if most is None else 1.0 - most,
        "rod": [core.L0 / MM, core.D0 / MM],
    }


def _notes(catalogue: Catalogue) -> Iterator[str]:
    """Yield sentences on what the page shows and leaves out."""
    section, title = catalogue.section, catalogue.scenario.title
    yield "Probabilities are those of one shot, far from edges and joints; firing tests are not replaced."
    if section.minimise != "areal_density_kg_m2":
        objective = "cost" if section.minimise == COST_COLUMN else "thickness"
        yield f"The scenario asks for the least {objective}; this page compares areal densities."
    if section.pareto:
        yield "The Pareto front of the scenario is not shown; armour optimise lists it."
    if catalogue.scenario.distributions():
        yield (
            "The distributions of the inputs are not included: probabilities include the model error alone. "
            "The design that armour optimise finds for a required probability may be heavier."
        )
    if catalogue.scenario.excludes_error():
        yield "By the model alone, as uncertainty.model asks: no probability is known."
    bounds = {"thickness": section.thickness_max_mm, "cost": section.cost_max_per_m2}
    if bounded := [name for name, bound in bounds.items() if bound is not None]:
        yield f"Designs beyond the greatest {' or '.join(bounded)} of the scenario are drawn, but not chosen."
    yield f"armour {__version__}{f'; scenario: {title}' * bool(title)}"


def _pairs(catalogue: Catalogue, probabilities: tuple[float, ...], on_progress: OnProgress) -> list[dict[str, Any]]:
    """Return the data of every pair of materials, on the finest grids that fit on a page."""
    offers = [offer[:2] for offer in catalogue.offers]
    for nodes in PAGE_NODES:
        grids = [(_nodes(ceramic, nodes), _nodes(backing, nodes)) for ceramic, backing in offers]
        count = sum(len(ceramics) * len(backings) for ceramics, backings in grids) * len(catalogue.threats)
        if count <= MOST_DESIGNS:
            break
    else:
        message = (
            f"must offer at most {MOST_DESIGNS} designs times threats to draw them on a page, found {count}; "
            "widen the steps, or offer fewer materials"
        )
        raise InputError([Problem(catalogue.scenario.file, "design", message)])
    coarser = nodes != PAGE_NODES[0]
    pairs = (_pair(catalogue, pair, grid, probabilities, on_progress) for pair, grid in enumerate(grids))
    return [pair | {"coarser": coarser} for pair in pairs]


def _nodes(layer: Layer, count: int) -> Floats:
    """Return the thicknesses of a layer that are on offer, mm, with others between them: about `count` in all."""
    offered = layer.thicknesses()
    parts = max(-(-count // len(offered)), 1)  # rounded up
    between = [np.linspace(low, high, parts, endpoint=False) for low, high in pairwise(offered)]
    return np.concatenate([*between, offered[-1:]])


def _pair(
    catalogue: Catalogue, pair: int, grid: Sequence[Floats], probabilities: tuple[float, ...], on_progress: OnProgress
) -> dict[str, Any]:
    """Return the data of a pair of materials; `grid` has its ceramic and back plate thicknesses, mm.

    "densities" are those of the layers, kg/m³, 0 for a back plate that exists already, whose areal density, kg/m², is
    "hull".  "offered" has the indices of the thicknesses on offer, and "excluded" those of designs beyond a bound.
    """
    ceramics, backings = grid = with_known_edges(catalogue, pair, *grid)
    offer = catalogue.offers[pair]
    designs = design_map(catalogue, pair, ceramics, backings, probabilities, on_progress)
    # A slider of the page limits the areal density, so it excludes no design here.
    massless = designs.candidates._replace(areal_density_kg_m2=np.zeros(len(designs.candidates.pair)))
    violations = catalogue.violations(massless)
    counts, density = catalogue.scenario.counts_backing, offer.backing_density_kg_m3
    return {
        "ceramic": offer.ceramic.material,
        "backing": offer.backing.material,
        "densities": [offer.ceramic_density_kg_m3, density * counts],
        "hull": "" if counts else density * float(backings[0]) * MM,
        "ceramics": ceramics.tolist(),
        "backings": backings.tolist(),
        "offered": [
            np.searchsorted(mm, layer.thicknesses()).tolist() for mm, layer in zip(grid, offer[:2], strict=True)
        ],
        "excluded": np.flatnonzero(violations > 0.0).tolist(),
        "untested": catalogue.untested[pair],
        "tested": [_tested(catalogue, designs, tiled=tiled) for tiled in (False, True)],
        **_caveats(catalogue, designs),
        **_numbers(designs),
    }


def _tested(catalogue: Catalogue, designs: DesignMap, *, tiled: bool) -> dict[str, Any] | None:
    """Return what tests tell of the designs with, or without, a tile; None if there are none.

    "unsound" says why the model does not hold, if it does not, and "rank" is the greatest of the designs in a search.
    For each threat, "tile" and "plate" are the least and greatest thicknesses tested, mm, "tiles" and "plates" words
    for those on the page that are far from these, "far" what else is far, "source" and "floor" the tests where the
    probability is known and whether it is at least that, and "why" the reason where it is not.
    """
    places = np.flatnonzero((designs.candidates.ceramic_mm > 0.0) == tiled)
    if not len(places):
        return None
    count = len(catalogue.threats)
    known = ~np.isnan(designs.untruncated_m_s[..., 0]).reshape(-1, count)[places]
    rows, of_threats = catalogue.against_each(designs.candidates), []
    for threat in range(count):
        firsts = (places[each.argmax(), None] for each in (known[:, threat], ~known[:, threat]))
        row_known, row_unknown = (rows.at(place * count + threat) for place in firsts)
        _, error, _ = limit_and_error(row_known, ignore_progress)
        tested = what_was_tested(catalogue.threats[threat], row_known.armours)
        sizes = zip(LAYERS.values(), (designs.ceramic_mm.tolist(), designs.backing_mm.tolist()), strict=True)
        words = {f"{layer}s": [str(tested.far(layer, mm) or "") for mm in sizes_mm] for layer, sizes_mm in sizes}
        of_threats.append(
            {
                **tested.thicknesses_mm,
                **words,
                "far": list(map(str, tested.others)),
                "source": "" if error is None else error.source,
                "floor": error is not None and bool(error.at_least),
                "why": "" if known[:, threat].all() else row_unknown.why_error_unknown(),
            }
        )
    rank, unsound = _greatest_rank(catalogue, designs.pair, tiled=tiled)
    return {"unsound": unsound, "rank": rank, "threats": of_threats}


def _greatest_rank(catalogue: Catalogue, pair: int, *, tiled: bool) -> tuple[int, str]:
    """Return the greatest rank of designs of a pair in a search, 0 to 4, and why the model does not hold, else "".

    The function `rank` in map.js lists the ranks.  `tiled` says which designs: those with a tile, or those without.
    """
    offer, ceramic = catalogue.offers[pair], catalogue.materials[pair].ceramic
    lacking = tiled and ceramic is not None and catalogue.lacks_sources[pair]
    for rank, quantity, required, found, is_unsound in (
        (0, "backing_density_kg_m3", 0.0, offer.backing_density_kg_m3, not catalogue.metal[pair]),
        (2 if lacking else 3, "interlayers", 0.0, 0.0, catalogue.scenario.interlayers),
        (2, "flow_stress_sources", LEAST_SOURCES, 0 if ceramic is None else ceramic.sources, lacking),
    ):
        if is_unsound:
            return rank, requirement_words(Requirement(quantity, "", required, found, "not known"))
    return 4, ""


def _caveats(catalogue: Catalogue, designs: DesignMap) -> dict[str, Any]:
    """Return the caveats of the model on the designs of a pair.

    "caveats" has sentences, each with the greatest ceramic thickness, mm, that it applies to; "low" says for each
    threat whether the computed ballistic limit of a bare plate is too low.
    """
    rows, threats = catalogue.against_each(designs.candidates), len(catalogue.threats)
    ceramic_mm, notes = designs.candidates.ceramic_mm, []
    against = (rows.armours.at(slice(threat, None, threats)) for threat in range(threats))
    by_threat = (limits_of_model(armours, [rows.materials[0].backing]) for armours in against)
    for note, masks in against_each([threat.title for threat in catalogue.threats], by_threat):
        most_mm = max(float(ceramic_mm[mask].max()) for mask in masks)
        notes += [(note.text, most_mm)] if note.said != "not known" else []
    if len({offer.backing.material for offer in catalogue.offers}) > 1 and ceramic_mm.any():
        notes.append((METALS, float(ceramic_mm.max())))
    return {
        "caveats": [(sentence(words), most_mm) for words, most_mm in notes],
        "low": is_limit_too_low(rows.armours.parameters)[:threats].tolist(),
    }


def _numbers(designs: DesignMap) -> dict[str, Any]:
    """Encode ballistic limits and stopped velocities, m/s, in base64 for the script of the page.

    For each design and threat, "floats" has three 32-bit floats: the limit, the least stopped velocity (0 if unknown),
    and the greatest probability that is stated.  "differences" has those between successive stopped velocities, as
    16-bit multiples of "step"; their sums are rounded down.
    """
    limits = designs.limits_m_s.reshape(-1)
    stopped = np.nan_to_num(designs.untruncated_m_s.reshape(len(limits), -1))
    floats = np.column_stack([limits, stopped[:, 0], designs.greatest_probability.reshape(-1)]).astype("<f4")
    above = np.maximum(stopped - floats[:, 1:2].astype(np.float64), 0.0)
    step = max(float(np.diff(above, axis=1).max(initial=0.0)) / 65_000.0, 1e-3)
    differences = np.diff(np.floor(above / step), axis=1).astype("<u2")
    return {
        "step": step,
        "floats": b64encode(floats.tobytes()).decode(),
        "differences": b64encode(differences.tobytes()).decode(),
    }
