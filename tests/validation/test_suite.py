"""Suite files: their meaning, and every mistake reported at once."""

from pathlib import Path

import pytest

from armour.analysis.evaluate import evaluate
from armour.design.optimise import optimise
from armour.errors import InputError, NoAnswerError
from armour.scenario.scenario import Scenario
from armour.validation.questions import BEST, QUESTIONS, Subject, answer
from armour.validation.suite import load_suite
from tests.design.results import best_of
from tests.helpers.cases import SCENARIOS, catalogue, grid, scenario, shipped_scenario
from tests.helpers.suites import HEAD, TABLE, case, load

CASE = case("a", 724.0, "band = 1.0")
OUTCOME = '[[case]]\nname = "a"\nscenario = "wilkins.toml"\nquantity = "outcome"\nexpected = "stopped"\n'
FILE = f"""
notes = ["lot", "kept"]
[[table]]
name = "f"
{HEAD}file = "t.csv"
where = {{ kept = 1 }}
"""
CSV = """test,armour.ceramic,armour.backing_thickness_mm,ballistic_limit_m_s,lot,kept
one,AD85,6.35,700,A,1
two,AD85,7.0,800,B,1
three,AD99.5,6.35,800,B,1
four,AD99.5,8.0,800,B,0
"""


def mistakes(folder: Path, text: str) -> list[str]:
    with pytest.raises(InputError) as error:
        load(folder, text)
    return [str(problem).replace(f"{folder}/", "") for problem in error.value.problems]


def test_a_case(folder: Path):
    suite = load(folder, f'title = "T"\nsource = "S"\n{CASE}reason = "R"\nset.armour.ceramic = "AD99.5"')
    [found] = suite.cases
    assert (suite.title, found.name, found.full_name, found.expected, found.band) == ("T", "a", "a", 724.0, 1.0)
    assert (found.source, found.reason, found.place) == ("S", "R", ("case", 0, "expected"))
    assert found.scenario.armour.ceramic == "AD99.5"
    assert load(folder, OUTCOME).cases[0].band is None


def test_a_table_is_a_case_a_row(folder: Path):
    percent = TABLE.replace("\nband = 10.0", "\nband_percent = 10.0")
    suite = load(folder, percent + "set.armour.backing_thickness_mm = 5.0\n")
    first, second = suite.cases
    assert first.full_name == "t: tile thickness 6.35 mm"
    assert (second.scenario.armour.ceramic_thickness_mm, second.scenario.armour.backing_thickness_mm) == (6.35, 5.0)
    assert (second.expected, second.place) == (730.0, ("table", 0, "rows", 1, 1))
    assert second.band == pytest.approx(73.0)
    [table] = suite.tables
    assert (table.name, table.rms_band, table.rms_band_percent) == ("t", 5.0, None)


def test_changes_come_last_and_go_into_every_scenario(folder: Path):
    (folder / "suite.toml").write_text(CASE + "set.armour.ceramic_thickness_mm = 5.0\n" + TABLE)
    changes = {"armour": {"ceramic_thickness_mm": 9.0}, "model.shear_perimeter": "projectile"}
    for each in load_suite(folder / "suite.toml", changes).cases:
        assert each.scenario.armour.ceramic_thickness_mm == 9.0
        assert each.scenario.model.shear_perimeter == "projectile"
    with pytest.raises(InputError, match=r"--set library\.ceramic\.AD85x: must be an entry of the library"):
        load_suite(folder / "suite.toml", {"library": {"ceramic": {"AD85x": {"based_on": "AD85"}}}})


def test_no_change_is_of_a_column_of_a_file(folder: Path):
    (folder / "t.csv").write_text(CSV)
    (folder / "suite.toml").write_text(FILE)
    message = "t.csv: armour.ceramic: must not be a column, as --set armour.ceramic sets it"
    with pytest.raises(InputError, match=message):
        load_suite(folder / "suite.toml", {"armour": {"ceramic": "AD85"}})
    assert "as set.armour.ceramic sets it" in mistakes(folder, FILE + 'set.armour.ceramic = "AD85"')[0]


