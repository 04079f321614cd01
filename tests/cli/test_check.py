"""`armour check` of several scenarios, and its JUnit XML."""

import json
import os
import shlex
import socket
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest

from armour.design.against import NO_BASE
from tests.helpers.cases import SCENARIOS

FAILS = (SCENARIOS / "wilkins.toml").read_text()
PASSES = FAILS.replace("velocity_m_s = 800.0", "velocity_m_s = 600.0")


@pytest.fixture
def doors(folder: Path) -> Path:
    """A folder with a scenario that is expected to stop its threat and one that fails."""
    doors = folder / "doors"
    doors.mkdir()
    (doors / "b.toml").write_text(FAILS)
    (doors / "a.toml").write_text(PASSES)
    return doors


def test_a_folder_is_its_scenarios(cli, doors: Path):
    result = cli("check", "doors", "doors/a.toml")
    assert result.exit_code == 3
    assert result.stdout.startswith("2 armours: 1 expected to stop, 1 FAILS\n")
    rows = [line.split()[::9] for line in result.stdout.splitlines() if line.startswith("doors/")]
    assert [row[0] for row in rows] == ["doors/a.toml", "doors/b.toml"]
    # With -v, each is shown as it is alone, below its file.
    alone, all_of_them = (cli("check", words, "-v").stdout for words in ("doors/a.toml", "doors"))
    assert f"doors/a.toml\n{alone}" in all_of_them
    (doors / "b.toml").write_text(PASSES)
    assert cli("check", "doors").exit_code == 0


def test_json_is_an_object_or_an_array(cli, doors: Path):
    one, two = (json.loads(cli("check", words, "--json").stdout) for words in ("doors/a.toml", "doors"))
    commands = [each["made_by"].pop("command") for each in (one, *two)]
    assert commands == ["armour check doors/a.toml --json", *["armour check doors --json"] * 2]
    assert two[0] == one
    assert [each["verdict"] for each in two] == ["expected to stop", "fails"]
    # The form does not depend on how many are in a folder.
    (doors / "b.toml").unlink()
    [alone] = json.loads(cli("check", "doors", "--json").stdout)
    assert alone["verdict"] == "expected to stop"


def test_mistakes_of_all_scenarios_are_told_together(cli, doors: Path):
    (doors / "c.toml").write_text("[impact]\n")
    (doors / "d.toml").write_text(FAILS.replace("800.0", "-800.0"))
    (doors / "e.toml").write_text("[impact\n")
    (doors / "none").mkdir()
    told = cli.fails(2, "check", "doors")
    assert {line.partition(": ")[0] for line in told} == {"doors/c.toml", "doors/d.toml", "doors/e.toml"}
    assert cli.fails(2, "check", "doors/a.toml", "doors/none") == [
        "doors/none: must be a folder of scenarios, found none in it"
    ]


def unix_socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as opened:
        opened.bind(str(path))


@pytest.mark.skipif(os.name != "posix", reason="has no pipes with names in folders")
@pytest.mark.parametrize(
    ("make", "counted"),
    [
        (lambda path: path.write_text("[tool]\n"), "1 other .toml file"),
        (lambda path: path.with_name(".x.toml").write_text(FAILS), "1 hidden file"),
        (lambda path: path.with_name(".x").mkdir(), "1 hidden folder"),
        (lambda path: path.symlink_to("b.toml"), "1 link"),
        (lambda path: path.with_name("above").symlink_to(".."), "1 link"),
        (lambda path: os.mkfifo(path), "1 pipe or socket"),
        (unix_socket, "1 pipe or socket"),
        (lambda path: (path.mkdir(), (path / "pyvenv.cfg").touch()), "1 virtual environment (x.toml)"),
    ],
)
@pytest.mark.usefixtures("doors")
def test_what_is_no_scenario_of_a_folder_is_skipped_and_counted(
    cli, monkeypatch: pytest.MonkeyPatch, make: Callable[[Path], None], counted: str
):
    monkeypatch.chdir("doors")  # as the name of a socket must be short
    make(Path("x.toml"))
    result = cli("check", ".")
    assert result.stdout.startswith("2 armours: 1 expected to stop, 1 FAILS\n")
    assert result.stderr.splitlines()[0] == f"note: skipped {counted}"


def test_a_name_may_begin_with_a_hyphen(cli, folder: Path):
    (folder / "--yes.toml").write_text(PASSES)
    assert cli("check", "--", "--yes.toml").exit_code == 0
    assert cli("check", ".").exit_code == 0
    (folder / "--yes.toml").write_text((SCENARIOS / "panel.toml").read_text())
    _, then = cli("optimise", "--", "--yes.toml").stderr.rstrip().rsplit("next: ", 1)
    words = shlex.split(then)
    assert words[:3] == ["armour", "optimise", "./--yes.toml"]
    assert cli(*words[1:]).exit_code == 0
    assert cli("check", "best.toml").exit_code == 0


