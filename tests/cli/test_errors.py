"""Bad input ends in messages and exit code 2, whatever the command."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.helpers.cases import SCENARIOS

COMMANDS = ["simulate", "ballistic-limit", "optimise"]


@pytest.mark.parametrize("content", [b"\x00\xff\xfe", b"\x89PNG\r\n\x1a\n\x00", b"[impact\n", b"a = 1\na = 2\n"])
@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_that_is_no_scenario(cli, command: str, content: bytes, folder: Path):
    (folder / "a.toml").write_bytes(content)
    [line] = cli.fails(2, command, "a.toml")
    assert line.startswith("a.toml: must be ")


@pytest.mark.parametrize("command", COMMANDS)
def test_all_mistakes_at_once(cli, command: str, folder: Path):
    text = (SCENARIOS / "wilkins.toml").read_text()
    text = text.replace("AD85", "AD85x").replace("800.0", "-800.0").replace("step = 0.1", "step = 0")
    (folder / "a.toml").write_text(text + "\n[modle]\nx = 1\n")
    lines = cli.fails(2, command, "a.toml")
    assert [line.split(": ")[1] for line in lines] == [
        "impact.velocity_m_s",
        "armour.ceramic",
        "optimise.ceramic_thickness_mm.step",
        "modle",
    ]


@pytest.mark.parametrize(
    "words",
    ["simulate", "simulate a.toml --velocity fast", "fly"],
)
def test_wrong_usage(cli, words: str):
    assert cli(*words.split()).exit_code == 2


def test_the_program_alone_shows_its_commands(cli):
    assert (cli().exit_code, cli().stdout) == (0, cli("--help").stdout[:-1])
    lines = cli().stdout.splitlines()
    assert len(lines) <= 36
    assert max(map(len, lines)) <= 80


@pytest.mark.parametrize("words", [("check", ""), ("simulate", ""), ("check", "wilkins", "--junit", "")])
def test_a_variable_that_is_not_set_is_no_path(cli, words: tuple[str, ...], folder: Path):
    """It would be the current folder, all scenarios of which would be checked."""
    assert cli.fails(2, *words) == ["command line: must not contain an empty word, such as a variable that is not set"]
    assert not list(folder.iterdir())


@pytest.mark.parametrize("number", ["7_00", "700%", "nan", "7,5"])
@pytest.mark.parametrize(
    "words",
    [
        "v50 tests/shots --confidence",
        "plan shots wilkins a.csv --result P --velocity-m-s",
        "plan shots wilkins --upper-m-s 900 --lower-m-s",
    ],
)
def test_numbers_that_no_table_has(cli, words: str, number: str, folder: Path):
    [line] = cli.fails(2, *words.split(), number)
    option = words.split()[-1]
    assert line.startswith(f"command line: {option}: must be ")
    assert f'found the text "{number}"' in line or (option, number) == ("--confidence", "700%")
    assert not list(folder.iterdir())


def test_a_scenario_without_its_ending(cli, folder: Path):
    (folder / "mine.toml").write_text((SCENARIOS / "wilkins.toml").read_text())
    assert cli.fails(2, "check", "mine") == [
        'mine: cannot be read: no such file or directory; did you mean "mine.toml"?'
    ]


@pytest.mark.usefixtures("folder")
def test_a_pipe_with_a_mistake_is_not_opened_again():
    """The message has no line, for which the program would wait for ever."""
    Path("a.toml").symlink_to("/dev/stdin")
    command = [sys.executable, "-m", "armour", "simulate", "a.toml"]
    text = (SCENARIOS / "wilkins.toml").read_text().replace("800.0", "-800.0")
    done = subprocess.run(command, input=text, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (2, "a.toml: impact.velocity_m_s: must be at least 10, found -800.0\n")
