"""Where an armour is unlike what the model was compared with, and errors that are given."""

from collections import defaultdict

import numpy as np
import pytest

from armour.analysis.variants import variants_of
from armour.engine import batch
from armour.evidence.fit import quantities
from armour.evidence.model_error import ModelError
from armour.evidence.tests import (
    Far,
    armours_of,
    far_from_tests,
    is_unusual,
    scenario_warnings,
    shipped_evidence,
    threat_warnings,
    what_was_tested,
)
from armour.scenario.inputs import BACKING, CERAMIC, OBLIQUITY, YIELD
from armour.scenario.scenario import Scenario
from armour.sweeps.sweep import sweep
from armour.units import GPA
from armour.validation.suite import load_suite
from tests.helpers.cases import scenario

RATIOS = ("ceramic_thickness_ratio", "backing_thickness_ratio", "rod_length_ratio")
TILES = shipped_evidence()[0]


def covered() -> dict[str, list[float]]:
    """Values of the paper's cases, without those with an initial flow stress."""
    values_by_quantity = defaultdict[str, list[float]](list)
    for case in load_suite("paper").cases:
        # Rows of a table are scored together where they are not each.
        if (case.not_scored and not case.group) or (case.scenario.armour.ceramic or "").endswith("initial"):
            continue
        q = quantities(case.scenario.core_armour(), np.nan, np.ones(1))
        for name in RATIOS:
            values_by_quantity[name].append(q[name])
    return values_by_quantity


def test_the_ranges_are_those_of_the_published_cases():
    ranges = {limits.name: (limits.low, limits.high) for limits in TILES.compared}
    for key, values in covered().items():
        low, high = ranges[key]
        assert low <= min(values) <= 1.04 * low
        assert 0.96 * high <= max(values) <= high


@pytest.mark.parametrize(
    "case",
    [
        scenario(),
        scenario(ceramic="SiC", backing="Ti-6Al-4V"),
        scenario(ceramic=None, ceramic_mm=0.0, backing="Ti-6Al-4V"),
        scenario(projectile="20 mm FSP"),
    ],
    ids=str,
)
def test_rows_are_judged_like_scenarios(case: Scenario):
    words = map(str, scenario_warnings(case))
    assert sorted(variants_of(case, {}, 2).caveats()) == sorted((warning, 2) for warning in words)


@pytest.mark.parametrize(
    ("ceramic_mm", "alike", "other"), [(6.35, "5083-H3", "AA5083-H116"), (0.0, "AA5083-H116", "5083-H3")]
)
def test_a_strength_of_another_kind_than_that_of_the_tests_is_named(ceramic_mm: float, alike: str, other: str):
    """Armour with a ceramic was compared by dynamic strengths, bare plates by static ones."""
    case = scenario(ceramic_mm=ceramic_mm)
    warnings = sweep(case, {"armour.backing": [alike, other, other]}, "areal_density_kg_m2").warnings
    [line] = [line for line in warnings if "yield strength" in line]
    assert f"of {other} is " in line
    assert line.endswith("2 of 3 rows")
    of_given_strength = sweep(
        case.replaced({"armour.backing": other}), {YIELD: [300.0]}, "areal_density_kg_m2"
    ).warnings
    assert "yield strength" not in str(of_given_strength)


def test_a_caveat_names_the_threats_that_it_is_about_unless_it_is_about_all():
    names = ("7.62 mm AP", "20 mm FSP", "12.7 mm FSP")
    for faced, against in ((names, " against 20 mm FSP at 850 m/s and 12.7 mm FSP at 850 m/s"), (names[1:], "")):
        case = scenario(threat=[{"projectile": name, "velocity_m_s": 850.0} for name in faced])
        armours = armours_of(*(case.against(threat) for threat in case.threats()))
        [note] = threat_warnings(case, armours)
        assert note.text.endswith(f"and so may be the limit{against}")