def test_a_scenario_in_a_folder_is_not_replaced_by_its_results(cli, doors: Path):
    for words in ([], ["--set", "armour.ceramic_thickness_mm=-1"]):
        cli.fails(2, "check", "doors", "--junit", "doors/a.toml", "--force", *words)
        assert (doors / "a.toml").read_text() == PASSES


@pytest.mark.usefixtures("folder")
def test_a_saved_design_has_all_that_was_required_of_it(cli):
    found = cli(
        "optimise", "panel", "--probability", "0.9", "--set", "design.areal_density_max_kg_m2=46", "--save", "b.toml"
    )
    assert found.exit_code == 0
    assert found.stderr.splitlines()[-1] == "next: armour check b.toml"
    [verdict] = [line for line in found.stdout.splitlines() if line.startswith("passes: ")]
    checked = cli("check", "b.toml")
    assert (checked.exit_code, checked.stdout.splitlines()[0]) == (0, verdict)
    assert "of at most 46 kg/m²" in checked.stdout
    assert verdict.endswith("(90 % required)")


def test_nothing_that_fails_is_saved_and_what_is_not_known_says_so(cli, folder: Path):
    fails = cli("optimise", "panel", "--set", "design.thickness_max_mm=9", "--save", "f.toml")
    assert (fails.exit_code, (folder / "f.toml").exists()) == (1, False)
    assert "f.toml not written: the nearest design FAILS" in fails.stderr
    unknown = cli("optimise", "panel", "--set", "armour.ceramic=SiC", "--probability", "0.9", "--save", "n.toml")
    assert (unknown.exit_code, (folder / "n.toml").exists()) == (1, True)
    assert "n.toml: not known whether this design holds" in unknown.stderr
    assert cli("check", "n.toml").exit_code == 3


@pytest.mark.parametrize("command", ["check", "optimise", "report"])
def test_the_model_alone_has_no_probability(cli, command: str):
    [line] = cli.fails(2, command, "panel", "--by-model", "--probability", "0.9")
    assert line.startswith("command line: --by-model: must not be combined with a required probability, which the ")


def test_by_the_model_is_as_excluding_the_model_error(cli, folder: Path):
    own = (SCENARIOS / "panel.toml").read_text() + "[uncertainty.model]\nscale_percent = 5.0\n"
    (folder / "own.toml").write_text(own)
    for command in ("check", "optimise"):
        option, key = (
            cli(command, "own.toml", "--by-model"),
            cli(command, "panel", "--set", "uncertainty.model.included=false"),
        )
        assert option.stdout.splitlines()[2:] == key.stdout.splitlines()[2:]
        assert "ed by the model: " in option.stdout


def test_a_suite_of_tests_for_every_scenario(cli, folder: Path, doors: Path):
    assert cli("check", "doors", "--junit", "j.xml").exit_code == 3
    suites = ElementTree.parse(folder / "j.xml").getroot()
    assert [(suite.get("tests"), suite.get("failures")) for suite in suites] == [("1", "0"), ("1", "1")]
    assert [case.get("classname") for case in suites.iter("testcase")] == ["doors/a.toml", "doors/b.toml"]
    assert all(float(suite.get("time", "")) > 0.0 for suite in suites)
    [failure] = suites.iter("failure")
    message = "FAILS: stops a shot of 7.62 mm AP at 800 m/s with 8 % (none required)"
    assert failure.text == failure.get("message") == message
    # The next run replaces it.
    (doors / "b.toml").write_text(PASSES)
    assert cli("check", "doors", "--junit", "j.xml").exit_code == 0
    assert "failure " not in (folder / "j.xml").read_text()


@pytest.mark.parametrize("command", ["check doors", "validate doors/c.toml"])
def test_mistakes_are_errors_in_junit_xml(cli, folder: Path, doors: Path, command: str):
    (doors / "c.toml").write_text("[impact]\n")
    wrote, *told = cli.fails(2, *command.split(), "--junit", "j.xml")
    [suite] = ElementTree.parse(folder / "j.xml").getroot()
    errors = [error.text for error in suite.iter("error")]
    assert wrote == "wrote j.xml"
    assert [line.partition(" (line")[0] for line in told] == errors
    located = [case.attrib for case in suite.iter("testcase") if "line" in case.attrib]
    assert ("doors/c.toml", "1") in [(case["file"], case["line"]) for case in located]
    assert suite.get("errors") == suite.get("tests") == str(len(errors))
    # One that cannot be written hides no mistake.
    assert cli.fails(2, *command.split(), "--junit", "none/j.xml") == told


