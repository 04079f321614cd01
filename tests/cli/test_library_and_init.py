import json
from pathlib import Path

import pytest

from armour import load_scenario, load_suite
from armour.files import shipped_suites, shipped_tests
from tests.helpers.cases import SCENARIOS


def test_a_kind_of_entries(cli):
    data = json.loads(cli("library", "--json").stdout)
    assert data["ceramic"]["AD85"]["flow_stress_GPa"]["value"] == 5.2
    metals = json.loads(cli("library", "metals", "--json").stdout)
    assert metals.pop("made_by") == {**data["made_by"], "command": "armour library metals --json"}
    assert metals == {"metal": data["metal"]}


@pytest.mark.parametrize(
    ("words", "first"),
    [
        ("7.62 mm AP", "7.62 mm AP (projectile)"),
        (".30-06 m2 ap", "7.62 mm APM2 (projectile)"),
        ("sic", "SiC (ceramic)"),
        ("boron carbide", "B4C (ceramic)"),
        ("STANAG level 4", "STANAG 4569 level 4, B32 (threat)"),
    ],
)
def test_an_entry_is_shown_with_its_sources(cli, words: str, first: str):
    for arguments in ([words], words.split()):
        result = cli("library", *arguments)
        assert result.stdout.splitlines()[0] == first
        assert "source" in result.stdout
    (kind, names), _ = json.loads(cli("library", words, "--json").stdout).items()
    assert [f"{name} ({kind})" for name in names] == [first]


def test_a_search_lists_the_entries_with_every_word(cli):
    def found(*words: str) -> dict[str, set[str]]:
        data = json.loads(cli("library", *words, "--json").stdout)
        return {kind: set(names) for kind, names in data.items() if kind != "made_by"}

    everything = found()
    assert [*everything] == ["projectile", "ceramic", "threat", "metal"]
    assert found("metal", "steel")["metal"] == found("steel")["metal"] < everything["metal"]
    assert {*found("steel")} == {"projectile", "metal"}
    assert found("alumina") == {"ceramic": {name for name in everything["ceramic"] if name.startswith("AD")}}
    assert found("b32", "14.5") == {"projectile": {"14.5 mm B32"}, "threat": {"STANAG 4569 level 4, B32"}}


@pytest.mark.parametrize(
    ("words", "near"),
    [
        ("AD85x", 'did you mean "AD85"?'),
        ("5083-H32", "choose from 5083-H3"),
        ("metal alumina", "armour library lists them"),
        ("STANGA 4569 level 3, B32", 'did you mean "STANAG 4569 level 3, B32"?'),
        ("kevlar", "it is neither metal nor ceramic"),
    ],
)
def test_what_the_library_lacks(cli, words: str, near: str):
    [line] = cli.fails(2, "library", words)
    assert line.startswith(f'library: {words}: no entry of the library has the words "{words}"')
    assert near in line


def test_init_writes_a_scenario_that_works(cli, folder: Path):
    result = cli("init")
    assert result.exit_code == 0
    text = (folder / "scenario.toml").read_text()
    assert "# time_step_us" in text
    assert load_scenario("scenario.toml").title == "My armour"
    for command in ("simulate", "ballistic-limit"):
        assert cli(command, "scenario.toml").exit_code == 0


def test_init_copies_a_shipped_scenario(cli, folder: Path):
    assert cli("init", "mine.toml", "--from", "paper/fig9_4mm").exit_code == 0
    first, _, copied = (folder / "mine.toml").read_text().partition("\n")
    assert first == "#:schema ./scenario.schema.json"
    assert copied == (SCENARIOS / "paper" / "fig9_4mm.toml").read_text()


def test_init_copies_a_suite_and_a_table(cli, folder: Path):
    assert cli("init", "s.toml", "--from", "paper").stderr.splitlines()[-1] == "next: armour validate s.toml"
    assert cli("validate", "s.toml", "--only", "lightest against the 7.62 mm AP: areal density").exit_code == 0
    assert cli("init", "t.csv", "--from", "tests/wilkins").exit_code == 0
    assert (folder / "t.csv").read_bytes() == (SCENARIOS / "tests" / "wilkins.csv").read_bytes()
    assert cli("init", "s.ipynb", "--from", "study.ipynb").stderr.splitlines()[-1] == "next: jupyter lab s.ipynb"
    assert (folder / "s.ipynb").read_bytes() == (SCENARIOS.parent / "docs" / "study.ipynb").read_bytes()
    wrong = ("t.toml", "tests/shots", "csv"), ("u.csv", "plates", "toml"), ("u.toml", "study.ipynb", "ipynb")
    assert cli.fails(2, "init", "wilkins") == [
        "wilkins: must end in .toml, found no ending; to copy the shipped one: --from wilkins"
    ]
    assert cli("init", "my s.toml").stderr.splitlines()[-1] == "next: armour check 'my s.toml'"
    for file, source, ending in wrong:
        assert cli.fails(2, "init", file, "--from", source)[0].startswith(f"{file}: must end in .{ending}")


def test_init_names_what_there_is(cli, folder: Path):
    names = cli("init", "--list").stdout.split()
    assert "wilkins" in names
    assert "paper/optimum_25mm_APDS" in names
    shipped = [*shipped_suites(), *shipped_tests(), "study.ipynb"]
    assert [name for name in shipped if name not in names] == []
    [line] = cli.fails(2, "init", "--from", "wilkin")
    assert 'did you mean "wilkins"?' in line
    assert list(folder.iterdir()) == []


