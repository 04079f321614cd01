"""Words that shells offer, asked for as the scripts of typer ask."""

import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from armour.cli.app import app


def offered(line: str) -> list[str]:
    """Return what fish is offered at the end of a command line."""
    asked = {
        "_ARMOUR_COMPLETE": "complete_fish",
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
        "_TYPER_COMPLETE_ARGS": f"armour {line}",
    }
    return CliRunner().invoke(app, [], prog_name="armour", env=asked).stdout.strip().splitlines()


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("simulate wil", ["wilkins"]),
        ("optimise paper/opt", ["paper/optimum_25mm_APDS", "paper/optimum_7.62mm_AP"]),
        ("report bare", ["bare_plate"]),
        ("simulate other/", []),
        ("library show B4", ["B4C"]),
        ("init --from wi", ["wilkins"]),
        ("calibrate w", ["wilkins.csv"]),
        ("calibrate wilkins.csv wilkins --fit ceramic.y", ["ceramic.youngs_modulus_GPa"]),
        ("calibrate wilkins.csv wilkins --law ba", ["backing"]),
        ("v50 shots.csv wil", ["wilkins"]),
        ("sweep wilkins --quantities outcome,dur", ["outcome,duration_us"]),
        ("sweep wilkins --over impact.", ["impact.velocity_m_s="]),
        ("simulate wilkins --set impact.", ["impact.velocity_m_s=", "impact.projectile="]),
        ("simulate wilkins --set backing.sh", ["backing.shear_strength_MPa="]),
        ("simulate wilkins --set optimise.ceramic_thickness_mm.s", ["optimise.ceramic_thickness_mm.step="]),
        ("simulate wilkins --set armour.ceramic=B4", ["armour.ceramic=B4C"]),
        ("simulate wilkins --set uncertainty.s", ["uncertainty.samples=", "uncertainty.seed="]),
    ],
)
@pytest.mark.usefixtures("folder")
def test_words(line: str, words: list[str]):
    assert offered(line) == words


def test_files_stand_beside_shipped_names(folder: Path):
    for name in ("wilma.toml", "wil.csv", "other.toml"):
        (folder / name).touch()
    assert offered("simulate wil") == ["wilkins", "wilma.toml"]


def test_bash_gets_names_of_several_words_as_one():
    asked = {"_ARMOUR_COMPLETE": "complete_bash", "COMP_WORDS": "armour library show 25", "COMP_CWORD": "3"}
    assert CliRunner().invoke(app, [], prog_name="armour", env=asked).stdout == "25\\ mm\\ APDS\n"


def test_distributions_are_offered_where_one_is_begun():
    assert not any("distribution" in word for word in offered("simulate wilkins --set "))
    assert "uncertainty.impact.velocity_m_s.mean=" in offered("simulate wilkins --set uncertainty.")


def test_nothing_that_takes_long_is_imported():
    code = (
        "import sys; from armour.cli import app, completion as c; c.assignments(''), c.entries(), c.scenarios('');"
        "sys.exit('numpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
