"""Searches of random catalogues against a plain loop over `check`: hulls, layers, costs, own tests and all verdicts."""

from itertools import product
from random import Random
from typing import Any, NamedTuple

import pytest

from armour.design.check import CheckResult, check, check_of
from armour.design.optimise import BestDesign, optimise
from armour.design.requirements import GOOD
from armour.evidence.caveats import is_no_metal
from armour.evidence.tests import lacks_sources
from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES
from tests.statistics.test_own_tests import of_wilkins

pytestmark = pytest.mark.slow

LOT = of_wilkins().armour.ceramic or ""
LAMINATE = {"UHMWPE": {"density_kg_m3": 980.0, "static_yield_strength_MPa": 900.0}}
CERAMICS, METALS = ["AD85", LOT, LOT, "AD99.5", "SiC", "B4C"], ["6061-T6", "5083-H3", "7075-T6", "UHMWPE"]
ROUNDS = {"7.62 mm AP": (550, 950), "7.62 mm APM2": (550, 950), "7.62 mm B32": (500, 900), "14.5 mm B32": (500, 900)}
INERT = {"name": "rubber", "thickness_mm": 1.0, "areal_density_kg_m2": 1.2, "cost_per_m2": 40.0}


def catalogue(seed: int) -> Scenario:
    """A catalogue of one or two ceramics on one or two metals, with one or two threats and what is required."""
    dice = Random(seed)
    threats: list[dict[str, Any]] = []
    for name in dice.sample([*ROUNDS], dice.choice([1, 1, 2])):
        threats.append({"projectile": name, "velocity_m_s": float(dice.randint(*ROUNDS[name]))})
        threats[-1] |= {"margin_m_s": 20.0} if dice.random() < 0.2 else {}
        threats[-1] |= {"obliquity_deg": 30.0} if dice.random() < 0.1 else {}

    def layers(names: list[str], low: int, high: int, count: int) -> list[dict[str, Any]]:
        return [
            {"material": name, "thickness_mm": sorted(dice.sample(range(low, high), count)), "cost_per_kg": cost}
            for name, cost in zip(dict.fromkeys(dice.sample(names, 2)), (20.0, 8.0), strict=False)
        ][: dice.choice([1, 2])]

    design: dict[str, Any] = {"ceramic": layers(CERAMICS, 4, 15, 3), "backing": layers(METALS, 4, 13, 2)}
    design["minimise"] = dice.choice([*OBJECTIVES])
    design |= {"probability_of_stopping": dice.choice([0.6, 0.8, 0.95])} if dice.random() < 0.6 else {}
    bounds = {"areal_density_max_kg_m2": (30.0, 60.0), "thickness_max_mm": (12.0, 24.0), "cost_max_per_m2": (400, 1500)}
    design |= {key: dice.uniform(*ends) for key, ends in bounds.items() if dice.random() < 0.2}
    changes: dict[str, Any] = {"threat": threats, "armour.layer": []}
    if dice.random() < 0.3:
        changes["armour.layer"] = [{**INERT, "place": dice.choice(["front", "behind", "behind", "between"])}]
    if dice.random() < 0.2:
        [hull, *_] = design["backing"]
        design |= {"existing": "backing", "backing": [{**hull, "thickness_mm": hull["thickness_mm"][:1]}]}
        changes |= {"armour.backing": hull["material"], "armour.backing_thickness_mm": float(hull["thickness_mm"][0])}
    library = of_wilkins().to_dict()["library"]
    return of_wilkins().replaced({"library": {**library, "metal": LAMINATE}, **changes, "design": design})


class Plain(NamedTuple):
    """A design of the loop."""

    layers: tuple[str, str, float, float]
    value: float
    verdict: str
    group: int  # of those of which it is not known whether they pass, the first to be named
    known: bool


def designs(case: Scenario) -> list[Plain]:
    section, found = case.design, []
    assert section is not None
    for ceramic, backing in product(section.ceramic, section.backing):
        for hc, hb in product(ceramic.thicknesses(), backing.thicknesses()):
            layers = ceramic.material, backing.material, hc, hb
            keys = "ceramic", "backing", "ceramic_thickness_mm", "backing_thickness_mm"
            own = case.replaced({f"armour.{key}": value for key, value in zip(keys, layers, strict=True)})
            checked = check_of(own, changes=False, needed=False)
            entry = own.entry_of("ceramic")
            assert entry is not None
            group = 2 * is_no_metal(own.core_armour().rho_B) + lacks_sources(entry)
            known = all(threat.model_error is not None for threat in checked.threats)
            found.append(Plain(layers, value_of(checked, section.minimise), checked.verdict, group, known))
    return found


def value_of(checked: CheckResult, minimise: str) -> float:
    value: float = getattr(checked, minimise)
    return value


def layers_of(design: BestDesign) -> tuple[str, str, float, float]:
    return design.ceramic, design.backing, design.ceramic_thickness_mm, design.backing_thickness_mm


def compare(seed: int) -> str:
    """Compare the search of a catalogue with the loop, and return its reason."""
    case = catalogue(seed)
    every, result = designs(case), optimise(case)
    shown, section = result.shown, case.design
    assert section is not None
    assert shown.check == check(shown.scenario)
    by_layers = {each.layers: each for each in every}
    assert by_layers[layers_of(shown)].verdict == shown.check.verdict
    passing = [each for each in every if each.verdict in GOOD]
    not_known = [each for each in every if each.verdict == "not known"]
    assert result.reason == ("" if passing else "not known" if not_known else "none passes")
    if offered := passing or not_known:
        first = min(offered, key=lambda each: (each.group, not each.known, each.value))
        alike = by_layers[layers_of(shown)]
        assert (alike.group, alike.known) == (first.group, first.known)
        assert alike.value == pytest.approx(first.value, rel=1e-9)
    for pair in result.pairs:
        own = [each for each in passing if each.layers[:2] == (pair.ceramic, pair.backing)]
        if own:
            best = min(own, key=lambda each: (not each.known, each.value))
            assert pair.best is not None
            assert value_of(pair.best.check, section.minimise) == pytest.approx(best.value, rel=1e-9)
    if passing:
        on_pair = [each.layers for each in passing if each.layers[:2] == layers_of(shown)[:2]]
        thinnest = {plate: min(hc for *_, hc, hb in on_pair if hb == plate) for *_, plate in on_pair}
        assert {each.backing_thickness_mm: each.ceramic_thickness_mm for each in result.frontier} == thinnest
    return result.reason


# Each reason, a hull, a layer between, own tests and costs.
@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 5])
def test_the_answer_is_that_of_a_plain_loop_over_checks(seed: int):
    compare(seed)
