import copy
import pickle
import re
import sys
from collections.abc import Callable
from copy import deepcopy
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from armour.core.equations import CONOID
from armour.errors import InputError
from armour.scenario.scenario import Scenario, load_scenario, parse_scenario, save_scenario
from armour.scenario.schema import Range, Solver
from tests.helpers.cases import COMPLETE, SCENARIOS, TEMPLATES, THREATS, data, scenario, shipped_scenario
from tests.helpers.foreign import NotAvailable, Quantity
from tests.helpers.known import known


def messages(content: dict[str, Any]) -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_scenario(content)
    return [f"{problem.key}: {problem.message}" for problem in caught.value.problems]


THICKNESS = "armour.ceramic_thickness_mm"


@pytest.mark.parametrize("value", [np.float32(4.5), np.array(4.5), np.float64(4.5)])
def test_numbers_of_numpy_are_those_of_python(value: Any):
    same = shipped_scenario("wilkins").replaced({THICKNESS: 4.5})
    content = same.to_dict()
    content["armour"] = {**content["armour"], "ceramic_thickness_mm": value}
    for case in (
        same.replaced({THICKNESS: value}),
        load_scenario("wilkins", {THICKNESS: value}),
        parse_scenario(content),
    ):
        assert case == same
        assert case.to_toml() == same.to_toml()
    threats = [{"projectile": "7.62 mm AP", "velocity_m_s": np.int64(800)}]
    assert same.replaced({"threat": threats}).threats()[0].velocity_m_s == 800.0
    library = "library.ceramic.AD85.density_kg_m3"
    assert same.replaced({library: np.int64(3500)}) == same.replaced({library: 3500})


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (np.ma.masked, "must be a finite number, found nan"),
        (NotAvailable(), "must be a finite number, found nan"),
        (Quantity(0.25), 'must be a number, found the text "0.25 inch"'),
        (np.timedelta64(4, "s"), 'must be a number, found the text "4 seconds"'),
        (np.array([4.5]), "must be a number, found a list"),
    ],
)
def test_what_is_no_number_of_a_scenario(value: Any, message: str):
    case = shipped_scenario("wilkins")
    for key in (THICKNESS, "ceramic.flow_stress_GPa"):
        with pytest.raises(InputError, match=f"replaced: {key}: {message}"):
            case.replaced({key: value})
        with pytest.raises(InputError, match=f"{key}: {message}"):
            load_scenario("wilkins", {key: value})
    content = case.to_dict()
    content["armour"] = {**content["armour"], "ceramic_thickness_mm": value}
    with pytest.raises(InputError, match=f"scenario: {THICKNESS}: {message}"):
        parse_scenario(content)


@pytest.mark.parametrize("path", COMPLETE, ids=lambda path: path.stem)
def test_every_shipped_scenario_is_valid(path: Path):
    assert load_scenario(path).title


@pytest.mark.parametrize("path", TEMPLATES, ids=lambda path: path.stem)
def test_a_template_lacks_what_it_asks_for_and_works_with_it(path: Path, tmp_path: Path):
    with pytest.raises(InputError) as caught:
        load_scenario(path)
    missing = {problem.key.rpartition(".")[2] for problem in caught.value.problems}
    assert all("is missing and must be given" in problem.message for problem in caught.value.problems)
    text = path.read_text()
    assert {line.split()[1] for line in text.splitlines() if re.match("# \\w+ = +#", line)} == missing
    values = {"velocity_m_s": 900.0, "penetrator_mass_g": 6.0, "penetrator_diameter_mm": 6.0, "density_kg_m3": 14850.0}
    for key in missing:
        text = re.sub(f"# {key} =", f"{key} = {values[key]}", text)
    (tmp_path / "complete.toml").write_text(text)
    assert load_scenario(tmp_path / "complete.toml").title


def test_the_wilkins_case_in_the_cores_terms():
    a = scenario().core_armour()
    assert pytest.approx(6.5e-3) == a.D0
    assert pytest.approx(5.46e-3 / (7850 * pi / 4 * 6.5e-3**2)) == a.L0
    assert (a.rho_p, a.Yp) == (7850, 2.35e9)
    assert (a.Hc0, a.Hb) == (6.35e-3, 6.35e-3)
    assert (a.rho_c, a.Ec, a.Yc0) == (3430, 267e9, 5.2e9)
    assert (a.rho_B, a.YB) == (2750, 1.05e9)
    assert a.tau == pytest.approx(0.7 * 372e6)
    assert a.shear_law == CONOID


