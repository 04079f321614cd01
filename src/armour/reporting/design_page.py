"""Write the designs of a scenario as one interactive HTML page, which needs no network and no JavaScript library."""

import json
from base64 import b64encode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from hashlib import sha256
from itertools import pairwise
from typing import Any

import numpy as np

from armour import __version__
from armour.analysis.results import OnProgress, ignore_progress
from armour.analysis.variants import Floats, outside_words
from armour.core.state import Parameters
from armour.design.catalogue import COST_COLUMN, Catalogue, catalogue_of
from armour.design.map import DesignMap, design_map, limits_over_sources, thicknesses_tested, with_known_edges
from armour.errors import InputError, Problem
from armour.evidence.caveats import is_limit_too_low, no_metal
from armour.evidence.model_error import INTERLAYER, given_error
from armour.evidence.tests import against_each, limits_of_model, outside_tests
from armour.reporting.formats import TEMPLATES, rendered
from armour.reporting.views.design import METALS
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Layer
from armour.units import MM

# The page has the velocity that each design stops with each of these probabilities, and interpolates between them.
# Probabilities of 1 to 99 % are then right to 0.002, even where the laws of the flow stress differ widely.
PROBABILITIES = (0.99, 0.975, 0.95, 0.9, 0.85, 0.77, 0.68, 0.59, 0.5, 0.41, 0.32, 0.23, 0.15, 0.08, 0.04, 0.02, 0.01)
# Largest number of designs times threats on a page, which then takes less than 1.5 MB.
MOST_DESIGNS = 25_000
# Pairs of numbers of nodes along an axis: of thicknesses in steps (0 adds none between these), and of a free range.
# The first pair with which the page is not too large is used.
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
    data = _question(catalogue) | {"pairs": _pairs(catalogue, on_progress)}
    data |= {"answer": list(answer), "command": list(command), "changes": list(changes)}
    # In JSON within HTML, no "<" may begin a tag.
    content = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    texts = {ending: (TEMPLATES / f"map.{ending}").read_text() for ending in ("js", "css")}
    hashes = {ending: b64encode(sha256(text.encode()).digest()).decode() for ending, text in texts.items()}
    return rendered("map.html", title=data["subject"], data=content, texts=texts, hashes=hashes)