def test_a_replacement(folder: Path):
    grid = "{ min = 1.0, max = 20.0, step = 1.0 }"
    text = CASE.replace("ballistic_limit_m_s", "weight_saved_percent") + (
        f"set.optimise = {{ ceramic_thickness_mm = {grid}, backing_thickness_mm = {grid} }}\n"
        'replaced_by.armour.ceramic = "Al-N"\n'
    )
    [found] = load(folder, text).cases
    assert found.replacement is not None
    assert (found.scenario.armour.ceramic, found.replacement.armour.ceramic) == ("AD85", "Al-N")
    assert found.replacement.optimise == found.scenario.optimise
    assert mistakes(folder, text.replace('ceramic = "Al-N"', 'ceramic = "AD85"')) == [
        "suite.toml: case[0].scenario: must be a valid scenario: "
        "wilkins.toml: replaced_by: must name another ceramic or another backing, and not both"
    ]


def test_only_some(folder: Path):
    (folder / "t.csv").write_text(CSV)
    suite = load(folder, FILE + "mean_band_percent = 5.0\ngroup = [{ name = 'A', where.lot = 'A' }]\n" + CASE + TABLE)
    assert suite.only("") == suite
    assert [found.name for found in suite.only("T: TILE").cases] == 2 * ["tile thickness 6.35 mm"]
    assert suite.only("6.35").tables == suite.tables[1:]
    # A part of the rows of a file is not held to bands.
    [table] = suite.only("two").tables
    assert (table.group, table.rms_band_percent, table.mean_band_percent) == ([], None, None)
    with pytest.raises(InputError, match="only: text: must be part of the name of a case"):
        suite.only("nothing of this name")