@pytest.mark.parametrize("ceramic", [None, "AD85"])
def test_a_bare_plate_with_or_without_a_ceramic_named(ceramic: str | None):
    bare = scenario(ceramic=ceramic, ceramic_mm=0.0)
    assert bare.core_armour().Hc0 == 0.0
    assert bare.areal_density_kg_m2() == pytest.approx(17.4625)


def test_a_thickness_of_no_ceramic():
    assert messages(data(ceramic=None)) == [
        "armour.ceramic_thickness_mm: must be 0 if no ceramic is named, found 6.35; name one as armour.ceramic"
    ]


def test_a_single_value_of_an_entry_that_is_not_known_makes_no_entry():
    with pytest.raises(InputError, match=r"library\.ceramic\.Nothing\.density_kg_m3: is missing and must be given"):
        scenario().replaced({"library.ceramic.Nothing.flow_stress_GPa": 5.0})


def test_missing_sections_are_all_named():
    assert messages({}) == [
        "impact: is missing and must be given, even if there is a [[threat]]",
        "armour: is missing and must be given",
    ]
    assert messages({**data(), "armour": {"backing": "6061-T6", "backing_thickness_mm": 6.0}}) == [
        "armour.ceramic_thickness_mm: is missing and must be given; 0 for a bare plate"
    ]


def test_library_files_are_found_beside_the_scenario(tmp_path: Path):
    (tmp_path / "mine.toml").write_text("[ceramic.mine]\nbased_on = 'AD85'\nflow_stress_GPa = 4.0\n")
    case = parse_scenario(data(ceramic="mine", library={"files": ["mine.toml"]}), folder=tmp_path)
    assert case.core_armour().Yc0 == 4e9


def test_library_files_in_a_tuple_are_read(tmp_path: Path):
    (tmp_path / "lib.toml").write_text('[ceramic.F]\nbased_on = "AD85"\n')
    content = data(library={"files": ("lib.toml",)}, armour={**data()["armour"], "ceramic": "F"})
    assert parse_scenario(content, folder=tmp_path).library.files == ("lib.toml",)


def test_the_last_library_file_with_a_name_counts_and_says_so(tmp_path: Path):
    (tmp_path / "a.toml").write_text("[ceramic.mine]\nbased_on = 'AD85'\nflow_stress_GPa = 4.0\n")
    (tmp_path / "b.toml").write_text("[ceramic.mine]\nbased_on = 'AD85'\nflow_stress_GPa = 6.0\n")
    case = parse_scenario(data(ceramic="mine", library={"files": ["a.toml", "b.toml"]}), folder=tmp_path)
    assert case.inputs()["ceramic.flow_stress_GPa"] == 6.0
    assert case.notes == (f"{tmp_path / 'b.toml'}: ceramic.mine: replaces the mine of {tmp_path / 'a.toml'}",)


def test_a_missing_library_file_is_the_only_mistake_of_what_may_be_in_it():
    own = {"files": ["nothing.toml"], "ceramic": {"a": {"based_on": "b"}}}
    [line] = messages(data(projectile="x", ceramic="a", backing="z", library=own))
    assert line.startswith('library.files[0]: must name a library file, found "nothing.toml", which cannot be read')


@pytest.mark.parametrize("text", ["user:x:0:secret\n", "[projectile]\nTOKEN=secret\n"])
def test_a_file_that_is_no_library_is_not_quoted(tmp_path: Path, text: str):
    """A scenario of a stranger may name any file of the user."""
    (tmp_path / "keys").write_text(text)
    [line] = messages({**data(), "library": {"files": [str(tmp_path / "keys")]}})
    assert "must name a library file" in line
    assert "must be valid TOML" in line
    assert "secret" not in line


def test_mistakes_in_a_library_file_name_that_file(tmp_path: Path):
    (tmp_path / "mine.toml").write_text("[ceramic.mine]\nbased_on = 'AD85x'\n")
    with pytest.raises(InputError) as caught:
        parse_scenario(data(library={"files": ["mine.toml"]}), folder=tmp_path)
    [problem] = caught.value.problems
    assert problem.file == str(tmp_path / "mine.toml")
    assert problem.key == "ceramic.mine.based_on"


STRESS = "ceramic.flow_stress_GPa"


@pytest.mark.parametrize(
    "changes",
    [
        {STRESS: 7, "armour.ceramic": "AD99.5"},
        {"ceramic": {"flow_stress_GPa": 7.0}, "armour": {"ceramic": "AD99.5"}},
        {'library.ceramic."AD99.5".flow_stress_GPa': 7.0, "armour.ceramic": "AD99.5"},
    ],
)
def test_an_input_is_replaced_by_role_or_by_name(changes: dict[str, object]):
    found, named = scenario().replaced(changes).core_armour(), scenario(ceramic="AD99.5").core_armour()
    assert found == named._replace(Yc0=7e9)
    wilkins = load_scenario(SCENARIOS / "wilkins.toml", changes)
    assert wilkins.core_armour().Yc0 == 7e9


