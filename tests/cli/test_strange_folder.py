"""A folder of a stranger: whatever lies in it, no command runs, obeys or overwrites anything."""

import os
import re
import shlex
import sqlite3
import struct
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from tests.helpers.cases import SCENARIOS
from tests.helpers.commands import run_in_a_row

ROOT = SCENARIOS.parent
COMMANDS = Path(sys.executable).parent
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (COMMANDS / "armour").exists(), reason="needs the installed command, and links"),
]

MODULES = (
    *("armour", "dask", "matplotlib", "multiprocessing", "numpy", "pip", "sitecustomize"),
    *("typing_extensions", "usercustomize", "yaml"),
)
SECRET = "user:secret"
# A bare plate, which fails.
SCENARIO = (SCENARIOS / "bare_plate.toml").read_text()
OPTION = "--set=armour.backing_thickness_mm=300 #.toml"

ANSWERED = (
    "simulate wilkins --history history.csv --plot run.svg",
    "optimise wilkins --csv front.csv",
    "report bare_plate -o report.html",
    "figures figures --only fig09",
    "v50 tests/shots wilkins",
    "calibrate tests/wilkins wilkins --write mine.toml --lot 7",
    "init new.toml",
    "library AD85",
)
REFUSED = (
    "simulate leak.toml",
    "ballistic-limit wilkins --plot link.svg",
    "sweep wilkins --over armour.ceramic_thickness_mm=4:8:1 -o journal.csv",
    "sweep wilkins --over armour.ceramic_thickness_mm=4:8:1 -o link.csv",
    "validate suite.toml",
    "validate tests.toml",
    "plan shots wilkins firing.csv --result complete",
)


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """The user's home, with a file of hers."""
    home = tmp_path / "home"
    home.mkdir()
    (home / "keys").write_text(SECRET)
    with closing(sqlite3.connect(home / "database")) as database, database:
        database.execute("create table bookmarks (name)")
    return home


@pytest.fixture
def ran(tmp_path: Path) -> Path:
    """A folder that gets a file from whatever is run."""
    ran = tmp_path / "ran"
    ran.mkdir()
    return ran


@pytest.fixture
def here(tmp_path: Path, home: Path, ran: Path) -> Path:
    """The stranger's folder, in which she works."""
    here = tmp_path / "here"
    here.mkdir()
    for name in MODULES:
        (here / f"{name}.py").write_text(f"open({str(ran / name)!r}, 'w')\n")
    keys = home / "keys"
    case = '[[case]]\nname = "a"\nscenario = "{}"\nquantity = "outcome"\nexpected = "perforated"\n'
    table = '[[table]]\nname = "a"\nscenario = "plate.toml"\nquantity = "ballistic_limit_m_s"\nfile = "{}"\n'
    texts = {
        ".env": "PYTHONPATH=.\n",
        ".coveragerc": "[run]\nplugins = pip\n",
        "matplotlibrc": "backend: module://pip\n",
        "pyproject.toml": '[tool.coverage.run]\nplugins = ["pip"]\n[build-system]\nrequires = ["pip"]\n',
        "pytest.ini": "[pytest]\naddopts = -p pip\n",
        "setup.cfg": "[tool:pytest]\naddopts = -p pip\n",
        "plate.toml": SCENARIO,
        OPTION: SCENARIO,
        "--help": SCENARIO,
        "leak.toml": f'{SCENARIO}\n[library]\nfiles = ["{keys}"]\n',
        "suite.toml": case.format(keys),
        "own.toml": f"regression = true\n{case.format('plate.toml')}",
        "tests.toml": table.format(keys),
        "firing.csv": "velocity_m_s,result\n700,stopped\n",
    }
    for name, text in texts.items():
        (here / name).write_text(text)
    (here / "link.svg").symlink_to(keys)
    (here / ".firing.csv.lock").symlink_to(keys)
    put_stores(here, home)
    return here


def put_stores(here: Path, home: Path) -> None:
    """Make stores of unfinished sweeps: one is a link to her database, one has a journal that names her file."""
    for name in ("link", "journal"):
        (here / f"{name}.csv.parts").mkdir(mode=0o700)
    (here / "link.csv.parts" / "rows").symlink_to(home / "database")
    store = here / "journal.csv.parts"
    with closing(sqlite3.connect(store / "rows")) as database, database:
        database.execute("create table chunk (start integer primary key, checksum, content)")
    keys, magic = bytes(home / "keys"), bytes.fromhex("d9d505f920a163d7")
    header = magic + struct.pack(">5I", 0, 1, 2, 512, 4096)
    ending = struct.pack(">I", 0) + keys + struct.pack(">2I", len(keys), sum(keys)) + magic
    (store / "rows-journal").write_bytes(header.ljust(512, b"\0") + ending)


