"""What every command has: changes, standard input, examples that run, a schema, plain colours."""

import inspect
import json
import re
import shlex
import tomllib
from functools import cache
from pathlib import Path

import jsonschema
import pytest
from typer.testing import CliRunner

from armour.cli.app import COMMANDS, app
from tests.cli.test_docs import PAGES, sessions
from tests.cli.test_golden import GOLDEN
from tests.helpers.cases import COMPLETE, SCENARIOS

pytestmark = pytest.mark.slow

WILKINS = SCENARIOS / "wilkins.toml"

DOCSTRINGS = [inspect.getdoc(command) or "" for commands in COMMANDS.values() for command in commands]
EXAMPLES = re.findall(r"^armour (.*)", "\n".join(DOCSTRINGS), re.MULTILINE)
# Commands of the documentation, which tests/cli/test_docs.py runs, and those of tests/cli/golden.
SHOWN = [command for page in PAGES for session in sessions(page) for command, _ in session]
PLAYED = [line.removeprefix("$ ") for path in GOLDEN.glob("*.txt") for line in path.read_text().splitlines()]
RUN_ELSEWHERE = [command.removeprefix("armour ") for command in SHOWN + PLAYED if command.startswith("armour ")]


@cache
def words_of(command: str) -> set[str]:
    return {word.removesuffix(".toml") for word in shlex.split(command.replace(" -o ", " --output "))}


def is_part_of_another(example: str) -> bool:
    """Whether a longer example, or a command that is run elsewhere, holds all words of an example."""
    words = words_of(example)
    return any(words < words_of(other) for other in EXAMPLES) or any(
        words <= words_of(other) for other in RUN_ELSEWHERE
    )


@pytest.mark.parametrize("example", [example for example in EXAMPLES if not is_part_of_another(example)])
def test_the_examples_of_the_help_run(cli, folder: Path, example: str):
    if "--force" in example:
        (folder / "mine.toml").touch()
    result = cli(*shlex.split(example))
    assert result.exit_code == 0, result.output


def test_standard_input(cli):
    piped = json.loads(cli("ballistic-limit", "-", "--json", stdin=WILKINS.read_text()).stdout)
    named = json.loads(cli("ballistic-limit", WILKINS, "--json").stdout)
    assert piped["made_by"].pop("command") == "armour ballistic-limit - --json"
    assert named["made_by"].pop("command").endswith("wilkins.toml --json")
    assert piped == named
    wrong = cli("simulate", "-", stdin="[impact]\nvelocity_m_s = -1.0\n")
    assert wrong.exit_code == 2
    assert "standard input: impact.velocity_m_s: must be at least 10, found -1" in wrong.stderr
    assert cli("simulate", "-", stdin="= 3").stderr.startswith("standard input: must be valid TOML")


def test_bytes_that_are_no_text(cli):
    done = cli("simulate", "-", stdin=b'a = "\xff"')
    assert (done.exit_code, done.stderr) == (2, "standard input: must be UTF-8 text, found the byte 0xff at 5\n")


def test_no_colour_where_none_is_wanted(cli, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("NO_COLOR", "")
    assert "\x1b[1m" in cli("library").stdout
    monkeypatch.delenv("FORCE_COLOR")
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in cli("library").stdout


@pytest.fixture(scope="module")
def schema() -> jsonschema.Draft202012Validator:
    found = json.loads(CliRunner().invoke(app, ["schema"]).stdout)
    jsonschema.Draft202012Validator.check_schema(found)
    return jsonschema.Draft202012Validator(found)


@pytest.mark.parametrize("path", COMPLETE, ids=lambda path: path.stem)
def test_every_scenario_meets_the_schema(schema, path: Path):
    assert [error.message for error in schema.iter_errors(tomllib.loads(path.read_text()))] == []


@pytest.mark.parametrize(
    "line",
    [
        "impact.velocity_m_s = -1.0",
        'impact.velocity_m_s = "fast"',
        "armour.thickness = 3",
        'model.shear_perimeter = "square"',
        "threat = [{ projectile = 'x' }]",
        'library.ceramic.X = { flow_stress_GPa = "hard" }',
        "design.backing = [{ material = 'x', thickness_mm = '3' }]",
    ],
)
def test_the_schema_sees_mistakes(schema, line: str):
    data = tomllib.loads(WILKINS.read_text())
    for key, value in tomllib.loads(line).items():
        data[key] = {**data.get(key, {}), **value} if isinstance(value, dict) else value
    assert list(schema.iter_errors(data))
