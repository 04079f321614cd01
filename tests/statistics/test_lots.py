"""Two lots: the difference of their V50s."""

from functools import cache
from itertools import product

import numpy as np
import pytest
from scipy.special import log_ndtr, ndtri

from armour.errors import NoAnswerError
from armour.statistics.lots import V50Difference
from armour.statistics.v50 import FiringResult, Shots, compared, v50
from tests.helpers.known import known

pytestmark = pytest.mark.slow

ONE = Shots((700, 710, 715, 720, 725, 730, 722, 735), (False, False, True, False, True, True, False, True))
OTHER = Shots((735, 741, 752, 760, 748, 757, 738), (False, False, True, True, False, True, True))


@pytest.fixture(autouse=True)
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Try few velocities for a further shot, each of which takes a fit."""
    monkeypatch.setattr("armour.statistics.v50.FURTHER", 3)


@cache
def moved(by_m_s: float) -> FiringResult:
    """V50 of the first lot with other velocities."""
    return v50(Shots([v + by_m_s for v in ONE.velocities_m_s], ONE.complete))


@cache
def difference(by_m_s: float) -> V50Difference:
    return moved(0.0).difference(moved(by_m_s))


def penalised(first_m_s: float, second_m_s: float, scale: float) -> float:
    """The log-likelihood of both lots with one scale and the Jeffreys prior, written down plainly."""
    total, information = 0.0, np.zeros((3, 3))
    for lot, (shots, middle) in enumerate(((ONE, first_m_s), (OTHER, second_m_s))):
        for velocity, complete in zip(shots.velocities_m_s, shots.complete, strict=True):
            z = (velocity - middle) / scale
            total += log_ndtr(z if complete else -z)
            weight = np.exp(-z * z - np.log(2.0 * np.pi) - log_ndtr(z) - log_ndtr(-z))
            row = np.array([lot == 0, lot == 1, velocity - middle], dtype=float)
            information += weight * np.outer(row, row)
    return float(total + 0.5 * np.linalg.slogdet(information)[1])


def test_the_ends_have_the_deviance_of_the_confidence_by_a_plain_search():
    found = v50(ONE).difference(v50(OTHER), 0.9)
    scales = np.geomspace(2.0, 40.0, 25)

    def greatest(difference: float) -> float:
        return max(penalised(v, v + difference, s) for v, s in product(np.linspace(705.0, 730.0, 51), scales))

    best = greatest(found.difference_m_s)
    for end in found.interval_m_s:
        assert end is not None
        assert 2.0 * (best - greatest(end)) == pytest.approx(ndtri(0.95) ** 2, abs=0.05)
    assert best >= max(greatest(found.difference_m_s + by) for by in (-1.0, 1.0))


def test_lots_that_are_the_same_do_not_differ_and_a_shift_is_the_difference():
    same, shifted = difference(0.0), difference(50.0)
    assert (same.difference_m_s, same.p_value) == pytest.approx((0.0, 1.0), abs=1e-3)
    assert shifted.difference_m_s == pytest.approx(50.0, abs=1e-3)
    assert shifted.p_value < 0.05
    assert known(same.interval_m_s[0]) == pytest.approx(-known(same.interval_m_s[1]), abs=1e-2)
    few = v50(Shots((700, 720), (False, True)))
    assert few.difference(few).interval_m_s == (None, None)


def test_several_pairs_have_wider_intervals_that_hold_together():
    found = compared({"A": moved(0.0), "B": moved(25.0), "C": moved(50.0)}, {})
    alone = difference(50.0)
    together = found.differences["C", "A"]
    assert [*found.differences] == [("B", "A"), ("C", "A"), ("C", "B")]
    assert together.confidence == pytest.approx(1.0 - 0.05 / 3.0)
    assert together.p_value == pytest.approx(3.0 * alone.p_value)
    assert known(together.interval_m_s[0]) < known(alone.interval_m_s[0])
    assert found.to_dict()["differences"]["C minus A"]["difference_m_s"] == pytest.approx(50.0, abs=1e-2)


def test_a_lot_without_a_curve_has_no_difference():
    with pytest.raises(NoAnswerError, match="no difference: one of the lots has no recommended curve"):
        moved(0.0).difference(v50(Shots((700, 740, 770, 780, 750), (False, False, False, False, True))))