@pytest.fixture
def environment(home: Path) -> dict[str, str]:
    """Her environment."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "MPL"))}
    path = f"{COMMANDS}{os.pathsep}{os.environ['PATH']}"
    return {**kept, "HOME": str(home), "PATH": path}


@pytest.fixture(autouse=True)
def untouched(here: Path, home: Path, ran: Path) -> Iterator[None]:
    """Nothing has been run, and no file that was there has changed."""
    before = contents(home) | contents(here)
    yield
    assert [path.name for path in ran.iterdir()] == []
    after = contents(home) | contents(here)
    assert {path: after.get(path) for path in before} == before


def contents(folder: Path) -> dict[Path, object]:
    """Contents of the files below a folder, and targets of links."""
    return {
        path: os.readlink(path) if path.is_symlink() else path.read_bytes()
        for path in folder.rglob("*")
        if path.is_symlink() or path.is_file()
    }


def run(line: str, here: Path, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """Run a line of shell."""
    command = ["bash", "-c", line]
    return subprocess.run(command, cwd=here, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(("lines", "code"), [(ANSWERED, 0), (REFUSED, 2)])
def test_no_command_runs_or_obeys_what_lies_there(
    lines: tuple[str, ...], code: int, here: Path, environment: dict[str, str]
):
    codes, said = run_in_a_row(lines, here, environment)
    assert codes == dict.fromkeys(lines, code), said
    assert "Traceback" not in said
    assert "secret" not in said


def test_no_process_that_a_command_starts_runs_it_either(here: Path, environment: dict[str, str]):
    over = "armour.ceramic_thickness_mm=4:8:1"
    done = run(f"armour sweep wilkins --over {over} -o cluster.csv --scheduler local", here, environment)
    assert done.returncode == 0, done.stderr


def test_the_action(here: Path, environment: dict[str, str], tmp_path: Path):
    """All lines that it runs, but for the installation."""
    text = (ROOT / "action.yml").read_text().replace('install "$SOURCE"', "--version")
    lines = [block or line for block, line in re.findall(r" run: (?:\|\n((?: {8}.+\n)+)|(.+))", text)]
    values = {"SOURCE": ROOT, "SCENARIOS": "-* plate.toml", "JUNIT": "results", "SUITE": "own.toml"}
    values |= {"BASE": "main", "PROBABILITY": "0.9", "RUNNER_TEMP": tmp_path, "AGAINST": tmp_path / "armour-base.json"}
    values |= {"GITHUB_OUTPUT": tmp_path / "output", "GITHUB_STEP_SUMMARY": tmp_path / "summary"}
    environment |= {name: str(value) for name, value in values.items()}
    # The base branch, in which one scenario requires more than in the checkout, and another is there.
    base, plate = tmp_path / "origin", (here / "plate.toml").read_text()
    base.mkdir()
    (base / "plate.toml").write_text(plate.replace("[armour]", "[design]\nprobability_of_stopping = 0.99\n\n[armour]"))
    made = "git init -q -b main && git add . && git -c user.name=a -c user.email=a@b commit -qm a"
    assert run(made, base, environment).returncode == 0
    assert run(f"git init -q && git remote add origin {shlex.quote(str(base))}", here, environment).returncode == 0
    codes = [run(line, here, environment).returncode for line in lines]
    assert codes == [0, 0, 0, 0, 3, 0]
    assert (tmp_path / "output").read_text().count("folder=/") == 1
    report = (here / "results" / "check.xml").read_text()
    assert report.count('<failure message="FAILS') == 3
    assert "weaker: 99 % before, 90 % now" in report
    assert "| plate.toml |" in (tmp_path / "summary").read_text()


def test_the_hook(here: Path, environment: dict[str, str]):
    text = (ROOT / ".pre-commit-hooks.yaml").read_text()
    [entry], [words] = re.findall(r"entry: (.+)", text), re.findall(r"args: \[(.+)\]", text)
    done = run(shlex.join([*entry.split(), *words.split(", "), OPTION, "plate.toml"]), here, environment)
    assert done.returncode == 3
    assert [line.endswith("  FAILS") for line in done.stdout.splitlines()].count(True) == 2
