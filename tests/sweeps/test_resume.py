"""A sweep that is resumed with anything changed is refused, or gives what a fresh one gives, to the byte."""

import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from time import time
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from armour.core.equations import crack_velocity
from armour.engine.changes import equations
from armour.errors import InputError
from armour.scenario.library import IN_COMMON, TEST_RESULTS, VARIED, OwnTests
from armour.scenario.scenario import Scenario, load_scenario, parse_scenario
from armour.scenario.schema import DesignSection, ModelSection
from armour.scenario.sections import Section
from armour.sweeps.cases import Grid, SweepCases
from armour.sweeps.store import ABOUT, Chunk, Store, checksum_of
from armour.sweeps.sweep import chunk_of, job_of, sweep, types_of, write_sweep
from tests.helpers.cases import CERAMICS, METALS, THREATS, csv_file, data, sweep_grid

RANGE = {"min": 4.0, "max": 12.0, "step": 4.0}
QUANTITIES = ["ballistic_limit_m_s", "probability_of_stopping", "required_ceramic_thickness_mm"]
GRID = sweep_grid("armour.ceramic_thickness_mm=5,6,7")
EVIDENCE: dict[str, Any] = {
    "lot": "lot 7",
    "source": "1 own test in t.csv",
    "calibrated": {"ceramic_strength_GPa": 5.2},
    "tests": {key: [1.0] for key in (*VARIED, *IN_COMMON, *TEST_RESULTS)},
    "law": [{"fit": "constant", "values": {"flow_stress_GPa": 5.2}, "level": [0.0, 0.1], "computed_m_s": [700.0]}],
}
SCATTER = {"scatter_percent": 4.0, "scatter_source": "s"}
LIBRARY = {
    "files": ["lib.toml"],
    "projectile": {"P": {"based_on": "7.62 mm AP", "penetrator_mass_g": 5.5}},
    "ceramic": {
        "C": {
            "based_on": "AD85",
            "flow_stress_GPa": {"value": 5.2, "source": "s", "tests": [{"ballistic_limit_m_s": 700.0}]},
            "evidence": EVIDENCE,
            **SCATTER,
        }
    },
    "metal": {"M": {"based_on": "6061-T6", "static_yield_strength_MPa": 300.0, **SCATTER}},
}
NORMAL = {"distribution": "normal", "standard_deviation_percent": 2.0}
# Every section of a scenario at least once.
WHOLE = data(
    projectile="P",
    ceramic="C",
    backing="M",
    title="T",
    optimise={"ceramic_thickness_mm": RANGE, "backing_thickness_mm": RANGE},
    threat=THREATS,
    design={
        "ceramic": [CERAMICS[0], {"material": "SiC", "thickness_mm": {"min": 4.0, "max": 8.0}, "cost_per_kg": 1.0}],
        "backing": METALS,
        **SCATTER,
    },
    uncertainty={
        "impact": {"velocity_m_s": NORMAL},
        "armour": {"ceramic_thickness_mm": {**NORMAL, "mean": 6.3, "min": 5.0, "max": 8.0}},
        "projectile": {"flow_stress_GPa": {"distribution": "normal", "standard_deviation": 0.1}},
        "ceramic": {"flow_stress_GPa": NORMAL, "density_kg_m3": NORMAL},
        "backing": {"density_kg_m3": NORMAL},
        "correlation": [{"between": ["ceramic.flow_stress_GPa", "ceramic.density_kg_m3"], "coefficient": 0.3}],
        "model": {"scale_percent": 5.0, "degrees_of_freedom": 1e6, "source": "tests"},
    },
    solver={},
    ballistic_limit={},
    library=LIBRARY,
)
WHOLE["armour"]["layer"] = [
    {"name": "cover", "place": "front", "thickness_mm": 1.5, "areal_density_kg_m2": 2.0, "cost_per_m2": 1.0}
]
# Values one of which every key may have in place of its own.
OTHERS: list[Any] = [
    *(0.9, 1.1, 2.0, 30.0, 250.0, 700.0, 256, 5, 0.01, 0.2, False, True, "other", "projectile", "AD99.5", "C"),
    *("7075-T6", "7.62 mm APM2", "latin hypercube", "thickness_mm", "lognormal", "uniform", "fitted", [], ["a"], [7.5]),
    *([1.0, 2.0], ["areal_density_kg_m2", "margin_m_s"], ["impact.velocity_m_s", "ceramic.density_kg_m3"], NORMAL),
    *([{"test": "1"}], [{"material": "SiC", "thickness_mm": [8.0]}], [{"slope": 0.5, "components": [[1.0] * 4]}]),
    *("NIJ 0101.06 type IV, M2 AP", {"N": {"based_on": "AD85"}}, {"N": {"based_on": "5083-H3"}}, {}, EVIDENCE),
    {"N": {"based_on": "7.62 mm AP"}},
    *("interface", "between"),
]
# Keys that only go with others.
LAW = {"fit": "backing", "computed_m_s": [710.0]}
TABLES: dict[tuple[Any, ...], Any] = {
    ("design",): {**WHOLE["design"], "backing": [{"material": "M", "thickness_mm": [6.0]}], "existing": "backing"},
    ("uncertainty", "model"): {"included": False},
    ("library", "ceramic", "C", "evidence", "law"): [LAW],
    ("library", "ceramic", "C", "evidence", "tests"): {**EVIDENCE["tests"], "velocity_m_s": [710.0]},
}


