"""`armour plan shots`."""

import json
import subprocess
import sys
from functools import wraps
from pathlib import Path
from typing import Any

import pytest

import armour
from armour.cli.app import COMMANDS
from armour.cli.experiments import plan_shots as command

NEXT = "next velocity"


def rows(path: Path) -> list[str]:
    return path.read_text().splitlines()


def test_a_firing_is_recorded_shot_by_shot(cli, folder: Path):
    first = cli("plan", "shots", "wilkins")
    assert first.exit_code == 0, first.output
    planned = float(next(line for line in first.stdout.splitlines() if NEXT in line).split()[-2])
    second = cli("plan", "shots", "wilkins", "f.csv", "--result", "partial")
    assert second.stderr == "wrote f.csv\n"
    assert rows(folder / "f.csv") == ["shot,velocity_m_s,result", f"1,{planned:g},partial"]
    third = cli("plan", "shots", "wilkins", "f.csv", "--result", "complete", "--velocity-m-s", "774.2", "--json")
    assert rows(folder / "f.csv")[2:] == ["2,774.2,complete"]
    found = json.loads(third.stdout)
    assert found["fired"]["velocities_m_s"] == [planned, 774.2]
    # Without a result the file stays, and the plan is the same.
    again = cli("plan", "shots", "wilkins", "f.csv", "--json")
    assert json.loads(again.stdout) == found
    assert len(rows(folder / "f.csv")) == 3


def test_the_examples_of_the_help_run(cli, folder: Path):
    assert folder.is_dir()
    for example in COMMANDS[command]:
        # The documentation draws a plan.
        assert cli(*example.replace("--plot plan.svg", "--half-width-m-s 60").split()).exit_code == 0


def test_tables(cli, folder: Path):
    (folder / "f.csv").write_text("velocity_m_s,result\n723,P\n770,C\n")
    shown = cli("plan", "shots", "wilkins", "f.csv", "--requirement-m-s", "700").stdout
    for line in (
        "required of the V50",
        "probability that it is met",
        "prior",
        "posterior",
        "error of the model: ± 7.0 %",
    ):
        assert line in shown
    classic = cli("plan", "shots", "wilkins", "f.csv", "--procedure", "neyer", "--lower-m-s=600", "--upper-m-s=900")
    assert "limits of V50" in classic.stdout
    assert "600.0 to 900.0 m/s" in classic.stdout


def test_a_simulation(cli, folder: Path):
    options = (
        "--simulate",
        "--true-v50-m-s",
        "770",
        "--true-scatter-m-s",
        "15",
        "--half-width-m-s",
        "40",
        "--seed",
        "2",
    )
    shown = cli("plan", "shots", "wilkins", *options)
    assert "V50 simulated" in shown.stdout
    assert "the interval of V50 is within ± 40 m/s" in shown.stdout
    assert shown.stdout == cli("plan", "shots", "wilkins", *options).stdout
    assert not list(folder.iterdir())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["wilkins", "none.csv"], "none.csv: cannot be read: no such file"),
        (["wilkins", "--result", "partial"], "command line: --result: adds a shot to SHOTS, which is not given"),
        (["wilkins", "f.csv", "--velocity-m-s", "700"], "command line: --velocity-m-s: is the velocity of the shot of"),
        (
            ["wilkins", "f.csv", "--result", "partial", "--velocity-m-s", "nan"],
            "command line: --velocity-m-s: must be near",
        ),
        (["wilkins", "f.csv", "--lower-m-s", "600"], "command line: --upper-m-s: must be given with the other limit"),
        (["wilkins", "f.csv", "--half-width-m-s", "0"], "command line: --half-width-m-s: must be at least 0.1"),
        (["wilkins", "bad.csv", "--result", "partial"], 'bad.csv: line 2: result: must be "partial" or "complete"'),
        (
            ["wilkins", "f.csv", "--result", "partial", "--velocity-m-s", "7410"],
            "command line: --velocity-m-s: must be",
        ),
        (["wilkins", "f.csv", "--result", "partial", "--simulate"], "command line: --result: is of a shot that was"),
        (
            ["wilkins", "--procedure", "neyer", "--lower-m-s", "900", "--upper-m-s", "700"],
            "command line: --lower-m-s, --upper-m-s: must rise, found 900 and 700",
        ),
        (["wilkins", "--simulate", "--true-v50-m-s", "700"], "command line: --true-scatter-m-s: must be given, as"),
        (["wilkins", "--seed", "4"], "command line: --seed: must not be given without simulating"),
        (["nowhere/f.toml"], "nowhere/f.toml: cannot be read"),
        (["wilkins", "f.csv", "--result", "partial", "--plot", "f.csv"], "f.csv: must end in .png, .svg or .pdf"),
    ],
)
def test_wrong_input(cli, folder: Path, arguments: list[str], message: str):
    (folder / "f.csv").write_text("velocity_m_s,result\n723,P\n")
    (folder / "bad.csv").write_text("velocity_m_s,result\n723,stopped\n")
    assert cli.fails(2, "plan", "shots", *arguments)[0].startswith(message)
    assert (folder / "f.csv").read_text() == "velocity_m_s,result\n723,P\n"


