"""Search of many designs against several threats."""

import dataclasses
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.impact import simulate
from armour.core.state import Outcome
from armour.design import catalogue as module
from armour.design import designs, search
from armour.design.catalogue import Catalogue
from armour.design.optimise import Design, optimise
from armour.design.search import MARGIN_PARTS, distinct, undominated
from armour.engine import batch
from armour.scenario.scenario import load_scenario
from tests.design.results import best_of
from tests.helpers.cases import GIVEN, SCENARIOS, THREATS, catalogue, offer, scenario, sourced
from tests.helpers.examples import examples

pytestmark = pytest.mark.slow

ROWS = Catalogue.against_each


def test_who_governs_along_the_frontier():
    """Each by its own limits: the least of what is left of the margins."""
    result = optimise(catalogue())
    for design, governing in zip(result.frontier, result.frontier_governed_by, strict=True):
        left = {}
        for threat in catalogue().threat:
            own = catalogue().replaced(
                {
                    "armour.ceramic": best_of(result).ceramic,
                    "armour.backing": best_of(result).backing,
                    "armour.ceramic_thickness_mm": design.ceramic_thickness_mm,
                    "armour.backing_thickness_mm": design.backing_thickness_mm,
                    "impact.projectile": threat.projectile,
                }
            )
            limit = ballistic_limit(own).ballistic_limit_m_s
            left[threat.title] = limit - threat.velocity_m_s - threat.margin_m_s
        assert governing == min(left, key=lambda title: left[title])
        assert min(left.values()) >= -0.01


def test_the_best_does_not_depend_on_the_range_of_the_search():
    wide = optimise(catalogue())
    for ends in ({"velocity_max_m_s": 500.0}, {"velocity_min_m_s": 1500.0}):
        narrow = optimise(catalogue().replaced({"ballistic_limit": ends}))
        assert best_of(narrow).governing == best_of(wide).governing
        assert best_of(narrow).ballistic_limit_m_s == pytest.approx(best_of(wide).ballistic_limit_m_s, abs=0.02)


def test_without_a_catalogue_it_is_the_grid():
    """One threat that is the impact, or an empty catalogue, changes nothing."""
    optimum = load_scenario(SCENARIOS / "paper" / "optimum_7.62mm_AP.toml")
    expected = optimise(optimum)
    assert optimise(optimum.replaced({"threat": [{"projectile": "7.62 mm AP", "velocity_m_s": 850.0}]})) == expected
    assert optimise(optimum.replaced({"design": {}})) == expected
    assert (best_of(expected).ceramic_thickness_mm, best_of(expected).backing_thickness_mm) == (11.0, 6.0)


def test_a_big_catalogue_is_exact():
    """4 ceramics, 4 metals, 20 by 20 thicknesses and 3 threats against all 6,400 at once."""
    thick = {"min": 2.0, "max": 21.0, "step": 1.0}
    library = {
        "ceramic": {
            f"C{i}": {"based_on": "AD85", "density_kg_m3": 3300.0 + 97.0 * i, **sourced(4.5 + 0.3 * i)}
            for i in range(4)
        },
        "metal": {
            f"M{i}": {"based_on": "6061-T6", "density_kg_m3": 2650.0 + 61.0 * i, "flow_stress_GPa": 0.8 + 0.1 * i}
            for i in range(4)
        },
    }
    threats = [*THREATS, {"projectile": "7.62 mm AP", "velocity_m_s": 700.0, "margin_m_s": 130.0, "name": "slow"}]
    case = scenario(
        threat=threats,
        library=library,
        uncertainty={"model": GIVEN},
        design={
            "ceramic": [{"material": name, "thickness_mm": thick} for name in library["ceramic"]],
            "backing": [{"material": name, "thickness_mm": thick} for name in library["metal"]],
        },
    )
    result = optimise(case)
    assert result.designs == 6_400
    hc, hb = (values.ravel() for values in np.meshgrid(*[2.0 + np.arange(20)] * 2))
    least = np.inf
    for ceramic in library["ceramic"]:
        for metal in library["metal"]:
            good = np.ones(400, dtype=bool)
            for threat in case.threat:
                changes = {"armour.ceramic": ceramic, "armour.backing": metal, "impact.projectile": threat.projectile}
                a = case.replaced(changes).core_armour()
                rows = batch.packed([a._replace(Hc0=c / 1000.0, Hb=b / 1000.0) for c, b in zip(hc, hb, strict=True)])
                velocity = threat.velocity_m_s + threat.margin_m_s
                good &= batch.impacts(rows, np.full(400, velocity)).outcome == Outcome.STOPPED
            least = min(least, float(np.where(good, a.rho_c * hc + a.rho_B * hb, np.inf).min()) / 1000.0)
    assert best_of(result).areal_density_kg_m2 == pytest.approx(least, rel=1e-12)


