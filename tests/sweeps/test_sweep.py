"""Sweeps give for every row what a scenario of these values gives, once, whatever happened in between."""

from pathlib import Path

import numpy as np
import pytest

from armour.analysis.quantities import QUANTITIES, Answers
from armour.errors import InputError, NoAnswerError
from armour.scenario.loading import Scenario
from armour.sweeps.checkpoint import read_table
from armour.sweeps.sweep import SWEPT, Axis, Cases, Grid, axis_of, changes_of, sweep, words_of
from tests.cases import scenario

GRID = {
    "ceramic_thickness_mm": {"min": 1.0, "max": 20.0, "step": 1.0},
    "backing_thickness_mm": {"min": 1.0, "max": 20.0, "step": 1.0},
}
KEYS = ("impact.velocity_m_s", "armour.ceramic_thickness_mm", "armour.backing_thickness_mm")


def case(**sections: object) -> Scenario:
    return scenario(optimise=GRID, ballistic_limit={"tolerance_m_s": 1e-4}, **sections)


def grid(*texts: str) -> Grid:
    return Grid(tuple(axis_of(text) for text in texts))


@pytest.mark.parametrize("name", ["a.csv", "a.parquet"])
def test_every_quantity_of_every_row_is_that_of_the_scenario(tmp_path: Path, name: str):
    source = grid("armour.ceramic_thickness_mm=2,6.35,9", "impact.velocity_m_s=500:900:200")
    assert sweep(case(), source, SWEPT, tmp_path / name, size=4) == 9
    table = read_table(tmp_path / name)
    assert list(table) == [*source.keys, *SWEPT]
    for row in range(9):
        values = {key: float(table[key][row]) for key in source.keys}
        answers = Answers(case().replaced(values))
        for quantity in SWEPT:
            try:
                expected = QUANTITIES[quantity].of(answers)
            except NoAnswerError:
                expected = float("nan")
            found = table[quantity][row]
            tolerance = 1e-3 if quantity == "ballistic_limit_m_s" else 1e-5
            if isinstance(expected, str):
                assert found == expected
            else:
                assert float(found) == pytest.approx(expected, rel=1e-9, abs=tolerance, nan_ok=True)


def test_keys_of_the_library_and_the_solver(tmp_path: Path):
    strength = 'library.metal."6061-T6".shear_strength_MPa'
    based = case(library={"metal": {"6061-T6": {"based_on": "6061-T6"}}})
    source = grid(f"{strength}=200,260.4", "solver.arrest_velocity_m_s=1,5")
    sweep(based, source, ["ballistic_limit_m_s"], tmp_path / "a.csv")
    table = read_table(tmp_path / "a.csv")
    for row in range(4):
        changes = changes_of({key: float(table[key][row]) for key in source.keys})
        limit = QUANTITIES["ballistic_limit_m_s"].of(Answers(based.replaced(changes)))
        assert float(table["ballistic_limit_m_s"][row]) == pytest.approx(limit, abs=1e-3)


