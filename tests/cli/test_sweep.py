import csv
import json
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from armour.cli.sweeping import ANSWERED
from armour.sweeps.tables import read_table
from tests.helpers.cases import SCENARIOS

pytestmark = pytest.mark.slow

WILKINS = SCENARIOS / "wilkins.toml"
CERAMIC = "armour.ceramic_thickness_mm"
OVER = ("--over", "armour.ceramic_thickness_mm=6.35")


@pytest.mark.usefixtures("drawn")
def test_a_grid_as_csv_with_a_map(cli, folder: Path):
    over = ["--over", f"{CERAMIC}=5:8:1", "--over", "armour.backing_thickness_mm=5,6.35"]
    result = cli("sweep", WILKINS, *over, "-o", "t.csv", "--plot", "t.svg")
    assert result.exit_code == 0
    assert "600.991" in result.stdout  # few rows are shown
    assert result.stderr.splitlines() == ["wrote t.csv: 8 rows", "wrote t.svg"]
    with (folder / "t.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row[CERAMIC] for row in rows] == [str(float(c)) for c in (5, 5, 6, 6, 7, 7, 8, 8)]
    limits = [float(row["ballistic_limit_m_s"]) for row in rows]
    assert limits == sorted(limits[::2] + limits[1::2], key=limits.index)
    svg = (folder / "t.svg").read_text()
    assert "ballistic limit, m/s" in svg
    assert not (folder / "t.csv.parts").exists()


def test_without_a_file_the_answers_are_printed(cli, folder: Path):
    result = cli("sweep", WILKINS, "--over", f"{CERAMIC}=6.35,8", "--set", "impact.velocity_m_s=750")
    header, _, *rows = result.stdout.splitlines()
    assert header.split("  ")[0] == "tile thickness, mm"
    assert [row.split()[-1] for row in rows] == ["FAILS", "stop"]
    assert "limit, m/s  stops  verdict" in header
    [untested, mark] = cli("sweep", WILKINS, *OVER, "--set", 'armour.ceramic="SiC"').stdout.splitlines()[2:]
    assert re.search(r" \d+\*  +not known  stopped by the model  SiC$", untested)
    assert mark == "* by the model, without tests"
    assert not list(folder.iterdir())


def test_against_several_threats_only_the_verdict_is_printed(cli):
    result = cli("sweep", "oblique", "--over", "armour.backing_thickness_mm=8,16")
    assert [line.split() for line in result.stdout.splitlines()[2:]] == [["8", "FAILS"], ["16", "FAILS"]]
    assert "threat" not in result.stderr


def test_without_a_file_json_has_the_columns(cli):
    data = json.loads(cli("sweep", WILKINS, *OVER, "--json").stdout)
    assert [*data["columns"]][1:] == [*ANSWERED]
    assert data["columns"]["verdict"] == ["fails"]


@pytest.mark.parametrize(
    ("words", "found"),
    [
        (("--over", f"{CERAMIC}=6:8:0.001"), "--output: must be given for more than 1,000 rows, found 2,001"),
        ((*OVER, "--scheduler", "local"), "--scheduler: needs -o"),
    ],
)
def test_what_needs_a_file(cli, words: tuple[str, ...], found: str):
    assert cli.fails(2, "sweep", WILKINS, *words) == [f"command line: {found}"]


def test_interrupted_it_says_how_to_resume(cli, folder: Path, monkeypatch: pytest.MonkeyPatch):
    def interrupted(*_args, **_settings):
        raise KeyboardInterrupt

    monkeypatch.setattr("armour.sweeps.sweep.MAX_CHUNK", 2)
    command = ("sweep", WILKINS, "--over", "impact.velocity_m_s=700:900:50", "--quantities", "outcome", "-o", "t.csv")
    with monkeypatch.context() as patch:
        patch.setattr("armour.sweeps.store.Store.finish", interrupted)
        [line] = cli.fails(130, *command)
    assert line == "interrupted; 5 of 5 rows are done; repeat the same sweep to resume"
    result = cli(*command)
    resumed = "resuming t.csv.parts: 5 of 5 rows"
    assert (result.exit_code, result.stderr.splitlines()) == (0, [resumed, "wrote t.csv: 5 rows"])
    assert (folder / "t.csv").read_text().count("\n") == 6


def test_a_large_sweep_asks_before_it_starts(cli, folder: Path, monkeypatch: pytest.MonkeyPatch):
    over = (
        "--over",
        f"{CERAMIC}=2:12:2e-4",
        "--over",
        "armour.backing_thickness_mm=0.02:1000:0.02",
        "--over",
        "projectile.flow_stress_GPa=1,2,3,4",
    )
    [line] = cli.fails(2, "sweep", WILKINS, *over, "-o", "t.csv")
    assert re.match(r"sweep: 10,000,200,000 rows take about [\d,]+ (hours|days)", line)
    assert line.endswith("; add --yes to go on")
    assert list(folder.iterdir()) == []
    monkeypatch.setattr("armour.sweeps.sweep.LONG_S", 0.0)
    monkeypatch.setattr("armour.cli.sweeping.ANNOUNCED_S", 0.0)
    result = cli("sweep", WILKINS, *OVER, "-o", "t.csv", "--yes")
    assert result.stderr.splitlines() == ["1 row takes about 1 second", "wrote t.csv: 1 row"]
    for output in ((), ("-o", "u.csv", "--yes")):
        words = cli("sweep", WILKINS, "--over", f"{CERAMIC}=6:7:0.7", *output).stderr
        assert words.count("the last value is 6.7, ") == 1


KILLED = """
import os, signal
from armour.cli.main import main
from armour.sweeps import store, sweep

append = store.Store.append

def append_and_end(*args):
    append(*args)
    os.kill(os.getpid(), signal.SIGKILL)

sweep.MAX_CHUNK, store.Store.append = 10, append_and_end
main()
"""


def test_killed_it_goes_on_where_it_stopped(cli, folder: Path):
    over = ["--over", f"{CERAMIC}=2:12:0.5", "--over", "armour.backing_thickness_mm=4:8:2"]
    command = ["sweep", str(WILKINS), *over, "--quantities", "ballistic_limit_m_s"]
    done = subprocess.run([sys.executable, "-c", KILLED, *command, "-o", "t.csv"], check=False)
    assert done.returncode == -signal.SIGKILL
    assert (folder / "t.csv.parts" / "rows").exists()
    assert cli(*command, "-o", "t.csv").stderr.startswith("resuming t.csv.parts: 10 of 63 rows\n")
    assert cli(*command, "-o", "whole.csv").exit_code == 0
    assert (folder / "t.csv").read_bytes() == (folder / "whole.csv").read_bytes()
    assert (folder / "t.csv").read_bytes().count(b"\n") == 21 * 3 + 1


FORMULAS = ["=cmd|' /C calc'!A0", "+1", "@x", "-1", "'=y"]


def formulas_toml(folder: Path) -> Path:
    """Write a scenario whose library has ceramics that a spreadsheet takes for formulas."""
    entries = (f'[library.ceramic."{name}"]\nbased_on = "AD85"\n' for name in FORMULAS)
    path = folder / "formulas.toml"
    path.write_text(WILKINS.read_text() + "".join(entries))
    return path


def test_names_are_no_formulas_and_are_read_again(cli, folder: Path):
    scenario = formulas_toml(folder)
    # As a person writes them, but for the last name.
    cases = [f"{name},{number}" for number, name in enumerate([*FORMULAS[:-1], "''=y"], 5)]
    (folder / "cases.csv").write_text("\n".join([f"armour.ceramic,{CERAMIC}", *cases]))
    for source, output in (("cases.csv", "first.csv"), ("again.csv", "second.csv")):
        done = cli("sweep", scenario, "--cases", source, "--quantities", "residual_velocity_m_s", "-o", output)
        assert done.exit_code == 0, done.output
        with (folder / output).open(newline="") as file:
            rows = list(csv.reader(file))
        assert not [cell for cell, *_ in rows if cell[0] in "=+-@"]
        with (folder / "again.csv").open("w", newline="") as file:
            csv.writer(file).writerows(row[:2] for row in rows)
    assert (folder / "first.csv").read_bytes() == (folder / "second.csv").read_bytes()
    assert read_table(folder / "first.csv")["armour.ceramic"].tolist() == FORMULAS