def test_a_front_with_margins_of_free_thicknesses_is_no_rounding(monkeypatch: pytest.MonkeyPatch):
    """Designs differ by more than the tolerance of a limit, and reach from the cheapest to the thickest."""
    monkeypatch.setattr(module, "FIRST_VALUES", 5)
    monkeypatch.setattr(search, "BACKING_TOLERANCE_MM", 0.05)
    layers = {
        "ceramic": [{"material": "AD85", "thickness_mm": {"min": 2.0, "max": 12.0}, "cost_per_kg": 12.0}],
        "backing": [{"material": "5083-H3", "thickness_mm": {"min": 4.0, "max": 12.0}, "cost_per_kg": 9.0}],
    }
    criteria = ["areal_density_kg_m2", "cost_per_m2", "margin_m_s"]
    result = optimise(catalogue(THREATS[:1], **layers, pareto=criteria))
    margins = [round(design.margin_m_s or 0.0, 1) for design in result.pareto]
    assert len(set(margins)) == MARGIN_PARTS + 1
    assert margins[0] == 0.0
    last = max(result.pareto, key=lambda design: design.margin_m_s or 0.0)
    assert (last.ceramic_thickness_mm, last.backing_thickness_mm) == (12.0, 12.0)
    values = np.array([[getattr(d, name) for name in criteria] for d in result.pareto]) * [1.0, 1.0, -1.0]
    resolution = np.array([0.01, 0.001 * values[:, 1].min(), 0.01])
    same = (np.abs(values[:, None] - values) <= resolution).all(axis=2)
    # Only the best by a criterion stays beside a design that is the same to the resolution.
    assert same.sum() <= len(values) + 2 * len(criteria)
    # The best has thicknesses rounded up to 0.01 mm.
    assert result.pareto[0].areal_density_kg_m2 == pytest.approx(best_of(result).areal_density_kg_m2, abs=0.1)
    cheapest = best_of(optimise(catalogue(THREATS[:1], **layers, minimise="cost_per_m2")))
    assert min(design.cost_per_m2 or 0.0 for design in result.pareto) == pytest.approx(cheapest.cost_per_m2, rel=2e-3)


def test_a_front_with_margins_of_one_free_thickness():
    """The other is one of a list; a margin between two designs of the front takes a design between them."""
    free = {"material": "AD85", "thickness_mm": {"min": 4.0, "max": 14.0}}
    metal = {"material": "5083-H3", "thickness_mm": [6.0]}
    result = optimise(
        catalogue(THREATS[:1], ceramic=[free], backing=[metal], pareto=["areal_density_kg_m2", "margin_m_s"])
    )
    assert len(result.pareto) == MARGIN_PARTS + 1
    margins = np.array([design.margin_m_s for design in result.pareto])
    assert np.diff(margins) == pytest.approx(margins[-1] / MARGIN_PARTS, abs=0.05)
    assert result.pareto[-1].ceramic_thickness_mm == 14.0
    # They are no requirement: the frontier has the least ceramic alone.
    assert [names(design) for design in result.frontier] == [names(best_of(result))]


