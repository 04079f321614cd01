"""The errors and ranges of armour.scenario.evidence, from the tests that they are estimated from."""

from collections.abc import Callable, Mapping
from math import pi, sqrt
from typing import Any

import numpy as np
import pytest
from scipy import stats

from armour.scenario.evidence import MEASURES, Evidence, shipped_evidence
from armour.scenario.library import shipped_library
from armour.statistics.calibration import Law, left_out_errors
from armour.validation.suite import load_suite
from armour.validation.validate import SuiteResult, validate
from tests.helpers.cases import TESTS, scenario
from tests.helpers.fits import wilkins_fit

pytestmark = pytest.mark.slow

CERAMIC_RATIO = MEASURES["ceramic_thickness_ratio"]
BACKING_RATIO = MEASURES["backing_thickness_ratio"]
BACKING_STRENGTH = MEASURES["backing_strength_GPa"]
SLENDERNESS = MEASURES["rod_length_ratio"]
TILES, BACKING_LAW, PRODUCT_LAW, *_PLATES = shipped_evidence()
CORES_ON_ALUMINIUM, CORES_ON_STEEL, FRAGMENTS_ON_ALUMINIUM, FRAGMENTS_ON_STEEL, *_OBLIQUE = _PLATES
OBLIQUE_ON_ALUMINIUM, OBLIQUE_ON_STEEL = _OBLIQUE
Cells = Mapping[str, Any]


@pytest.fixture(scope="module")
def plates() -> SuiteResult:
    return validate(load_suite("plates"))


def is_core(cells: Cells) -> bool:
    return cells["kind"] == "armour-piercing"


def is_normal(cells: Cells) -> bool:
    return float(cells["impact.obliquity_deg"]) == 0.0


def is_steel_core(cells: Cells) -> bool:
    return is_core(cells) and is_normal(cells) and float(cells["projectile.density_kg_m3"]) < 8000.0


BARE: dict[Evidence, tuple[str, Callable[[Cells], bool]]] = {
    CORES_ON_ALUMINIUM: ("aluminium", lambda cells: is_core(cells) and is_normal(cells)),
    CORES_ON_STEEL: ("steel", is_steel_core),
    FRAGMENTS_ON_ALUMINIUM: ("aluminium", lambda cells: cells["kind"] == "fragment simulator"),
    FRAGMENTS_ON_STEEL: ("steel", lambda cells: cells["kind"] == "fragment simulator"),
    OBLIQUE_ON_ALUMINIUM: ("aluminium", lambda cells: is_core(cells) and not is_normal(cells)),
    OBLIQUE_ON_STEEL: ("steel", lambda cells: is_core(cells) and not is_normal(cells)),
}


def residuals_of(plates: SuiteResult, evidence: Evidence) -> tuple[Any, Any, list[Cells]]:
    """Relative errors, per cent, alloys and cells of the tests of some evidence."""
    metal, chosen = BARE[evidence]
    checks = [check for check in plates.checks if check.case.cells["metal"] == metal and chosen(check.case.cells)]
    errors = [100.0 * (float(check.case.expected) / float(check.computed or 0.0) - 1.0) for check in checks]
    return np.array(errors), np.array([check.case.cells["plate"] for check in checks]), [c.case.cells for c in checks]


LAWS: list[tuple[Law, Evidence, str]] = [
    ("constant", TILES, "AD85"),
    ("backing", BACKING_LAW, "AD85 backing law"),
    ("product", PRODUCT_LAW, "AD85 product law"),
]


@pytest.mark.parametrize(("law", "evidence", "ceramic"), LAWS, ids=lambda item: str(item)[:12])
def test_tiles_have_the_error_of_tests_left_out(law: Law, evidence: Evidence, ceramic: str):
    errors = 100.0 * np.array(left_out_errors(wilkins_fit(law)))
    mean, scale, freedom = evidence.error
    assert len(errors) == 13
    assert freedom == 13 - len(wilkins_fit(law).coefficients)
    # The mean does not differ from 0 by its standard error, and the scale is the root mean square.
    assert abs(np.mean(errors) - mean) < np.std(errors, ddof=1) / sqrt(13)
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(scale, abs=0.05)
    found = scenario(ceramic=ceramic).model_error()
    assert found is not None
    assert found.source == evidence.title