def sections_in(value: object, parts: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Section]]:
    """Yield every section in a value, with its place."""
    if isinstance(value, Section):
        yield parts, value
        value = {name: getattr(value, name) for name in type(value).model_fields}
    inner = value.items() if isinstance(value, Mapping) else enumerate(value) if isinstance(value, list | tuple) else ()
    for name, each in inner:
        yield from sections_in(each, (*parts, name))


def classes_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield every class of sections that an annotation leads to."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
        for field in annotation.model_fields.values():
            yield from classes_in(field.annotation)
    for inner in getattr(annotation, "__args__", ()):
        yield from classes_in(inner)


def put(content: Any, parts: tuple[Any, ...], value: object) -> Any:
    """Return the content of a scenario with another value in a place; the rest is not copied."""
    name, *rest = parts
    if rest:
        inner = content.get(name) if isinstance(content, dict) else content[name]
        if isinstance(content, dict) and not isinstance(inner, dict | list):
            inner = {"value": inner} if name in content else {}
        value = put(inner, (*rest,), value)
    if isinstance(content, dict):
        return {**content, name: value}
    return [*content[:name], value, *content[name + 1 :]]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)  # from where a scenario that is made of sections reads library files
    (tmp_path / "lib.toml").write_text('[ceramic.F]\nbased_on = "AD85"\nflow_stress_GPa = 4.0\n')
    return tmp_path


def likeliest_first(value: object) -> list[Any]:
    """Return the other values, those of the type of a value first."""
    return sorted(OTHERS, key=lambda other: type(other) is not type(value))


def accepts(section: Section, key: str, value: object) -> bool:
    """Whether a section may have a value of a key: sooner known than of the whole scenario."""
    try:
        type(section).model_validate({**section.model_dump(exclude_unset=True), key: value})
    except ValidationError:
        return False
    return True


