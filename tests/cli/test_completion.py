"""Words that shells offer, asked for as the scripts of typer ask."""

import os
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from armour.scenario.schema import SHEAR_LAWS
from tests.helpers.commands import invoke

pytestmark = pytest.mark.slow


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
        ("calibrate tests/w", ["tests/wilkins"]),
        ("calibrate tests/wilkins wilkins --fit ceramic.y", ["ceramic.youngs_modulus_GPa"]),
        ("calibrate tests/wilkins wilkins --law ba", ["backing"]),
        ("v50 tests/shots wil", ["wilkins"]),
        ("sweep wilkins --quantities outcome,dur", ["outcome,duration_us"]),
        ("sweep wilkins --quantities '$(x),dur", []),
        ("sweep wilkins --over impact.", ["impact.velocity_m_s=", "impact.obliquity_deg="]),
        ("simulate wilkins --set impact.p", ["impact.projectile="]),
        ("simulate wilkins --set backing.sh", ["backing.shear_strength_MPa="]),
        ("simulate wilkins --set optimise.ceramic_thickness_mm.s", ["optimise.ceramic_thickness_mm.step="]),
        ("simulate wilkins --set armour.ceramic=B4", ["armour.ceramic=B4C"]),
        ("simulate wilkins --set model.shear_perimeter=", [f"model.shear_perimeter={law}" for law in SHEAR_LAWS]),
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
    for name in ("wilma.toml", "wil.csv", "other.toml", "wil$(x).toml", "wil`x`.toml", "wil'.toml", "wil\n.toml"):
        (folder / name).touch()
    assert offered("simulate wil") == ["wilkins", "wilma.toml"]


# Command, settings, and the key that puts in what is offered, one after the other.
SHELLS = {
    "bash": (
        ["bash", "--noprofile", "--rcfile", "rc", "-i"],
        'COMP_WORDBREAKS=${COMP_WORDBREAKS//[=:]}\neval "$(_ARMOUR_COMPLETE=source_bash armour)"\n'
        'bind "\\C-n":menu-complete\n',
        "\x0e",
    ),
    "zsh": (
        ["zsh", "-d", "-i"],
        'autoload -Uz compinit; compinit -D\neval "$(_ARMOUR_COMPLETE=source_zsh armour)"\nsetopt menu_complete\n',
        "\t",
    ),
    "fish": (["fish", "-i"], "env _ARMOUR_COMPLETE=source_fish armour | source\n", "\t"),
}


class Shell:
    """A shell at a terminal, in which one types; in it, the program notes its arguments and ends."""

    def __init__(self, name: str, folder: Path) -> None:
        command, settings, self.key = SHELLS[name]
        home = folder / "home"
        # Fish without completions of manual pages makes those of all there are.
        for place in ("bin", ".config/fish", ".local/share/fish/generated_completions"):
            (home / place).mkdir(parents=True)
        self.arguments = home / "arguments"
        self.arguments.touch()
        note = f'[ "$_ARMOUR_COMPLETE" ] || {{ printf "%s\\n" "$*" >>{self.arguments}; exit; }}'
        (home / "bin" / "armour").write_text(f'#!/bin/sh\n{note}\nexec {sys.executable} -m armour "$@"\n')
        (home / "bin" / "armour").chmod(0o755)
        for file in ("rc", ".zshrc", ".config/fish/config.fish"):
            (home / file).write_text(f"{settings}cd {folder}\n")
        places = {"HOME": str(home), "ZDOTDIR": str(home), "XDG_CONFIG_HOME": str(home / ".config")}
        controller, terminal = os.openpty()
        self.keyboard = controller
        self.process = subprocess.Popen(
            command,
            stdin=terminal,
            stdout=terminal,
            stderr=terminal,
            cwd=home,
            start_new_session=True,
            preexec_fn=lambda: os.close(os.open(os.ttyname(0), os.O_RDWR)),  # the terminal of its session
            env={**os.environ, **places, "PATH": f"{home / 'bin'}:{os.environ['PATH']}", "TERM": "dumb"},
        )
        os.close(terminal)

    def run(self, typed: Sequence[str]) -> list[str]:
        """Type lines and return the arguments with which the program was then called."""
        for number, line in enumerate(typed):
            os.write(self.keyboard, line.encode())
            deadline = time.monotonic() + 30.0
            while self.arguments.read_text().count("\n") <= number:
                assert time.monotonic() < deadline, self.arguments.read_text()
                if select.select([self.keyboard], [], [], 0.01)[0]:
                    os.read(self.keyboard, 4096)
        return self.arguments.read_text().splitlines()

    def close(self) -> None:
        """End the shell."""
        self.process.kill()
        self.process.wait()
        os.close(self.keyboard)


# What would make a file in the working folder.
EVIL = (
    *("$(touch {})", "`touch {}`", "\\$(touch {})", "\\`touch {}`", "'$(touch {})'", '"$(touch {})"', "\n$(touch {})"),
    *(";touch {};", "'; touch {}; '", '"; touch {}; "', "\\\\$(touch {})", ")'; touch {}; '", "\ntouch {}\n"),
)


@pytest.mark.skipif(sys.platform == "win32", reason="needs a terminal")
@pytest.mark.parametrize("name", SHELLS)
def test_a_shell_evaluates_no_name_of_a_file(name: str, tmp_path: Path):
    """Whatever is chosen of what is offered: names that a shell could take for more than a word are not."""
    if shutil.which(name) is None:
        pytest.skip(f"there is no {name}")
    for number, evil in enumerate(EVIL):
        (tmp_path / f"wil{evil.format(f'evaluated{number}')}.toml").touch()
    (tmp_path / "wil of two.toml").touch()
    shell = Shell(name, tmp_path)
    try:
        # The first end of line may only take what is chosen.
        found = shell.run([f"armour simulate wil{shell.key * presses}\r\r" for presses in range(1, 4)])
    finally:
        shell.close()
    assert not list(tmp_path.glob("evaluated*"))
    assert set(found) <= {"simulate wil", "simulate wilkins", "simulate wil of two.toml"}
    assert "simulate wil of two.toml" in found


@pytest.mark.skipif(shutil.which("bash") is None or sys.platform == "win32", reason="there is no bash")
def test_bash_completes_values_where_it_does_not_split_words(tmp_path: Path):
    bash = Shell("bash", tmp_path)
    try:
        line = "simulate wilkins --set armour.backing=Ti-"
        assert bash.run([f"armour {line}\t9\r"]) == [f"{line}6Al-4V 9"]
    finally:
        bash.close()


def test_distributions_are_offered_where_one_is_begun():
    assert not any("distribution" in word for word in offered("simulate wilkins --set "))
    assert "uncertainty.impact.velocity_m_s.mean=" in offered("simulate wilkins --set uncertainty.")


def test_nothing_that_takes_long_is_imported():
    code = (
        "import sys; from armour.cli import app, completion as c; c.assignments(''), c.entries(), c.scenarios('');"
        "sys.exit('numpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
