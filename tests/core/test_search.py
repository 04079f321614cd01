"""Searches against bisection on the outcome."""

from collections.abc import Callable
from math import inf, sqrt

import numpy as np
import pytest

from armour.core import equations as eq
from armour.core import search
from armour.core.run import TOLERANCE
from armour.core.search import (
    RunSettings,
    Trial,
    find_ballistic_limit,
    first_scanned,
    impact,
    least_energy,
    least_energy_of_plate,
    may_perforate,
    narrowed_change,
    scan,
)
from armour.core.stages import mass_ahead, medium_ahead, rates, select_stage, shear_force, with_intact_strength
from armour.core.state import Medium, Parameters, State
from tests.helpers.bisection import bisect
from tests.helpers.cases import armour
from tests.helpers.runs import perforates, random_designs

LIMITS, STEPS = 15, 500_000
VELOCITIES = scan(20.0, 4000.0)
SOLVER = RunSettings(1.0, 0.0, STEPS, TOLERANCE)


def test_the_limits_are_those_of_scan_and_bisection():
    for p in random_designs(LIMITS):
        result = find_ballistic_limit(p, VELOCITIES, 1e-4, 1.0, 0.0, STEPS)
        above = next(i for i, velocity in enumerate(VELOCITIES) if result.high <= velocity)
        low, high = bisect(lambda v, p=p: perforates(p, v), VELOCITIES[above - 1], VELOCITIES[above], 1e-6)  # type: ignore[misc]
        assert result.low <= high
        assert result.high >= low
        assert result.high - result.low <= 1e-4
        assert result.resolved
        assert result.runs <= (20 if p.drive_law == eq.STRENGTH else 20 + search.SCAN_POINTS)


def test_the_ends_of_a_fine_bracket_have_their_outcomes():
    """The residual energy vanishes some 5e-10 m/s below the change of the outcome."""
    p = armour("7.62 mm AP", "AD85", "6061-T6", 7.83, 7.24)
    for flow_stress in (5.238e9, 5.24e9, 5.248e9, 5.258e9):
        harder = p._replace(Yc0=flow_stress)
        result = find_ballistic_limit(harder, VELOCITIES, 1e-9, 1.0, 0.0, STEPS)
        assert perforates(harder, result.high)
        assert not perforates(harder, result.low)


def test_a_change_to_stop_is_narrowed():
    """Where a faster projectile is stopped again, the lower impact perforates."""
    p = armour()
    limit = find_ballistic_limit(p, VELOCITIES, 1e-6, 1.0, 0.0, STEPS).high
    result = narrowed_change(p, impact(p, limit + 50.0, SOLVER), impact(p, limit - 50.0, SOLVER), 1e-3, SOLVER)
    assert result.low <= limit <= result.high
    assert result.high - result.low <= 1.2e-3


def test_a_range_without_a_root():
    p = armour()
    slow = scan(20.0, 500.0)
    result = find_ballistic_limit(p, slow, 1e-3, 1.0, 0.0, STEPS)
    assert (result.low, result.high, result.resolved) == (500.0, inf, True)
    result = find_ballistic_limit(p, scan(900.0, 1500.0), 1e-3, 1.0, 0.0, STEPS)
    assert (result.low, result.high, result.resolved) == (-inf, 900.0, True)


@pytest.mark.parametrize("steps", [3, 21])
def test_an_unresolved_run_ends_the_search(steps: int):
    result = find_ballistic_limit(armour(), VELOCITIES, 1e-3, 1.0, 0.0, steps)
    assert result.low == result.high
    assert not result.resolved


class Impacts:
    """Impacts whose outcome is a function of the velocity, which it counts."""

    def __init__(self, perforates: Callable[[float], bool], unresolved: tuple[float, float] = (inf, inf)) -> None:
        self.perforates, self.unresolved, self.count = perforates, unresolved, 0

    def at_velocity(self, _p: Parameters, V: float, _solver: RunSettings) -> Trial:
        self.count += 1
        resolved = not self.unresolved[0] <= V <= self.unresolved[1]
        perforated = resolved and self.perforates(V)
        return Trial(V, perforated, resolved, 1.0 if perforated else -1.0)


