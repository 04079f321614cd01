"""The public names."""

import ast
import doctest
import inspect
import json
import pkgutil
import re
import subprocess
import sys
import tomllib
import types
from collections.abc import Iterator
from dataclasses import is_dataclass
from pathlib import Path
from typing import get_args, get_type_hints

import pytest

import armour
from armour.analysis.results import Result
from tests.helpers.cases import SCENARIOS

STUB = Path(armour.__file__).with_suffix(".pyi")


def homes() -> dict[str, str]:
    """Module of every public name, as the stub has it."""
    imports = [node for node in ast.parse(STUB.read_text()).body if isinstance(node, ast.ImportFrom)]
    return {alias.name: f"armour.{node.module}" for node in imports for alias in node.names}


def test_the_public_names_are_those_of_the_stub():
    assert dir(armour) == sorted(homes())
    namespace: dict[str, object] = {}
    exec("from armour import *", namespace)
    # A name that leaves leaves a register of its warning.
    assert namespace.keys() - {"__builtins__", "__warningregistry__"} == homes().keys()


@pytest.mark.parametrize("name", sorted(homes()))
def test_every_public_name_is_defined_and_documented_in_its_module(name: str):
    thing = getattr(armour, name)
    assert not isinstance(thing, types.ModuleType)
    assert thing.__module__ == homes()[name]
    assert thing.__doc__


def test_versions():
    declared = [node for node in ast.parse(STUB.read_text()).body if isinstance(node, ast.AnnAssign)]
    names = [node.target.id for node in declared if isinstance(node.target, ast.Name)]
    assert names == ["__version__", "MODEL_VERSION"]
    assert all(isinstance(getattr(armour, name), str) for name in names)


def test_no_package_hides_a_public_name():
    assert not {module.name for module in pkgutil.iter_modules(armour.__path__)} & homes().keys()


def test_an_unknown_name():
    name = "fly"
    with pytest.raises(AttributeError, match=name):
        getattr(armour, name)


def test_the_package_is_marked_as_typed():
    assert STUB.with_name("py.typed").is_file()


FRESH = """
import sys, armour

def imported(*names):
    return [name for name in names if name in sys.modules]

found = [imported("numpy", "scipy", "pydantic"), dir(armour)]
scenario = armour.load_scenario("wilkins")
found.append(imported("numpy"))
armour.simulate(scenario)
armour.ballistic_limit(scenario)
found.append(imported("scipy.stats"))
import armour.sweeps.sweep, armour.reporting.report
from armour import report, sweep
print([*found, callable(sweep), callable(report)])
"""


def test_nothing_is_imported_before_it_is_needed_and_no_module_hides_a_function():
    done = subprocess.run([sys.executable, "-c", FRESH], capture_output=True, text=True, check=True)
    assert ast.literal_eval(done.stdout) == [[], dir(armour), [], [], True, True]


def test_a_notebook_shows_a_result_as_its_tables():
    found = armour.confidence(armour.load_scenario(SCENARIOS / "wilkins.toml"))
    assert "<table" in (found._repr_html_() or "")


@pytest.mark.parametrize("kind", [str, Path])
def test_a_path_is_a_text_or_a_path(kind: type, tmp_path: Path):
    scenario = armour.load_scenario(kind(SCENARIOS / "wilkins.toml"))
    armour.save_scenario(scenario, kind(tmp_path / "saved.toml"))
    assert armour.parse_scenario(tomllib.loads(scenario.to_toml()), folder=kind(tmp_path)).title == scenario.title
    (tmp_path / "library.toml").write_text("")
    armour.read_library(kind(tmp_path / "library.toml"), armour.shipped_library())
    assert armour.read_tests(kind(SCENARIOS / "tests" / "wilkins.csv"), scenario).names
    assert armour.read_shots(kind(SCENARIOS / "tests" / "shots.csv")).velocities_m_s
    assert armour.load_suite(kind(Path(__file__).parent / "validation" / "regression.toml")).cases
    assert (
        armour.sweep(
            scenario, None, "areal_density_kg_m2", kind(tmp_path / "out.csv"), cases=kind(_cases(tmp_path))
        ).rows
        == 1
    )


def _cases(folder: Path) -> Path:
    path = folder / "cases.csv"
    path.write_text("armour.backing_thickness_mm\n7\n")
    return path


def test_a_suite_is_validated_by_its_path_its_name_or_as_it_is_read():
    path = Path(__file__).parent / "validation" / "regression.toml"
    by_path = armour.validate(path)
    assert by_path.checks
    assert by_path == armour.validate(armour.load_suite(path))
    with pytest.raises(armour.InputError, match="none: cannot be read"):
        armour.validate("none")
    with pytest.raises(armour.InputError, match="validate: suite: must be a Suite or a path, found 5"):
        armour.validate(5)  # type: ignore[arg-type]


def test_every_result_has_warnings():
    public = [getattr(armour, name) for name in dir(armour)]
    results = [thing for thing in public if isinstance(thing, type)]
    found = {thing for thing in results if issubclass(thing, Result)}
    assert {armour.ImpactResult, armour.Comparison, armour.SuiteResult, armour.History} <= found
    for thing in found:
        assert isinstance(inspect.getattr_static(thing, "warnings"), property), thing
        assert get_type_hints(thing).get("notes", tuple[armour.Note, ...]) == tuple[armour.Note, ...], thing


