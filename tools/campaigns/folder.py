"""Run commands in hostile folders, drawn at random: nothing in the folder is run, obeyed or overwritten.

    python -m tools.campaigns folder

A folder has modules with the names of what Python and the installed distributions import, files that programs and
shells read as settings, links to files of the user, stores of unfinished sweeps and names that look like options.  The
commands are the examples of the help, the lines of the action for GitHub and the hook for pre-commit.  A trial is wrong
if a planted module or program was run, if a file that was there or one of the user's changed, if Python ended with a
traceback, or if the same command in an empty folder has another answer.
"""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path
from random import Random

from armour.cli.app import COMMANDS, told
from tools.campaigns.trials import WRONG, run
from tools.campaigns.verdict import asked

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = Path(sys.executable).parent
# Programs that shells and libraries look for.
NAMES = ("armour", "cat", "chromium", "git", "latex", "ldconfig", "less", "python", "python3", "sh", "stty", "uname")
# Settings by file, all of which would run or change something: {ran} is a file to leave, {keys} one of the user's.
SETTINGS = {
    ".env": "PYTHONPATH=.\n",
    "matplotlibrc": "backend: module://pip\ntext.usetex: True\nsavefig.format: xyz\n",
    "pip.conf": "[global]\nindex-url = file:///nowhere\n",
    "pyproject.toml": '[tool.coverage.run]\nplugins = ["pip"]\n[build-system]\nrequires = ["pip"]\n',
    "pyvenv.cfg": "home = /nowhere\n",
    "armour.toml": "[solver]\ntime_step_us = 50\n",
    "x.pth": "import os; os.system('touch {ran}')\n",
    "wilkins": "not a scenario\n",
    "wilkins.csv": "velocity_m_s,result\n1,P\n",
    "--help": "",
    "--set=armour.backing_thickness_mm=300 #.toml": '#:schema ./x.json\n[impact]\nprojectile = "P"\n',
    "-o": "",
}
ACTION = (
    "python -P -m pip cache dir",
    "armour check --junit results.xml -- {scenario}",
    "armour validate paper --only table --junit validate.xml",
)
# What depends on the time, the folder or on how often a command ran.
CHANGING = re.compile(r"\d+ (?:rows|tests|armours).*\r")


@cache
def commands() -> list[str]:
    """Return the examples of the help that need no file of the user, and what runs elsewhere."""
    examples = [example for group in COMMANDS.values() for command in group for example in told(command)[1]]
    slow = ("figures", "report", "optimise", "validate", "uncertainty", "0.1 -o")
    quick = [example for example in examples if not any(part in example for part in slow)]
    sweep = "armour sweep wilkins --over impact.velocity_m_s=700,800 -o x.csv"
    return [*quick, "armour optimise wilkins", sweep, *ACTION]


def planted(folder: Path, keys: Path, ran: Path, dice: Random) -> None:
    """Fill a folder with a random choice of what is hostile."""
    modules = sorted({*sys.stdlib_module_names, *packages_distributions(), "sitecustomize", "usercustomize", "armour"})
    for name in dice.sample(modules, dice.randint(5, 60)):
        if dice.random() < 0.3:
            (folder / name).mkdir(exist_ok=True)
        place = folder / name / "__init__.py" if (folder / name).is_dir() else folder / f"{name}.py"
        place.write_text(f"open({str(ran / name)!r}, 'w')\n")
    for name in dice.sample(NAMES, dice.randint(0, len(NAMES))):
        if not (folder / name).exists():
            (folder / name).write_text(f"#!/bin/sh\ntouch {shlex.quote(str(ran / name))}\n")
            (folder / name).chmod(0o755)
    for name in dice.sample([*SETTINGS], dice.randint(3, len(SETTINGS))):
        if not (folder / name).exists():
            (folder / name).write_text(SETTINGS[name].format(ran=ran / "setting", keys=keys))
    for name in dice.sample(["run.csv", "run.svg", "x.csv", "mine.toml", ".firing.csv.lock"], dice.randint(0, 3)):
        (folder / name).symlink_to(keys)
    if dice.random() < 0.5:
        store = folder / "x.csv.parts"
        store.mkdir()
        (store / "rows").symlink_to(keys) if dice.random() < 0.5 else (store / "rows").write_bytes(dice.randbytes(4096))


def contents(folder: Path) -> dict[Path, bytes]:
    """Return what is in a folder: the content of each file, and where a link leads."""
    there = [path for path in folder.rglob("*") if path.is_symlink() or path.is_file()]
    return {path: os.fsencode(os.readlink(path)) if path.is_symlink() else path.read_bytes() for path in there}


def ended(words: list[str], folder: Path, home: Path) -> tuple[int, str]:
    """Run a command in a folder, and return its exit code and what it says."""
    program = sys.executable if words[0] == "python" else str(PROGRAMS / words[0])
    env = {"PATH": f"{PROGRAMS}:/usr/bin:/bin", "HOME": str(home), "XDG_CACHE_HOME": os.environ["XDG_CACHE_HOME"]}
    command = [program, *words[1:]]
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, check=False, timeout=300)
    return done.returncode, CHANGING.sub("", done.stdout + done.stderr)


def trial(place: Path, dice: Random, answers: dict[str, tuple[int, str]]) -> str:
    """Run a command in a folder that is drawn; return how that ends."""
    home, ran, folder, empty = (place / name for name in ("home", "ran", "folder", "empty"))
    for each in (home, ran, folder, empty):
        each.mkdir(parents=True)
    keys = home / "keys"
    keys.write_text("user:secret")
    planted(folder, keys, ran, dice)
    command = dice.choice(commands())
    names = [path.name for path in folder.iterdir() if path.suffix == ".toml"] or ["wilkins"]
    words = [dice.choice(names) if word == "{scenario}" else word for word in shlex.split(command)]
    before = contents(folder) | contents(home)
    code, said = ended(words, folder, home)
    after = contents(folder) | contents(home)
    if left := [*ran.iterdir()]:
        return f"{WRONG}: {left[0].name} was run by {command}"
    if changed := [path for path, content in before.items() if after.get(path) != content]:
        return f"{WRONG}: {changed[0].name} changed by {command}"
    if "Traceback" in said or code not in (0, 1, 2, 3):
        return f"{WRONG}: exit code {code} of {command}: {said[-300:]}"
    if code == 2 or "{scenario}" in command:
        return "refused, or a scenario of the folder"
    if command not in answers:
        answers[command] = ended(words, empty, home)
    same = answers[command] == (code, said)
    return "the same as in an empty folder" if same else f"{WRONG}: another answer of {command}"


def main() -> int:
    """Print how the trials ended."""
    options, answers = asked(__doc__, trials=500, seed=11), dict[str, tuple[int, str]]()
    os.environ.setdefault("XDG_CACHE_HOME", str(Path.home() / ".cache"))

    def folders(place: Path) -> Iterator[str]:
        for number in range(options.trials):
            yield trial(place / str(number), Random(f"{options.seed} {number}"), answers)

    return run(folders)