def test_shipped_scenarios_and_suites_go_by_name(folder: Path, monkeypatch: pytest.MonkeyPatch):
    (folder / "wilkins.toml").unlink()
    for name in ("wilkins", f"{SCENARIOS}/wilkins.toml"):
        assert load(folder, CASE.replace("wilkins.toml", name)).cases[0].scenario.armour.ceramic == "AD85"
    monkeypatch.chdir(folder)
    assert load_suite("paper").file.name == "paper.toml"
    with pytest.raises(InputError, match=r"plate: cannot be read.*did you mean \"plates\"\?$"):
        load_suite("plate")
    (folder / "plates").write_text("")
    with pytest.raises(InputError, match="plates: case: is missing"):
        load_suite("plates")


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
[[case]]
name = "d"
scenario = "none.toml"
quantity = "ballistic_limit_m_s"
band = 1.0
expected = 1.0
"""
    assert mistakes(folder, text) == [
        'suite.toml: case[0].name: must not be empty, found the text ""',
        'suite.toml: case[0].quantity: must name a quantity, found "balistic_limit_m_s"; '
        'did you mean "ballistic_limit_m_s"?',
        "suite.toml: case[0].expected: must be a number, found true",
        "suite.toml: case[0].colour: unknown key; choose from name, scenario, set, quantity, band, band_percent, "
        "reason, source, regression, not_scored, expected, replaced_by, measured",
        "suite.toml: case[1]: must have a band or band_percent: how far the computed value may be from the expected",
        "suite.toml: table[0].rows: must not be empty, found a list",
        "suite.toml: case[2].scenario: must be a valid scenario: none.toml: cannot be read: no such file or directory; "
        "`armour init --list` lists what is shipped",
    ]


IN_SCENARIO = "case[0].scenario: must be a valid scenario: wilkins.toml: "
IN_ROW = "table[0].rows[0]: must be a valid scenario: wilkins.toml: "


MISTAKES = {
    CASE: [
        ("band = 1.0", "band = 1.0\nband_percent = 2.0", "case[0]: must have band or band_percent, found both"),
        ("band = 1.0", "band = -1.0", "case[0].band: must be at least 0, found -1.0"),
        ("724.0", "nan", "case[0].expected: must be a finite number, found nan"),
        ("724.0", '"fast"', "case[0]: expected must be a number for ballistic_limit_m_s, found the"),
        ("band = 1.0", "band = 1.0\nreplaced_by = {}", "case[0]: replaced_by belongs to thickness_saved_percent"),
        ("ballistic_limit_m_s", "outcome", "case[0]: an outcome has no band, found band"),
        ("band = 1.0", 'band = 1.0\nset.armour.ceramic = "AD85x"', f"{IN_SCENARIO}armour.ceramic: must name a"),
        ("ballistic_limit_m_s", "optimum_areal_density_kg_m2", f"{IN_SCENARIO}optimise: is missing"),
    ],
    OUTCOME: [
        ("stopped", "undecided", 'case[0]: expected must be "stopped" or "perforated" (or partial or complete'),
        ('"stopped"', '"stopped"\nmeasured = 1.0', "case[0]: an outcome has no difference from a measured"),
        ("outcome", "verdict", "case[0]: expected must be one of fails, perforated by the model, not known"),
    ],
    TABLE: [
        ("6.35, 730.0]", "730.0]", "table[0]: every row must have the 2 numbers of the columns, found 1 in row"),
        ('"expected"', '"found"', "table[0]: columns must include expected"),
        ("rms_band", "rms_band_percent = 2.0\nrms_band", "table[0]: must have rms_band or rms_band_percent, foun"),
        (
            "ballistic_limit_m_s",
            "weight_saved_percent",
            "table[0]: a table must be of numbers that one scenario answers",
        ),
        ("band", "where = { x = 1 }\nband", "table[0]: must not have where without a file"),
        ("ceramic_thickness_mm", "ceramic.density_kg_m3", f"{IN_ROW}armour.ceramic.density_kg_m3: must not go"),
        ("[6.35", "[-1.0", f"{IN_ROW}armour.ceramic_thickness_mm: must be"),
        ("armour.ceramic_thickness_mm", "design.thickness_max_mm", "design.thickness_max_mm: must have an effec"),
        ("band", "set.armour.ceramic_thickness_mm = 5.0\nband", f"{IN_ROW}armour.ceramic_thickness_mm: must"),
        ("band", "set.uncertainty.seed = 5\nband", "uncertainty.seed: must have"),
        ("band", 'set.library.ceramic.AD85x.based_on = "AD85"\nband', 'scenario uses; did you mean "AD85"?'),
    ],
    TABLE.replace("0],", "0, 0.0],"): [
        ('d"]', 'd", "measured"]', "table[0]: measured must be greater than 0, found 0")
    ],
    FILE: [
        ("where = { kept = 1 }", 'columns = ["x"]', "table[0]: must not have columns with a file"),
        ("ballistic_limit_m_s", "penetration_depth_mm", "table[0]: quantity must be one of"),
        ("ballistic_limit_m_s", "residual_mass_g", "t.csv: must be a table of tests with the column"),
        ("kept = 1", "kept = 2", "t.csv: must have tests with ballistic_limit_m_s and kept as the suite selects"),
        ("kept = 1", "kept = { max = 2 }", "table[0].where.kept.max: unknown key; choose from min, below"),
    ],
}


@pytest.mark.parametrize(
    ("text", "old", "new", "message"), [(text, *row) for text, rows in MISTAKES.items() for row in rows]
)
def test_a_mistake(folder: Path, text: str, old: str, new: str, message: str):
    (folder / "t.csv").write_text(CSV)
    [found] = mistakes(folder, text.replace(old, new, 1))
    assert message in found


def test_mistakes_in_a_file_are_all_told(folder: Path):
    (folder / "t.csv").write_text(CSV.replace("6.35", "x").replace("AD99.5,8.0", "AD9,8.0"))
    assert [line.split(":")[1] for line in mistakes(folder, FILE)] == [" line 2", " line 4", " line 5"]


def test_tables_have_names_of_their_own(folder: Path):
    """Two tables of one name would be summarised as one, and a table called "cases" with those of no table."""
    for names in (("a", "a"), ("a", "cases")):
        text = "".join(TABLE.replace('name = "t"', f'name = "{name}"') for name in names)
        message = f'must each have a name of its own, other than "cases", found "{names[1]}"'
        assert mistakes(folder, text) == [f"suite.toml: table: {message}"]


GRID = grid((0.0, 60.0, 1.0), (1.0, 60.0, 1.0))
THIN = {layer: {"min": 0.5, "max": 2.0, "step": 0.5} for layer in GRID}


@pytest.fixture(scope="module")
def wilkins() -> Scenario:
    """The Wilkins case with a grid of designs."""
    return scenario(optimise=GRID)


@pytest.mark.parametrize("asked", ["wilkins", "catalogue"])
def test_the_best_design(asked: str, wilkins: Scenario):
    """Of a grid, and of a catalogue in [design] without one, which has costs."""
    subject = Subject(wilkins if asked == "wilkins" else catalogue())
    best = best_of(optimise(subject.scenario))
    costs = ["optimum_cost_per_m2"] if best.cost_per_m2 is None else []
    values = {name: answer(name, subject) for name in BEST if name not in costs}
    assert values == {name: getattr(best, name.removeprefix("optimum_")) for name in values}
    assert len(costs) == (asked == "wilkins")
    for name in costs:
        with pytest.raises(NoAnswerError, match=r"^no cost: "):
            answer(name, subject)


def test_a_suite_watches_a_scenario_with_a_catalogue(folder: Path):
    (folder / "wilkins.toml").write_text(catalogue().to_toml())
    quantity = "optimum_areal_density_kg_m2"
    [found] = load(folder, CASE.replace("ballistic_limit_m_s", quantity) + "set.design.thickness_max_mm = 9.0\n").cases
    with pytest.raises(NoAnswerError, match=r"^no design is known to pass; .* mm .*, the nearest: fails$"):
        answer(quantity, Subject(found.scenario))


def test_a_probability_that_is_not_known():
    with pytest.raises(NoAnswerError, match=r"^not known: no test of My alumina on metal is known"):
        answer("probability_of_stopping", Subject(shipped_scenario("unknown_ceramic")))


@pytest.mark.parametrize(("layer", "material"), [("ceramic", "AD99.5"), ("backing", "7075-T6")])
def test_what_a_replacement_saves(wilkins: Scenario, layer: str, material: str):
    after = wilkins.replaced({f"armour.{layer}": material})
    subject = Subject(wilkins, after)
    name = f"required_{layer}_thickness_mm"
    thick, thin = (float(evaluate(s, {}, [name])[name][0]) for s in (wilkins, after))
    assert answer("thickness_saved_percent", subject) == pytest.approx(100.0 * (thick - thin) / (6.35 + thick))
    key = f"armour.{layer}_thickness_mm"
    heavy = wilkins.replaced({key: thick}).areal_density_kg_m2()
    light = after.replaced({key: thin}).areal_density_kg_m2()
    assert answer("weight_saved_percent", subject) == pytest.approx(100.0 * (1.0 - light / heavy))


@pytest.mark.parametrize("name", [name for name, reads in QUESTIONS.items() if "optimise" in reads])
def test_no_design_is_enough(name: str):
    fast = scenario(ceramic_mm=1.0, backing_mm=1.0, optimise=THIN)
    with pytest.raises(NoAnswerError, match="no design"):
        answer(name, Subject(fast, fast.replaced({"armour.backing": "7075-T6"})))
