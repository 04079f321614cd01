"""Words that shells offer, asked for as the scripts of typer ask."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.helpers.commands import invoke


def offered(line: str) -> list[str]:
    """Return what fish is offered at the end of a command line."""
    asked = {
        "_ARMOUR_COMPLETE": "complete_fish",
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
        "_TYPER_COMPLETE_ARGS": f"armour {line}",
    }
    return invoke([], env=asked).stdout.strip().splitlines()


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("simulate wil", ["wilkins"]),
        ('check "" wil', ["wilkins"]),
        ("optimise paper/opt", ["paper/optimum_25mm_APDS", "paper/optimum_7.62mm_AP"]),
        ("report bare", ["bare_plate"]),
        ("simulate other/", []),
        ("library B4", ["B4C"]),
        ("init --from wi", ["wilkins"]),
        ("calibrate tests/wilkins wilkins --fit ceramic.y", ["ceramic.youngs_modulus_GPa"]),
        ("calibrate tests/wilkins wilkins --law ba", ["backing"]),
        ("v50 tests/sh", ["tests/shots"]),
        ("sweep wilkins --quantities outcome,dur", ["outcome,duration_us"]),
        ("sweep wilkins --quantities '$(x),dur", []),
        ("sweep wilkins --over impact.", ["impact.velocity_m_s=", "impact.obliquity_deg="]),
        ("simulate wilkins --set impact.p", ["impact.projectile="]),
        ("simulate wilkins --set backing.sh", ["backing.shear_strength_MPa="]),
        ("simulate wilkins --set armour.ceramic=B4", ["armour.ceramic=B4C"]),
        ("simulate wilkins --set ceramic.flow_stress_GPa=", []),
        ("validate pl", ["plates"]),
    ],
)
@pytest.mark.usefixtures("folder")
def test_words(line: str, words: list[str]):
    assert offered(line) == words


def test_where_files_begin_with_the_word_shells_complete_to_these(folder: Path):
    """Names of files are never offered, as zsh evaluates what is."""
    (folder / "wil$(x).toml").touch()
    assert (offered("simulate wil"), offered("simulate "), offered("simulate bare")) == ([], [], ["bare_plate"])


def test_nothing_that_takes_long_is_imported():
    code = (
        "import sys; from armour.cli import app, completion as c; c.assignments(''), c.entries(), c.scenarios('');"
        "sys.exit('numpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
