"""Library files with calibrated entries."""

from pathlib import Path
from typing import Any

from armour.errors import NoAnswerError
from armour.scenario.library import library_toml
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC, NAMES, VELOCITY, entry_of, name_of
from armour.statistics.calibration import CalibrationResult
from armour.statistics.flow_stress_laws import FLOW_STRESS, TERMS
from armour.statistics.test_data import LIMIT, Tests


def value_at(result: CalibrationResult, name: str, ceramic_mm: float, backing_mm: float) -> float:
    """Compute a fitted input by its law at thicknesses, mm.

    Raises
    ------
    NoAnswerError
        If a coefficient is not identified.
    """
    total = 0.0
    for term, thickness in zip(TERMS, (1.0, ceramic_mm, backing_mm), strict=True):
        for coefficient in result.coefficients:
            if coefficient.name == name + term:
                if coefficient.estimate is None:
                    raise NoAnswerError(f"nothing to write: {coefficient.name} is not identified: {coefficient.reason}")
                total += coefficient.estimate * thickness
    return total


def library_text(result: CalibrationResult, tests: Tests, scenario: Scenario) -> str:
    """Return a library file with the calibrated entries and the tests that they were calibrated to.

    An input that depends on the thicknesses takes its value at those of the scenario.

    Raises
    ------
    NoAnswerError
        If a coefficient is not identified.
    """
    names = dict.fromkeys(c.name.split(" per ")[0] for c in result.coefficients)
    ceramic, backing = scenario.armour.ceramic_thickness_mm, scenario.armour.backing_thickness_mm
    of_law = f"{result.law} law" + ("" if result.law == "constant" else f" at {ceramic:g} mm on {backing:g} mm")
    tables: dict[str, Any] = {}
    for name in names:
        role, key = name.split(".")
        entry = entry_of(tests.groups[0].scenario, role)
        assert entry is not None
        intervals = [c.interval for c in result.coefficients if c.name == name]
        source = f"armour calibrate, {len(tests.names)} tests of {Path(tests.file).name}"
        if name == FLOW_STRESS:
            source += f", {of_law}"
        if result.law in ("", "constant") and intervals and intervals[0] is not None:
            low, high = intervals[0]
            source += f", {100.0 * result.confidence:g} % interval {low:.4g} to {high:.4g}"
        value = {
            "value": float(f"{value_at(result, name, ceramic, backing):.6g}"),
            "status": "fitted",
            "source": source,
            "tests": [_test_table(tests, i, role) for i in range(len(tests.names))],
        }
        entries = tables.setdefault(entry.kind, {})
        entries.setdefault(f"{entry.name}, calibrated", {"based_on": entry.name})[key] = value
    return library_toml(tables)


def _test_table(tests: Tests, test: int, role: str) -> dict[str, float | str]:
    """Inputs and measurements of a test, without the name of the calibrated entry."""
    scenario = next(group.scenario for group in tests.groups if test in group.where)
    found: dict[str, float | str] = {}
    for other, key in NAMES.items():
        name = name_of(scenario, other)
        if other != role and name is not None:
            found[key] = name
    found[CERAMIC] = scenario.armour.ceramic_thickness_mm
    found[BACKING] = scenario.armour.backing_thickness_mm
    cells = tests.cells[test]
    if LIMIT not in cells:
        found[VELOCITY] = scenario.impact.velocity_m_s
    return {**found, **{name: value for name, value in cells.items() if name not in ("test", *NAMES.values())}}
