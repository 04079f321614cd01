"""A sweep that is resumed with anything changed is refused, or gives what a fresh one gives, to the byte."""

import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from armour.core.equations import crack_velocity
from armour.engine.changes import equations
from armour.errors import InputError
from armour.scenario.scenario import Scenario, load_scenario, parse_scenario
from armour.sweeps.cases import Grid, SweepCases
from armour.sweeps.store import ABOUT, Chunk, Store, checksum_of
from armour.sweeps.sweep import chunk_of, job_of, types_of, write_sweep
from tests.helpers.cases import csv_file, data, sweep_grid

GRID = sweep_grid("armour.ceramic_thickness_mm=5,6,7")
REFUSED = "contains rows of another sweep, which differs in "


def interrupt(scenario: Scenario, source: Grid | SweepCases, output: Path) -> None:
    """Begin a sweep, and end it after its first chunk."""

    def stop(_rows: int, _stored: bool) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_sweep(scenario, source, [LIMITS], output, size=1, threads=1, on_chunk=stop)


@pytest.mark.parametrize(
    "changes",
    [
        {"model.shear_perimeter": "projectile"},
        {"solver.arrest_velocity_m_s": 3.0},
        {"ballistic_limit.tolerance_m_s": 50.0},
        {"uncertainty.model.included": False},
        {"design.existing": "backing"},
        {"ceramic.flow_stress_GPa": 5.0},
    ],
)
def test_another_scenario_is_refused(tmp_path: Path, changes: dict[str, object]):
    wilkins = load_scenario("wilkins")
    interrupt(wilkins, GRID, tmp_path / "a.csv")
    with pytest.raises(InputError, match=REFUSED + "scenario"):
        write_sweep(wilkins.replaced(changes), GRID, [LIMITS], tmp_path / "a.csv")


def test_words_are_no_other_scenario(tmp_path: Path):
    path = tmp_path / "a.csv"
    first, second = (
        parse_scenario(data(ceramic="C", library={"ceramic": {"C": {"based_on": "AD85", "description": words}}}))
        for words in ("words", "other words")
    )
    interrupt(first, GRID, path)
    write_sweep(second, GRID, [LIMITS], path)
    write_sweep(second, GRID, [LIMITS], tmp_path / "b.csv")
    assert path.read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_a_library_file_whose_ceramic_only_cases_name(tmp_path: Path):
    entry, library = '[ceramic.F]\nbased_on = "AD85"\nflow_stress_GPa = ', tmp_path / "lib.toml"
    cases = SweepCases(csv_file(tmp_path / "c.csv", "armour.ceramic", "F", "AD85", "F"))
    library.write_text(f"{entry}4.0")
    interrupt(parse_scenario(data(library={"files": [str(library)]})), cases, tmp_path / "a.csv")
    library.write_text(f"{entry}6.0")
    with pytest.raises(InputError, match=REFUSED + "scenario"):
        write_sweep(parse_scenario(data(library={"files": [str(library)]})), cases, [LIMITS], tmp_path / "a.csv")


def test_cases_of_the_same_bytes(tmp_path: Path):
    """Names of other widths and numbers of rows are other cases."""
    header, library = "armour.ceramic", {"ceramic": {name: {"based_on": "AD85"} for name in ("a", "b", "ab")}}
    made, begun = parse_scenario(data(library=library)), SweepCases(csv_file(tmp_path / "one.csv", header, "a", "b"))
    other = SweepCases(csv_file(tmp_path / "two.csv", header, "ab"))
    interrupt(made, begun, tmp_path / "a.csv")
    with pytest.raises(InputError, match=REFUSED + "rows"):
        write_sweep(made, other, [LIMITS], tmp_path / "a.csv")
    write_sweep(made, begun, [LIMITS], tmp_path / "a.csv")


LIMITS, KEY = "ballistic_limit_m_s", "armour.ceramic_thickness_mm"
ONE = {KEY: np.array([5.0]), LIMITS: np.array([500.0])}


@pytest.mark.parametrize(
    "chunk",
    [
        Chunk({**ONE, KEY: np.array([5.5])}, {}),
        Chunk({KEY: np.array([5.0, 6.0, 7.0, 8.0]), LIMITS: np.full(4, 500.0)}, {}),
        Chunk(ONE, {"far": 2}),
        Chunk(ONE, {"far\x1b[2J": 1}),
        b"{}",
        b"[1,{}]",
        b"[JOB,{}]",
        b"[JOB,{}]\n" + bytes(7),
        b'[JOB,{"far":0}]\n' + bytes(16),
        b"[" * 100_000,
    ],
)
def test_rows_that_the_sweep_cannot_have_are_refused(tmp_path: Path, chunk: Chunk | bytes):
    """Their checksums are right: anybody can compute them."""
    output, wilkins = tmp_path / "t.csv", load_scenario("wilkins")
    with Store(output, job_of(wilkins, GRID, [LIMITS]), types_of(GRID, [LIMITS])) as store:
        store.append(Chunk(ONE, {}))
        if isinstance(chunk, Chunk):
            rows = np.rec.fromarrays([*chunk.columns.values()], dtype=store.type).tobytes()
            chunk = ABOUT.dump_json((store.job, {**chunk.warnings})) + b"\n" + rows
        content = chunk.replace(b"JOB", json.dumps(store.job).encode())
        store._database.execute("update chunk set content = ?, checksum = ?", [content, checksum_of(0, content)])
    with pytest.raises(InputError, match=r"t\.csv\.parts: must have rows of this sweep, found rows that"):
        write_sweep(wilkins, GRID, [LIMITS], output, size=1)
    assert not output.exists()


