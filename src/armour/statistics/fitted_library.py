"""Write library files and scenario files with calibrated entries."""

import re
from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import Annotated, Any

import tomli_w
from pydantic import Field

from armour.errors import InputError, NoAnswerError, counted, mistake
from armour.files import parse_toml, printable, write_file
from armour.scenario.checked import checked
from armour.scenario.inputs import BACKING, CERAMIC, FLOW_STRESS, INPUTS, NAMES, VELOCITY
from armour.scenario.library import FLOW_STRESS_LAW, LibraryEntry, shipped_library
from armour.scenario.scenario import Scenario, parse_scenario
from armour.scenario.schema import DesignSection, Line
from armour.statistics.calibration import LAWS, CalibrationResult
from armour.statistics.measured import LIMIT, MEASURED, OUTCOME, Tests
from armour.statistics.own_tests import NOTHING_OF_ERROR

# A list of numbers, each on a separate line.
NUMBER_LIST = re.compile(r"\[\n((?:\s+[-+.\deE]+,\n)+)\s*\]")


@checked
def save_fit(
    result: CalibrationResult,
    tests: Tests,
    scenario: Scenario,
    *,
    lot: Annotated[Line, Field(min_length=1)],
    library: str | PathLike[str] | None = None,
    fitted: str | PathLike[str] | None = None,
) -> None:
    """Write the result of a calibration to files, all or none; existing files are replaced.

    Parameters
    ----------
    result : CalibrationResult
    tests : Tests
    scenario : Scenario
        The tests and the scenario that were given to `calibrate`.
    lot : str
        Name of the tested lot, which is part of the names of the calibrated entries: ``"AD85, lot 7"``.
    library : path-like, optional
        Library file to write, with the calibrated entries and the tests that they were calibrated to.
    fitted : path-like, optional
        Scenario file to write, with these entries and the uncertainty of the fitted inputs.

    Raises
    ------
    InputError
        If no file is given, or one cannot be written.
    NoAnswerError
        If an input is not identified, or no scenario could use the fit.
    """
    contents: dict[Path, bytes] = {}
    if library is not None:
        contents[Path(library)] = library_text(result, tests, scenario, lot).encode()
    if fitted is not None:
        contents[Path(fitted)] = scenario_text(result, tests, scenario, lot, Path(fitted)).encode()
    if not contents:
        raise mistake("save_fit", "library", "must be given, or fitted: the file to write")
    for path, content in contents.items():
        write_file(path, content)


def library_text(result: CalibrationResult, tests: Tests, scenario: Scenario, lot: str) -> str:
    """Return the text of a library file with the calibrated entries and the tests that they were calibrated to.

    The file needs only the shipped library.  The arguments are those of `save_fit`; the entries must make a valid
    scenario in `scenario`.
    """
    tables, names = _calibrated_entries(result, tests, lot)
    _valid_scenario(lambda: scenario.replaced({"library": tables, **names}))
    return _compact_toml(tomli_w.dumps(tables))


def scenario_text(result: CalibrationResult, tests: Tests, scenario: Scenario, lot: str, path: Path) -> str:
    """Return the text of a scenario file with the calibrated entries, to be written at `path`.

    If the entries do not hold the tests as evidence, the file has the distributions of the fitted inputs.
    """
    for coefficient in result.coefficients:
        if result.evidence is None and coefficient.interval and None in coefficient.interval:
            raise NoAnswerError(f"nothing to write: the tests bound {coefficient.name} on one side only")
    tables, names = _calibrated_entries(result, tests, lot)
    with_entries = _valid_scenario(lambda: scenario.replaced({"library": tables, **names}))
    data = parse_toml(with_entries.to_toml(path.parent), scenario.file)
    tested = tests.groups[0].scenario
    _rename(data, scenario, {role: (tested.name_of(role), names[key]) for role, key in NAMES.items() if key in names})
    section, inputs = data.setdefault("uncertainty", {}), [coefficient.name for coefficient in result.coefficients]
    keeps_tests, pairs = result.evidence is not None, section.pop("correlation", [])
    for coefficient in result.coefficients:
        role, key = coefficient.name.split(".")
        section.get(role, {}).pop(key, None)
        if not keeps_tests:
            spread = float(f"{coefficient.standard_error:.6g}")
            section.setdefault(role, {})[key] = {"distribution": "normal", "standard_deviation": spread}
    correlations = [pair for pair in pairs if not {*pair["between"]} & {*inputs}]
    if keeps_tests:
        # The evidence of the entry includes the uncertainty of the fitted values.
        section.pop("model", None)
    else:
        correlations += (
            {"between": [name, other], "coefficient": float(f"{result.correlation[i][j]:.6g}")}
            for i, name in enumerate(inputs)
            for j, other in enumerate(inputs[:i])
        )
    if correlations:
        section["correlation"] = correlations
    for role in [role for role, table in section.items() if table == {}]:
        del section[role]
    if not section:
        del data["uncertainty"]
    return _compact_toml(_valid_scenario(lambda: parse_scenario(data, file=str(path), folder=path.parent)).to_toml())


