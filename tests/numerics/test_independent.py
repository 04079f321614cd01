"""Residual velocities, lengths and ballistic limits of the core against those of an independent method."""

import numpy as np
import pytest

from armour.core.run import run
from armour.core.state import Outcome
from tests.helpers.bisection import bisect
from tests.helpers.runs import path, perforates, random_designs, traced
from tests.numerics.reference import ARREST, Reference

pytestmark = pytest.mark.slow

COUNT = 40


def impact_velocity(index: int) -> float:
    return float(np.random.default_rng(index).uniform(300.0, 1400.0))


@pytest.mark.parametrize("diameter", [6.5e-3, 14.25e-3])
def test_the_designs_pass_through_every_stage(diameter: float):
    """Dwell on intact and fragmented ceramic, plates held, moving and carried, projectiles eroding and rigid."""
    designs = [(i, p) for i, p in enumerate(random_designs(COUNT)) if pytest.approx(diameter) == p.D0]
    stages = {stage for i, p in designs for stage in path(traced(p, impact_velocity(i))[1])}
    dwell, plate = {"Iech", "Fech", "Fecm"}, {"Peph", "Pepm", "Prph", "Prpm", "Prcm"}
    assert dwell | plate | {"Ieph", "Feph", "Fepm", "Frph", "Frpm"} <= stages


@pytest.mark.parametrize("index", range(0, COUNT, 2))
def test_residual_velocity_and_length_agree(index: int):
    p, velocity = random_designs(COUNT)[index], impact_velocity(index)
    reference, end = Reference(p, velocity), run(p, velocity, 0.0, ARREST, 100_000)
    assert (end.outcome == Outcome.PERFORATED) == reference.perforated
    assert pytest.approx(reference.V, rel=1e-4) == end.y.V
    assert pytest.approx(reference.L, rel=1e-4) == end.y.L


@pytest.mark.parametrize("index", range(3))
def test_ballistic_limits_agree(index: int):
    p = random_designs(COUNT)[index]
    found = bisect(lambda velocity: perforates(p, velocity), 50.0, 4000.0, 1e-3)[1]
    assert Reference(p, found + 0.02).perforated
    assert not Reference(p, found - 0.02).perforated
