"""Calibrations to Wilkins' tests, each made once."""

from functools import cache

from armour.statistics.calibration import CalibrationResult, Law, calibrate
from armour.statistics.measured import read_tests
from tests.helpers.cases import TESTS, shipped_scenario


@cache
def wilkins_fit(law: Law | None = None) -> CalibrationResult:
    """The calibration of the flow stress of AD85 by a law, by default that of the scenario."""
    wilkins = shipped_scenario("wilkins")
    return calibrate(read_tests(TESTS, wilkins), wilkins, law=law)