def test_a_folder_of_the_name_of_a_suite_is_none(cli, folder: Path):
    (folder / "paper").mkdir()
    assert "published values are not replaced" in cli.fails(2, "validate", "paper", "--update")[0]
    assert cli.fails(2, "report", "paper", "--as-is") == ["command line: --as-is: needs a scenario, found a suite"]


@pytest.mark.parametrize(
    ("command", "hint"),
    [
        ("v50 shots.csv", "tests/shots is a shipped table"),
        ("calibrate wilkins.csv wilkins", "tests/wilkins is a shipped table"),
        ("simulate wilkins.toml", "wilkins is a shipped scenario"),
        ("validate paper.toml", "paper is a shipped suite"),
        ("report plates.toml", "plates is a shipped suite"),
    ],
)
@pytest.mark.usefixtures("folder")
def test_a_name_with_an_ending_is_never_a_shipped_file(cli, command: str, hint: str):
    [line] = cli.fails(2, *command.split())
    assert "cannot be read: no such file" in line
    assert hint in line


TOO_LONG = "a" * 300


@pytest.mark.parametrize(
    "args",
    [
        ["simulate", TOO_LONG],
        ["plan", "shots", "wilkins", TOO_LONG, "--result", "partial"],
        ["sweep", "wilkins", "--cases", TOO_LONG, "-o", "a.csv"],
        ["sweep", "wilkins", "--over", "armour.ceramic_thickness_mm=5,6", "-o", f"{TOO_LONG}.csv"],
        ["simulate", "wilkins", "--plot", f"{TOO_LONG}.png"],
        ["init", f"{TOO_LONG}.toml"],
        ["figures", TOO_LONG],
    ],
)
@pytest.mark.usefixtures("folder")
def test_a_name_that_no_file_can_have(cli, args: list[str]):
    [message] = cli.fails(2, *args)
    known = ("file name too long", "no such file", "must be a folder")
    assert any(words in message for words in known)


def test_a_regression_suite_is_filled_by_an_update(cli, folder: Path):
    told = cli("init", "mine.toml", "--from", "regression").stderr.splitlines()
    assert told[-1] == "next: armour validate mine.toml --update"
    assert "expected =" not in (folder / "mine.toml").read_text()
    assert cli("validate", "mine.toml", "--update").exit_code == 0
    result = cli("validate", "mine.toml")
    assert (result.exit_code, result.stdout.splitlines()[0]) == (0, "5 of 5 within their bands")


def test_a_suite_of_scenarios_names_them_from_its_folder(cli, folder: Path):
    (folder / "doors").mkdir()
    (folder / "suites").mkdir()
    for name in ("a.toml", "doors/b.toml"):
        (folder / name).write_bytes((SCENARIOS / "oblique.toml").read_bytes())
    given = [word for name in ("a.toml", "doors", "wilkins") for word in ("--from", name)]
    told = cli("init", "suites/mine.toml", *given).stderr.splitlines()
    assert told == ["wrote suites/mine.toml", "next: armour validate suites/mine.toml --update"]
    suite = load_suite("suites/mine.toml")
    assert [*dict.fromkeys(case.section.scenario for case in suite.cases)] == [
        "../a.toml",
        "../doors/b.toml",
        "wilkins",
    ]
    assert cli("validate", "suites/mine.toml", "--update").exit_code == 0
    assert cli("validate", "suites/mine.toml").exit_code == 0
    # A name, given alone, still copies; in a folder the suite itself is no scenario.
    assert cli("init", "copy.toml", "--from", "wilkins").stderr.splitlines()[-1] == "next: armour check copy.toml"
    assert cli("init", "suites/mine.toml", "--from", ".", "--force").exit_code == 0


def test_a_suite_of_scenarios_with_mistakes(cli, folder: Path):
    for name in ("a.toml", "b.toml"):
        (folder / name).write_text("[armour]\n")
    told = cli.fails(2, "init", "s.toml", "--from", "a.toml", "--from", "b.toml", "--from", "paper")
    assert [line.partition(":")[0] for line in told] == 4 * ["a.toml"] + 4 * ["b.toml"] + ["paper"]
    for name in ("a.toml", "b.toml"):
        (folder / name).write_bytes((SCENARIOS / "wilkins.toml").read_bytes())
    assert cli.fails(2, "init", "s.csv", "--from", ".") == ["s.csv: must end in .toml, found .csv"]
    assert cli.fails(2, "init", "b.toml", "--from", "b.toml", "--force") == [
        "b.toml: must not be the file that is read; choose another name"
    ]


def test_what_the_template_shows_as_optional_is_valid(folder: Path):
    lines = (SCENARIOS / "template.toml").read_text().splitlines()
    shown = [line.removeprefix("# ") if line.startswith(("# [", '# "')) or " = " in line else line for line in lines]
    text = "\n".join(line for line in shown if not line.startswith(("files", "existing")))
    (folder / "all.toml").write_text(text)
    scenario = load_scenario("all.toml")
    assert scenario.threat[0].title == "AP"
    assert scenario.design is not None
    assert scenario.uncertainty is not None
    assert scenario.entry("metal", "My steel")["shear_strength_MPa"] == 630.0


def test_a_file_of_the_same_name_wins(cli, folder: Path):
    (folder / "wilkins").mkdir()
    assert cli("ballistic-limit", "wilkins").exit_code == 0
    (folder / "wilkins").rmdir()
    (folder / "wilkins").write_text("[armour]\n")
    assert cli.fails(2, "ballistic-limit", "wilkins")[0].startswith("wilkins: impact: is missing")