def names(design: Design) -> tuple[str, str, float, float]:
    return design.ceramic, design.backing, design.ceramic_thickness_mm, design.backing_thickness_mm


def test_designs_that_differ_by_less_than_the_resolution_are_one():
    costs = np.array([[1.0, 5.0], [1.001, 4.995], [1.002, 4.9], [3.0, 2.0], [3.005, 1.995]])
    rows = distinct(costs, np.arange(5), np.array([0.01, 0.01]))
    assert rows.tolist() == [0, 2, 4]
    assert distinct(costs, np.arange(5), np.zeros(2)).tolist() == [0, 1, 2, 3, 4]
    assert distinct(costs[:0], np.arange(0), np.zeros(2)).tolist() == []


def test_equal_sums_are_equal_on_the_front():
    steps = {"min": 4.0, "max": 12.0, "step": 0.1}
    layers = offer("AD99.5", steps, "7075-T6", {"min": 2.0, "max": 8.0, "step": 0.3})
    front = optimise(catalogue(THREATS[:1], **layers, pareto=["thickness_mm", "areal_density_kg_m2"])).pareto
    thicknesses = [round(item.thickness_mm, 6) for item in front]
    assert len(set(thicknesses)) == len(thicknesses)


@given(st.integers(2, 3).flatmap(lambda width: st.lists(st.lists(st.integers(0, 6), min_size=width, max_size=width))))
@examples(max_examples=100)
def test_undominated_rows_are_those_that_no_other_dominates(rows: list[list[int]]):
    costs = np.array(rows, dtype=float).reshape(len(rows), -1 if rows else 2)
    first = [i for i, row in enumerate(rows) if row not in rows[:i]]
    expected = [
        i for i in first if not any(other != rows[i] and (costs[j] <= costs[i]).all() for j, other in enumerate(rows))
    ]
    assert sorted(undominated(costs).tolist()) == expected


def test_a_search_in_portions(monkeypatch: pytest.MonkeyPatch):
    """No array grows with the catalogue."""
    case = catalogue(pareto=["areal_density_kg_m2", "margin_m_s"])
    whole = optimise(case)
    rows = Mock(wraps=ROWS)
    monkeypatch.setattr(designs, "IMPACTS_AT_A_TIME", 20)
    monkeypatch.setattr(designs, "LIMITS_AT_A_TIME", 3)
    monkeypatch.setattr(Catalogue, "against_each", lambda *args: rows(*args))
    counted: list[int] = []
    found = optimise(case, on_progress=lambda count, _: counted.append(count))
    assert dataclasses.replace(found, runs=whole.runs) == whole
    assert max(len(call.args[1].pair) for call in rows.call_args_list) == 20 // len(case.threat)
    assert sum(counted) >= found.runs


def test_thicknesses_that_are_free_come_to_the_optimum_of_the_paper():
    optimum = load_scenario(SCENARIOS / "paper" / "optimum_7.62mm_AP.toml")
    free = {"material": "AD85", "thickness_mm": {"min": 2.0, "max": 20.0}}
    metal = {"material": "5083-H3", "thickness_mm": {"min": 2.0, "max": 14.0}}
    best = best_of(optimise(optimum.replaced({"design": {"ceramic": [free], "backing": [metal]}})))
    # The areal density hardly depends on how it is divided between the two.
    assert 54.2175 < best.areal_density_kg_m2 < 54.25  # both are rounded up to 0.01 mm
    assert best.backing_thickness_mm == pytest.approx(6.2034, abs=0.05)
    one = best_of(
        optimise(optimum.replaced({"design": {"ceramic": [free], "backing": [{**metal, "thickness_mm": [6.0]}]}}))
    )
    other = best_of(
        optimise(
            optimum.replaced(
                {"design": {"ceramic": [{**free, "thickness_mm": [one.ceramic_thickness_mm]}], "backing": [metal]}}
            )
        )
    )
    assert other.backing_thickness_mm == pytest.approx(6.0, abs=1e-4)


