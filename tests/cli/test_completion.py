"""Words that shells offer, asked for as the scripts of typer ask."""

import os
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import pytest
from typer.testing import CliRunner

from armour.cli.app import app
from armour.cli.completion import for_bash


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
        ("init --from wi", ["wilkins", "wilkins.csv"]),
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
        (
            "simulate wilkins --set model.shear_perimeter=",
            ["model.shear_perimeter=conoid", "model.shear_perimeter=projectile"],
        ),
        ("simulate wilkins --set ceramic.flow_stress_GPa=", []),
        ("sweep wilkins --over armour.ceramic=B4", []),
        ("validate pl", ["plates"]),
        ("report pl", ["plates"]),
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


class Bash:
    """A bash at a terminal, in which one types; it completes words as the script of the program has it."""

    def __init__(self, folder: Path) -> None:
        (folder / "bin").mkdir()
        (folder / "bin" / "armour").write_text(f'#!/bin/sh\nexec {sys.executable} -m armour "$@"\n')
        (folder / "bin" / "armour").chmod(0o755)
        self.lines = folder / "lines"
        self.lines.touch()
        # Control-T notes the line and clears it.
        note = f'"\\C-t": printf "%s\\n" "$READLINE_LINE" >> {self.lines}; READLINE_LINE='
        script = 'eval "$(_ARMOUR_COMPLETE=source_bash armour)"'
        (folder / "rc").write_text(f"{script}\nbind -x '{note}'\n")
        controller, terminal = os.openpty()
        self.keyboard = controller
        self.process = subprocess.Popen(
            ["bash", "--noprofile", "--rcfile", str(folder / "rc"), "-i"],
            stdin=terminal,
            stdout=terminal,
            stderr=terminal,
            cwd=folder,
            start_new_session=True,
            env={**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "TERM": "dumb"},
        )
        os.close(terminal)

    def completed(self, lines: Sequence[str]) -> list[str]:
        """Return lines as they are after the tab at their end."""
        deadline = time.monotonic() + 30.0
        os.write(self.keyboard, "".join(f"{line}\t\x14" for line in lines).encode())
        while self.lines.read_text().count("\n") < len(lines):
            assert time.monotonic() < deadline, self.lines.read_text()
            if select.select([self.keyboard], [], [], 0.01)[0]:
                os.read(self.keyboard, 4096)
        return self.lines.read_text().splitlines()

    def close(self) -> None:
        """End bash."""
        self.process.kill()
        self.process.wait()
        os.close(self.keyboard)


BASH = {
    "armour library show 25\\ m": "armour library show 25\\ mm\\ APDS ",
    "armour simulate wilkins --set armour.backing=Ti-": "armour simulate wilkins --set armour.backing=Ti-6Al-4V ",
    "armour simulate wilkins --set a=1:2 --set impact.v": (
        "armour simulate wilkins --set a=1:2 --set impact.velocity_m_s="
    ),
}


@pytest.mark.skipif(shutil.which("bash") is None or sys.platform == "win32", reason="there is no bash")
def test_bash_completes_values_and_names_of_several_words(folder: Path):
    bash = Bash(folder)
    try:
        assert bash.completed(list(BASH)) == list(BASH.values())
    finally:
        bash.close()


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        (["--set", "armour.ceramic", "=", "B4"], ["B4C"]),
        (["--set", "ceramic.flow_stress_GPa", "="], []),
        (["--set", "ceramic.flow_stress_GPa", "=", "7"], []),
        (["--set", "model.shear_perimeter", "="], ["conoid", "projectile"]),
        (["--set", "impact.projectile", "=", "25"], ["25\\ mm\\ APDS"]),
        (["--set", "impact.projectile", "=", "'25 m"], ["25 mm APDS"]),
        (["--set", "'impact.projectile=25 m"], ["impact.projectile=25 mm APDS"]),
        (["--set", "=", "armour.ceramic", "=", "B4"], ["B4C"]),
        (["--set", "armour.ceramic", "=", ""], []),
        (["--set", "backing.sh"], ["backing.shear_strength_MPa=", "backing.shear_strength_MPa=VALUE"]),
    ],
)
def test_what_bash_is_offered(
    typed: list[str], offered: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    words = ["armour", "simulate", "wilkins", *typed]
    monkeypatch.setenv("_ARMOUR_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "\n".join(words))
    monkeypatch.setenv("COMP_CWORD", str(len(words) - 1))
    with for_bash(), suppress(SystemExit):
        app([], prog_name="armour")
    assert capsys.readouterr().out.splitlines() == offered


def test_distributions_are_offered_where_one_is_begun():
    assert not any("distribution" in word for word in offered("simulate wilkins --set "))
    assert "uncertainty.impact.velocity_m_s.mean=" in offered("simulate wilkins --set uncertainty.")


def test_nothing_that_takes_long_is_imported():
    code = (
        "import sys; from armour.cli import app, completion as c; c.assignments(''), c.entries(), c.scenarios('');"
        "sys.exit('numpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
