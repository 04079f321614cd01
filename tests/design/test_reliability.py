"""Bounds on the probability of perforation."""

from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import confidence
from armour.analysis.estimates import Estimate
from armour.analysis.samples import probability_of_perforation
from armour.design.optimise import BestDesign, optimise
from armour.errors import InputError
from armour.scenario.scenario import Scenario
from tests.design.results import best_of
from tests.helpers.cases import CERAMICS, THREATS, catalogue, offer, scenario
from tests.helpers.known import known
from tests.helpers.plain_designs import designs, stops

pytestmark = pytest.mark.slow

# The model error is that of tests.
FROM_TESTS: dict[str, Any] = {"samples": 4096}
THREAT = {"projectile": "7.62 mm AP", "velocity_m_s": 700.0}
BOUNDED = {"projectile": "7.62 mm AP", "velocity_m_s": 800.0, "probability_of_perforation": 0.02}
UNCERTAIN: dict[str, Any] = {
    "samples": 256,
    "model": {"scale_percent": 0.01, "degrees_of_freedom": 1e6, "source": "as if the model were exact"},
    "ceramic": {"flow_stress_GPa": {"distribution": "normal", "standard_deviation_percent": 4.0}},
    "armour": {"backing_thickness_mm": {"distribution": "normal", "standard_deviation": 0.05}},
}


def test_a_bound_on_the_probability_of_perforation():
    case = catalogue([BOUNDED], UNCERTAIN)
    best = best_of(optimise(case))
    assert known(best.check.threats[0].sampled).high <= 0.02
    plain = best_of(optimise(catalogue([{k: BOUNDED[k] for k in ("projectile", "velocity_m_s")}])))
    assert best.areal_density_kg_m2 > plain.areal_density_kg_m2
    # Every lighter design that stops the threat as it stands is perforated too often.
    lighter = [layers for layers, values in designs(case, stops) if values["areal_density_kg_m2"] < lightest(best)]
    assert lighter
    assert all(sampled(case, layers).high > 0.02 for layers in lighter)


def lightest(best: BestDesign) -> float:
    return best.areal_density_kg_m2 - 1e-9


def sampled(case: Scenario, layers: tuple[str, str, float, float]) -> Estimate:
    """The probability of perforation of a design against the only threat of a catalogue."""
    names = ("ceramic", "backing", "ceramic_thickness_mm", "backing_thickness_mm")
    changes = {f"armour.{name}": value for name, value in zip(names, layers, strict=True)}
    own = case.replaced(changes).against(case.threats()[0])
    return probability_of_perforation(own, case.threats()[0].probability_of_perforation)


def test_a_threat_without_a_bound_beside_one_with():
    threats = [{"projectile": "7.62 mm AP", "velocity_m_s": 700.0}, {**THREATS[1], "probability_of_perforation": 0.3}]
    best = best_of(optimise(catalogue(threats, UNCERTAIN)))
    plain, bounded = best.check.threats
    assert plain.sampled is None
    assert known(bounded.sampled).high <= 0.3


def test_the_thickness_of_an_absent_ceramic_does_not_vary():
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 300.0, "probability_of_perforation": 0.05}
    varying = {**UNCERTAIN, "armour": {"ceramic_thickness_mm": {"distribution": "normal", "standard_deviation": 0.05}}}
    bare = {"ceramic": [{"material": "AD85", "thickness_mm": [0.0, 20.0]}]}
    assert best_of(optimise(catalogue([threat], varying, **bare))).ceramic_thickness_mm == 0.0


def test_a_pair_whose_error_is_not_known_has_its_best_by_the_limit_and_comes_last():
    found = optimise(catalogue([THREAT], FROM_TESTS, probability_of_stopping=0.6))
    by_limit = {(pair.ceramic, pair.backing): pair.best for pair in optimise(catalogue([THREAT], FROM_TESTS)).pairs}
    unknown = {(pair.ceramic, pair.backing): pair for pair in found.pairs if not pair.ranked}
    assert ("AD99.5", "6061-T6") in unknown
    assert list(unknown.values()) == list(found.pairs[-len(unknown) :])
    for names, pair in unknown.items():
        of_limit = known(by_limit[names])
        assert pair.best is not None
        assert pair.best.check.threats[0].model_error is None
        assert pair.best.areal_density_kg_m2 == of_limit.areal_density_kg_m2
    sampled = optimise(catalogue([THREAT], {**UNCERTAIN, "model": None}, probability_of_stopping=0.6))
    assert {(pair.ceramic, pair.backing) for pair in sampled.pairs if not pair.ranked} == unknown.keys()
    given = catalogue(
        [THREAT],
        {"model": {"scale_percent": 5.0, "degrees_of_freedom": 1e6, "source": "tests"}},
        probability_of_stopping=0.6,
    )
    assert all(pair.best is not None for pair in optimise(given).pairs)


