from pathlib import Path
from typing import Any

import pytest

from armour.errors import InputError
from armour.statistics.calibration import calibrate
from armour.statistics.measured import read_tests
from tests.helpers.cases import csv_file, shipped_scenario

C, V = "armour.ceramic_thickness_mm", "impact.velocity_m_s"


@pytest.mark.parametrize(
    ("header", "rows", "kwargs", "message"),
    [
        (
            f"{C},ballistic_limit_m_s",
            ["6,700"],
            {},
            "must have at least 2 measurements without uncertainties for 1 coefficients",
        ),
        (
            f"{C},ballistic_limit_m_s",
            ["6,700", "7,720"],
            {"fit": [C]},
            "must not be a column where it is fitted",
        ),
        (
            f"{C},ballistic_limit_m_s",
            ["6,700", "7,720"],
            {"fit": [V]},
            "must be a property of a material or projectile",
        ),
        (f"{C},ballistic_limit_m_s", ["6,700", "7,720"], {"fit": ["hardness"]}, 'found "hardness"; choose from'),
        (
            f"{C},ballistic_limit_m_s",
            ["6,700", "7,720"],
            {"law": "linear"},
            "must have at least 4 measurements without uncertainties for 3 coefficients, found 2",
        ),
        (
            f"{C},{V},outcome,ballistic_limit_m_s",
            ["6,,,700", "7,720,defeated,", "7,720,perforated,"],
            {},
            "1 coefficients, found 1; outcomes alone do not tell how measurements scatter",
        ),
        (
            f"{C},{V},outcome,ballistic_limit_uncertainty_m_s",
            ["6,700,defeated,10", "7,720,perforated,10"],
            {"law": "linear"},
            "must have at least 3 measurements or outcomes for 3 coefficients, found 2",
        ),
        (
            f"armour.ceramic,{C},ballistic_limit_m_s",
            ["AD85,6,700", "AD99.5,7,720"],
            {},
            "armour.ceramic: must be the same in all tests where the ceramic is fitted, found AD85, AD99.5",
        ),
    ],
)
def test_fits_that_are_not_possible(tmp_path: Path, header: str, rows: list[str], kwargs: dict[str, Any], message: str):
    wilkins = shipped_scenario("wilkins")
    tests = read_tests(csv_file(tmp_path / "t.csv", header, *rows), wilkins)
    with pytest.raises(InputError) as error:
        calibrate(tests, wilkins, **kwargs)
    assert message in str(error.value)
