"""Outputs: each whole or not at all, never over what is read; streams that are closed or full."""

import csv
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from armour.errors import InputError, Problem
from armour.reporting.pictures import drawing
from armour.validation import figures
from tests.helpers.cases import SCENARIOS
from tests.helpers.commands import COMMAND, options_of

pytestmark = pytest.mark.slow

WILKINS, SHOTS = SCENARIOS / "wilkins.toml", SCENARIOS / "tests" / "shots.csv"
LIBRARY = '[ceramic."AD85, own"]\nbased_on = "AD85"\n'
OWN = WILKINS.read_text().replace('"AD85"', '"AD85, own"') + '\n[library]\nfiles = ["lib.toml"]\n'
SUITE = (
    'regression = true\n[[case]]\nname = "a"\nscenario = "own.toml"\nquantity = "outcome"\nexpected = "perforated"\n'
)


@pytest.fixture
def own(folder: Path) -> Path:
    """A folder with a scenario that names a library file, and a suite of it."""
    for name, text in (("lib.toml", LIBRARY), ("own.toml", OWN), ("suite.toml", SUITE)):
        (folder / name).write_text(text)
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_no_file_is_written_where_one_cannot_be_drawn(cli, own: Path, monkeypatch: pytest.MonkeyPatch):
    def fails(*_: object) -> bytes:
        raise InputError([Problem("p.svg", "", "cannot be drawn")])

    monkeypatch.setattr(drawing, "saved", fails)
    before = contents(own)
    result = cli("simulate", "own.toml", "--history", "h.csv", "--plot", "p.svg")
    assert (result.exit_code, result.stderr) == (2, "p.svg: cannot be drawn\n")
    assert "perforated" in result.stdout
    assert contents(own) == before


def test_a_file_that_cannot_be_written_is_told_after_the_answer(cli, own: Path, monkeypatch: pytest.MonkeyPatch):
    (own / "p.svg").write_text("old")
    sync, synced = os.fsync, []

    def fails_at_the_second(handle: int) -> None:
        synced.append(handle)
        if len(synced) == 2:
            raise OSError(28, "No space left on device")
        sync(handle)

    monkeypatch.setattr(os, "fsync", fails_at_the_second)
    result = cli("simulate", "own.toml", "--history", "h.csv", "--plot", "p.svg", "--force")
    assert result.exit_code == 2
    assert result.stderr == "wrote h.csv\np.svg: cannot be written: no space left on device\n"
    assert "perforated" in result.stdout
    assert (own / "p.svg").read_text() == "old"


@pytest.mark.parametrize(
    ("command", "read"),
    [
        ("calibrate {tests} own.toml --lot 7 --write lib.toml", "lib.toml"),
        ("validate suite.toml --markdown own.toml", "own.toml"),
        ("validate suite.toml --junit lib.toml", "lib.toml"),
        ("validate suite.toml --update --markdown own.toml", "own.toml"),
        ("simulate own.toml --history link.csv", "link.csv"),
        ("v50 {shots} own.toml --plot link.svg", "link.svg"),
        ("v50 hard.svg own.toml --plot hard.svg", "hard.svg"),
        ("sweep own.toml --cases link.csv -o link.csv", "link.csv"),
        ("sweep own.toml --over impact.velocity_m_s=800 -o link.csv", "link.csv"),
        ("report own.toml -o link.md", "link.md"),
    ],
)
def test_nothing_that_is_read_is_written_over(cli, own: Path, command: str, read: str):
    for name in ("link.svg", "link.csv", "link.md"):
        (own / name).symlink_to("lib.toml")
    (own / "hard.svg").hardlink_to(own / "own.toml")
    before = contents(own)
    words = shlex.split(f"{command} --force".format(tests=SCENARIOS / "tests" / "wilkins.csv", shots=SHOTS))
    assert cli.fails(2, *words) == [f"{read}: must not be the file that is read; choose another name"]
    assert contents(own) == before


def test_a_file_on_standard_input_is_not_written_over(own: Path):
    (own / "own.csv").symlink_to("own.toml")
    before = contents(own)
    code, messages = shell("simulate - --history own.csv --force < own.toml", own)
    assert (code, messages) == (2, "own.csv: must not be the file that is read; choose another name\n")
    assert contents(own) == before


WRITING = [
    "simulate own.toml --history {0} --plot {1}",
    "ballistic-limit own.toml --plot {1}",
    "optimise own.toml --csv {0} --plot {1}",
    "sensitivity own.toml --plot {1}",
    "uncertainty own.toml --plot {1}",
    "calibrate {tests} own.toml --lot 7 --write {0} --write-scenario {1}",
    "v50 {shots} own.toml --csv {0} --plot {1}",
    "check own.toml --csv {0} --plot {1}",
    "report own.toml -o {2}",
    "validate suite.toml --markdown {0} --junit {1}",
    "sweep own.toml --over impact.velocity_m_s=800 -o {0} --plot {1}",
    "figures figs --only fig09",
    "init {3}",
    "plan shots own.toml --plot {1}",
]


def test_every_command_that_writes_files_is_tried():
    writing = [command for command, options in options_of(COMMAND) if "--force" in options]
    assert [command for command in writing if not any(line.startswith(command) for line in WRITING)] == []


@pytest.mark.parametrize("command", WRITING)
def test_nothing_is_replaced_unasked(cli, own: Path, command: str, monkeypatch: pytest.MonkeyPatch):
    def writes(*_: object, **_settings: object) -> None:
        raise AssertionError("written though it is there")

    monkeypatch.setattr("armour.cli.runner.write_file", writes)
    (own / "figs").mkdir()
    names = ["old.csv", "old.svg", "old.md", "old.toml", "figs/fig09.csv", "figs/fig09.png"]
    for name in names:
        (own / name).write_text("old")
    line = command.format(*names, tests=SCENARIOS / "tests" / "wilkins.csv", shots=SHOTS)
    written = [name for name in names if name in line or ("figures" in line and "fig09" in name)]
    told = [f"{name}: exists already; choose another name, or --force" for name in written]
    assert cli.fails(2, *shlex.split(line)) == told
    assert [(own / name).read_text() for name in names] == ["old"] * 6


@pytest.mark.parametrize(
    ("words", "columns", "rows"),
    [
        ("v50 {shots}", "curve,v50_m_s,v50_interval_low_m_s,v50_interval_high_m_s,scale_m_s", 4),
        ("calibrate {tests} own.toml", "test,quantity,measured,computed,left_out,bound,uncertainty", 13),
        (
            "check own.toml",
            "scenario,threat,verdict,change,velocity_m_s,ballistic_limit_m_s,expected_limit_m_s,interval_low_m_s",
            5,
        ),
        ("check own.toml wilkins", "scenario,threat,verdict,change,velocity_m_s", 10),
    ],
)
def test_the_rows_of_a_result_are_written(cli, own: Path, words: str, columns: str, rows: int):
    tests = SCENARIOS / "tests" / "wilkins.csv"
    cli(*words.format(tests=tests, shots=SHOTS).split(), "--csv", "rows.csv")
    header, *lines = (own / "rows.csv").read_text().splitlines()
    assert header.startswith(columns)
    assert len(lines) == rows
    assert all(len(line) == len(header.split(",")) for line in csv.reader(lines))


@pytest.mark.parametrize("words", ["check own.toml --junit -", "simulate own.toml --history -", "init -"])
def test_standard_output_is_no_file(cli, own: Path, words: str):
    assert cli.fails(2, *words.split()) == ["-: must be the name of a file to write"]
    assert not (own / "-").exists()


def test_streams_and_pipes_are_no_files_to_keep(cli, own: Path):
    assert cli("simulate", "own.toml", "--history", "h.csv").exit_code == 0
    assert (
        shell("simulate own.toml --history /dev/stderr", own)[1] == (own / "h.csv").read_text() + "wrote /dev/stderr\n"
    )
    os.mkfifo(own / "pipe")
    reader = subprocess.Popen(["cat", "pipe"], stdout=subprocess.PIPE, text=True, cwd=own)
    assert cli("simulate", "own.toml", "--history", "pipe").stderr == "wrote pipe\n"
    assert reader.communicate()[0] == (own / "h.csv").read_text()


def test_figures_that_fail_leave_no_folder(cli, folder: Path, monkeypatch: pytest.MonkeyPatch):
    def fails(*_: object) -> None:
        raise InputError([Problem("fig09", "", "fails")])

    monkeypatch.setattr(figures, "compute_figure", fails)
    assert cli.fails(2, "figures", "new/figs", "--only", "fig09") == ["fig09: fails"]
    assert not list(folder.iterdir())


def test_a_long_list_of_mistakes_is_cut(cli, folder: Path):
    (folder / "a.toml").write_text(WILKINS.read_text() + "".join(f"[x{number}]\n" for number in range(332)))
    lines = cli.fails(2, "simulate", "a.toml")
    assert (len(lines), lines[-1]) == (21, "and 312 more problems")


def shell(command: str, folder: Path) -> tuple[int, str]:
    """Exit code and messages of a command line after the program's name, with redirections."""
    line = f"{shlex.quote(sys.executable)} -m armour {command.format(wilkins=WILKINS)}"
    done = subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False, cwd=folder)
    return done.returncode, done.stderr


def test_an_answer_that_cannot_be_shown(folder: Path):
    code, messages = shell("simulate {wilkins} > /dev/full", folder)
    assert (code, messages) == (2, "standard output: cannot be written: no space left on device\n")


def test_closed_streams(folder: Path):
    assert shell("simulate {wilkins} --history h.csv >&- 2>&-", folder) == (0, "")
    assert (folder / "h.csv").read_text().startswith("time_us,")
    assert shell("simulate nothing.toml 2>&-", folder) == (2, "")
    code, messages = shell("simulate - <&-", folder)
    assert (code, messages.partition(",")[0]) == (2, "standard input: impact: is missing and must be given")


def test_a_file_name_that_is_no_text(cli, folder: Path):
    name = os.fsdecode(b"w\xff.toml")
    (folder / name).write_text("x = 1\n" + WILKINS.read_text())
    [line] = cli.fails(2, "simulate", name)
    assert line.startswith("w\\udcff.toml: x: unknown key; choose from title, ")
    assert line.endswith(" (line 1)")
    (folder / name).write_text(WILKINS.read_text())
    assert cli("report", name, "-o", "r.md").exit_code == 0
    assert "armour report 'w\\udcff.toml' -o r.md" in (folder / "r.md").read_text()
    (folder / "suite.toml").write_text(SUITE.replace("own", "wilkins"))
    (folder / "suite.toml").rename(folder / name.replace("w", "s"))
    (folder / "wilkins.toml").write_text(WILKINS.read_text())
    assert json.loads(cli("validate", name.replace("w", "s"), "--json").stdout)["suite"] == name.replace("w", "s")


@pytest.mark.parametrize("name", ["x\n::error::y", "##vso[x]y", "\x1b[31mx"])
def test_no_name_of_a_file_is_a_command_of_a_log(cli, folder: Path, name: str):
    path = f"{name}.toml"
    (folder / "a.toml").write_text(WILKINS.read_text().replace("title = ", 'title = "::error::z" # '))
    (folder / "t.csv").write_text("velocity_m_s,result\n700,P\n720,C\n")
    (folder / f"{name}.csv").write_text((folder / "t.csv").read_text())
    done = [
        cli("check", path),
        cli("init", path),
        cli("check", path),
        cli("simulate", "a.toml", "--history", f"h{name}.csv"),
        cli("validate", path),
        cli("v50", f"{name}.csv", "--csv", "v.csv"),
        cli("ballistic-limit", path, "--json"),
        cli("library", name),
        cli("check", ".", "--junit", "j.xml"),
    ]
    for result in done:
        for line in (result.stdout + result.stderr).split("\n"):
            assert not line.lstrip().startswith("::"), line
            assert not re.search(r"##(\[|vso\[)", line), line
            assert line.isprintable(), line
    assert json.loads(done[6].stdout)["made_by"]["command"].startswith("armour ballistic-limit ")
    told = (folder / "j.xml").read_text()
    assert not re.search(r"(?m)^\s*::", told)


@pytest.mark.parametrize("name", ["x\n::error::y", "\x1b[31mx", "it's", os.fsdecode(b"w\xff"), "-x"])
def test_a_proposed_command_names_the_file(cli, folder: Path, name: str):  # noqa: ARG001 (the current one)
    if shutil.which("bash") is None:
        pytest.skip("needs bash")
    command = cli("init", "--", f"{name}.toml").stderr.rpartition("next: ")[2]
    words = subprocess.run(["bash", "-c", f"printf '%s\\0' {command}"], capture_output=True, check=True).stdout
    armour, check, file, end = words.split(b"\0")
    assert (armour, check, end) == (b"armour", b"check", b"")
    assert os.path.normpath(os.fsdecode(file)) == f"{name}.toml"