def _question(catalogue: Catalogue) -> dict[str, Any]:
    """Return the data of the page other than designs: requirements, the scenario's own armour, threats and notes."""
    from scipy.special import ndtri  # slow to import

    section, scenario = catalogue.section, catalogue.scenario
    return {
        "subject": _subject(catalogue),
        "title": scenario.title,
        "version": __version__,
        "confidence": section.required_probability,
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
    """Return the title of the page, such as "AD85 on 6061-T6 against 7.62 mm AP"."""
    layers = catalogue.section.ceramic, catalogue.section.backing
    materials = (" or ".join(dict.fromkeys(layer.material for layer in options)) for options in layers)
    armour = " on ".join(filter(None, materials))
    return f"{armour} against {' and '.join(catalogue.titles)}"


def _threat(catalogue: Catalogue, i: int) -> dict[str, Any]:
    """Return the data of the i-th threat.

    "own" is the required probability of stopping, if the threat has one, and "rod" the penetrator's length and diameter
    in mm.
    """
    threat = catalogue.threats[i]
    most = threat.probability_of_perforation
    rows = catalogue.against_each(catalogue.candidates(0, np.ones(1), np.ones(1)))
    core = Parameters(*rows.parameters[i].tolist())
    return {
        "name": threat.name or threat.standard or threat.projectile,
        "projectile": threat.projectile,
        "velocity": threat.velocity_m_s,
        "obliquity": threat.obliquity_deg,
        "margin": threat.margin_m_s,
        "own": None if most is None else 1.0 - most,
        "rod": [core.L0 / MM, core.D0 / MM],
    }


def _notes(catalogue: Catalogue) -> Iterator[str]:
    """Yield sentences on what the page leaves out."""
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
    """Return the data of every pair of materials, on the finest grids that fit on a page."""
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
    """Return the thicknesses of a layer that are on offer, mm, with others between them up to about `nodes` in all.

    Of a free range, return `free` evenly spaced thicknesses.
    """
    offered = layer.thicknesses()
    if layer.free_range():
        return np.linspace(offered[0], offered[-1], free)
    parts = max(-(-nodes // len(offered)), 1)
    between = [np.linspace(low, high, parts, endpoint=False) for low, high in pairwise(offered)]
    return np.concatenate([*between, offered[-1:]])


def _pair(catalogue: Catalogue, pair: int, grid: tuple[Floats, Floats], on_progress: OnProgress) -> dict[str, Any]:
    """Return the data of a pair of materials; `grid` has its ceramic and back plate thicknesses, mm."""
    ceramics, backings = grid = with_known_edges(catalogue, pair, *grid)
    offer = catalogue.offers[pair]
    designs = design_map(catalogue, pair, ceramics, backings, PROBABILITIES, on_progress)
    # A slider of the page limits the areal density, so it excludes no design here.
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
        "single": bool(catalogue.lacks_sources[pair] or not catalogue.metal[pair]),
        "unlike": "" if catalogue.metal[pair] else no_metal(offer.backing_density_kg_m3),
        "over": _over_sources(catalogue, designs),
        "tested": [[layers["ceramic"], layers["backing"]] if len(layers) == 2 else None for layers in tested],
        "source": _source(catalogue, designs),
        **_outside(catalogue, designs),
        **_numbers(designs),
    }


def _outside(catalogue: Catalogue, designs: DesignMap) -> dict[str, Any]:
    """Return where the designs lie outside the tests, whatever the velocities, which a user of the page can change.

    "inside" has the places of the designs inside the tests, "outside" the quantities in which all lie outside,
    "caveats" sentences with the greatest ceramic thickness, mm, that they apply to, and "low" whether the ballistic
    limit against each threat is too low.
    """
    rows, threats = catalogue.against_each(designs.candidates), len(catalogue.threats)
    factors = outside_tests(rows.armours, np.full_like(rows.velocities, np.nan), threats)
    ceramic_mm, notes = designs.candidates.ceramic_mm, []
    against = (rows.armours.at(slice(threat, None, threats)) for threat in range(threats))
    by_threat = (limits_of_model(armours, [rows.materials[0].backing]) for armours in against)
    for note, masks in against_each(catalogue.titles, by_threat):
        most_mm = max(float(ceramic_mm[mask].max()) for mask in masks)
        notes += [(note.text, most_mm)] if note.said != "not known" else []
    if len({offer.backing.material for offer in catalogue.offers}) > 1 and ceramic_mm.any():
        notes.append((METALS, float(ceramic_mm.max())))
    return {
        "caveats": [(f"{words[:1].upper()}{words[1:]}.", most_mm) for words, most_mm in notes],
        "low": is_limit_too_low(rows.armours.parameters)[:threats].tolist(),
        "inside": [place for place, outside in enumerate(factors) if not outside],
        "outside": outside_words(_in_common(factors)),
    }


def _in_common(every: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the quantities in which all of several designs lie outside the tests by the same factor."""
    first, *others = every or [{}]
    return {key: factor for key, factor in first.items() if all(each.get(key) == factor for each in others)}


def _over_sources(catalogue: Catalogue, designs: DesignMap) -> list[list[float]] | None:
    """Return two lists of ballistic limits, m/s: with the least and with the greatest flow stress that sources give.

    Each list has the limits of the first design against all threats, then those of the second, and so on.  Return None
    if no sources are given, and if both thicknesses vary, as the limits would take too much room.
    """
    if min(len(designs.ceramic_mm), len(designs.backing_mm)) > 1:
        return None
    limits = limits_over_sources(catalogue, designs)
    return None if limits is None else [limits[place].ravel().round(1).tolist() for place in (0, -1)]


def _places(nodes: Floats, layer: Layer) -> list[int]:
    """Return the indices of the thicknesses on offer among the nodes, mm; for a free range, all indices."""
    if layer.free_range():
        return list(range(len(nodes)))
    return np.searchsorted(nodes, layer.thicknesses()).tolist()


def _source(catalogue: Catalogue, designs: DesignMap) -> str:
    """Return the source of the model error of a pair; "" if no probability is known."""
    places = np.flatnonzero(~np.isnan(designs.by_tests_m_s[..., 0, 0]))
    if not len(places):
        return ""
    if (error := given_error(catalogue.scenario)) is not None:
        return error.source
    rows = catalogue.against_each(designs.candidates.at(places[:1])).at(np.array([0]))
    return next(evidence.title for evidence, _ in rows.armours.by_evidence())


def _numbers(designs: DesignMap) -> dict[str, Any]:
    """Encode ballistic limits and stopped velocities, m/s, in base64 for the script of the page.

    For each design and threat, "floats" has three 32-bit floats: the limit, the least stopped velocity (0 if unknown),
    and the greatest probability that is stated.  "differences" has those between successive stopped velocities, as
    16-bit multiples of "step"; their sums are rounded down.
    """
    limits = designs.limits_m_s.reshape(-1)
    stopped = np.nan_to_num(designs.by_tests_m_s.reshape(len(limits), -1))
    floats = np.column_stack([limits, stopped[:, 0], designs.greatest.reshape(-1)]).astype("<f4")
    above = np.maximum(stopped - floats[:, 1:2].astype(np.float64), 0.0)
    step = max(float(np.diff(above, axis=1).max(initial=0.0)) / 65_000.0, 1e-3)
    differences = np.diff(np.floor(above / step), axis=1).astype("<u2")
    return {
        "step": step,
        "floats": b64encode(floats.tobytes()).decode(),
        "differences": b64encode(differences.tobytes()).decode(),
    }