@pytest.mark.parametrize("command", ["check wilkins", "validate suite.toml"])
@pytest.mark.parametrize("content", ["", "<testsuites/>", "<?xml version='1.0' encoding='utf-8'?>\n<testsuites>"])
def test_junit_xml_of_others_is_kept(cli, folder: Path, command: str, content: str):
    case = "[[case]]\nname = 'a'\nscenario = 'wilkins'\nquantity = 'outcome'\nexpected = 'perforated'\n"
    (folder / "suite.toml").write_text(case)
    (folder / "j.xml").write_text(content)
    words = (*command.split(), "--junit", "j.xml")
    assert cli.fails(2, *words) == ["j.xml: exists already; choose another name, or --force"]
    assert cli(*words, "--force").exit_code in (0, 3)
    assert cli(*words).exit_code in (0, 3)


def test_a_check_against_an_earlier_one(cli, doors: Path):
    (doors.parent / "base.json").write_text(cli("check", "doors", "--json").stdout)
    unmoved = cli("check", "doors/a.toml", "doors/b.toml", "--against", "base.json")
    assert unmoved.stdout.endswith("\n\nnothing has changed since base.json\n")
    weaker = PASSES.replace("600.0", "500.0")
    (doors / "a.toml").write_text(weaker)
    (doors / "b.toml").write_text(PASSES)
    result = cli("check", "doors", "--against", "base.json", "--junit", "j.xml")
    assert result.exit_code == 3
    assert result.stdout.startswith("2 armours: 2 expected to stop\n")
    assert result.stdout.splitlines()[-1] == "weaker than in base.json: 2 of 6 changes"
    suite = ElementTree.parse(doors.parent / "j.xml").getroot()[-1]
    assert [case.get("name") for case in suite.findall("testcase")] == ["7.62 mm AP velocity, m/s"] * 2
    (doors / "b.toml").unlink()
    answers = json.loads(cli("check", "doors", "--against", "base.json", "--json").stdout)
    assert [(each["scenario"], each["moved"][0]["quantity"]) for each in answers] == [
        ("doors/a.toml", "velocity_m_s"),
        ("doors/b.toml", "scenario"),
    ]


def test_an_earlier_check_that_is_none(cli, folder: Path):
    (folder / "bad.json").write_text("[" * 100_000)
    assert cli.fails(2, "check", "wilkins", "--against", "bad.json") == [f"bad.json: {NO_BASE}"]


def test_a_threat_that_holds_is_skipped_if_no_probability_is_required(cli, doors: Path):
    cli("check", "doors", "--junit", "j.xml")
    holds, fails = ElementTree.parse(doors.parent / "j.xml").getroot()
    [skipped] = holds.findall("testcase/skipped")
    assert (skipped.get("message") or "").endswith(" (none required)")
    assert (holds.get("skipped"), fails.get("failures"), fails.get("skipped")) == ("1", "1", "0")
    cli("check", "doors/a.toml", "--probability", "0.6", "--junit", "j.xml", "--force")
    assert ElementTree.parse(doors.parent / "j.xml").findall(".//skipped") == []


def test_a_requirement_on_the_command_line_is_a_floor(cli, folder: Path):
    (folder / "weak.toml").write_text(f"{PASSES}\n[design]\nprobability_of_stopping = 0.6\n")
    for option in ("--probability", "--confidence"):
        result = cli("check", "weak.toml", option, "0.9999")
        assert result.exit_code == 3
        assert "(99.99 % required)" in result.stdout
    lower = cli("check", "weak.toml", "--probability", "55%")
    assert lower.exit_code == 0
    assert "(60 % required)" in lower.stdout
    assert cli.fails(2, "check", "weak.toml", "--probability", "95") == [
        "command line: --probability: must be less than 1, found 95; did you mean 0.95?"
    ]


def test_markdown_for_a_summary(cli, doors: Path):
    (doors.parent / "base.json").write_text(cli("check", "doors", "--json").stdout)
    (doors / "a.toml").write_text(PASSES.replace("600.0", "500.0"))
    cli("check", "doors", "--against", "base.json", "--markdown", "check.md")
    text = (doors.parent / "check.md").read_text()
    assert text.startswith("# Check of armour\n\n2 armours: 1 expected to stop, 1 FAILS\n")
    assert "| doors/b.toml | 7.62 mm AP | FAILS |" in text
    assert "## Since the earlier check" in text
    assert "weaker than in base.json" in text


def test_scenarios_in_folders_below_are_checked(cli, doors: Path):
    (doors / "hull/floor").mkdir(parents=True)
    (doors / "hull/floor/C.TOML").write_text(FAILS)
    result = cli("check", "doors")
    assert result.stdout.startswith("3 armours: 1 expected to stop, 2 FAILS\n")
    assert "skipped" not in result.stderr
    (doors / "hull/floor/C.TOML").write_text("x = 1\n" + FAILS)
    assert cli.fails(2, "check", "doors")[0].endswith("(line 1)")
