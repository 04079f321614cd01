"""A sweep gives for every row, once, what the scenario with its values gives, interrupted or not."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.evaluate import evaluate
from armour.analysis.impact import simulate
from armour.analysis.quantities import QUANTITIES
from armour.design.check import evaluated
from armour.errors import InputError
from armour.scenario.scenario import Scenario
from armour.sweeps import sweep as sweeps
from armour.sweeps.cases import SweepCases
from armour.sweeps.sweep import sweep as sweep_in_python
from armour.sweeps.sweep import write_sweep
from armour.sweeps.tables import read_table
from tests.helpers.cases import csv_file, sweep_grid, sweep_scenario
from tests.helpers.exotic import narrow_ranges

pytestmark = pytest.mark.slow

KEYS = ("impact.velocity_m_s", "armour.ceramic_thickness_mm", "armour.backing_thickness_mm")


@pytest.mark.parametrize("name", ["a.csv", "a.parquet"])
def test_every_quantity_of_every_row_is_that_of_the_scenario(tmp_path: Path, name: str):
    source = sweep_grid("armour.ceramic_thickness_mm=2,6.35,9", "impact.velocity_m_s=500,900")
    assert write_sweep(sweep_scenario(), source, list(QUANTITIES), tmp_path / name, size=4) == 6
    table = read_table(tmp_path / name)
    assert list(table) == [*source.keys, *QUANTITIES]
    for row in range(6):
        case = sweep_scenario().replaced({key: float(table[key][row]) for key in source.keys})
        for quantity, [expected] in evaluate(case, {}, list(QUANTITIES)).items():
            np.testing.assert_array_equal(table[quantity][row], expected)
        result = simulate(case)
        assert table["outcome"][row] == result.outcome
        assert table["residual_velocity_m_s"][row] == pytest.approx(result.residual_velocity_m_s, rel=1e-12)
        assert table["ballistic_limit_m_s"][row] == pytest.approx(ballistic_limit(case).ballistic_limit_m_s, rel=1e-12)


def test_a_question_without_an_answer_leaves_its_field_empty(tmp_path: Path):
    source = sweep_grid("impact.velocity_m_s=800,9000")
    quantities = ["required_ceramic_thickness_mm", "required_backing_thickness_mm", "required_total_thickness_mm"]
    write_sweep(sweep_scenario(), source, quantities, tmp_path / "a.csv", size=1)
    lines = (tmp_path / "a.csv").read_text().splitlines()
    assert lines[2] == "9000.0,,,"
    assert all(lines[1].split(","))
    write_sweep(sweep_scenario(), source, quantities, tmp_path / "a.parquet", size=1)
    assert np.isnan(read_table(tmp_path / "a.parquet")[quantities[0]][1])


def test_a_sweep_is_resumed_as_often_as_it_is_interrupted(tmp_path: Path):
    grid = sweep_grid("armour.ceramic_thickness_mm=2:12:0.1", "impact.velocity_m_s=700:900:50")
    lines = (f"{c},{v}" for c, v in np.column_stack(list(grid.rows(np.arange(grid.count)).values())).tolist())
    cases = SweepCases(csv_file(tmp_path / "c.csv", ",".join(grid.keys), *lines))
    case, whole = sweep_scenario().replaced({"impact.projectile": "20 mm FSP"}), list[str]()
    write_sweep(case, grid, ["outcome"], tmp_path / "whole.csv", tell=whole.append)
    assert whole
    left = 0

    def stop(_rows: int, stored: bool) -> None:
        nonlocal left
        left -= not stored
        if not left:
            raise KeyboardInterrupt

    for source in (grid, cases):
        for size, new in ((40, 4), (7, 3), (100, 2)):
            left = new
            with pytest.raises(KeyboardInterrupt, match="of 505 rows are done"):
                write_sweep(case, source, ["outcome"], tmp_path / "a.csv", size=size, on_chunk=stop)
            assert not (tmp_path / "a.csv").exists()
        told: list[str] = []
        write_sweep(case, source, ["outcome"], tmp_path / "a.csv", tell=told.append)
        assert told == [f"resuming {tmp_path / 'a.csv'}.parts: 381 of 505 rows", *whole]
        assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
        (tmp_path / "a.csv").unlink()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("armour.ceramic_thickness_mm=-1,5", "armour.ceramic_thickness_mm: must be at least 0, found -1"),
        ("impact.speed=800", "impact.speed: unknown key"),
        ("solver.arrest_velocity_m_s=1,9999", "arrest_velocity_m_s: must be below the impact velocity, "),
        ("impact.velocity_m_s=1000,10", "must be below the impact velocity, 10 m/s, found 20"),
        ("solver.arrest_velocity_m_s=1,2,-1", "solver.arrest_velocity_m_s: must be greater than 0, found -1"),
    ],
)
def test_values_that_are_not_allowed_leave_nothing(tmp_path: Path, text: str, message: str):
    scenario = sweep_scenario().replaced({"solver.arrest_velocity_m_s": 20.0})
    with pytest.raises(InputError, match=message):
        write_sweep(scenario, sweep_grid(text), ["outcome"], tmp_path / "a.csv", size=1)
    assert list(tmp_path.iterdir()) == []


AGAIN = (
    "ballistic_limit_m_s: the outcome changes more than once with the impact velocity, and the lowest change is taken"
)
THICKER = "required_ceramic_thickness_mm: a thicker ceramic is perforated at a velocity that a thinner one stops"


def test_rows_whose_outcome_changes_again_are_told_even_when_resumed(tmp_path: Path):
    source, quantities = sweep_grid("impact.velocity_m_s=359.086,20"), ["required_ceramic_thickness_mm"]
    told: list[str] = []

    def stop(_rows: int, _stored: bool) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_sweep(narrow_ranges(), source, quantities, tmp_path / "a.csv", size=1, on_chunk=stop)
    write_sweep(narrow_ranges(), source, quantities, tmp_path / "a.csv", size=1, tell=told.append)
    assert f"warning: {THICKER}; this concerns 1 of 2 rows" in told
    assert read_table(tmp_path / "a.csv")["required_ceramic_thickness_mm"][0] == pytest.approx(9.546, abs=1e-3)
    found = sweep_in_python(narrow_ranges(), {"armour.ceramic_thickness_mm": [10.75, 40.0]})
    assert f"{AGAIN}; this concerns 1 of 2 rows" in found.warnings


@pytest.mark.parametrize("rows", [2, 16])
def test_reading_data_does_not_make_a_sweep_seem_long(monkeypatch: pytest.MonkeyPatch, rows: int):
    source = sweep_grid(f"armour.ceramic_thickness_mm=4:{3 + rows}:1")
    clock, loads = [0.0], [100.0]

    def timed(of: Scenario, rows: dict[str, Any], *others: Any) -> Any:
        """Let the first rows take long."""
        count = len(rows["armour.ceramic_thickness_mm"])
        clock[0] += count + (loads.pop() if count > 1 and loads else 0.0)
        return evaluated(of, rows, *others)

    monkeypatch.setattr(sweeps, "perf_counter", lambda: clock[0])
    monkeypatch.setattr(sweeps, "evaluated", timed)
    effort = sweeps.effort_of(sweep_scenario(), source, ["outcome"])
    assert (effort.row_s, effort.seconds) == (1.0, rows)