@pytest.mark.parametrize(("law", "evidence", "ceramic"), LAWS[1:], ids=lambda item: str(item)[:12])
def test_the_library_has_the_laws_as_calibrated(law: Law, evidence: Evidence, ceramic: str):
    assert evidence.title.endswith(f"{law} law")
    entry = shipped_library().entries["ceramic"][ceramic]
    for coefficient in wilkins_fit(law).coefficients:
        assert entry[coefficient.name.split(".")[1]] == pytest.approx(coefficient.estimate, abs=6e-4)
        assert coefficient.interval is not None
        low, high = coefficient.interval
        source = entry.values[coefficient.name.split(".")[1]].source
        assert source.endswith(f"95 % interval {low:.2f} to {high:.2f}")


@pytest.mark.parametrize(("law", "evidence", "ceramic"), LAWS, ids=lambda item: str(item)[:12])
def test_tiles_left_out_one_by_one_lie_within_the_interval_of_the_others(law: Law, evidence: Evidence, ceramic: str):
    errors = 100.0 * np.array(left_out_errors(wilkins_fit(law)))
    others = np.array([np.sqrt(np.mean(np.square(np.delete(errors, i)))) for i in range(13)])
    within = abs(errors) <= stats.t.ppf(0.975, evidence.error[2] - 1.0) * others
    assert within.sum() == {"AD85": 12, "AD85 backing law": 11, "AD85 product law": 13}[ceramic]


@pytest.mark.parametrize("evidence", BARE, ids=lambda evidence: evidence.title)
def test_plates_have_the_error_of_the_suite(plates: SuiteResult, evidence: Evidence):
    errors, alloys, _ = residuals_of(plates, evidence)
    mean, scale, freedom = evidence.error
    assert evidence.title.startswith(f"{len(errors)} tests of")
    assert f"{len(set(alloys))} " in evidence.title.partition(" on ")[2]
    assert freedom == len(set(alloys)) - 1
    assert errors.mean() == pytest.approx(mean, abs=0.06)
    assert errors.std(ddof=1) * sqrt(1.0 + 1.0 / len(errors)) == pytest.approx(scale, abs=0.06)


def test_plates_left_out_alloy_by_alloy_lie_within_the_interval_of_the_others(plates: SuiteResult):
    counts = {}
    for evidence in BARE:
        errors, alloys, _ = residuals_of(plates, evidence)
        within = 0
        for alloy in np.unique(alloys):
            rest, out = errors[alloys != alloy], errors[alloys == alloy]
            scale = rest.std(ddof=1) * sqrt(1.0 + 1.0 / len(rest))
            factor = stats.t.ppf(0.975, len(np.unique(alloys)) - 2)
            within += int((abs(out - rest.mean()) <= factor * scale).sum())
        counts[evidence.title] = (within, len(errors))
    assert list(counts.values()) == [(511, 528), (37, 39), (144, 147), (11, 12), (40, 42), (265, 278)]
    within, count = np.sum(list(counts.values()), axis=0)
    assert 0.93 <= within / count <= 0.97


@pytest.mark.parametrize("evidence", BARE, ids=lambda evidence: evidence.title)
def test_the_ranges_hold_the_tests(plates: SuiteResult, evidence: Evidence):
    _, _, cells = residuals_of(plates, evidence)

    def column(key: str) -> Any:
        return np.array([float(row[key]) for row in cells])

    diameter = column("projectile.penetrator_diameter_mm")
    area = pi * diameter**2 / 4.0
    values = {
        BACKING_RATIO: column("armour.backing_thickness_mm")
        / np.cos(np.radians(column("impact.obliquity_deg")))
        / diameter,
        BACKING_STRENGTH: 2.7e-3 * column("backing.dynamic_yield_strength_MPa"),
        SLENDERNESS: 1e6
        * column("projectile.penetrator_mass_g")
        / column("projectile.density_kg_m3")
        / area
        / diameter,
    }
    for limits in evidence.measured:
        if limits.measure in values:
            assert limits.low <= values[limits.measure].min() <= 1.06 * limits.low
            assert 0.94 * limits.high <= values[limits.measure].max() <= limits.high
    low, high = evidence.velocities_m_s
    measured = column("ballistic_limit_m_s")
    assert low <= measured.min() <= 1.06 * low
    assert 0.9 * high <= measured.max() <= high


def test_the_ranges_of_tiles_hold_wilkins_tests():
    tests = np.loadtxt(TESTS, delimiter=",", skiprows=1)
    diameter = scenario().core_armour().D0 * 1e3
    for limits in TILES.measured:
        if limits.measure in (CERAMIC_RATIO, BACKING_RATIO):
            ratios = tests[:, 0 if limits.measure == CERAMIC_RATIO else 1] / diameter
            assert limits.low <= ratios.min() <= 1.06 * limits.low
            assert 0.92 * limits.high <= ratios.max() <= limits.high