def test_a_given_error_is_that_of_samples():
    error = ModelError(2.0, 7.0, 12.0)
    dice = np.random.default_rng(1)
    samples = 0.02 + 0.07 * dice.standard_t(12.0, 400_000)
    limits = 889.0 * (1.0 + samples)
    assert error.probability_v50_exceeds(889.0, 850.0) == pytest.approx(float(np.mean(limits > 850.0)), abs=0.002)
    shots = limits * (1.0 + 0.01 * error.scatter_percent * dice.standard_normal(len(limits)))
    assert error.probability_of_stopping(889.0, 850.0) == pytest.approx(float(np.mean(shots > 850.0)), abs=0.002)
    low, high = error.interval(889.0)
    assert np.mean((889.0 * (1.0 + samples) > low) & (889.0 * (1.0 + samples) < high)) == pytest.approx(0.95, abs=0.002)
    assert error.median(889.0) == pytest.approx(1.02 * 889.0)


def test_an_error_at_the_ends_and_beyond():
    error = ModelError(0.0, 7.0, 12.0)
    assert error.quantile([0.0, 0.5, 1.0]) == pytest.approx([-0.99, 0.0, np.inf], abs=1e-12)
    assert error.probability_of_stopping(700.0, [600.0, 700.0])[1] == 0.5


# The ends of all ranges of docs/howto/confidence.md.
@pytest.mark.parametrize(
    ("field", "low", "high", "bare"),
    [
        ("Hb", 0.32, 9.7, True),
        ("rho_B", 2600.0, 8000.0, True),
        ("YB", 0.18, 5.7, True),
        ("L0", 0.9, 3.6, True),
        ("rho_p", 7700.0, 15000.0, True),
        ("Yp", 2.3, 2.4, True),
        ("Hc0", 0.61, 4.1, False),
        ("rho_c", 0.98 * 3420.0, 1.02 * 3840.0, False),
        ("Yc0", 4.8, 8.0, False),
        ("Hb", 0.66, 3.0, False),
        ("rho_B", 2600.0, 2900.0, False),
        ("YB", 0.9, 1.6, False),
        ("L0", 3.2, 5.4, False),
        ("rho_p", 7700.0, 8000.0, False),
        ("Yp", 2.3, 2.4, False),
    ],
)
def test_an_unusual_armour_is_outside_by_more_than_a_factor_of_two(field: str, low: float, high: float, bare: bool):
    case = scenario(ceramic=None, ceramic_mm=0.0) if bare else scenario()
    parameters = case.core_armour()
    factor = parameters.D0 if field in ("Hb", "L0", "Hc0") else GPA if field.startswith("Y") else 1.0
    values = np.array([0.49 * low, 0.51 * low, 1.99 * high, 2.01 * high, np.nan]) * factor
    rows = batch.fields(batch.packed([parameters] * len(values)))._replace(**{field: values})
    rows = rows._replace(tau=0.26 * rows.YB)
    assert is_unusual(rows).tolist() == [True, False, False, True, False]


def test_what_is_far_from_the_tests_is_told_with_what_was_tested():
    """A thickness counts from 10 % beyond the range, which is that of Wilkins."""
    case, diameter_mm = scenario(), 6.5
    tested = what_was_tested(case.impact, armours_of(case))
    assert tested.thicknesses_mm["tile"] == pytest.approx((0.89 * diameter_mm, 1.21 * diameter_mm), rel=0.01)
    low_mm, high_mm = tested.thicknesses_mm["tile"]
    for tile_mm, is_far in ((0.9 * low_mm, True), (0.95 * low_mm, False), (1.09 * high_mm, False), (12.1, True)):
        changed = case.replaced({CERAMIC: tile_mm, BACKING: 6.35})
        words = [f"{tile_mm:.4g} mm tile (tested 5.8 to 7.9 mm)"] * is_far
        assert list(map(str, far_from_tests(changed, armours_of(changed)))) == words
    single = tested._replace(thicknesses_mm={"tile": (5.86, 5.86)})
    assert single.far("tile", 14.0) == Far("14 mm tile", "tested 5.9 mm")
    other = scenario("7.62 mm APM2", "SiC", "5083-H3").replaced({OBLIQUITY: 15.0})
    found = (
        Far("SiC", "no test"),
        Far("5083-H3", "tested on 6061-T6"),
        Far("7.62 mm APM2", "tested with 7.62 mm AP"),
        Far("15°", "tested to 0°"),
    )
    assert {*found} <= {*far_from_tests(other, armours_of(other))}
