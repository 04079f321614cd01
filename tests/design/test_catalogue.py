"""Catalogues: layers, threats, constraints and costs, and wrong questions about them."""

from typing import Any

import numpy as np
import pytest

from armour.design import catalogue as module
from armour.design.catalogue import catalogue_of
from armour.design.check import check
from armour.design.optimise import optimise
from armour.engine import batch
from armour.errors import InputError
from tests.design.results import best_of
from tests.helpers.cases import CERAMICS, GIVEN, METALS, RANGE, THREATS, catalogue, offer, scenario
from tests.helpers.known import known
from tests.helpers.plain_designs import designs, stops

GRID = {"ceramic_thickness_mm": {"min": 0.0, "max": 0.0, "step": 1.0}, "backing_thickness_mm": RANGE}


def test_a_law_of_the_flow_stress_against_penetrators_of_other_diameters():
    """The lightest design is that of plain runs."""
    law = {"flow_stress_backing_exponent": 0.4, "flow_stress_product_exponent": -0.2, "flow_stress_ceramic_slope": 0.1}
    threats = [THREATS[0], {"projectile": "14.5 mm B32", "velocity_m_s": 650.0}]
    tables = {"ceramic": {"Mine": {"based_on": "AD99.5", **law}}}
    ceramics = [{"material": name, "thickness_mm": [8.0, 10.0, 12.0, 14.0]} for name in ("AD85", "Mine")]
    backings = [{"material": "7075-T6", "thickness_mm": [6.0, 9.0, 12.0]}]
    sections = {"library": tables, "uncertainty": {"model": GIVEN}}
    case = scenario(threat=threats, design={"ceramic": ceramics, "backing": backings}, **sections)
    assert case.design is not None
    found = {name: values["areal_density_kg_m2"] for name, values in designs(case, stops)}
    least = min(found, key=lambda name: found[name])
    assert least[0] == "Mine"
    assert 1 < len(found) < 24
    best = best_of(optimise(case))
    assert (best.ceramic, best.backing, best.ceramic_thickness_mm, best.backing_thickness_mm) == least


def test_what_costs_nothing():
    free = [
        {"material": "AD85", "thickness_mm": [12.0], "cost_per_kg": 0.0},
        {"material": "AD99.5", "thickness_mm": [12.0], "cost_per_kg": 9.0},
    ]
    metal = [{"material": "6061-T6", "thickness_mm": [10.0], "cost_per_m2": 0.0}]
    result = optimise(catalogue(ceramic=free, backing=metal, minimise="cost_per_m2"))
    assert [(pair.ceramic, pair.excess_percent) for pair in result.pairs] == [("AD85", None), ("AD99.5", None)]


def test_a_pair_without_a_design_says_which_constraint_keeps_it_out():
    masses = {
        (pair.ceramic, pair.backing): pair.best.areal_density_kg_m2
        for pair in optimise(catalogue()).pairs
        if pair.best is not None
    }
    most = min(masses.values())
    held = optimise(catalogue(areal_density_max_kg_m2=most, thickness_max_mm=1000.0)).pairs
    for pair in held:
        assert (pair.best is None) == (pair.nearest is not None) == (masses[pair.ceramic, pair.backing] > most)
        if pair.nearest is not None:
            assert pair.nearest.check.verdict == "fails"


def test_a_pair_of_which_no_thickness_stops_the_threats():
    """A range without a step has steps of 0.1 mm."""
    metals = [{"material": "6061-T6", "thickness_mm": [10.0]}, {"material": "7075-T6", "thickness_mm": [0.5]}]
    ceramics = [{"material": "AD85", "thickness_mm": {"min": 1.0, "max": 12.0}}]
    result = optimise(catalogue(ceramic=ceramics, backing=metals))
    nearest = known(result.pairs[1].nearest)
    assert (nearest.ceramic_thickness_mm, nearest.backing_thickness_mm) == (12.0, 0.5)
    assert nearest.short_m_s["M2"] == pytest.approx(260.0, abs=0.5)
    stepped = [{"material": "AD85", "thickness_mm": {"min": 1.0, "max": 12.0, "step": 0.1}}]
    assert optimise(catalogue(ceramic=stepped, backing=metals)) == result


def test_a_catalogue_of_bare_plates_needs_no_grid():
    bare = {"ceramic": None, "ceramic_thickness_mm": 0.0, "backing": "7075-T6", "backing_thickness_mm": 5.0}
    plates = [{"material": "7075-T6", "thickness_mm": [10.0, 40.0]}]
    best = best_of(optimise(scenario(armour=bare, design={"backing": plates})))
    assert (best.ceramic_thickness_mm, best.backing_thickness_mm) == (0.0, 40.0)


def test_a_limit_that_is_exceeded_claims_no_probability_that_is_unknown():
    layers = offer("SiC", [8.0], "6061-T6", 8.0)
    found = optimise(scenario(design={**layers, "probability_of_stopping": 0.9, "thickness_max_mm": 5.0}))
    assert (found.reason, found.shown.check.threats[0].verdict) == ("none passes", "not known")
    assert [row.verdict for row in found.shown.check.requirements] == ["fails"]


