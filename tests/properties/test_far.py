"""The probability of stopping far from the tests: without a jump, bounded by the distance, and judged so everywhere."""

from math import log
from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import confidence
from armour.analysis.evaluate import evaluate
from armour.analysis.variants import Floats, variants_of
from armour.design.check import check
from armour.design.optimise import optimise
from armour.evidence.tests import shipped_evidence
from armour.reporting.by_result import in_a_line
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.scenario import Scenario
from tests.helpers.cases import scenario
from tests.helpers.known import known

# The diameter of the penetrator of the 7.62 mm AP, to which thicknesses are relative.
DIAMETER_MM = scenario().core_armour().D0 * 1e3
TILES: dict[str, Any] = {"ceramic_mm": 7.0, "backing_mm": 7.0}
BARE: dict[str, Any] = {"ceramic": None, "ceramic_mm": 0.0, "backing_mm": 20.0}
RANGES = {
    kind: {data_range.name: data_range for data_range in evidence.measured}
    for evidence in shipped_evidence()
    if evidence.fits and (kind := evidence.fits[0].name)
}
ARMOURS = {
    "tile": (CERAMIC, RANGES["constant"]["ceramic_thickness_ratio"], TILES),
    "back plate": (BACKING, RANGES["constant"]["backing_thickness_ratio"], TILES),
    "aluminium": (BACKING, RANGES["cores_aluminium"]["backing_thickness_ratio"], BARE | {"backing": "AA6082-T651"}),
    "steel": (BACKING, RANGES["cores_steel"]["backing_thickness_ratio"], BARE | {"backing": "HHA Class 1"}),
}


def probabilities(case: Scenario, key: str, thicknesses_mm: Floats) -> Floats:
    return np.asarray(evaluate(case, {key: thicknesses_mm}, ["probability_of_stopping"])["probability_of_stopping"])


@pytest.mark.parametrize("name", ARMOURS)
def test_the_probability_has_no_jump_at_the_ends_of_the_tested_thicknesses(name: str):
    key, tested, armour = ARMOURS[name]
    for end in (tested.low, tested.high):
        at_end_mm = end * DIAMETER_MM
        near_mm = at_end_mm * np.exp(np.linspace(-0.05, 0.05, 41))
        sides_mm = at_end_mm * (1.0 + np.array([-1e-9, 1e-9]))
        limit = confidence(scenario(**armour).replaced({key: at_end_mm})).ballistic_limit_m_s
        for factor in (0.7, 0.9, 1.05):
            case = scenario(**armour, velocity=factor * known(limit))
            assert np.ptp(probabilities(case, key, sides_mm)) < 1e-6
            assert np.abs(np.diff(probabilities(case, key, near_mm))).max() < 0.025


@pytest.mark.parametrize("name", ARMOURS)
def test_it_is_at_most_what_the_distance_allows(name: str):
    key, tested, armour = ARMOURS[name]
    for factor, most in ((1.0, 1.0), (1.1, 0.976), (1.22, 0.951), (1.5, 0.9), (1.64, 0.878)):
        for thickness_mm in (tested.low * DIAMETER_MM / factor, tested.high * DIAMETER_MM * factor):
            case = scenario(**armour, velocity=50.0).replaced({key: thickness_mm})
            [greatest] = variants_of(case, {}, 1).errors.greatest
            assert greatest == pytest.approx(1.0 - 0.1 * log(factor) / log(1.5), abs=1e-9)
            assert greatest == pytest.approx(most, abs=1e-3)
            assert confidence(case).probability_of_stopping == pytest.approx(greatest, abs=1e-4)


def test_an_armour_whose_requirement_is_beyond_the_bound_is_not_known_and_one_that_fails_without_it_fails():
    thick = scenario(ceramic_mm=12.0, backing_mm=8.0, design={"probability_of_stopping": 0.95})
    limit = known(confidence(thick).ballistic_limit_m_s)
    slow, fast = (thick.replaced({"impact.velocity_m_s": round(part * limit)}) for part in (0.7, 1.0))
    assert [check(case).verdict for case in (slow, fast)] == ["not known", "fails"]
    assert check(slow.replaced({"design.probability_of_stopping": 0.85})).verdict == "passes"
    [judged] = check(slow).threats
    assert judged.probability_of_stopping == known(judged.model_error).greatest_probability < 0.95
    assert known(judged.probability_v50_exceeds_velocity) > 0.99
    assert in_a_line(check(slow)).endswith(" with at most 89 % so far from the tests (95 % required)")


def test_a_thicker_layer_that_is_only_far_from_the_tests_is_not_called_perforated():
    layers = {
        "ceramic": [{"material": "AD85", "thickness_mm": {"min": 4.0, "max": 30.0}}],
        "backing": [{"material": "6061-T6", "thickness_mm": [10.0, 11.0]}],
    }
    found = optimise(scenario(velocity=850.0, design={"probability_of_stopping": 0.95, **layers}))
    assert found.best is not None
    assert not [text for text in found.warnings if "is perforated at a velocity that a thinner one stops" in text]