def test_a_table_of_cases(tmp_path: Path):
    cases = tmp_path / "cases.csv"
    rng = np.random.default_rng(3)
    rows = rng.uniform((500.0, 3.0, 3.0), (1200.0, 12.0, 12.0), (57, 3))
    cases.write_text("\n".join([",".join(KEYS), *(",".join(map(repr, row)) for row in rows.tolist())]))
    source = Cases(cases)
    assert (source.keys, source.count) == (KEYS, 57)
    assert [len(chunk[KEYS[0]]) for chunk in source.chunks(10)] == [10, 10, 10, 10, 10, 7]
    sweep(case(), source, ["residual_velocity_m_s"], tmp_path / "a.csv", size=10)
    table = read_table(tmp_path / "a.csv")
    np.testing.assert_array_equal(np.column_stack([table[key] for key in KEYS]), rows)
    for row in (0, 23, 56):
        answers = Answers(case().replaced(dict(zip(KEYS, rows[row].tolist(), strict=True))))
        expected = QUANTITIES["residual_velocity_m_s"].of(answers)
        assert float(table["residual_velocity_m_s"][row]) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_an_interrupted_sweep_goes_on_where_it_stopped(tmp_path: Path):
    source = grid("armour.ceramic_thickness_mm=2:12:0.1", "impact.velocity_m_s=700:900:50")
    done: list[tuple[int, bool]] = []

    def stop(rows: int, before: bool) -> None:
        done.append((rows, before))
        if len(done) == 7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(case(), source, ["outcome"], tmp_path / "a.csv", size=40, on_chunk=stop)
    assert not (tmp_path / "a.csv").exists()
    after: list[bool] = []
    sweep(case(), source, ["outcome"], tmp_path / "a.csv", size=40, on_chunk=lambda _, before: after.append(before))
    assert after == [True] * 7 + [False] * 6
    sweep(case(), source, ["outcome"], tmp_path / "b.csv", size=40)
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_other_questions_do_not_go_on_with_its_chunks(tmp_path: Path):
    def interrupt(_rows: int, _before: bool) -> None:
        raise KeyboardInterrupt

    source = grid("impact.velocity_m_s=700,800")
    with pytest.raises(KeyboardInterrupt):
        sweep(case(), source, ["outcome"], tmp_path / "a.csv", size=1, on_chunk=interrupt)
    for other, quantities in ((case(velocity=801.0), ["outcome"]), (case(), ["duration_us"])):
        with pytest.raises(InputError, match="another sweep"):
            sweep(other, source, quantities, tmp_path / "a.csv", size=1)


def test_axes():
    assert axis_of("armour.ceramic_thickness_mm=4:5:0.5") == Axis("armour.ceramic_thickness_mm", (4.0, 4.5, 5.0))
    assert axis_of('library.metal."a=b".x = 1, 2.5') == Axis('library.metal."a=b".x', (1.0, 2.5))
    for text in ("a", "=1", "a=", "a=1:2", "a=2:1:1", "a=1:2:0", "a=x", "a=0:1:1e-9", "a=1:nan:1"):
        with pytest.raises(InputError, match="--over"):
            axis_of(text)


def test_a_grid_gives_every_combination_once():
    source = grid("a=1,2,3", "b=4:5:0.5")
    rows = [(a, b) for chunk in source.chunks(2) for a, b in zip(chunk["a"].tolist(), chunk["b"].tolist(), strict=True)]
    assert rows == [(a, b) for a in (1.0, 2.0, 3.0) for b in (4.0, 4.5, 5.0)]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("armour.ceramic_thickness_mm=-1,5", "armour.ceramic_thickness_mm: must be at least 0, found -1"),
        ("impact.velocity_m_s=800,nan", "impact.velocity_m_s: must be a finite number"),
        ("impact.speed=800", "impact.speed: unknown key"),
        ("a b=800", "sweep: a b: must be a key of the scenario"),
    ],
)
def test_values_that_are_not_allowed(tmp_path: Path, text: str, message: str):
    with pytest.raises(InputError, match=message):
        sweep(case(), grid(text), ["outcome"], tmp_path / "a.csv")


def test_everything_that_is_wrong_at_once(tmp_path: Path):
    with pytest.raises(InputError) as error:
        sweep(scenario(), grid("a=1", "a=2"), ["limit", SWEPT[-1]], tmp_path / "a.csv")
    assert [problem.key for problem in error.value.problems] == ["--quantities", "--over", "optimise"]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must be a table of numbers"),
        ("a,b\n", "at least one row"),
        ("a,b\n1,x\n", "must be a table of numbers.*'x'"),
        ("a,b\n1,\n", "must be a table of numbers"),
        ("a,b\n1,2,3\n", "must be a table of numbers"),
    ],
)
def test_tables_that_are_none(tmp_path: Path, text: str, message: str):
    (tmp_path / "cases.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        Cases(tmp_path / "cases.csv")


def test_a_table_that_is_not_there(tmp_path: Path):
    with pytest.raises(InputError, match="cannot be read"):
        Cases(tmp_path / "cases.csv")


def test_names_in_words():
    assert words_of("armour.ceramic_thickness_mm") == "ceramic thickness, mm"
    assert words_of("ballistic_limit_m_s") == "ballistic limit, m/s"
    assert words_of('library.metal."x".density_kg_m3') == "density, kg/m³"
    assert words_of("outcome") == "outcome"
