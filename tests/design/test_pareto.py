"""Pareto fronts."""

import numpy as np

from armour.analysis.variants import Bools, Floats, Ints
from armour.design.optimise import optimise
from armour.design.pareto import undominated, verified_front
from tests.cases import THREATS, catalogue


def test_undominated_rows():
    costs = np.array([[1.0, 5.0], [2.0, 2.0], [2.0, 2.0], [3.0, 3.0], [5.0, 1.0], [1.0, 6.0]])
    assert undominated(costs).tolist() == [0, 1, 4]


def test_members_that_do_not_count_make_room_for_others():
    """The first row does not count, and the second is dearer than it seemed: the third takes its place."""
    costs = np.array([[1.0, 1.0], [2.0, 2.0], [3.0, 2.5], [4.0, 2.6]])
    verified = np.array([[1.0, 1.0], [3.5, 2.7], [3.0, 2.5], [4.0, 2.6]])
    asked: list[int] = []

    def verify(some: Ints) -> tuple[Bools, Floats]:
        asked.extend(some.tolist())
        return some > 0, verified[some]

    assert verified_front(costs, verify).tolist() == [2]
    assert asked == [0, 1, 2]


def test_a_front_with_margins():
    """More margin costs mass: along the front both rise, and every design has the margin it says."""
    found = optimise(catalogue(THREATS[:1], pareto=["areal_density_kg_m2", "margin_m_s"])).pareto
    masses, margins = [item.areal_density_kg_m2 for item in found], [item.margin_m_s or 0.0 for item in found]
    assert len(found) > 5
    assert masses == sorted(masses)
    assert margins == sorted(margins)
    assert margins[0] >= 0.0


def test_equal_sums_are_equal_on_the_front():
    steps = {"min": 4.0, "max": 12.0, "step": 0.1}
    layers = {
        "ceramic": [{"material": "AD99.5", "thickness_mm": steps}],
        "backing": [{"material": "7075-T6", "thickness_mm": {"min": 2.0, "max": 8.0, "step": 0.3}}],
    }
    front = optimise(catalogue(THREATS[:1], **layers, pareto=["thickness_mm", "areal_density_kg_m2"])).pareto
    thicknesses = [round(item.thickness_mm, 6) for item in front]
    assert len(set(thicknesses)) == len(thicknesses)