FAST = scan(1000.0, 4000.0)  # no velocity lacks the energy to perforate


@pytest.mark.parametrize(
    ("change", "unresolved", "low", "high"),
    [
        (inf, (inf, inf), 4000.0, inf),
        (0.0, (inf, inf), -inf, 1000.0),
        (2500.0, (900.0, 1000.0), 1000.0, 1000.0),
        (2500.0, (2000.0, 2100.0), 2000.0, 2000.0),
        (2500.0, (2499.0, 2501.0), 2500.0, 2500.0),
    ],
)
def test_every_run_of_a_search_is_counted(monkeypatch: pytest.MonkeyPatch, change, unresolved, low, high):
    impacts = Impacts(lambda V: change < V, unresolved)
    monkeypatch.setattr(search, "impact", impacts.at_velocity)
    result = find_ballistic_limit(armour(), FAST, 0.01, 1.0, 0.0, STEPS)
    assert result.low == pytest.approx(low, abs=1.0)
    assert result.high == pytest.approx(high, abs=1.0)
    assert result.resolved is (unresolved[0] == inf)
    assert result.low == result.high or result.resolved
    assert result.runs == impacts.count


def test_usual_runs_that_contradict_the_rough_ones_scan_again(monkeypatch: pytest.MonkeyPatch):
    """The rough runs see a change at 1,500 m/s, the usual ones at 2,500."""
    rough, usual = Impacts(lambda V: V > 1500.0), Impacts(lambda V: V > 2500.0)
    monkeypatch.setattr(
        search,
        "impact",
        lambda p, V, solver: (rough if solver.tolerance > TOLERANCE else usual).at_velocity(p, V, solver),
    )
    result = find_ballistic_limit(armour(), FAST, 0.01, 1.0, 0.0, STEPS)
    assert result.low <= 2500.0 <= result.high <= result.low + 0.0101
    assert result.runs == rough.count + usual.count


def test_a_tolerance_below_rounding_ends():
    result = find_ballistic_limit(armour(), VELOCITIES, 0.0, 1.0, 0.0, STEPS)
    assert result.high - result.low < 1e-9
    assert result.runs < 140


def test_the_residual_energy_continues_below_the_limit():
    """Its derivative is the same above and below; where a projectile stops alone, it only has the sign."""
    p = armour()
    limit = find_ballistic_limit(p, VELOCITIES, 1e-8, 1.0, 0.0, STEPS).high
    f = [impact(p, limit + distance, SOLVER).f for distance in (-0.02, -0.01, 0.01, 0.02)]
    assert f[0] < f[1] < 0.0 < f[2] < f[3]
    assert f[2] - f[1] == pytest.approx(2.0 * (f[1] - f[0]), rel=1e-3)
    assert f[2] - f[1] == pytest.approx(2.0 * (f[3] - f[2]), rel=1e-3)
    assert impact(p, 100.0, SOLVER).f < 0.0


def test_a_scan_has_even_ratios_from_end_to_end():
    velocities = scan(20.0, 4000.0, 5)
    assert (velocities[0], velocities[-1], len(velocities)) == (20.0, 4000.0, 5)
    assert velocities[1:4] == pytest.approx([20.0 * 200.0 ** (i / 4) for i in (1, 2, 3)])
    assert len(VELOCITIES) == search.SCAN_POINTS


def fastest_without(p: Parameters) -> float:
    """The highest velocity, m/s, at which a projectile has not the energy to perforate."""
    low, high = 0.0, 10_000.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if may_perforate(p, middle) else (middle, high)
    return low


