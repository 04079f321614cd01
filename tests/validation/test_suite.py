"""Suite files: their meaning, and every mistake reported at once."""

import re
from pathlib import Path

import pytest

from armour.errors import InputError
from armour.validation.suite import Suite, load_suite
from tests.helpers.cases import SCENARIOS

HEAD = 'scenario = "wilkins.toml"\nquantity = "ballistic_limit_m_s"\n'
CASE = f'[[case]]\nname = "a"\n{HEAD}expected = 724.0\nband = 1.0\n'
TABLE = f"""
[[table]]
name = "t"
{HEAD}
columns = ["armour.ceramic_thickness_mm", "expected", "they"]
rows = [
    [6.35, 724.0, 700.0],
    [7.0, 760.0, 750.0],
]
rivals = ["they"]
band_percent = 10.0
rms_band = 20.0
"""


def load(folder: Path, text: str) -> Suite:
    path = folder / "suite.toml"
    path.write_text(text)
    return load_suite(path)


def mistakes(folder: Path, text: str) -> list[str]:
    with pytest.raises(InputError) as error:
        load(folder, text)
    return [f"{problem.key}: {problem.message}" for problem in error.value.problems]


def test_a_case(folder: Path):
    suite = load(folder, f'title = "T"\nsource = "S"\n{CASE}reason = "R"\nset.armour.ceramic = "AD99.5"')
    [case] = suite.cases
    assert (suite.title, case.name, case.full_name, case.expected, case.band) == ("T", "a", "a", 724.0, 1.0)
    assert (case.source, case.reason, case.place) == ("S", "R", ("case", 0, "expected"))
    assert case.scenario.armour.ceramic == "AD99.5"


def test_a_table_is_a_case_a_row(folder: Path):
    suite = load(folder, TABLE + "set.armour.backing_thickness_mm = 5.0\n")
    first, second = suite.cases
    assert first.full_name == "t: ceramic thickness 6.35 mm"
    assert (second.scenario.armour.ceramic_thickness_mm, second.scenario.armour.backing_thickness_mm) == (7.0, 5.0)
    assert second.expected == 760.0
    assert second.band == pytest.approx(76.0)
    assert second.rivals == {"they": 750.0}
    assert second.place == ("table", 0, "rows", 1, 1)
    [group] = suite.tables
    assert (group.name, group.rms_band, group.rms_band_percent) == ("t", 20.0, None)


def test_a_difference_needs_a_measured_number(folder: Path):
    text = CASE.replace("724.0", '"perforated"').replace("ballistic_limit_m_s", "outcome").replace("band = 1.0", "")
    assert mistakes(folder, f"{text}measured = 1.0\n") == [
        "case[0]: an outcome has no difference from a measured value, found measured"
    ]
    table = TABLE.replace('"they"', '"measured"', 1).replace('rivals = ["they"]', "").replace("700.0]", "0.0]")
    assert mistakes(folder, table) == ["table[0]: measured must be at least 1e-12, found 0 in rows[0]"]


def test_changes_come_last_and_go_into_every_scenario(folder: Path):
    (folder / "suite.toml").write_text(CASE + "set.armour.ceramic_thickness_mm = 5.0\n" + TABLE)
    changes = {"armour": {"ceramic_thickness_mm": 9.0}, "model.shear_perimeter": "projectile"}
    for case in load_suite(folder / "suite.toml", changes).cases:
        assert case.scenario.armour.ceramic_thickness_mm == 9.0
        assert case.scenario.model.shear_perimeter == "projectile"


def test_a_replacement(folder: Path):
    grid = "{ min = 1.0, max = 20.0, step = 1.0 }"
    text = f"""
[[case]]
name = "a"
scenario = "wilkins.toml"
set.optimise = {{ ceramic_thickness_mm = {grid}, backing_thickness_mm = {grid} }}
replaced_by.armour.ceramic = "Al-N"
quantity = "weight_saved_percent"
expected = 10.0
band = 1.0
"""
    [case] = load(folder, text).cases
    assert case.replacement is not None
    assert (case.scenario.armour.ceramic, case.replacement.armour.ceramic) == ("AD85", "Al-N")
    assert case.replacement.optimise == case.scenario.optimise
    assert mistakes(folder, text.replace('ceramic = "Al-N"', 'ceramic = "AD85"')) == [
        "case[0].scenario: must be a valid scenario: "
        f"{folder / 'wilkins.toml'}: replaced_by: must name another ceramic or another backing, and not both"
    ]


