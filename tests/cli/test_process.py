"""The installed command as a process of its own."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from armour import MODEL_VERSION, __version__
from tests.cases import SCENARIOS

REPOSITORY = SCENARIOS.parent
# Imported by no command but those that plot, keep a history or refine.
HEAVY = ["matplotlib", "numpy", "scipy"]
# Imported by no command but those that read a scenario or the library.
READING = ["pydantic"]


def process(*args: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *map(str, args)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, stdin=subprocess.DEVNULL, check=False)


def test_python_m(tmp_path: Path):
    result = process("-m", "armour", "--version", cwd=tmp_path)
    assert result.stdout == f"armour {__version__}, model {MODEL_VERSION}\n"


@pytest.mark.parametrize(
    ("args", "not_needed"),
    [
        (["--help"], HEAVY + READING),
        (["simulate", SCENARIOS / "wilkins.toml"], HEAVY),
        (["library"], HEAVY),
    ],
)
def test_nothing_is_imported_before_it_is_needed(args: list[object], not_needed: list[str]):
    code = f"""
import sys
sys.argv = ["armour", *{[str(arg) for arg in args]!r}]
from armour.cli import main
try:
    main()
except SystemExit as end:
    assert not end.code
print([name for name in {not_needed!r} if name in sys.modules], file=sys.stderr)
"""
    assert process("-c", code).stderr == "[]\n"


def test_a_reader_that_goes_away_is_no_error():
    command = f"{sys.executable} -m armour library | head -n 1; exit ${{PIPESTATUS[0]}}"
    result = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert result.stderr == ""


def test_the_wheel_ships_configs_and_scenarios(tmp_path: Path):
    build = ["-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--quiet", "-w", tmp_path, REPOSITORY]
    result = process(*build)
    assert result.returncode == 0, result.stderr
    [wheel] = tmp_path.glob("*.whl")
    site = tmp_path / "site"
    zipfile.ZipFile(wheel).extractall(site)
    shipped = {path.relative_to(site / "armour").as_posix() for path in site.rglob("*.toml")}
    folders = ("configs", "scenarios", "suites")
    there = {
        path.relative_to(REPOSITORY).as_posix() for name in folders for path in (REPOSITORY / name).rglob("*.toml")
    }
    assert there == shipped
    assert {"configs/metals.toml", "scenarios/wilkins.toml", "suites/paper.toml"} <= shipped
    assert (site / "armour" / "py.typed").exists()
    code = f"""
import sys
sys.path.insert(0, {str(site)!r})
import armour
assert armour.__file__.startswith({str(site)!r}), armour.__file__
from armour.files import shipped
assert str(shipped("configs")).startswith({str(site)!r})
path = shipped("scenarios") / "wilkins.toml"
print(armour.simulate(armour.load_scenario(path)).outcome)
print(len(armour.load_suite(armour.paper_suite()).cases) > 70)
"""
    assert process("-c", code, cwd=tmp_path).stdout == "perforated\nTrue\n"


def test_the_first_use_says_that_it_compiles_and_the_second_does_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    command = ["-m", "armour", "sweep", SCENARIOS / "wilkins.toml", "--over", "impact.velocity_m_s=800", "-o"]
    first = process(*command, tmp_path / "a.csv")
    assert first.stderr.startswith("compiling, once after an installation")
    second = process(*command, tmp_path / "b.csv")
    assert second.stderr == f"wrote {tmp_path / 'b.csv'}: 1 rows\n"