def test_an_error_that_is_not_known_against_one_threat():
    known = {"projectile": "7.62 mm AP", "velocity_m_s": 700.0}
    for other, why in (
        ({"projectile": "30 mm APDS", "velocity_m_s": 100.0}, "no test of such"),
        (
            {**known, "obliquity_deg": 15.0},
            "the model was compared with no test",
        ),
    ):
        result = optimise(catalogue([known, other], FROM_TESTS, ceramic=CERAMICS[:1], probability_of_stopping=0.6))
        assert (result.best, result.reason) == (None, "not known")
        assert why in result.shown.check.threats[1].reason


def test_a_confidence_is_kept_by_the_error_of_tests():
    """The lightest of all designs whose probability is enough, one by one; of each back plate the thinnest."""
    layers = offer("AD85 backing law", {"min": 5.0, "max": 12.0, "step": 0.5}, "6061-T6", [5.0, 7.0, 9.0])
    case = catalogue(
        [{"projectile": "7.62 mm AP", "velocity_m_s": 750.0}], FROM_TESTS, probability_of_stopping=0.9, **layers
    )
    result = optimise(case)
    probabilities = {}
    for hb in (5.0, 7.0, 9.0):
        for hc in np.arange(5.0, 12.5, 0.5).tolist():
            armour = {"armour.ceramic_thickness_mm": hc, "armour.backing_thickness_mm": hb}
            design = scenario(ceramic="AD85 backing law", velocity=750.0).replaced(armour)
            probabilities[hc, hb] = confidence(design).probability_of_stopping or 0.0
    enough = [(hc, hb) for (hc, hb), probability in probabilities.items() if probability >= 0.9]
    found = [(design.ceramic_thickness_mm, design.backing_thickness_mm) for design in result.frontier]
    assert found == [min(layer for layer in enough if layer[1] == hb) for hb in sorted({hb for _, hb in enough})]
    best = best_of(result)
    assert best.areal_density_kg_m2 == pytest.approx(min(3.43 * hc + 2.75 * hb for hc, hb in enough))
    probability = best.check.threats[0].probability_of_stopping
    expected = probabilities[best.ceramic_thickness_mm, best.backing_thickness_mm]
    assert probability == pytest.approx(expected, abs=1e-4)


def test_what_was_not_tested_is_ranked_apart():
    ceramics = [{"material": name, "thickness_mm": [6.0, 7.0, 8.0, 9.0]} for name in ("B4C", "AD85", "SiC")]
    metals = [{"material": "6061-T6", "thickness_mm": [6.0]}]
    found = optimise(catalogue([THREAT], FROM_TESTS, ceramic=ceramics, backing=metals))
    assert [(pair.ceramic, pair.ranked) for pair in found.pairs] == [("AD85", True), ("B4C", False), ("SiC", False)]
    assert best_of(found).ceramic == "AD85"
    # Without any that was tested, the lightest is the best, but not one with a single source.
    untested = optimise(catalogue([THREAT], FROM_TESTS, ceramic=ceramics[::2], backing=metals))
    assert best_of(untested).ceramic == "SiC"
    lighter = known(next(pair.best for pair in untested.pairs if pair.ceramic == "B4C"))
    assert lighter.areal_density_kg_m2 < best_of(untested).areal_density_kg_m2
    single = optimise(catalogue([THREAT], FROM_TESTS, ceramic=ceramics[:1], backing=metals))
    assert (single.best, single.reason) == (None, "not known")
    assert single.nearest == single.pairs[0].best is not None