def test_only_some(folder: Path):
    suite = load(folder, CASE + TABLE)
    assert [case.name for case in suite.only("T: CERAMIC").cases] == [case.name for case in suite.cases if case.group]
    assert suite.only("7").tables == suite.tables
    assert suite.only("") == suite
    with pytest.raises(InputError, match="whose name contains"):
        suite.only("nothing of this name")


def test_the_shipped_scenarios_can_be_named_from_anywhere(folder: Path):
    text = CASE.replace('"wilkins.toml"', f'"{SCENARIOS}/wilkins.toml"')
    assert load(folder, text).cases[0].scenario.title.startswith("6.35 mm AD85")


def test_every_mistake_at_once(folder: Path):
    text = f"""
[[case]]
name = ""
scenario = "wilkins.toml"
quantity = "balistic_limit_m_s"
expected = true
colour = 1
[[case]]
name = "b"
{HEAD}expected = 1.0
[[table]]
name = "c"
{HEAD}columns = ["x"]
rows = []
"""
    assert mistakes(folder, text) == [
        'case[0].name: must not be empty, found the text ""',
        'case[0].quantity: must name a quantity, found "balistic_limit_m_s"; did you mean "ballistic_limit_m_s"?',
        "case[0].expected: must be a number up to 1e+12, or the outcome in quotes, found true",
        "case[0].colour: unknown key; choose from name, scenario, set, quantity, band, band_percent, reason, source, "
        "regression, not_scored, expected, replaced_by, measured",
        "case[1]: must have a band or band_percent: how far the computed value may be from the expected",
        "table[0].rows: must not be empty, found a list",
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("band = 1.0", "band = 1.0\nband_percent = 2.0", "case[0]: must have band or band_percent, found both"),
        ("band = 1.0", "band = -1.0", "case[0].band: must be at least 0, found -1.0"),
        ("band = 1.0", "band = 1e300", "case[0].band: must be at most 1e+12, found 1e+300"),
        ("724.0", "1e300", "case[0].expected: must be a number up to 1e+12, or the outcome in quotes, found 1e+300"),
        ("724.0", "nan", "case[0].expected: must be a number up to 1e+12, or the outcome in quotes, found nan"),
        ("724.0", "1" + 400 * "0", ": must be valid TOML, found a whole number of more than 64 bits"),
        ("724.0", '"fast"', "case[0]: expected must be a number for ballistic_limit_m_s, found 'fast'"),
        ("band = 1.0", "band = 1.0\nreplaced_by = {}", "case[0]: replaced_by belongs to thickness_saved_percent and"),
        ("ballistic_limit_m_s", "outcome", "case[0]: an outcome has no band, found band"),
    ],
)
def test_mistakes_of_a_case(folder: Path, old: str, new: str, message: str):
    [found] = mistakes(folder, CASE.replace(old, new))
    assert found.startswith(message)


def test_an_outcome_is_one_of_two(folder: Path):
    text = '[[case]]\nname = "a"\nscenario = "wilkins.toml"\nquantity = "outcome"\nexpected = "stopped"\n'
    assert mistakes(folder, text) == ['case[0]: expected must be "perforated" or "defeated", found \'stopped\'']
    assert load(folder, text.replace("stopped", "defeated")).cases[0].band is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[7.0, 760.0, 750.0]", "[7.0, 760.0]", "every row must have the 3 numbers of the columns, found 2 in rows[1]"),
        ('"expected"', '"found"', "columns must hold expected"),
        ('"they"]\n', '"those"]\n', "columns must hold they"),
        ('"they"]\n', '"expected"]\n', "columns must differ from each other"),
        (
            "rms_band = 20.0",
            "rms_band = 1.0\nrms_band_percent = 2.0",
            "must have rms_band or rms_band_percent, found both",
        ),
        ("ballistic_limit_m_s", "weight_saved_percent", "a table must be of numbers that one scenario answers"),
    ],
)
def test_mistakes_of_a_table(folder: Path, old: str, new: str, message: str):
    found = mistakes(folder, TABLE.replace(old, new, 1))
    assert f"table[0]: {message}" in found[0]


