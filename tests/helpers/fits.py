"""Calibrations to Wilkins' tests, each made once, and to tables that are given as text."""

from functools import cache
from typing import Any

from armour.scenario.inputs import FLOW_STRESS
from armour.scenario.scenario import Scenario
from armour.statistics.calibration import CalibrationResult, Law, calibrate
from armour.statistics.measured import Tests, read_tests
from tests.helpers.cases import TESTS, shipped_scenario


@cache
def wilkins_fit(law: Law | None = None) -> CalibrationResult:
    """The calibration of the flow stress of AD85 by a law, by default that of the scenario."""
    wilkins = shipped_scenario("wilkins")
    return calibrate(read_tests(TESTS, wilkins), wilkins, law=law)


def table_of(case: Scenario, header: str, *rows: str) -> Tests:
    """The tests of a table."""
    return read_tests([dict(zip(header.split(","), row.split(","), strict=True)) for row in rows], case)


def fitted(case: Scenario, header: str, *rows: str, fit: Any = FLOW_STRESS, **settings: Any) -> CalibrationResult:
    """The calibration to the tests of a table."""
    return calibrate(table_of(case, header, *rows), case, fit, **settings)