def test_nothing_on_offer():
    assert [row.quantity for row in optimise(catalogue(thickness_max_mm=5.0)).shown.check.requirements] == [
        "thickness_mm"
    ]
    fast = [{"projectile": "7.62 mm AP", "velocity_m_s": 2500.0}]
    for constraint in ({}, {"thickness_max_mm": 20.0}, {"probability_of_stopping": 0.9}):
        result = optimise(catalogue(fast, **constraint))
        assert (result.best, result.reason, result.shown.check.verdict) == (None, "none passes", "fails")


@pytest.mark.parametrize(
    "asked", [{"minimise": "cost_per_m2"}, {"pareto": ["thickness_mm", "cost_per_m2"]}, {"cost_max_per_m2": 1000.0}]
)
def test_costs_that_are_asked_for_must_be_given(asked: dict[str, Any]):
    ceramics = [CERAMICS[0], {"material": "AD99.5", "thickness_mm": [12.0]}]
    with pytest.raises(InputError) as error:
        optimise(catalogue(ceramic=ceramics, **asked))
    [problem] = error.value.problems
    assert problem.key == "design.ceramic[1]"
    assert problem.message == 'must have a cost if [design] asks for costs, found none for "AD99.5"'
    own = scenario(design=asked, optimise={"ceramic_thickness_mm": RANGE, "backing_thickness_mm": RANGE})
    with pytest.raises(InputError) as error:
        optimise(own)
    assert [problem.key for problem in error.value.problems] == ["design.ceramic[0]", "design.backing[0]"]


@pytest.mark.parametrize(
    ("case", "message"),
    [
        (lambda: scenario(design={}), "optimise: is missing and must be given"),
        (
            lambda: catalogue([{**THREATS[0], "margin_m_s": 9500.0}]),
            "must be at most 10000 together, found 800 and 9500",
        ),
        (lambda: catalogue([{**THREATS[0], "name": "a\x1b[31m"}]), "must be one line of printable text"),
        (lambda: catalogue(pareto=["thickness_mm"]), "must list at least 2 values, found 1"),
        (lambda: catalogue(ceramic=[{"material": "AD85x", "thickness_mm": [5.0]}]), 'did you mean "AD85"?'),
        (
            lambda: catalogue(backing=[{"material": "6061-T6", "thickness_mm": "5"}]),
            'thickness_mm: must be a list, found the text "5"; a range is a table such as { min = 4.0, max = 12.0 }',
        ),
        (lambda: catalogue(backing=[{"material": "6061-T6", "thickness_mm": []}]), "thickness_mm: must not be empty"),
        # Rows of its designs could not be told apart; an alias is the same material.
        (
            lambda: catalogue(ceramic=[CERAMICS[0], CERAMICS[0]]),
            'design.ceramic[1].material: must be listed once, with all its thicknesses, found "AD85" twice',
        ),
    ],
)
def test_wrong_questions(case: Any, message: str):
    with pytest.raises(InputError) as error:
        optimise(case())
    assert message in str(error.value)


@pytest.mark.parametrize("ceramic", ["AD85", None])
def test_the_rows_of_pairs_and_threats_are_those_of_their_scenarios(ceramic: str | None):
    case = catalogue([*THREATS, {"projectile": "25 mm APDS", "velocity_m_s": 1000.0}])
    if ceramic is None:
        case = scenario(ceramic=None, ceramic_mm=0.0, optimise=GRID).replaced({"design": {"backing": METALS}})
    found = catalogue_of(case)
    for pair in range(len(found.offers)):
        for threat in range(len(found.threats)):
            one = found.candidates(pair, np.array([9.0 if ceramic else 0.0]), np.array([6.0]))
            thick = {"armour.ceramic_thickness_mm": float(one.ceramic_mm[0]), "armour.backing_thickness_mm": 6.0}
            armour = found.against(pair, threat).replaced(thick).core_armour()
            variants = found.against_each(one).at(np.array([threat]))
            assert variants.parameters.tolist() == batch.packed([armour]).tolist()
            assert variants.velocities.tolist() == [found.threats[threat].velocity_m_s]


@pytest.mark.parametrize(
    ("most", "message"),
    [
        ({"MAX_MATERIAL_PAIRS": 3}, "design: must contain at most 3 pairs of materials, found 4"),
        ({"MAX_DESIGNS": 143}, "design: must contain at most 143 designs, found 144"),
        ({"MAX_IMPACTS": 200}, "threat: must list at most 1 threats for 144 designs, found 2"),
    ],
)
def test_more_than_can_be_meant(monkeypatch: pytest.MonkeyPatch, most: dict[str, int], message: str):
    for name, value in most.items():
        monkeypatch.setattr(module, name, value)
    with pytest.raises(InputError) as error:
        catalogue_of(catalogue())
    assert message in str(error.value)


def test_every_design_says_in_what_it_is_far_from_the_tests_as_check_does():
    asked = catalogue([{"projectile": "7.62 mm AP", "velocity_m_s": 700.0}])
    best = [pair.best for pair in optimise(asked).pairs if pair.best is not None]
    assert {design.ceramic for design in best} == {"AD85", "AD99.5"}
    for design in best:
        [threat] = check(design.scenario).threats
        assert threat.far_from_tests == design.far_from_tests
        assert (f"{design.ceramic} (no test)" in design.far_from_tests) == design.untested
