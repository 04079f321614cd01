import csv
import json
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.quantities import QUANTITIES
from armour.cli.sweeping import ANSWERED
from armour.scenario.scenario import load_scenario
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
    warning, *wrote = result.stderr.splitlines()
    assert "0.89 penetrator diameters, was tested" in warning
    assert wrote == ["wrote t.csv: 8 rows", "wrote t.svg"]
    with (folder / "t.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row[CERAMIC] for row in rows] == [str(float(c)) for c in (5, 5, 6, 6, 7, 7, 8, 8)]
    limits = [float(row["ballistic_limit_m_s"]) for row in rows]
    assert limits == sorted(limits[::2] + limits[1::2], key=limits.index)
    svg = (folder / "t.svg").read_text()
    assert "ballistic limit, m/s" in svg
    assert "kg/m²" in svg
    assert not (folder / "t.csv.parts").exists()


@pytest.mark.parametrize(
    "over", [(f"{CERAMIC}=6,7",), (f"{CERAMIC}=6,7", "armour.backing_thickness_mm=5,6")], ids=["curve", "map"]
)
@pytest.mark.usefixtures("folder")
def test_a_picture_of_no_number_says_so(cli, over: tuple[str, ...]):
    grid = [word for values in over for word in ("--over", values)]
    slow = ("--set", "ballistic_limit.velocity_max_m_s=100")
    result = cli("sweep", WILKINS, *grid, *slow, "-o", "t.csv", "--plot", "t.svg")
    assert result.exit_code == 0
    assert result.stderr.splitlines()[-1] == "wrote t.svg"
    rows = 2 ** len(over)
    assert f"{rows} of {rows} rows have no ballistic limit." in Path("t.svg").read_text()


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
        ((*OVER, "--scheduler", "local"), "--scheduler: must be given with -o"),
    ],
)
def test_what_needs_a_file(cli, words: tuple[str, ...], found: str):
    assert cli.fails(2, "sweep", WILKINS, *words) == [f"command line: {found}"]


@pytest.mark.parametrize("output", [".", "/"])
@pytest.mark.usefixtures("folder")
def test_a_folder_is_no_table(cli, output: str):
    assert cli.fails(2, "sweep", WILKINS, *OVER, "-o", output) == [f"{output or '.'}: cannot be written: is a folder"]


def test_interrupted_it_says_how_to_resume(cli, folder: Path, monkeypatch: pytest.MonkeyPatch):
    def interrupted(*_args, **_settings):
        raise KeyboardInterrupt

    monkeypatch.setattr("armour.sweeps.sweep.MAX_CHUNK", 2)
    command = ("sweep", WILKINS, "--over", "impact.velocity_m_s=700:900:50", "--quantities", "outcome", "-o", "t.csv")
    with monkeypatch.context() as patch:
        patch.setattr("armour.sweeps.store.Store.finish", interrupted)
        [line] = cli.fails(130, *command)
    assert line == "interrupted; 5 of 5 rows are done; repeat the same sweep to resume"
    with (folder / "t.csv.parts" / "rows").open("r+b") as rows:
        rows.write(b"no database")
    result = cli(*command)
    damaged = "t.csv.parts/rows: damaged, all rows are computed again"
    assert (result.exit_code, result.stderr.splitlines()) == (0, [damaged, "wrote t.csv: 5 rows"])
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
    assert re.match(r"sweep: 10,000,200,000 rows; about [\d,]+ (hours|days)", line)
    assert line.endswith("; --yes to go on")
    assert list(folder.iterdir()) == []
    monkeypatch.setattr("armour.sweeps.sweep.LONG_S", 0.0)
    monkeypatch.setattr("armour.cli.runner.ANNOUNCED_S", 0.0)
    result = cli("sweep", WILKINS, *OVER, "-o", "t.csv", "--yes")
    assert result.stderr.splitlines() == ["1 row; about 1 second", "wrote t.csv: 1 row"]


def test_the_help_lists_every_quantity(cli):
    text = " ".join(cli("sweep", "--help").stdout.split()).replace("│ │", "")
    assert [name for name in QUANTITIES if name not in text] == []


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
    assert re.match(
        r"resuming t\.csv\.parts, written \d+ seconds? ago: 10 of 63 rows\n", cli(*command, "-o", "t.csv").stderr
    )
    assert cli(*command, "-o", "whole.csv").exit_code == 0
    assert (folder / "t.csv").read_bytes() == (folder / "whole.csv").read_bytes()
    assert (folder / "t.csv").read_bytes().count(b"\n") == 21 * 3 + 1


def test_materials_and_projectiles_by_name(cli, folder: Path):
    header, rows = (
        "armour.ceramic,ceramic.flow_stress_GPa,armour.backing,impact.projectile",
        ("AD85,5.2,6061-T6,7.62 mm AP", "AD99.5,5.9,5083-H3,7.62 mm APM2", "AD85,5.3,6061-T6,7.62 mm AP"),
    )
    (folder / "c.csv").write_text("\n".join((header, *rows)))
    assert cli("sweep", WILKINS, "--cases", "c.csv", "-o", "t.csv").exit_code == 0
    with (folder / "t.csv").open() as file:
        found = list(csv.DictReader(file))
    for row in found:
        limit = float(row.pop("ballistic_limit_m_s"))
        case = load_scenario(WILKINS, {**row, "ceramic.flow_stress_GPa": float(row["ceramic.flow_stress_GPa"])})
        assert ballistic_limit(case).ballistic_limit_m_s == limit
    (folder / "c.csv").write_text("\n".join((header, *rows, "AD85,5.2,6061-T7,7.62 mm AP")))
    [line] = cli.fails(2, "sweep", WILKINS, "--cases", "c.csv", "-o", "u.csv")
    assert line.startswith(
        'c.csv: line 5: armour.backing: must name a metal of the library, found "6061-T7"; choose from 6061-T6 '
    )


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


def test_a_wrong_row_of_cases_has_its_line(cli, folder: Path):
    keys = "projectile.penetrator_diameter_mm,projectile.penetrator_mass_g"
    (folder / "c.csv").write_text(f"{keys}\n6.5,5.46\n\n65,5460\n0.65,5.46\n")
    [line] = cli.fails(2, "sweep", WILKINS, "--cases", "c.csv", "-o", "t.csv")
    assert line.startswith("c.csv: line 5: projectile.penetrator_mass_g: must make a rod")
    (folder / "c.csv").write_text(f"{keys}\n6.5,5.46\n65,5460\n0.65,0.00546\n")
    assert cli("sweep", WILKINS, "--cases", "c.csv", "--quantities", "outcome", "-o", "t.csv").exit_code == 0