def changes_of_every_key(folder: Path) -> Iterator[tuple[str, Scenario]]:
    """Yield, for every key of every section, a scenario in which it has another value."""
    whole = parse_scenario(WHOLE, folder=folder)
    seen: set[tuple[str, str]] = set()
    for parts, section in sections_in(whole):
        for key in type(section).model_fields:
            if next(sections_in(getattr(section, key)), None):
                seen.add((name_of(type(section)), key))  # the keys in it are changed
                continue
            for other in likeliest_first(getattr(section, key)):
                if not accepts(section, key, other):
                    continue
                try:
                    made = parse_scenario(put(WHOLE, (*parts, key), other), folder=folder)
                except (InputError, TypeError):
                    continue
                if made.model_dump() != whole.model_dump():
                    yield f"{parts} {key}", made
                    seen.add((name_of(type(section)), key))
                    break
    for parts, other in TABLES.items():
        yield str(parts), parse_scenario(put(WHOLE, parts, other), folder=folder)
        seen |= {
            (name_of(ModelSection), "included"),
            (name_of(OwnTests), "tests"),
            (name_of(DesignSection), "existing"),
        }
    missing = {(name_of(each), key) for each in classes_in(Scenario) for key in each.model_fields} - seen
    assert not missing, missing


def name_of(section: type[BaseModel]) -> str:
    """Return the name of a class of sections, without its parameters."""
    return section.__name__.split("[")[0]


def interrupt(scenario: Scenario, source: Grid | SweepCases, output: Path) -> None:
    """Begin a sweep, and end it after its first chunk."""

    def stop(_rows: int, _stored: bool) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_sweep(scenario, source, QUANTITIES, output, size=1, threads=1, on_chunk=stop)


def table_of(scenario: Scenario, source: Grid | SweepCases, output: Path) -> bytes | str:
    """Return the table of a sweep, or why there is none."""
    try:
        write_sweep(scenario, source, QUANTITIES, output, size=1, threads=1)
    except InputError as error:
        return str(error).replace(str(output), "")
    return output.read_bytes()


REFUSED = "contains rows of another sweep, which differs in "


def check_resumed(scenario: Scenario, source: Grid | SweepCases, begun: Path, what: str) -> bool:
    """Check what the rest of a sweep gives that was begun with another question; return whether it is refused."""
    folder = begun.parent / "again"
    shutil.copytree(begun.with_name(begun.name + ".parts"), folder / "a.csv.parts")
    found = table_of(scenario, source, folder / "a.csv")
    refused = isinstance(found, str) and (REFUSED in found or "found too few warnings" in found)
    assert refused or found == table_of(scenario, source, folder / "fresh.csv"), what
    shutil.rmtree(folder)
    return refused


@pytest.mark.slow
def test_every_key_of_the_scenario(folder: Path, monkeypatch: pytest.MonkeyPatch):
    # A scenario that is made of its sections has its files in the working folder.
    monkeypatch.chdir(folder)
    two, begun = sweep_grid("armour.ceramic_thickness_mm=5,6"), folder / "a.csv"
    interrupt(parse_scenario(WHOLE, folder=folder), two, begun)
    refused = {what for what, made in changes_of_every_key(folder) if check_resumed(made, two, begun, what)}
    sections = (
        "('model',) shear_perimeter",
        "('solver',) arrest_velocity_m_s",
        "('uncertainty', 'model') mean_percent",
    )
    assert {*sections} < refused


def test_a_library_file_whose_ceramic_only_cases_name(folder: Path):
    cases = SweepCases(csv_file(folder / "c.csv", "armour.ceramic", "F", "AD85", "F"))
    content = data(library={"files": ["lib.toml"]}, optimise=WHOLE["optimise"])
    interrupt(parse_scenario(content, folder=folder), cases, folder / "a.csv")
    (folder / "lib.toml").write_text('[ceramic.F]\nbased_on = "AD85"\nflow_stress_GPa = 6.0\n')
    assert check_resumed(parse_scenario(content, folder=folder), cases, folder / "a.csv", "library file")


def test_cases_of_the_same_bytes(folder: Path):
    """Names of other widths and numbers of rows are other cases."""
    header, one, two = "armour.ceramic", Path("one.csv"), Path("two.csv")
    library = {"ceramic": {name: {"based_on": "AD85"} for name in ("a", "b", "ab")}}
    made = parse_scenario(data(library=library, optimise=WHOLE["optimise"]))
    begun = SweepCases(csv_file(folder / one, header, "a", "b"))
    interrupt(made, begun, folder / "a.csv")
    assert check_resumed(made, SweepCases(csv_file(folder / two, header, "ab")), folder / "a.csv", "cases")
    assert not check_resumed(made, SweepCases(folder / one), folder / "a.csv", "the same cases")