@pytest.mark.parametrize("index", range(60))
def test_nothing_perforates_without_the_energy(index: int):
    p = random_designs(60)[index]._replace(drive_law=eq.STRENGTH)
    fastest = fastest_without(p)
    assert fastest > 50.0
    for part in (0.3, 0.6, 0.8, 0.9, 0.97, 1.0):
        assert not perforates(p, part * fastest)


def test_without_a_bound_on_the_energy_the_scan_starts_at_its_lowest_velocity():
    p = armour()
    assert first_scanned(p, VELOCITIES) > 0
    assert first_scanned(p._replace(drive_law=eq.INTERFACE), VELOCITIES) == 0


def test_unusual_armours_are_not_perforated_without_the_energy():
    """Light and heavy rods, soft and hard ones, thin and thick layers."""
    rng = np.random.default_rng(4)
    close = 0.0
    for _ in range(60):
        D0 = 0.007
        factors = np.exp(rng.uniform(-1.0, 1.0, 8)).tolist()
        p = armour(perimeter="projectile" if rng.random() < 0.5 else "conoid")
        p = p._replace(
            L0=3.0 * D0 * factors[0], D0=D0, rho_p=min(p.rho_p * factors[1], 18e3), Yp=p.Yp * factors[2],
            Hc0=D0 * factors[3] * float(rng.random() > 0.2), Yc0=p.Yc0 * factors[4],
            Hb=D0 * factors[5], YB=p.YB * factors[6], tau=p.tau * factors[7],
        )  # fmt: skip
        fastest = fastest_without(p)
        assert not perforates(p, fastest)
        assert not perforates(p, 0.9 * fastest)
        close = max(close, float(perforates(p, 1.3 * fastest)))
    assert close == 1.0


def test_a_plate_takes_least_by_penetration_until_a_plug_is_left():
    p = armour(ceramic=None, ceramic_mm=0.0, backing_mm=6.0)
    plug = p.YB * p.D0 / (8.0 * p.tau)
    assert 0.0 < plug < p.Hb
    energy = p.YB * (p.Hb - plug) + 4.0 * p.tau / p.D0 * plug**2
    assert least_energy_of_plate(p) == pytest.approx(energy)
    assert least_energy(p, 300.0) == pytest.approx(energy)
    for other in (0.9 * plug, 1.1 * plug):
        assert p.YB * (p.Hb - other) + 4.0 * p.tau / p.D0 * other**2 > energy


def test_a_thin_light_plate_is_displaced_whole_and_takes_no_more():
    p = armour(ceramic=None, ceramic_mm=0.0)._replace(Hb=2e-3, rho_B=10.0, YB=50e9, Yp=50e9)
    energy = 4.0 * p.tau / p.D0 * 4e-6
    assert least_energy_of_plate(p) == pytest.approx(energy)
    limit = sqrt(2.0 * energy / (p.rho_p * p.L0))
    assert not perforates(p, 0.995 * limit)
    assert perforates(p, 1.01 * limit)
    assert may_perforate(p, limit)
    assert not may_perforate(p, 0.99 * limit)


def test_ceramic_takes_energy():
    """Exponentially with its thickness while little energy is left, and linearly above a knee."""
    p = armour(perimeter="projectile")
    plate = least_energy_of_plate(p)
    areal = p.rho_p * p.L0 + p.rho_B * p.Hb + p.rho_c * p.Hc0
    greatest = 4.0 / 3.0 * p.tau * p.Hb / p.D0
    assert greatest / (2.0 * p.Yc0 / (areal * 100.0**2)) < plate
    assert least_energy(p, 100.0) == pytest.approx(plate + greatest * p.Hc0)
    rate = 2.0 * p.Yc0 / (areal * 5000.0**2)
    assert plate * np.exp(rate * p.Hc0) < greatest / rate
    assert least_energy(p, 5000.0) == pytest.approx(plate * np.exp(rate * p.Hc0))
    rate = 2.0 * p.Yc0 / (areal * 950.0**2)
    knee = greatest / rate
    depth = np.log(knee / plate) / rate
    assert 0.0 < depth < p.Hc0
    assert least_energy(p, 950.0) == pytest.approx(knee + greatest * (p.Hc0 - depth))