def test_an_input_changes_an_entry_of_the_scenario():
    own = scenario(ceramic="mine", library={"ceramic": {"mine": {"based_on": "AD85", "density_kg_m3": 3000.0}}})
    for key in (STRESS, "library.ceramic.mine.flow_stress_GPa"):
        assert own.replaced({key: 7.0}).core_armour() == own.core_armour()._replace(Yc0=7e9)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({STRESS: -7.0}, f"{STRESS}: must be at least 0.001, found -7"),
        ({STRESS: "hard"}, f'{STRESS}: must be a number, found the text "hard"'),
        ({"projectile.penetrator_diameter_mm": 90.0}, "penetrator_mass_g: must make a rod"),
        ({"cermic.flow_stress_GPa": 7.0}, f'must name an input of the scenario, .*; did you mean "{STRESS}"'),
        ({"ceramic": "SiC"}, 'found "ceramic"; did you mean "armour.ceramic"'),
        ({"threat.margin_m_s": 20.0}, "threat: must be a list, found a table; write its heading in double brackets"),
        ({"ceramic.flow_stress_ceramic_slope": 0.1}, "must name an input of the scenario"),
        ({"backing.dynamic_yield_strength_MPa": 400.0, "armour.backing": "x"}, 'must name a metal .*, found "x"'),
    ],
)
def test_an_input_that_is_refused(changes: dict[str, object], message: str):
    with pytest.raises(InputError, match=f"replaced: .*{message}"):
        scenario().replaced(changes)


def test_scenarios_are_equal_by_content(tmp_path: Path):
    case = shipped_scenario("uncertain")
    save_scenario(case, tmp_path / "saved.toml")
    same = [parse_scenario(case.to_dict()), load_scenario(tmp_path / "saved.toml"), case.replaced({})]
    assert {case, *same} == {case}
    assert case not in {case.replaced({"impact.velocity_m_s": 801.0}), None}
    error = {"uncertainty.model.included": False}
    assert case.replaced(error).replaced({"uncertainty.model.included": True}).excludes_error() is False


@pytest.mark.parametrize(
    "copied",
    [
        copy.copy,
        deepcopy,
        lambda case: pickle.loads(pickle.dumps(case)),
        Scenario.model_copy,
        lambda case: case.model_copy(deep=True),
        Scenario.copy,
    ],
)
def test_a_copied_scenario_is_the_same(copied: Callable[[Scenario], Scenario]):
    case = scenario(library={"ceramic": {"X": {"based_on": "AD85", "density_kg_m3": 3000.0}}}, ceramic="X")
    again = copied(case)
    assert (again, repr(again), again.core_armour()) == (case, repr(case), case.core_armour())
    assert again.replaced({"armour.ceramic_thickness_mm": 9.0}).armour.ceramic_thickness_mm == 9.0


def test_a_range_has_its_ends_and_the_digits_of_the_file():
    values = Range(min=2.0, max=20.0, step=0.1).values()
    assert len(values) == 181
    assert values[0] == 2.0
    assert values[83] == 10.3
    assert values[-1] == 20.0
    assert Range(min=1.0, max=1.0, step=5.0).values() == (1.0,)
    assert Range(min=1.0, max=2.0, step=0.4).values() == (1.0, 1.4, 1.8)


@pytest.mark.parametrize("make", [Scenario, Scenario.model_construct, Scenario.model_validate])
def test_a_scenario_is_not_made_of_sections(make: Callable[..., Scenario]):
    plain = scenario()
    sections = {"impact": plain.impact, "armour": plain.armour}
    with pytest.raises(InputError, match="Scenario: must be made by load_scenario or parse_scenario"):
        make(sections) if make == Scenario.model_validate else make(**sections)


def replacing(case: Scenario, update: dict[str, Any]) -> Scenario:
    """What Python 3.13 calls `copy.replace`."""
    return copy.replace(case, **update)  # type: ignore[attr-defined,no-any-return,unused-ignore]


# Every way to copy a scenario with other sections.
CHANGES = [
    lambda case, update: case.model_copy(update=update),
    lambda case, update: case.model_copy(update=update, deep=True),
    lambda case, update: case.copy(update=update),
    lambda case, update: case.replaced(update),
    pytest.param(replacing, marks=pytest.mark.skipif(sys.version_info < (3, 13), reason="no copy.replace")),
]