def test_a_scenario_of_the_same_heading_in_python(folder: Path):
    over: dict[str, object] = {"armour.ceramic_thickness_mm": [5.0, 6.0, 7.0]}
    wilkins, output = load_scenario("wilkins"), folder / "a.csv"
    interrupt(wilkins, GRID, output)
    for changes in ({"model.shear_perimeter": "projectile"}, {"ballistic_limit.tolerance_m_s": 50.0}):
        with pytest.raises(InputError, match=REFUSED):
            sweep(wilkins.replaced(changes), over, QUANTITIES, output)


def test_the_content_identifies_a_scenario_not_its_words(folder: Path):
    """A description and a source change no number: the rest of the sweep is that of the same scenario."""
    content = put(WHOLE, ("library", "ceramic", "C", "description"), "words")
    content = put(content, ("library", "ceramic", "C", "flow_stress_GPa", "source"), "another page")
    whole = parse_scenario(WHOLE, folder=folder)
    assert str(whole) == str(whole.replaced({"solver.arrest_velocity_m_s": 3.0}))
    assert whole.digest() != whole.replaced({"solver.arrest_velocity_m_s": 3.0}).digest()
    assert parse_scenario(content, folder=folder).digest() == whole.digest()


def interrupted_after_a_chunk(output: Path) -> None:
    def interrupt(_rows: int, _stored: bool) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_sweep(load_scenario("wilkins"), GRID, QUANTITIES[:1], output, size=1, on_chunk=interrupt)
    assert output.with_name(f"{output.name}.parts").exists()


LIMITS, KEY = QUANTITIES[0], "armour.ceramic_thickness_mm"
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
    with Store(output, job_of(wilkins, GRID, [LIMITS]), types_of(GRID, [LIMITS]), print) as store:
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
    with Store(output, job_of(scenario, GRID, NAMES), types_of(GRID, NAMES), print) as store:
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
    with Store(output, job_of(wilkins, source, NAMES), types_of(source, NAMES), print) as store:
        for rows in (range(4), range(4, 7)):
            store.append(chunk_of(wilkins, source.rows(np.array(rows)), NAMES, 1))
    hours_ago = time() - 3.0 * 3600.0
    os.utime(tmp_path / "t.csv.parts" / "rows", (hours_ago, hours_ago))

    def noted(scenario: Scenario, rows: Mapping[str, Any], **settings: Any) -> Chunk:
        computed.append(rows[KEY].tolist())
        return chunk_of(scenario, rows, **settings)

    monkeypatch.setattr("armour.sweeps.sweep.chunk_of", noted)
    write_sweep(wilkins, source, NAMES, output, size=5, tell=told.append)
    assert told[0] == f"resuming {output}.parts, written 3 hours ago: 7 of 10 rows"
    [(one, other), rest] = computed
    assert (one < 4.0, 4.0 <= other < 7.0, rest) == (True, True, [7.0, 8.0, 9.0])
    assert output.read_bytes() == whole.read_bytes()


def test_the_rows_computed_again_are_drawn_anew(tmp_path: Path):
    wilkins, drawn = load_scenario("wilkins"), set[int]()
    begun_by_a_stranger(tmp_path / "t.csv", wilkins, [chunk_of(wilkins, GRID.rows(np.arange(2)), NAMES, 1)])
    for _ in range(100):
        with Store(tmp_path / "t.csv", job_of(wilkins, GRID, NAMES), types_of(GRID, NAMES), print) as store:
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
        interrupted_after_a_chunk(output)
    with (
        nullcontext() if changed_first else changed,
        pytest.raises(InputError, match="rows of another sweep, which differs in program"),
    ):
        write_sweep(load_scenario("wilkins"), GRID, QUANTITIES[:1], output, size=1)
    assert not output.exists()