def test_a_joint_motion_in_ceramic_takes_the_force_round_the_projectile():
    """Round the base of a wide conoid a third of the force would be more."""
    p = armour(ceramic_mm=20.0)
    assert p.D0 + 4.0 * p.Hc0 > 3.0 * p.D0
    expected = least_energy_of_plate(p) + 4.0 * p.tau * p.Hb / p.D0 * p.Hc0
    assert least_energy(p, 100.0) == pytest.approx(expected)


def test_the_bound_ends_where_an_eroding_rod_transfers_more_than_it_loses():
    soft = armour()._replace(Yp=1e8, tau=1e12, YB=1e12)
    assert not may_perforate(soft, 0.99 * sqrt(2.0 * 1e8 / soft.rho_p))
    assert may_perforate(soft, 1.01 * sqrt(2.0 * 1e8 / soft.rho_p))


def test_a_law_of_the_flow_stress_counts():
    p = armour(ceramic_mm=9.0)
    p = p._replace(tau=20.0 * p.tau, YB=0.1 * p.YB, a_c=-0.5)
    weaker = with_intact_strength(p)
    assert weaker.Yc0 < p.Yc0
    assert fastest_without(p) == fastest_without(weaker) < fastest_without(p._replace(a_c=0.0))


def test_the_kinetic_energy_falls_as_the_bound_on_it_says():
    """The inequalities 2 and 3 of docs/numerics.md, "Bound on the energy", at random states in every kind of stage."""
    rng = np.random.default_rng(5)
    stages = set()
    for _ in range(1500):
        rho_p, Yp, rho_c, Yc0, rho_B, YB, tau = (
            rng.uniform(1.0, 10.0, 7) * (2e3, 1e9, 1e3, 1e9, 1e3, 3e8, 5e7)
        ).tolist()
        p = armour()._replace(rho_p=rho_p, Yp=Yp, rho_c=rho_c, Yc0=Yc0, rho_B=rho_B, YB=YB, tau=tau)
        medium = Medium(int(rng.integers(3)))
        Vi = sqrt(2.0 * Yp / rho_p)
        V, W = (Vi * np.sort(rng.random(2))[::-1]).tolist()
        W *= medium != Medium.INTACT and rng.random() < 0.8
        h_s, h, Z = np.sort(rng.random(3)).tolist()
        Z = p.Hc0 + Z * p.Hb if medium == Medium.PLATE else Z * p.Hc0
        y = State(Z, p.L0 * float(rng.random()), V, W, h * p.Hc0)
        if rng.random() < 0.1:
            y = y._replace(W=V) if medium == Medium.PLATE else y
        s = select_stage(medium, y, p, float(rng.uniform(V, Vi)), h_s * p.Hc0)
        stages.add((medium, s.eroding, s.penetrated))
        k = rates(y, s, p)
        U, A0 = k.Z, eq.cross_section(p.D0)
        Y, rho = medium_ahead(y, s, p)
        m, f = mass_ahead(y, s, p) / A0, shear_force(y, s, p) / A0
        of_projectile = p.rho_p * (k.L * y.V**2 / 2.0 + y.L * y.V * k.V)
        of_target = -rho * (U - y.W) * y.W**2 / 2.0 + m * y.W * k.W
        lost, rounding = -of_projectile - of_target, 1e-9 * p.rho_p * y.V**3
        assert lost >= Y * (U - y.W) + f * y.W - rounding
        if medium == Medium.FRAGMENTED:
            assert lost >= U * min(p.Yc0 * (y.V / s.Vs1) ** 2, f / 3.0) - rounding
    assert len(stages) == 10