def test_after_the_end_a_shot_needs_its_velocity(cli, folder: Path):
    (folder / "f.csv").write_text("velocity_m_s,result\n723,P\n770,C\n")
    options = ("plan", "shots", "wilkins", "f.csv", "--half-width-m-s", "90", "--result", "partial")
    assert cli.fails(2, *options) == ["command line: --velocity-m-s: must be given: no further shot was planned"]
    assert cli(*options, "--velocity-m-s", "740").exit_code == 0


def test_an_armour_without_a_known_error(cli, folder: Path):
    assert folder.is_dir()
    [line] = cli.fails(
        2, "plan", "shots", "wilkins", "--set", "armour.backing=Ti-6Al-4V", "--set", "armour.ceramic=SiC"
    )
    assert "uncertainty.model: must give scale_percent for a prior: the model was compared with no test" in line


@pytest.mark.parametrize(
    ("partial", "complete", "given"), [("P", "C", "cp"), ("PP", "CP", "cp"), ("pp", "cp", "Complete")]
)
def test_results_in_any_spelling_and_shots_that_repeat_others(
    cli, folder: Path, partial: str, complete: str, given: str
):
    (folder / "f.csv").write_text(f"velocity_m_s,result\n723,{partial}\n770,{complete}\n")
    for result in (given, "C"):
        assert cli("plan", "shots", "wilkins", "f.csv", "--result", result, "--velocity-m-s", "770").exit_code == 0
    assert rows(folder / "f.csv") == [
        "shot,velocity_m_s,result",
        f"1,723,{partial}",
        *(f"{shot},770,{complete}" for shot in (2, 3, 4)),
    ]


def test_a_save_between_reading_and_writing_stays(cli, folder: Path, monkeypatch: pytest.MonkeyPatch):
    table, saved = folder / "f.csv", "velocity_m_s,result\n723,P\n770,C\n741,P\n"
    table.write_text("velocity_m_s,result\n723,P\n770,C\n")
    plan_shots = armour.plan_shots

    @wraps(plan_shots)
    def plan(*args: Any, **kwargs: Any) -> Any:
        table.write_text(saved)
        return plan_shots(*args, **kwargs)

    monkeypatch.setattr(armour, "plan_shots", plan)
    options = ("plan", "shots", "wilkins", "f.csv", "--plot", "p.svg", "--velocity-m-s", "750", "--result", "complete")
    result = cli(*options)
    assert result.exit_code == 2
    assert "f.csv: cannot be written: it has changed since it was read; repeat the command\n" in result.stderr
    assert table.read_text() == saved
    assert not (folder / "p.svg").exists()
    assert cli(*options).exit_code == 0
    assert table.read_text() == f"{saved}750,C\n"


def test_two_shots_at_once_are_both_there(folder: Path):
    command = [sys.executable, "-m", "armour", "plan", "shots", "wilkins", "f.csv", "--result", "partial"]
    velocities = ("700", "710")
    started = [subprocess.Popen([*command, "--velocity-m-s", velocity], cwd=folder) for velocity in velocities]
    assert [process.wait() for process in started] == [0, 0]
    assert sorted(row.split(",")[1] for row in rows(folder / "f.csv")[1:]) == [*velocities]


def test_a_shipped_table_is_not_taken_for_the_firing(cli, folder: Path):
    assert folder.is_dir()
    [line] = cli.fails(2, "plan", "shots", "wilkins", "shots.csv")
    assert line.startswith("shots.csv: cannot be read: no such file")


def test_a_shot_far_from_its_plan_is_warned_of(cli, folder: Path):
    options = ("plan", "shots", "wilkins", "f.csv", "--result", "partial", "--velocity-m-s")
    assert "far from" not in cli(*options, "700").stderr
    assert "the shot, at 850 m/s, is far from the planned velocity, 7" in cli(*options, "850").stderr
    assert len(rows(folder / "f.csv")) == 3