def test_the_passing_thicknesses_may_end_below_the_greatest_on_offer():
    """Of the thickest, beyond the evidence, no probability is known: thinner ones pass all the same."""
    plate = scenario("7.62 mm APM2", None, "AA7039-T64", 0.0, 40.0)
    layer = {"material": "AA7039-T64", "thickness_mm": {"min": 20.0, "max": 110.0}}
    wide = plate.replaced({"design": {"probability_of_stopping": 0.95, "backing": [layer]}})
    narrow = wide.replaced({"design.backing": [{**layer, "thickness_mm": {"min": 20.0, "max": 60.0}}]})
    assert best_of(optimise(wide)).backing_thickness_mm == pytest.approx(best_of(optimise(narrow)).backing_thickness_mm)
    ceramic = {"material": "AD85", "thickness_mm": {"min": 4.0, "max": 20.0}}
    metal = {"material": "5083-H3", "thickness_mm": [7.0, 8.5]}
    wide = scenario(
        backing="5083-H3", design={"probability_of_stopping": 0.9, "ceramic": [ceramic], "backing": [metal]}
    )
    narrow = wide.replaced({"design.ceramic": [{**ceramic, "thickness_mm": {"min": 4.0, "max": 12.0}}]})
    best = best_of(optimise(narrow))
    assert best_of(optimise(wide)).areal_density_kg_m2 == pytest.approx(best.areal_density_kg_m2, abs=2e-4)


def test_free_thicknesses_of_which_some_are_not_enough_and_limits():
    """Up to 9 mm of ceramic is too little on thin plates; a limit on the thickness then leaves a heavier optimum."""
    layers = offer("AD85", {"min": 2.0, "max": 9.0}, "6061-T6", {"min": 1.0, "max": 14.0})
    wide = best_of(optimise(catalogue(THREATS[:1], **layers)))
    assert wide.ceramic_thickness_mm <= 9.0
    thinnest = best_of(optimise(catalogue(THREATS[:1], **layers, minimise="thickness_mm")))
    middle = 0.5 * (thinnest.thickness_mm + wide.thickness_mm)
    assert thinnest.thickness_mm < middle
    narrow = best_of(optimise(catalogue(THREATS[:1], **layers, thickness_max_mm=middle)))
    assert narrow.thickness_mm <= middle
    assert wide.areal_density_kg_m2 < narrow.areal_density_kg_m2 + 0.01  # thicknesses are rounded up to 0.01 mm
    assert narrow.areal_density_kg_m2 < thinnest.areal_density_kg_m2 + 0.01
    coarse = offer("AD85", {"min": 2.0, "max": 9.0, "step": 0.1}, "6061-T6", {"min": 1.0, "max": 14.0, "step": 0.1})
    by_grid = best_of(optimise(catalogue(THREATS[:1], **coarse))).areal_density_kg_m2
    assert by_grid - 0.35 < wide.areal_density_kg_m2 <= by_grid


def test_free_thicknesses_against_several_threats_are_the_least():
    layers = offer("AD85", {"min": 2.0, "max": 14.0}, "6061-T6", [5.0, 7.0])
    of = catalogue(**layers).replaced({"uncertainty.model": None}).replaced({"uncertainty.model.included": False})
    for design in optimise(of).frontier:
        for less, outcomes in ((0.0, {"stopped"}), (0.01 + 2e-6, {"stopped", "perforated"})):
            against = [
                of.replaced(
                    {
                        "armour.ceramic_thickness_mm": design.ceramic_thickness_mm - less,
                        "armour.backing_thickness_mm": design.backing_thickness_mm,
                        "impact.projectile": threat.projectile,
                        "impact.velocity_m_s": threat.required_m_s,
                    }
                )
                for threat in of.threat
            ]
            assert {simulate(each).outcome for each in against} == outcomes