def begun_by_a_stranger(output: Path, scenario: Scenario, chunks: Sequence[Chunk]) -> None:
    """Leave an unfinished sweep over GRID with the chunks, and with checksums that are right."""
    with Store(output, job_of(scenario, GRID, NAMES), types_of(GRID, NAMES)) as store:
        for chunk in chunks:
            store.append(chunk)


NAMES = ["outcome", "ballistic_limit_m_s", "required_ceramic_thickness_mm"]


@pytest.mark.parametrize("name", ["t.csv", "t.parquet"])
@pytest.mark.parametrize(
    ("column", "forged", "words"),
    [
        (
            "ballistic_limit_m_s",
            lambda values: values + 150.0,
            r"ballistic_limit_m_s = \d+\.\d+ in row 2, but computed",
        ),
        ("ballistic_limit_m_s", lambda values: np.nextafter(values, np.inf), r"ballistic_limit_m_s = "),
        ("outcome", lambda values: np.full_like(values, "\x1b[2J"), "rows that this sweep cannot have"),
        ("outcome", lambda values: np.full_like(values, "stopped"), "outcome = stopped in row 2, but computed perf"),
        ("required_ceramic_thickness_mm", lambda values: values * np.nan, "required_ceramic_thickness_mm = nan in row"),
    ],
)
def test_forged_rows_are_refused(
    tmp_path: Path, name: str, column: str, forged: Callable[[NDArray[Any]], NDArray[Any]], words: str
):
    output, wilkins = tmp_path / name, load_scenario("wilkins")
    first, second = (chunk_of(wilkins, GRID.rows(np.array([row])), NAMES, 1) for row in (0, 1))
    second = second._replace(columns={**second.columns, column: forged(second.columns[column])})
    begun_by_a_stranger(output, wilkins, [first, second])
    message = rf"{name}\.parts: must have rows of this sweep, found {words}.*remove the folder to start again"
    for _ in range(2):  # the folder is kept: it may be finished elsewhere
        with pytest.raises(InputError, match=message):
            write_sweep(wilkins, GRID, NAMES, output)
    assert not output.exists()


def test_warnings_that_were_removed_are_missed(tmp_path: Path):
    fragment = load_scenario("wilkins").replaced({"impact.projectile": "20 mm FSP"})
    chunk = chunk_of(fragment, GRID.rows(np.array([0, 1])), NAMES, 1)
    assert chunk.warnings
    begun_by_a_stranger(tmp_path / "t.csv", fragment, [chunk._replace(warnings={})])
    with pytest.raises(InputError, match=r"t\.csv\.parts: must have rows of this sweep, found too few warnings"):
        write_sweep(fragment, GRID, NAMES, tmp_path / "t.csv")


def test_a_row_of_each_stored_chunk_is_computed_again_and_then_the_rest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    wilkins, source = load_scenario("wilkins"), sweep_grid("armour.ceramic_thickness_mm=0:9:1")
    output, whole, told, computed = tmp_path / "t.csv", tmp_path / "whole.csv", list[str](), list[list[float]]()
    write_sweep(wilkins, source, NAMES, whole)
    with Store(output, job_of(wilkins, source, NAMES), types_of(source, NAMES)) as store:
        for rows in (range(4), range(4, 7)):
            store.append(chunk_of(wilkins, source.rows(np.array(rows)), NAMES, 1))

    def noted(scenario: Scenario, rows: Mapping[str, Any], **settings: Any) -> Chunk:
        computed.append(rows[KEY].tolist())
        return chunk_of(scenario, rows, **settings)

    monkeypatch.setattr("armour.sweeps.sweep.chunk_of", noted)
    write_sweep(wilkins, source, NAMES, output, size=5, tell=told.append)
    assert told[0] == f"resuming {output}.parts: 7 of 10 rows"
    [(one, other), rest] = computed
    assert (one < 4.0, 4.0 <= other < 7.0, rest) == (True, True, [7.0, 8.0, 9.0])
    assert output.read_bytes() == whole.read_bytes()


def test_the_rows_computed_again_are_drawn_anew(tmp_path: Path):
    wilkins, drawn = load_scenario("wilkins"), set[int]()
    begun_by_a_stranger(tmp_path / "t.csv", wilkins, [chunk_of(wilkins, GRID.rows(np.arange(2)), NAMES, 1)])
    for _ in range(100):
        with Store(tmp_path / "t.csv", job_of(wilkins, GRID, NAMES), types_of(GRID, NAMES)) as store:
            drawn |= {*store.drawn}
    assert drawn == {0, 1}


def test_no_chunk_is_larger_than_a_sweep_makes_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """In a larger one, a single row would be computed again of many that are forged."""
    wilkins = load_scenario("wilkins")
    begun_by_a_stranger(tmp_path / "t.csv", wilkins, [chunk_of(wilkins, GRID.rows(np.arange(2)), NAMES, 1)])
    monkeypatch.setattr("armour.sweeps.sweep.MAX_CHUNK", 1)
    with pytest.raises(InputError, match="found rows that this sweep cannot have"):
        write_sweep(wilkins, GRID, NAMES, tmp_path / "t.csv")


@pytest.mark.parametrize("changed_first", [True, False])
def test_rows_with_and_without_a_changed_equation_are_not_mixed(tmp_path: Path, changed_first: bool):
    output = tmp_path / "t.csv"
    changed = equations(crack_velocity=lambda Ec, rho_c: 0.5 * crack_velocity(Ec, rho_c))
    with changed if changed_first else nullcontext():
        interrupt(load_scenario("wilkins"), GRID, output)
    with (
        nullcontext() if changed_first else changed,
        pytest.raises(InputError, match="rows of another sweep, which differs in program"),
    ):
        write_sweep(load_scenario("wilkins"), GRID, [LIMITS], output, size=1)
    assert not output.exists()