@pytest.mark.parametrize("is_used", [True, False])
@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_copy_is_validated_and_keeps_no_number(
    change: Callable[[Scenario, dict[str, Any]], Scenario], is_used: bool
):
    case = scenario(threat=THREATS, solver={"time_step_us": 0.1})
    if is_used:
        case.core_armour()
    armour = case.armour.model_copy(update={"ceramic_thickness_mm": 20.0})
    threats = (case.threat[1].model_copy(update={"velocity_m_s": 700.0}),)
    changed = change(case, {"armour": armour, "threat": threats, "solver": Solver()})
    meant = scenario(ceramic_mm=20.0, threat=[{**THREATS[1], "velocity_m_s": 700.0}])
    assert changed == meant
    assert changed.core_armour() == meant.core_armour() != case.core_armour()
    assert changed.inputs() == meant.inputs()
    assert parse_scenario(changed.to_dict()) == meant
    assert changed.replaced({"title": "x"}).core_armour() == meant.core_armour()
    wrong = {"armour": armour.model_copy(update={"ceramic_thickness_mm": -5.0}), "armor": armour}
    with pytest.raises(InputError) as error:
        change(case, wrong)
    assert [str(problem) for problem in error.value.problems] == [
        "replaced: armour.ceramic_thickness_mm: must be at least 0, found -5.0",
        'replaced: armor: unknown key; did you mean "armour"?',
    ]


def test_a_copy_has_other_sections_whole():
    case = scenario(ballistic_limit={"velocity_min_m_s": 100.0, "tolerance_m_s": 0.5})
    changed = case.model_copy(update={"ballistic_limit": {"tolerance_m_s": 0.1}})
    assert changed == scenario(ballistic_limit={"tolerance_m_s": 0.1})


def test_sections_in_data_are_validated():
    case = scenario()
    thin = {"impact": case.impact, "armour": case.armour.model_copy(update={"ceramic_thickness_mm": -5.0})}
    for make in (parse_scenario, lambda changes: load_scenario("wilkins", changes)):
        with pytest.raises(InputError, match=r"armour\.ceramic_thickness_mm: must be at least 0, found -5"):
            make(thin)


def test_a_scenario_with_nothing_in_place_of_a_section_can_be_saved(tmp_path: Path):
    case = load_scenario("catalogue")
    for without in (case.model_copy(update={"design": None}), case.against(case.threats()[0])):
        save_scenario(without, tmp_path / "saved.toml")
        assert load_scenario(tmp_path / "saved.toml") == without
    with pytest.raises(InputError, match=r"solver\.arrest_velocity_m_s: must be a number, found None"):
        case.replaced({"solver.arrest_velocity_m_s": None})


def test_a_notebook_completes_names_of_a_scenario_and_not_of_pydantic():
    names = {name for name in dir(scenario()) if not name.startswith("_")}
    assert {"impact", "replaced", "to_toml"} < names
    assert not {"model_dump", "schema", "parse_obj"} & names


def test_a_computed_value_cannot_be_set():
    with pytest.raises(ValidationError, match="frozen"):
        scenario().interlayers = 1  # type: ignore[misc]


def test_a_value_without_a_source_names_its_file():
    plain = scenario(library={"ceramic": {"AD85": {"based_on": "AD85", "density_kg_m3": 3500.0}}})
    changed = plain.replaced({"ceramic.flow_stress_GPa": 4.5}).replaced({"title": "x"})
    values = changed.entry("ceramic", "AD85").values
    assert values["flow_stress_GPa"].source == "scenario"
    assert values["density_kg_m3"].source == "scenario"
    assert changed.file == "scenario"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (None, "replaced: changes: must be a mapping, found None"),
        ({5: 900.0}, "replaced: must be a key of the scenario as TOML writes it"),
    ],
)
def test_what_replaced_refuses_names_the_call(changes: Any, message: str):
    with pytest.raises(InputError, match=message):
        scenario().replaced(changes)


def test_a_saved_scenario_finds_its_library_files(tmp_path: Path):
    (tmp_path / "own.toml").write_text('[ceramic.mine]\nbased_on = "AD85"\n')
    (tmp_path / "below").mkdir()
    made = parse_scenario(data(ceramic="mine", library={"files": ["own.toml"]}), folder=tmp_path)
    save_scenario(made, tmp_path / "below" / "saved.toml")
    again = load_scenario(tmp_path / "below" / "saved.toml")
    assert again.core_armour() == made.core_armour()
    assert again.to_toml(tmp_path) == made.to_toml()


def test_the_former_name_of_a_required_probability_is_read():
    of = parse_scenario({**data(), "design": {"confidence": 0.9}})
    assert known(of.design).probability_of_stopping == 0.9
