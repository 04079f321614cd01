"""The installed command as a process of its own."""

import codecs
import os
import subprocess
import sys
from pathlib import Path

import pytest

from armour import MODEL_VERSION, __version__
from armour.cli.streams import plain
from tests.helpers.commands import IN_A_ROW

pytestmark = pytest.mark.slow

# Imported by no command but those that plot or keep a history.
HEAVY = ["matplotlib", "numpy", "scipy"]
# Imported by no command but those that answer these questions.
OTHERS = ["armour.statistics.calibration", "armour.validation.validate", "armour.design.optimise"]


def process(*args: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *map(str, args)]
    return subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)


def test_python_m():
    assert process("-m", "armour", "--version").stdout == f"armour {__version__}, model {MODEL_VERSION}\n"


@pytest.mark.parametrize(
    ("args", "not_needed"),
    [
        (["--help"], HEAVY),
        (["simulate", "wilkins"], ["matplotlib", *OTHERS]),
        (["library"], HEAVY + OTHERS),
    ],
)
def test_nothing_is_imported_before_it_is_needed(args: list[object], not_needed: list[str]):
    code = f"""
import sys
sys.argv = ["armour", *{[str(arg) for arg in args]!r}]
from armour.cli.main import main
try:
    main()
except SystemExit as end:
    assert not end.code
print([name for name in {not_needed!r} if name in sys.modules], file=sys.stderr)
"""
    assert process("-c", code).stderr.splitlines()[-1] == "[]"


def piped(args: str) -> tuple[int, str, str]:
    """Exit code, output and messages of a command whose reader takes one line and goes."""
    # The reader waits for the first block, so that the command finds the pipe closed at the next one.
    reader = f"{sys.executable} -c 'import sys; print(sys.stdin.readline(), end=str())'"
    command = f"{sys.executable} -u -m armour {args} | {reader}; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def test_a_reader_that_goes_away_costs_no_file_no_warning_and_no_exit_code(folder: Path):
    code, output, messages = piped("check uncertain --csv h.csv --set impact.velocity_m_s=850")
    assert (code, output.count("\n")) == (3, 1)
    wrote, warning, *_ = messages.splitlines()
    assert (wrote, (folder / "h.csv").exists(), warning[:9]) == ("wrote h.csv", True, "warning: ")


@pytest.mark.parametrize("number", ["SIGINT", "SIGTERM"])
def test_interrupted_or_terminated_while_it_starts(number: str):
    code = f"""
import os, signal, sys
class Interrupt:
    def find_spec(self, name, *_):
        if name == "armour.cli.app":
            os.kill(os.getpid(), signal.{number})
from armour.cli.main import main
sys.meta_path.insert(0, Interrupt())
sys.argv = ["armour", "simulate", "wilkins"]
main()
"""
    done = process("-c", code)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")


def test_an_encoding_without_rules_or_units(tmp_path: Path):
    lines = [sys.executable, "-c", IN_A_ROW, "check oblique", "check é°─Ω"]
    environment = {**os.environ, "PYTHONIOENCODING": "cp437"}
    done = subprocess.run(lines, capture_output=True, cwd=tmp_path, check=False, env=environment)
    shown, said = done.stdout.decode("cp437"), done.stderr.decode("cp437")
    assert "\né°─Ω: cannot be read" in said
    assert any(line and set(line) == {"─"} for line in shown.splitlines())
    assert " 30° " in shown


def test_every_encoding_has_characters_for_what_is_printed():
    codecs.register_error("plain", plain)
    sessions = "".join(path.read_text(encoding="utf-8") for path in (Path(__file__).parent / "golden").iterdir())
    special = "".join(character for character in {*sessions} if not character.isascii())
    for encoding in ("ascii", "cp437", "cp850", "cp932", "cp1252", "latin-1", "utf-16"):
        assert not {*"?\\"} & {*special.encode(encoding, "plain").decode(encoding)}, encoding


def test_numbers_do_not_depend_on_the_threads_of_the_linear_algebra(cli, monkeypatch: pytest.MonkeyPatch):
    plan = ("plan", "shots", "wilkins", "--json")
    here = os.environ["OPENBLAS_NUM_THREADS"]
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2" if here == "1" else "1")
    assert process("-m", "armour", *plan).stdout == cli(*plan).stdout != ""


@pytest.mark.parametrize("time", ["", "abc", "99999999999999"])
def test_a_wrong_time_in_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, time: str):
    """On which libraries that draw fail."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", time)
    for words in (
        ["simulate", "wilkins", "--plot", tmp_path / "a.svg"],
        ["report", "wilkins", "-o", tmp_path / "a.html"],
    ):
        done = process("-m", "armour", *words)
        assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr
