"""`armour plan shots`."""

import subprocess
import sys
from functools import wraps
from pathlib import Path
from typing import Any

import pytest

import armour

pytestmark = pytest.mark.slow

# A procedure that is computed soon.
PLAIN = ("plan", "shots", "wilkins", "f.csv", "--procedure", "up-and-down")


def rows(path: Path) -> list[str]:
    return path.read_text().splitlines()


def test_after_the_end_a_shot_needs_its_velocity(cli, folder: Path):
    (folder / "f.csv").write_text("velocity_m_s,result\n723,P\n770,C\n")
    options = ("plan", "shots", "wilkins", "f.csv", "--half-width-m-s", "90", "--result", "partial")
    assert cli.fails(2, *options) == ["command line: --velocity-m-s: must be given: no further shot was planned"]
    assert cli(*options, "--velocity-m-s", "740").exit_code == 0


def test_a_file_that_does_not_exist_yet_is_a_firing_without_shots(cli, folder: Path):
    first, without = cli(*PLAIN), cli("plan", "shots", "wilkins", *PLAIN[4:])
    assert "note: f.csv: no such file, so no shot has been fired; --result makes the file\n" in first.stderr
    assert first.stdout == without.stdout
    assert not (folder / "f.csv").exists()
    assert cli(*PLAIN, "--result", "P").exit_code == 0
    assert len(rows(folder / "f.csv")) == 2


def test_a_shot_without_its_velocity_has_the_planned_one_which_is_said(cli, folder: Path):
    said = cli(*PLAIN, "--result", "P").stderr
    [_header, shot] = rows(folder / "f.csv")
    assert f"note: f.csv: recorded the planned {shot.split(',')[1]} m/s, as --velocity-m-s was not given\n" in said
    assert "note: f.csv" not in cli(*PLAIN, "--result", "P", "--velocity-m-s", "730").stderr


@pytest.mark.parametrize(
    ("partial", "complete", "given"), [("P", "C", "cp"), ("PP", "CP", "cp"), ("pp", "cp", "Complete")]
)
def test_results_in_any_spelling_and_shots_that_repeat_others(
    cli, folder: Path, partial: str, complete: str, given: str
):
    (folder / "f.csv").write_text(f"velocity_m_s,result\n723,{partial}\n770,{complete}\n")
    assert cli(*PLAIN, "--result", given, "--velocity-m-s", "770").exit_code == 0
    assert rows(folder / "f.csv") == ["velocity_m_s,result", f"723,{partial}", *[f"770,{complete}"] * 2]


def test_a_shot_is_taken_back(cli, folder: Path):
    assert cli(*PLAIN, "--result", "P", "--velocity-m-s", "730").exit_code == 0
    before = (folder / "f.csv").read_text()
    planned = cli(*PLAIN).stdout
    assert cli(*PLAIN, "--result", "C", "--velocity-m-s", "755").exit_code == 0
    undone = cli(*PLAIN, "--undo")
    assert (undone.exit_code, undone.stdout) == (0, planned)
    assert "note: f.csv: removed line 3: 2,755,C," in undone.stderr
    assert (folder / "f.csv").read_text() == before
    assert cli(*PLAIN, "--undo").exit_code == 0
    assert cli.fails(2, *PLAIN, "--undo") == ["f.csv: must have a shot to take back, found none"]
    assert cli.fails(2, "plan", "shots", "wilkins", "--undo") == ["command line: --undo: needs SHOTS"]
    assert cli.fails(2, *PLAIN, "--undo", "--result", "P") == ["command line: --undo: cannot be combined with --result"]


def test_what_else_a_new_row_has_is_said(cli, folder: Path):
    (folder / "f.csv").write_text("Shot;V1 (m/s);V2 (m/s);Result;Fair hit\n1;722;722;PP;yes\n")
    added = "note: f.csv: added line 3: 2; 776; 776; CP; yes\n"
    assert added in cli(*PLAIN, "--result", "C", "--velocity-m-s", "776").stderr


def test_the_next_command_repeats_what_changes_the_question(cli, folder: Path):
    (folder / "f.csv").write_text("velocity_m_s,result,lot\n700,P,A\n730,C,A\n715,C,A\n720,P,A\n740,C,B\n")
    asked = "--requirement-m-s 700 --requirement-fraction 0.05 --confidence 0.9 --where lot=A"
    changed = "--set armour.ceramic_thickness_mm=8"
    told = cli("v50", "f.csv", "wilkins", *asked.split(), *changed.split()).stderr
    assert told.endswith(f"next: armour plan shots f.csv wilkins {asked} {changed}\n")
    asked, ended = "--confidence 0.5 --where lot=A", ["--half-width-m-s", "200"]
    told = cli("plan", "shots", "f.csv", "wilkins", *asked.split(), *ended).stderr
    assert told.endswith(f"next: armour v50 f.csv wilkins {asked}\n")
    assert "next:" not in cli("plan", "shots", "f.csv", "wilkins", "--where", "lot=B", *ended).stderr


def test_a_shot_at_another_armour_is_refused(cli, folder: Path):
    assert cli(*PLAIN, "--result", "P", "--velocity-m-s", "730").exit_code == 0
    before, other = (folder / "f.csv").read_text(), ("--set", "armour.ceramic_thickness_mm=8")
    assert before.endswith(",6.35 mm AD85 on 6.35 mm 6061-T6 against 7.62 mm AP\n")
    for words in (other, (*other, "--result", "P"), ("--set", "impact.projectile=12.7 mm APM2", "--result", "C")):
        [line] = cli.fails(2, *PLAIN, *words)
        assert line.startswith("f.csv: armour and round: must be the scenario's, ")
        assert line.endswith(", found 6.35 mm AD85 on 6.35 mm 6061-T6 against 7.62 mm AP")
    assert (folder / "f.csv").read_text() == before
    assert cli(*PLAIN, "--result", "C", "--velocity-m-s", "780").exit_code == 0
    assert "warning: f.csv, wilkins: armour and round: must be the" in cli("v50", *PLAIN[3:1:-1], *other).stderr


def test_a_save_between_reading_and_writing_stays(cli, folder: Path, monkeypatch: pytest.MonkeyPatch):
    table, saved = folder / "f.csv", "velocity_m_s,result\n723,P\n770,C\n741,P\n"
    table.write_text("velocity_m_s,result\n723,P\n770,C\n")
    plan_shots = armour.plan_shots

    @wraps(plan_shots)
    def plan(*args: Any, **kwargs: Any) -> Any:
        table.write_text(saved)
        return plan_shots(*args, **kwargs)

    monkeypatch.setattr(armour, "plan_shots", plan)
    options = (*PLAIN, "--plot", "p.svg", "--velocity-m-s", "750", "--result", "complete")
    result = cli(*options)
    assert result.exit_code == 2
    assert "f.csv: cannot be written: it has changed since it was read; repeat the command\n" in result.stderr
    assert table.read_text() == saved
    assert not (folder / "p.svg").exists()
    assert cli(*options).exit_code == 0
    assert table.read_text() == f"{saved}750,C\n"


def test_two_shots_at_once_are_both_there(folder: Path):
    command = [sys.executable, "-m", "armour", *PLAIN, "--result", "partial"]
    velocities = ("700", "710")
    started = [subprocess.Popen([*command, "--velocity-m-s", velocity], cwd=folder) for velocity in velocities]
    assert [process.wait() for process in started] == [0, 0]
    assert sorted(row.split(",")[1] for row in rows(folder / "f.csv")[1:]) == [*velocities]
