"""Fits that are not possible, and one far from its end."""

from typing import Any

import pytest

from armour.analysis.variants import Floats
from armour.core.search import SCAN_POINTS
from armour.engine import batch
from armour.errors import InputError
from armour.statistics.calibration import calibrate
from armour.statistics.measured import read_tests
from tests.helpers.cases import TESTS, shipped_scenario
from tests.helpers.fits import fitted, table_of

C, V, LIMIT = "armour.ceramic_thickness_mm", "impact.velocity_m_s", "ballistic_limit_m_s"
STRESS, TAU = "ceramic.flow_stress_GPa", "backing.shear_strength_MPa"
TWO = [f"{C},{LIMIT}", "6,700", "7,720"]
MANY = [f"{C},{LIMIT}", *(f"6,{700 + test}" for test in range(301))]
WEIGHTED = [f"{C},{V},outcome,ballistic_limit_uncertainty_m_s", "6,700,stopped,10", "7,720,perforated,10"]
CERAMICS = [f"armour.ceramic,{C},{LIMIT}", "AD85,6,700", "AD99.5,7,720"]


@pytest.mark.parametrize(
    ("table", "settings", "message"),
    [
        (TWO, {"fit": [C]}, "must not be a column if it is fitted"),
        (TWO, {"fit": [V]}, "must be a property of a material or projectile"),
        (TWO, {"fit": ["impact.obliquity_deg"]}, "must be a property of a material or projectile"),
        (TWO, {"fit": ["hardness"]}, 'found "hardness"; choose from'),
        (TWO, {"fit": "ceramic"}, 'calibrate: fit: must name an input of the scenario, found "ceramic"'),
        (TWO, {"fit": []}, "must name at least one input"),
        (TWO, {"law": "linear"}, "must have at least 3 measurements or outcomes for 3 coefficients, found 2"),
        (TWO, {"law": "linaer"}, 'found the text "linaer"; did you mean "linear"'),
        (TWO, {"fit": [TAU], "law": "backing"}, f"calibrate: law: must not be given unless {STRESS} is fitted"),
        (WEIGHTED, {"law": "linear"}, "must have at least 3 measurements or outcomes for 3 coefficients, found 2"),
        (MANY, {}, "must have at most 300 limits and outcomes, found 301"),
        (CERAMICS, {}, "armour.ceramic: must be the same in all tests if the ceramic is fitted, found AD85, AD99.5"),
    ],
)
def test_fits_that_are_not_possible(
    table: list[str], settings: dict[str, Any], message: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("armour.statistics.likelihood.search", lambda *_: pytest.fail("searched for"))
    with pytest.raises(InputError) as error:
        fitted(shipped_scenario("wilkins"), *table, **settings)
    assert message in str(error.value)


@pytest.mark.parametrize("changes", [{"armour.ceramic": "AD99.5"}, {STRESS: 4.5}, {"solver.time_step_us": 0.1}])
def test_another_scenario_than_that_of_the_tests(changes: dict[str, object]):
    wilkins = shipped_scenario("wilkins")
    with pytest.raises(InputError, match="calibrate: scenario: must be the one that the tests were read with;"):
        calibrate(read_tests(TESTS, wilkins), wilkins.replaced(changes))


def test_a_fit_far_from_its_end_takes_no_dense_scans(monkeypatch: pytest.MonkeyPatch):
    """Inputs that the tests do not identify lead far from all tests, where each limit would take 1,025 velocities."""
    scans: list[int] = []
    searched = batch.ballistic_limits

    def counted(
        rows: Floats, low: float, high: float, tolerance: float, settings: Any, points: int, threads: Any
    ) -> Any:
        scans.append(points)
        return searched(rows, low, high, tolerance, settings, points, threads)

    monkeypatch.setattr(batch, "ballistic_limits", counted)
    wilkins = shipped_scenario("wilkins")
    few = table_of(wilkins, *TESTS.read_text().splitlines()[:5])
    names = ["ceramic.flow_stress_GPa", "ceramic.youngs_modulus_GPa"]
    result = calibrate(few, wilkins, names)
    assert any(coefficient.estimate is None for coefficient in result.coefficients)
    assert set(scans) == {SCAN_POINTS}
