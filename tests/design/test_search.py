"""Search of many designs against several threats."""

import dataclasses
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armour.analysis.ballistic_limit import ballistic_limit
from armour.design import designs
from armour.design.catalogue import Catalogue
from armour.design.optimise import optimise
from armour.design.search import distinct, undominated
from armour.scenario.scenario import load_scenario
from tests.design.results import best_of
from tests.helpers.cases import SCENARIOS, THREATS, catalogue, offer
from tests.helpers.examples import examples

pytestmark = pytest.mark.slow

ROWS = Catalogue.against_each


def test_who_governs_along_the_frontier():
    """Each by its own limits: the least of what is left of the margins."""
    result = optimise(catalogue())
    for design in result.frontier:
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
        assert design.governing == min(left, key=lambda title: left[title])
        assert min(left.values()) >= -0.01


def test_the_best_does_not_depend_on_the_range_of_the_search():
    wide = optimise(catalogue())
    for ends in ({"velocity_max_m_s": 500.0}, {"velocity_min_m_s": 1500.0}):
        narrow = optimise(catalogue().replaced({"ballistic_limit": ends}))
        assert best_of(narrow).governing == best_of(wide).governing
        assert best_of(narrow).margin_m_s == pytest.approx(best_of(wide).margin_m_s, abs=0.02)


def test_without_a_catalogue_it_is_the_grid():
    """One threat that is the impact, or an empty catalogue, changes nothing."""
    optimum = load_scenario(SCENARIOS / "paper" / "optimum_7.62mm_AP.toml")
    expected = optimise(optimum)
    assert optimise(optimum.replaced({"threat": [{"projectile": "7.62 mm AP", "velocity_m_s": 850.0}]})) == expected
    assert optimise(optimum.replaced({"design": {}})) == expected
    assert (best_of(expected).ceramic_thickness_mm, best_of(expected).backing_thickness_mm) == (11.0, 6.0)


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
