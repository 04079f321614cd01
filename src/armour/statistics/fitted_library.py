"""Library files with calibrated entries."""

from pathlib import Path
from typing import Any

from armour.errors import InputError, NoAnswerError
from armour.scenario.library import LibraryEntry, library_toml, shipped_library
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC, INPUTS, NAMES, VELOCITY, entry_of, name_of
from armour.statistics.calibration import CalibrationResult
from armour.statistics.flow_stress_laws import FLOW_STRESS, TERMS
from armour.statistics.test_data import LIMIT, MEASURED, OUTCOME, Tests


def value_at(result: CalibrationResult, name: str, ceramic_mm: float, backing_mm: float) -> float:
    """Return a fitted input by its law at thicknesses, mm."""
    estimates = {coefficient.name: coefficient.estimate or 0.0 for coefficient in result.coefficients}
    thicknesses = (1.0, ceramic_mm, backing_mm)
    return sum(estimates.get(name + term, 0.0) * size for term, size in zip(TERMS, thicknesses, strict=True))


def library_text(result: CalibrationResult, tests: Tests, scenario: Scenario) -> str:
    """Return a library file with the calibrated entries and the tests that they were calibrated to.

    An input that depends on the thicknesses takes its value at those of the scenario.  The file needs the shipped
    library alone, and the scenario must allow its entries.
    """
    for coefficient in result.coefficients:
        if coefficient.estimate is None:
            raise NoAnswerError(f"nothing to write: {coefficient.name} is not identified: {coefficient.reason}")
    intervals = {coefficient.name: coefficient.interval for coefficient in result.coefficients}
    names = dict.fromkeys(name.split(" per ")[0] for name in intervals)
    ceramic, backing = scenario.armour.ceramic_thickness_mm, scenario.armour.backing_thickness_mm
    of_law = f"{result.law} law" + ("" if result.law == "constant" else f" at {ceramic:g} mm on {backing:g} mm")
    tables: dict[str, Any] = {}
    used: dict[str, str] = {}
    for name in names:
        role, key = name.split(".")
        entry = entry_of(tests.groups[0].scenario, role)
        assert entry is not None
        source = f"armour calibrate, {len(tests.names)} tests of {Path(tests.file).name}"
        if name == FLOW_STRESS:
            source += f", {of_law}"
        interval = intervals.get(name)
        if result.law in ("", "constant") and interval is not None:
            source += f", {100.0 * result.confidence:g} % interval {interval[0]:.4g} to {interval[1]:.4g}"
        value = {
            "value": float(f"{value_at(result, name, ceramic, backing):.6g}"),
            "status": "fitted",
            "source": source,
            "tests": [_test_table(tests, i, role) for i in range(len(tests.names))],
        }
        entries = tables.setdefault(entry.kind, {})
        entries.setdefault(f"{entry.name}, calibrated", _base_of(entry))[key] = value
        used[NAMES[role]] = f"{entry.name}, calibrated"
    try:
        scenario.replaced({"library": tables, **used})
    except InputError as error:
        reasons = "; ".join(f"{problem.key} {problem.message}" for problem in error.problems)
        raise NoAnswerError(f"nothing to write: no scenario could use the fit: {reasons}") from None
    return library_toml(tables)


def _base_of(entry: LibraryEntry) -> dict[str, Any]:
    """Return what a calibrated entry inherits: a name of the shipped library, or values where it does not have them."""
    if shipped_library().entries[entry.kind].get(entry.name) == entry:
        return {"based_on": entry.name}
    return {"description": entry.description} | {
        key: value.model_dump() for key, value in entry.values.items() if key not in entry.derived
    }


def _test_table(tests: Tests, test: int, role: str) -> dict[str, float | str]:
    """Return the inputs and measurements of a test, without the name of the calibrated entry."""
    scenario = next(group.scenario for group in tests.groups if test in group.where)
    cells = tests.cells[test]
    names = {key: name_of(scenario, other) for other, key in NAMES.items() if other != role}
    found: dict[str, float | str] = {key: name for key, name in names.items() if name is not None}
    found[CERAMIC] = scenario.armour.ceramic_thickness_mm
    found[BACKING] = scenario.armour.backing_thickness_mm
    if LIMIT not in cells:
        found[VELOCITY] = scenario.impact.velocity_m_s
    return {**found, **{name: cell for name, cell in cells.items() if name in (*INPUTS, *MEASURED, OUTCOME)}}