def test_a_table_without_rows(folder: Path):
    [found] = mistakes(folder, re.sub(r"rows = \[\n.*?\n\]\n", "", TABLE, flags=re.DOTALL))
    assert found == "table[0]: must have rows, or a file that has them"


def test_mistakes_in_scenarios_say_where_they_are_named(folder: Path):
    found = mistakes(folder, CASE + 'set.armour.ceramic = "AD86"\n' + CASE.replace("wilkins", "missing"))
    assert found == [
        "case[0].scenario: must be a valid scenario: "
        f'{folder / "wilkins.toml"}: armour.ceramic: must name a ceramic of the library, found "AD86"; '
        'did you mean "AD85"?',
        "case[1].scenario: must be a valid scenario: "
        f"{folder / 'missing.toml'}: cannot be read: no such file or directory",
    ]


def test_a_suite_without_cases(folder: Path):
    assert mistakes(folder, 'title = "empty"') == ["case: is missing: a suite must have at least one case or table"]


def test_a_quantity_that_needs_a_grid(folder: Path):
    [found] = mistakes(folder, CASE.replace("ballistic_limit_m_s", "optimum_areal_density_kg_m2"))
    assert "optimise: is missing and must be given" in found


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            '"armour.ceramic_thickness_mm"',
            '"armour.ceramic.density_kg_m3"',
            "table[0].rows[0]: must be a valid scenario: {}: armour.ceramic.density_kg_m3: must not go below",
        ),
        (
            "rivals",
            "set.armour.ceramic_thickness_mm = 5.0\nrivals",
            "{}: armour.ceramic_thickness_mm: must be given once",
        ),
        ("rivals", "set.title.x = 5.0\nrivals", "table[0].scenario: must be a valid scenario: {}: title: must be"),
        ("rivals", 'set."impact.velocity_m_s.mean" = 5.0\nrivals', "{}: impact.velocity_m_s.mean: must not go below"),
        (
            "rivals",
            "set.solver.arrest_velocity_m_s = 2.0\nset.uncertainty.seed = 5\nrivals",
            "uncertainty.seed: must have",
        ),
        ("rivals", 'set.library.ceramic.AD86.based_on = "AD85"\nrivals', 'scenario uses; did you mean "AD85"?'),
        (
            '"armour.ceramic_thickness_mm"',
            '"design.thickness_max_mm"',
            "design.thickness_max_mm: must have an effect",
        ),
        (
            "[6.35, 7",
            "[-1.0, 7",
            "table[0].rows[0]: must be a valid scenario: {}: armour.ceramic_thickness_mm: must be",
        ),
    ],
)
def test_changes_that_reach_nothing(folder: Path, old: str, new: str, message: str):
    found = mistakes(folder, TABLE.replace(old, new, 1))
    assert len(found) == 1
    assert message.format(folder / "wilkins.toml") in found[0]


def test_a_change_that_no_case_uses(folder: Path):
    (folder / "suite.toml").write_text(CASE)
    with pytest.raises(InputError, match=r"--set library\.ceramic\.AD86: must be an entry of the library"):
        load_suite(folder / "suite.toml", {"library": {"ceramic": {"AD86": {"based_on": "AD85"}}}})


def test_a_script_that_makes_many_mistakes(folder: Path):
    rows = "".join(f"    [-{i + 1}.0, 724.0, 700.0],\n" for i in range(30))
    found = mistakes(folder, TABLE.replace("rows = [\n", f"rows = [\n{rows}"))
    assert len(found) == 21
    assert found[19].startswith("table[0].rows[19]: must be a valid scenario")
    assert found[20] == ": must be right up to here; what follows is not checked"


def test_a_suite_names_a_shipped_scenario(tmp_path: Path):
    path = tmp_path / "suite.toml"
    case = 'name = "one"\nscenario = "wilkins"\nquantity = "outcome"\nexpected = "perforated"\n'
    path.write_text(f"[[case]]\n{case}")
    assert load_suite(path).cases[0].scenario.armour.ceramic == "AD85"
    with pytest.raises(InputError, match="only: text: must be a text, found None"):
        load_suite(path).only(None)  # type: ignore[arg-type]
