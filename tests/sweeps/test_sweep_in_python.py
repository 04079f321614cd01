"""Sweeps in Python."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from armour.design.check import check
from armour.errors import InputError
from armour.sweeps.sweep import sweep
from tests.helpers.cases import csv_file, scenario
from tests.helpers.foreign import Column, Quantity

CERAMIC, BACKING = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"
OVER: dict[str, object] = {CERAMIC: {"min": 4.0, "max": 8.0, "step": 2.0}, BACKING: np.array([5.0, 6.0])}


def test_a_grid_in_memory():
    found = sweep(scenario(), OVER, ["areal_density_kg_m2", "outcome"])
    assert (found.keys, found.quantities, found.rows) == ((CERAMIC, BACKING), ("areal_density_kg_m2", "outcome"), 6)
    assert found[CERAMIC].tolist() == [4.0, 4.0, 6.0, 6.0, 8.0, 8.0]
    assert found[BACKING].tolist() == [5.0, 6.0] * 3
    armour = scenario(ceramic_mm=8.0, backing_mm=5.0)
    assert found["areal_density_kg_m2"][4] == pytest.approx(armour.areal_density_kg_m2())
    assert found.to_dict()["outcome"] == found["outcome"].tolist()


def test_a_result_compares_and_is_plain_data():
    over: dict[str, object] = {CERAMIC: [6.0, 400.0]}
    found = sweep(scenario(), over)
    assert found == sweep(scenario(), over)
    assert found != sweep(scenario(), {CERAMIC: [6.5, 400.0]})
    assert found != sweep(scenario(backing_mm=7.0), over)
    assert found.to_dict()["ballistic_limit_m_s"][1] is None
    assert list(found.columns) == [CERAMIC, "ballistic_limit_m_s"]
    with pytest.raises(InputError, match='sweep: column: must name a column, found the text "foo"; choose from'):
        found["foo"]


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_a_grid_in_a_file(tmp_path: Path, ending: str):
    output, counted = tmp_path / f"table{ending}", list[int]()
    kept = sweep(scenario(), OVER, "duration_us")
    found = sweep(scenario(), OVER, "duration_us", str(output), on_progress=lambda n, _total: counted.append(n))
    assert (found.output, found.rows, sum(counted)) == (output, 6, 6)
    assert list(found.columns) == list(kept.columns)
    assert all(np.array_equal(found[name], kept[name]) for name in kept.columns)
    assert len(found.warnings) == len(kept.warnings)
    with pytest.raises(InputError, match="exists already"):
        sweep(scenario(), OVER, "duration_us", output)


@pytest.mark.parametrize(
    "values",
    [
        np.array([4, 6]),
        pa.array([4.0, 6.0]),
        range(4, 8, 2),
    ],
)
def test_numbers_in_any_sequence(values: Any):
    assert sweep(scenario(), {CERAMIC: values}, "areal_density_kg_m2")[CERAMIC].tolist() == [4.0, 6.0]
    assert sweep(scenario(), cases={CERAMIC: values}, quantities="areal_density_kg_m2")[CERAMIC].tolist() == [4.0, 6.0]


@pytest.mark.parametrize("values", [np.array(["AD85", "SiC"]), Column("AD85", "SiC"), pa.array(["AD85", "SiC"])])
def test_names_in_any_sequence(values: Any):
    quantities = np.array(["areal_density_kg_m2"])
    found = sweep(scenario(), {"armour.ceramic": values}, quantities)
    assert found["armour.ceramic"].tolist() == ["AD85", "SiC"]
    assert sweep(scenario(), cases={"armour.ceramic": values}, quantities=quantities) == found


@pytest.mark.parametrize(
    ("values", "found"),
    [
        (np.ma.array([4.0, 500.0], mask=[False, True]), "None in it"),
        ([4.0, Quantity(0.25)], 'the text "0.25 inch" in it'),
        ([True, False], "true in it"),
        ([10**400], "a whole number of more than 64 bits in it"),
        (np.array(4.0), "a ndarray"),
    ],
)
def test_values_that_are_no_numbers(values: Any, found: str):
    with pytest.raises(InputError) as error:
        sweep(scenario(), {CERAMIC: values})
    must = "must be a sequence of finite numbers, or a range with min, max and step"
    assert str(error.value) == f"sweep: over {CERAMIC}: {must}, found {found}"


@pytest.mark.parametrize("output", [None, "t.csv"])
def test_a_probability_without_the_error_of_the_model(output: str | None, tmp_path: Path):
    case = scenario().replaced({"uncertainty.model.included": False})
    path = None if output is None else tmp_path / output
    told = sweep(case, {CERAMIC: [4.0, 6.0]}, ["ballistic_limit_m_s", "probability_of_stopping"], path).warnings
    assert "probability_of_stopping: has no value if uncertainty.model.included is false" in told


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ([], "must be a sequence of finite numbers, or a range with min, max and step, found none"),
        ("4:8:2", "4:8:2"),
        ([4.0, np.nan], "found nan in it"),
        ({"min": 8.0, "max": 4.0, "step": 1.0}, "max: must be at least min, which is 8, found 4"),
    ],
)
def test_wrong_values(values, found: str):
    with pytest.raises(InputError, match=CERAMIC) as error:
        sweep(scenario(), {CERAMIC: values})
    assert found in str(error.value)


def test_a_wrong_input_of_a_group_has_the_place_of_its_row(tmp_path: Path):
    lines = ("AD85,6", "B4C,6", "AD85,7", "B4C,-6")
    path = csv_file(tmp_path / "c.csv", f"armour.ceramic,{CERAMIC}", *lines)
    with pytest.raises(InputError, match=f"line 5: {CERAMIC}: must be at least 0, found -6"):
        sweep(scenario(), cases=path)


def test_wrong_questions(monkeypatch: pytest.MonkeyPatch):
    with pytest.raises(InputError, match="at least one key"):
        sweep(scenario(), {})
    with pytest.raises(InputError, match="at least one quantity"):
        sweep(scenario(), OVER, [])
    monkeypatch.setattr("armour.sweeps.sweep.MAX_ROWS", 5)
    with pytest.raises(InputError, match="output: must be given for more than 5 rows, found 6"):
        sweep(scenario(), OVER)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"over": None}, "sweep: over: must be given, or cases, but not both"),
        ({"quantities": ["outcome", "outcome"]}, "sweep: quantities: must not name anything twice"),
        ({"threads": 0}, "sweep: threads: must be at least 1, found 0"),
        ({"over": {"armour.ceramic": {"min": 1.0}}}, "over armour.ceramic: must be a sequence of names, found"),
    ],
)
def test_wrong_arguments(arguments: dict[str, Any], message: str):
    with pytest.raises(InputError, match=message):
        sweep(**{"scenario": scenario(), "over": {CERAMIC: [4.0]}, **arguments})


SPREAD = {"distribution": "normal", "standard_deviation": 20.0}
THREAT = [{"projectile": "7.62 mm APM2", "velocity_m_s": 700.0, "margin_m_s": 25.0}]


@pytest.mark.parametrize(
    "sections",
    [
        {},
        {"design": {"probability_of_stopping": 0.9, "areal_density_max_kg_m2": 40.0}},
        {"threat": THREAT, "design": {"thickness_max_mm": 14.0}},
        {"uncertainty": {"model": {"included": False}}},
        {
            "design": {"probability_of_stopping": 0.6},
            "uncertainty": {"samples": 128, "impact": {"velocity_m_s": SPREAD}},
        },
    ],
    ids=["nothing required", "probability and weight", "threat", "by the model", "sampled"],
)
def test_the_verdict_is_that_of_a_check_of_each_row(sections: dict[str, Any]):
    of, over = scenario(**sections), {CERAMIC: [5.0, 8.5], "armour.ceramic": ["AD85", "SiC"]}
    found = sweep(of, over, "verdict")
    rows = [{CERAMIC: mm, "armour.ceramic": name} for mm in (5.0, 8.5) for name in ("AD85", "SiC")]
    assert found["verdict"].tolist() == [check(of.replaced(row)).verdict for row in rows]
    assert not [warning for warning in found.warnings if warning.startswith(("threat", "verdict", "uncertainty"))]


def test_the_verdict_depends_on_what_a_check_reads():
    threats = scenario(threat=THREAT, ceramic_mm=8.0)
    found = sweep(threats, {"design.areal_density_max_kg_m2": [30.0, 50.0]}, "verdict")["verdict"].tolist()
    assert found == ["fails", "expected to stop"]
    with pytest.raises(InputError, match=r"impact\.velocity_m_s: must have an effect: verdict does not depend on it"):
        sweep(threats, {"impact.velocity_m_s": [700.0]}, "verdict")
    both = sweep(threats, {"impact.velocity_m_s": [500.0, 900.0]}, ["verdict", "outcome"])
    assert both["verdict"].tolist() == 2 * [check(threats).verdict]
    assert both["outcome"].tolist() == ["stopped", "perforated"]


def test_threats_that_a_sweep_does_not_use_are_told():
    threats = scenario(threat=[{"projectile": "7.62 mm APM2", "velocity_m_s": 700.0}])
    [told] = (warning for warning in sweep(threats, OVER).warnings if warning.startswith("threat: "))
    assert "the 7.62 mm AP at 800 m/s of [impact]; armour check gives the probability for every threat" in told
    assert not any("threat" in warning for warning in sweep(threats, OVER, "areal_density_kg_m2").warnings)