def test_a_suite_and_a_library_are_shown_in_a_line():
    assert repr(armour.load_suite("paper")).endswith("cases of paper.toml>")
    assert re.fullmatch(r"<Library: \d+ projectiles, \d+ ceramics, \d+ metals>", repr(armour.shipped_library()))


def test_a_scenario_a_value_and_tests_are_shown_in_a_line():
    scenario = armour.load_scenario(SCENARIOS / "wilkins.toml")
    assert repr(scenario) == str(scenario)
    assert repr(scenario).startswith("<Scenario: 6.35 mm AD85 on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s; ")
    assert repr(scenario.replaced({"title": "Mine"})).endswith(" at 800 m/s; scenario: Mine>")
    assert repr(scenario.entry("metal", "6061-T6").values["density_kg_m3"]).startswith("<Value: 2750, nominal, ")
    tests = armour.read_tests("tests/wilkins", scenario)
    assert re.fullmatch(r"<Tests: \d+ tests of tests/wilkins \(shipped\), \d+ measurements>", repr(tests))


def test_a_scenario_as_plain_data_is_the_same_scenario():
    scenario = armour.load_scenario(SCENARIOS / "wilkins.toml").replaced({"ceramic.flow_stress_GPa": 4.5})
    data = json.loads(json.dumps(scenario.to_dict()))
    assert armour.parse_scenario(data).to_toml() == scenario.to_toml()
    data["impact"]["velocity_m_s"] = 1.0
    assert scenario.to_dict()["impact"]["velocity_m_s"] == 800.0


def classes() -> dict[str, type]:
    """Public dataclasses by name."""
    found = {name: getattr(armour, name) for name in dir(armour)}
    return {name: thing for name, thing in found.items() if isinstance(thing, type) and is_dataclass(thing)}


def parts_of(hint: object) -> Iterator[type]:
    """Dataclasses in a type."""
    if isinstance(hint, type) and is_dataclass(hint):
        yield hint
    for part in get_args(hint):
        yield from parts_of(part)


def words_of(cls: type) -> set[str]:
    """Words of the docstrings of a class and its bases."""
    return {word for base in cls.__mro__ for word in re.findall(r"\w+", base.__doc__ or "")}


@pytest.mark.parametrize("name", sorted(classes()))
def test_what_a_result_holds_is_public_or_described_with_it(name: str):
    cls, public = classes()[name], {item: getattr(armour, item) for item in dir(armour)}
    words = words_of(cls)
    assert {item for item in cls.__dataclass_fields__ if not item.startswith("_")} <= words  # type: ignore[attr-defined]
    # What several results hold is described with one of them, which the others name.
    for other in words & classes().keys():
        words |= words_of(classes()[other])
    for hint in get_type_hints(cls, localns=public).values():
        for kind in parts_of(hint):
            assert kind in public.values() or set(kind.__dataclass_fields__) <= words  # type: ignore[attr-defined]


def test_every_parameter_of_a_public_function_is_described():
    for name in dir(armour):
        thing = getattr(armour, name)
        if not isinstance(thing, type):
            described = re.findall(r"^\**([\w, ]+) : ", inspect.getdoc(thing) or "", re.MULTILINE)
            named = {word for words in described for word in words.split(", ")}
            named |= set(re.findall(r"^(\w+)$", inspect.getdoc(thing) or "", re.MULTILINE))
            assert inspect.signature(thing).parameters.keys() <= named, name


def test_the_examples_of_the_docstrings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    for thing in (armour, *(getattr(armour, name) for name in dir(armour))):
        for test in doctest.DocTestFinder().find(thing, thing.__name__, globs={}):
            assert doctest.DocTestRunner().run(test).failed == 0


QUESTIONS = [
    *("simulate", "ballistic_limit", "confidence", "compare", "sensitivity", "uncertainty", "optimise"),
    *("v50", "calibrate", "sweep", "save_scenario", "read_tests"),
]


@pytest.mark.parametrize("name", QUESTIONS)
@pytest.mark.parametrize("given", ["wilkins", None, {}, 5, Path("x")])
def test_a_wrong_argument_is_refused_by_name(name: str, given: object):
    second: dict[str, object] = {"calibrate": given, "sweep": {}, "save_scenario": "x"}
    more = [second[name]] if name in second else []
    arguments = ["tests/wilkins", given] if name == "read_tests" else [given, *more]
    with pytest.raises(armour.InputError, match=rf"{name}: \w+: must be a \w+, found "):
        getattr(armour, name)(*arguments)


@pytest.mark.parametrize("name", ["load_scenario", "load_suite", "parse_scenario"])
@pytest.mark.parametrize("given", [None, 5, [1]])
def test_a_wrong_path_or_mapping_is_refused(name: str, given: object):
    with pytest.raises(armour.InputError, match=rf"{name}: \w+: must be a (path|mapping), found "):
        getattr(armour, name)(given)