def _rename(data: dict[str, Any], scenario: Scenario, names: Mapping[str, tuple[str | None, str]]) -> None:
    """Replace the names of tested entries by those of calibrated ones in the threats and the catalogue of a scenario.

    `data` are the tables of its file, which are changed; `names` has the tested and the calibrated name by role.
    """
    design, layers = scenario.design or DesignSection(), data.get("design", {})
    for role, key, sections, tables in (
        ("projectile", "projectile", scenario.threat, data.get("threat", [])),
        ("ceramic", "material", design.ceramic, layers.get("ceramic", [])),
        ("backing", "material", design.backing, layers.get("backing", [])),
    ):
        tested, calibrated = names.get(role, (None, ""))
        for section, table in zip(sections, tables, strict=True):
            if getattr(section, key) == tested:
                table[key] = calibrated


def _compact_toml(text: str) -> str:
    """Return a TOML text with each list of numbers on one line; refuse names that are not UTF-8."""
    if wrong := next((line for line in text.split("\n") if printable(line) != line), ""):
        raise mistake("calibrate", "", f"must be given names in UTF-8, found {printable(wrong)}")
    return NUMBER_LIST.sub(lambda numbers: f"[{', '.join(numbers[1].replace(',', ' ').split())}]", text)


def _valid_scenario(scenario_of: Callable[[], Scenario]) -> Scenario:
    """Return the scenario that `scenario_of` makes with a fit; raise a NoAnswerError if the scenario is not valid."""
    try:
        return scenario_of()
    except InputError as error:
        reasons = "; ".join(f"{problem.key} {problem.message}" for problem in error.problems)
        raise NoAnswerError(f"nothing to write: no scenario could use the fit: {reasons}") from None


def _calibrated_entries(result: CalibrationResult, tests: Tests, lot: str) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the calibrated entries as tables of a library file, and their names by the scenario's key that names them.

    `lot` is part of the names.
    """
    tables: dict[str, Any] = {}
    names: dict[str, str] = {}
    for coefficient in result.coefficients:
        if coefficient.estimate is None and result.evidence is None:
            raise NoAnswerError(f"nothing to write: {coefficient.name} is not identified: {coefficient.reason}")
        role, key = coefficient.name.split(".")
        entry = tests.groups[0].scenario.entry_of(role)
        assert entry is not None
        source = f"armour calibrate, {counted(len(tests.names), 'test')} of {Path(tests.file).name}"
        if coefficient.name == FLOW_STRESS or key in FLOW_STRESS_LAW:
            source += f", {result.law} law"
        if changed := result.question.get("changed"):
            source += f", computed with {changed}"
        low, high = coefficient.interval or (None, None)
        if low is not None and high is not None:
            source += f", {100.0 * result.confidence:g} % interval {low:.4g} to {high:.4g}"
        names[NAMES[role]] = name = f"{entry.name}, {lot}"
        entries = tables.setdefault(entry.kind, {})
        value = entry.values[key].model_dump() if key in entry.values else {}
        if coefficient.estimate is not None:
            value = {"value": float(f"{coefficient.estimate:.6g}"), "status": "fitted", "source": source}
        if name not in entries:
            entries[name] = _base_of(entry, result.law)
            if result.evidence is not None or role != "projectile":
                reason = {"reason": result.reason or NOTHING_OF_ERROR}
                entries[name]["evidence"] = {"lot": lot, **(result.evidence or reason)}
            value["tests"] = [_table_of_test(tests, i, role) for i in range(len(tests.names))]
        entries[name][key] = value
    return tables, names


def _base_of(entry: LibraryEntry, law: str) -> dict[str, Any]:
    """Return the table that a calibrated entry starts from: based on `entry` if it is shipped, otherwise its values.

    Coefficients of laws of the flow stress other than `law` are set to 0.
    """
    base: dict[str, Any] = {"based_on": entry.name}
    if shipped_library().entries[entry.kind].get(entry.name) != entry:
        values = {key: value.model_dump() for key, value in entry.values.items() if key not in entry.derived}
        base = {"description": entry.description} | values
    other_laws = [key for key in FLOW_STRESS_LAW if law in LAWS and key not in LAWS[law] and key in entry.values]
    return base | {key: 0.0 for key in other_laws if entry[key]}


def _table_of_test(tests: Tests, test: int, calibrated_role: str) -> dict[str, float | str]:
    """Return the test at an index as a table of a library file: its inputs and measurements, by key.

    The name of the material in the calibrated role is left out, as the entry that holds the table has it.
    """
    scenario = next(group.scenario for group in tests.groups if test in group.where)
    cells = tests.cells[test]
    names = {key: scenario.name_of(role) for role, key in NAMES.items() if role != calibrated_role}
    table: dict[str, float | str] = {key: name for key, name in names.items() if name is not None}
    table[CERAMIC] = scenario.armour.ceramic_thickness_mm
    table[BACKING] = scenario.armour.backing_thickness_mm
    if LIMIT not in cells:
        table[VELOCITY] = scenario.impact.velocity_m_s
    return {**table, **{name: cell for name, cell in cells.items() if name in (*INPUTS, *MEASURED, OUTCOME)}}