@pytest.mark.parametrize(
    ("velocity_m_s", "reason", "ceramics"),
    [(1000.0, "not known", ["B4C", "AD85"]), (1200.0, "none passes", ["AD85", "B4C"])],
)
def test_a_design_of_one_source_is_the_nearest_if_it_is_not_known_and_the_others_fail(
    velocity_m_s: float, reason: str, ceramics: list[str]
):
    offered = [{"material": name, "thickness_mm": [4.0, 5.0, 6.0]} for name in ("B4C", "AD85")]
    metals = [{"material": "6061-T6", "thickness_mm": [6.0, 8.0]}]
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": velocity_m_s}
    found = optimise(catalogue([threat], {}, ceramic=offered, backing=metals))
    assert (found.reason, known(found.nearest).ceramic) == (reason, ceramics[0])
    assert found.designs == 12
    assert [(pair.ceramic, pair.ranked) for pair in found.pairs] == [(name, name == "AD85") for name in ceramics]


def test_the_pareto_front_keeps_to_the_bound():
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 800.0}
    criteria = ["areal_density_kg_m2", "margin_m_s"]
    bounded = optimise(catalogue([{**threat, "probability_of_perforation": 0.02}], UNCERTAIN, pareto=criteria))
    plain = optimise(catalogue([threat], pareto=criteria))
    assert min(design.areal_density_kg_m2 for design in bounded.pareto) == best_of(bounded).areal_density_kg_m2
    assert best_of(bounded).areal_density_kg_m2 > best_of(plain).areal_density_kg_m2
    assert set(bounded.pareto) != set(plain.pareto)


def test_the_frontier_keeps_to_the_bound():
    """Each of its designs, and none thinner on the same back plate does; none is lighter than the best."""
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 800.0}
    layers = offer("AD85", {"min": 5.0, "max": 14.0, "step": 0.5}, "6061-T6", [5.0, 6.0, 7.0])
    bounded = {**threat, "probability_of_perforation": 0.02}
    case = catalogue([bounded], UNCERTAIN, **layers)
    result = optimise(case)
    assert min(design.areal_density_kg_m2 for design in result.frontier) == best_of(result).areal_density_kg_m2
    plain = optimise(catalogue([threat], **layers)).frontier
    for design, least in zip(result.frontier, plain, strict=True):
        thickness = design.ceramic_thickness_mm
        for ceramic in np.arange(least.ceramic_thickness_mm, thickness + 0.5, 0.5).tolist():
            found = sampled(case, ("AD85", "6061-T6", ceramic, design.backing_thickness_mm))
            assert (found.high <= 0.02) == (ceramic == thickness)
    assert min(d.areal_density_kg_m2 for d in plain) < best_of(result).areal_density_kg_m2


def test_the_probability_is_at_the_threats_own_velocity():
    plain, with_margin = (
        best_of(optimise(catalogue([{**BOUNDED, "margin_m_s": margin}], UNCERTAIN))) for margin in (0.0, 20.0)
    )
    [alone], [both] = plain.check.threats, with_margin.check.threats
    assert known(alone.ballistic_limit_m_s) > 820.0
    assert alone.sampled == both.sampled
    assert [(row.quantity, row.verdict) for row in both.requirements] == [
        ("margin_m_s", "passes"),
        ("probability_of_stopping", "passes"),
    ]


@pytest.mark.parametrize(
    "uncertain",
    [
        {"impact": {"velocity_m_s": {"distribution": "uniform", "min": 100.0, "max": 110.0}}},
        {"armour": {"ceramic_thickness_mm": {"distribution": "normal", "mean": 12.0, "standard_deviation": 0.1}}},
        {"ceramic": {"flow_stress_GPa": {"distribution": "normal", "mean": 9.0, "standard_deviation": 0.1}}},
    ],
)
def test_distributions_must_follow_the_designs(uncertain: Any):
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 800.0, "probability_of_perforation": 0.05}
    with pytest.raises(InputError, match="must be centred on the value of each design or threat"):
        optimise(catalogue([threat], uncertain))


def test_samples_that_are_not_allowed():
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 500.0, "probability_of_perforation": 0.4}
    wide = {"armour": {"ceramic_thickness_mm": {"distribution": "normal", "standard_deviation": 10.0}}}
    with pytest.raises(InputError, match="must not include values that are not allowed"):
        optimise(catalogue([threat], wide))
