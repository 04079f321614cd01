"""The designs of a scenario as one interactive page, which needs no network and no library."""

import json
from base64 import b64encode
from collections.abc import Iterable, Iterator, Sequence
from hashlib import sha256
from itertools import pairwise
from typing import Any

import numpy as np

from armour import __version__
from armour.analysis.results import OnProgress, ignore_progress
from armour.analysis.variants import Floats, outside_words
from armour.core.state import Parameters
from armour.design.catalogue import COST_COLUMN, NO_BOUND, Catalogue, catalogue_of
from armour.design.map import DesignMap, design_map, limits_over_sources, thicknesses_tested, with_known_edges
from armour.errors import InputError, Problem
from armour.evidence.caveats import is_limit_too_low, no_metal
from armour.evidence.model_error import INTERLAYER, given_error
from armour.evidence.tests import limits_of_model, outside_tests
from armour.reporting.formats import TEMPLATES, rendered
from armour.reporting.views.design import METALS, in_common
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Layer
from armour.units import MM

# Probabilities of which a page has the velocities that are stopped.  With the interpolation of the page, probabilities
# of 1 to 99 % are right to 0.002, also where the laws of the evidence are far apart.
PROBABILITIES = (0.99, 0.975, 0.95, 0.9, 0.85, 0.77, 0.68, 0.59, 0.5, 0.41, 0.32, 0.23, 0.15, 0.08, 0.04, 0.02, 0.01)
# Designs times threats up to which a page takes less than 1.5 MB.
MOST_DESIGNS = 25_000
# Nodes along an axis of given thicknesses, 0 for no more than these, and of a free range: the first pair of numbers
# with which the page is not too large is used.
PAGE_NODES = ((31, 61), (21, 41), (13, 25), (0, 13))


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
        Changes of the scenario that the command needs, such as "ceramic.flow_stress_GPa=5".
    on_progress : callable, optional
        Called with impacts.
    answer : sequence of str
        What `armour optimise` says if it names no best design, such as the flow stress that is needed.

    Raises
    ------
    InputError
        If more designs are on offer than a page can hold.
    """
    catalogue = catalogue_of(scenario)
    data = _question(catalogue) | {"pairs": _pairs(catalogue, on_progress)}
    data |= {"answer": list(answer), "command": list(command), "changes": list(changes)}
    # In JSON within HTML, no "<" may begin a tag.
    content = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    texts = {ending: (TEMPLATES / f"map.{ending}").read_text() for ending in ("js", "css")}
    hashes = {ending: b64encode(sha256(text.encode()).digest()).decode() for ending, text in texts.items()}
    return rendered("map.html", title=data["subject"], data=content, texts=texts, hashes=hashes)


def _question(catalogue: Catalogue) -> dict[str, Any]:
    """Return what the page needs of the scenario beside the designs: requirements, own armour, threats, notes."""
    from scipy.special import ndtri  # slow to import

    section, scenario = catalogue.section, catalogue.scenario
    return {
        "subject": _subject(catalogue),
        "title": scenario.title,
        "version": __version__,
        "confidence": section.confidence,
        "most": section.areal_density_max_kg_m2,
        "added": {"areal": scenario.inert("areal_density_kg_m2"), "thickness": scenario.inert("thickness_mm")},
        "layers": [
            [("inert", layer.thickness_mm, layer.name) for layer in scenario.armour.layer if layer.place == place]
            for place in ("front", "between", "behind")
        ],
        "interlayer": INTERLAYER if scenario.interlayers else "",
        "scores": [float(score) for score in ndtri(PROBABILITIES)],
        "own": {
            "ceramic": scenario.armour.ceramic,
            "backing": scenario.armour.backing,
            "projectile": scenario.impact.projectile,
            "velocity": scenario.impact.velocity_m_s,
            "obliquity": scenario.impact.obliquity_deg,
        },
        "threats": [_threat(catalogue, i) for i in range(len(catalogue.threats))],
        "notes": list(_notes(catalogue)),
        "exact": catalogue.sampled,
    }


def _subject(catalogue: Catalogue) -> str:
    layers = catalogue.section.ceramic, catalogue.section.backing
    materials = (" or ".join(dict.fromkeys(layer.material for layer in options)) for options in layers)
    armour = " on ".join(filter(None, materials))
    return f"{armour} against {' and '.join(catalogue.titles)}"


def _threat(catalogue: Catalogue, i: int) -> dict[str, Any]:
    threat, bound = catalogue.threats[i], float(catalogue.bounds[i])
    most = threat.probability_of_perforation
    rows = catalogue.against_each(catalogue.candidates(0, np.ones(1), np.ones(1)))
    core = Parameters(*rows.parameters[i].tolist())
    return {
        "name": threat.name or threat.standard or threat.projectile,
        "projectile": threat.projectile,
        "velocity": threat.velocity_m_s,
        "obliquity": threat.obliquity_deg,
        "margin": threat.margin_m_s,
        "own": None if most is None or bound >= NO_BOUND else 1.0 - most,
        "rod": [core.L0 / MM, core.D0 / MM],
    }


def _notes(catalogue: Catalogue) -> Iterator[str]:
    """Give what the page does not show."""
    section = catalogue.section
    if section.minimise != "areal_density_kg_m2":
        objective = "cost" if section.minimise == COST_COLUMN else "thickness"
        yield f"The scenario asks for the least {objective}; this page compares areal densities."
    if section.pareto:
        yield "The Pareto front of the scenario is not shown; armour optimise lists it."
    if catalogue.scenario.distributions():
        yield (
            "The distributions of the inputs are not included: probabilities include the model error alone. "
            "The design that armour optimise finds for a confidence may be heavier."
        )
    if catalogue.scenario.excludes_error():
        yield "The model error is excluded by uncertainty.model, so no probability is known."
    bounds = {"thickness": section.thickness_max_mm, "cost": section.cost_max_per_m2}
    if bounded := [name for name, bound in bounds.items() if bound is not None]:
        yield f"Designs beyond the greatest {' or '.join(bounded)} of the scenario are drawn, but not chosen."


def _pairs(catalogue: Catalogue, on_progress: OnProgress) -> list[dict[str, Any]]:
    """Return the designs of every pair of materials, on the finest grids that are not too much for a page."""
    offers = [offer[:2] for offer in catalogue.offers]
    for nodes, free in PAGE_NODES:
        grids = [(_nodes(ceramic, nodes, free), _nodes(backing, nodes, free)) for ceramic, backing in offers]
        count = sum(len(ceramics) * len(backings) for ceramics, backings in grids) * len(catalogue.threats)
        if count <= MOST_DESIGNS:
            break
    else:
        message = (
            f"must offer at most {MOST_DESIGNS} designs times threats to draw them on a page, found {count}; "
            "widen the steps, or offer fewer materials"
        )
        raise InputError([Problem(catalogue.scenario.file, "design", message)])
    coarser = (nodes, free) != PAGE_NODES[0]
    return [_pair(catalogue, pair, grid, on_progress) | {"coarser": coarser} for pair, grid in enumerate(grids)]


def _nodes(layer: Layer, nodes: int, free: int) -> Floats:
    """Return the thicknesses of a layer that are on offer, with others between them where these are few, mm."""
    offered = layer.thicknesses()
    if layer.free_range():
        return np.linspace(offered[0], offered[-1], free)
    parts = max(-(-nodes // len(offered)), 1)
    between = [np.linspace(low, high, parts, endpoint=False) for low, high in pairwise(offered)]
    return np.concatenate([*between, offered[-1:]])


def _pair(catalogue: Catalogue, pair: int, grid: tuple[Floats, Floats], on_progress: OnProgress) -> dict[str, Any]:
    ceramics, backings = grid = with_known_edges(catalogue, pair, *grid)
    offer = catalogue.offers[pair]
    designs = design_map(catalogue, pair, ceramics, backings, PROBABILITIES, on_progress)
    # A slider of the page has the greatest areal density.
    massless = designs.candidates._replace(areal_density_kg_m2=np.zeros(len(designs.candidates.pair)))
    violations = catalogue.violations(massless)
    tested = [thicknesses_tested(catalogue, pair, i) for i in range(len(catalogue.threats))]
    densities = {"ceramic": offer.ceramic.density_kg_m3, "backing": offer.backing.density_kg_m3}
    counts, density = catalogue.scenario.counts_backing, offer.backing_density_kg_m3
    return {
        "ceramic": offer.ceramic.material,
        "backing": offer.backing.material,
        "densities": [offer.ceramic_density_kg_m3, density * counts],
        "hull": "" if counts else density * float(backings[0]) * MM,
        "changes": [f"{layer}.density_kg_m3={each:.17g}" for layer, each in densities.items() if each is not None],
        "ceramics": ceramics.tolist(),
        "backings": backings.tolist(),
        "offered": [_places(ceramics, offer.ceramic), _places(backings, offer.backing)],
        "free": [layer.free_range() is not None for layer in offer[:2]],
        "excluded": np.flatnonzero(violations > 0.0).tolist(),
        "untested": catalogue.untested[pair],
        "single": bool(catalogue.one_source[pair] or not catalogue.metal[pair]),
        "unlike": "" if catalogue.metal[pair] else no_metal(offer.backing_density_kg_m3),
        "over": _over_sources(catalogue, designs),
        "tested": [[layers["ceramic"], layers["backing"]] if len(layers) == 2 else None for layers in tested],
        "source": _source(catalogue, designs),
        **_outside(catalogue, designs),
        **_numbers(designs),
    }


def _outside(catalogue: Catalogue, designs: DesignMap) -> dict[str, Any]:
    """Return the designs inside the tests, and in what all designs lie outside; the velocities of a page may change.

    Beside these are sentences on designs up to a ceramic thickness, mm, and the threats whose limits are too low.
    """
    rows, threats = catalogue.against_each(designs.candidates), len(catalogue.threats)
    found = outside_tests(rows.armours, np.full_like(rows.velocities, np.nan), threats)
    ceramic_mm, notes = np.repeat(designs.candidates.ceramic_mm, threats), []
    for note, where in limits_of_model(rows.armours, [rows.materials[0].backing]):
        notes += [(note.text, float(ceramic_mm[where].max()))] if note.said != "not known" else []
    if len({offer.backing.material for offer in catalogue.offers}) > 1 and ceramic_mm.any():
        notes.append((METALS, float(ceramic_mm.max())))
    return {
        "caveats": [(f"{words[:1].upper()}{words[1:]}.", most_mm) for words, most_mm in notes],
        "low": is_limit_too_low(rows.armours.parameters)[:threats].tolist(),
        "inside": [place for place, outside in enumerate(found) if not outside],
        "outside": outside_words(in_common(found)),
    }


def _over_sources(catalogue: Catalogue, designs: DesignMap) -> list[list[float]] | None:
    """Return the limits with the least and the greatest flow stress of sources, of designs and threats in turn.

    There are none without sources, nor if both thicknesses vary, as they would take too much room.
    """
    if min(len(designs.ceramic_mm), len(designs.backing_mm)) > 1:
        return None
    limits = limits_over_sources(catalogue, designs)
    return None if limits is None else [limits[place].ravel().round(1).tolist() for place in (0, -1)]


def _places(nodes: Floats, layer: Layer) -> list[int]:
    """Return the places of the thicknesses on offer among the nodes; all of a free range."""
    if layer.free_range():
        return list(range(len(nodes)))
    return np.searchsorted(nodes, layer.thicknesses()).tolist()


def _source(catalogue: Catalogue, designs: DesignMap) -> str:
    """Return what the probabilities of a pair rest on."""
    places = np.flatnonzero(~np.isnan(designs.stopped_m_s[..., 0, 0]))
    if not len(places):
        return ""
    if (error := given_error(catalogue.scenario)) is not None:
        return error.source
    rows = catalogue.against_each(designs.candidates.at(places[:1])).at(np.array([0]))
    return next(evidence.title for evidence, _ in rows.armours.by_evidence())


def _numbers(designs: DesignMap) -> dict[str, Any]:
    """Return limits and velocities that are stopped as bytes.

    Of each design and threat there is the limit, the least of the velocities, 0 where it is unknown, both as 32-bit
    floats, and the differences of the velocities as 16-bit multiples of the step, rounded down in sum.
    """
    limits = designs.limits_m_s.reshape(-1)
    stopped = np.nan_to_num(designs.stopped_m_s.reshape(len(limits), -1))
    floats = np.column_stack([limits, stopped[:, 0]]).astype("<f4")
    above = np.maximum(stopped - floats[:, 1:].astype(np.float64), 0.0)
    step = max(float(np.diff(above, axis=1).max(initial=0.0)) / 65_000.0, 1e-3)
    differences = np.diff(np.floor(above / step), axis=1).astype("<u2")
    return {
        "step": step,
        "floats": b64encode(floats.tobytes()).decode(),
        "differences": b64encode(differences.tobytes()).decode(),
    }
