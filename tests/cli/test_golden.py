"""What commands print, whole, on a terminal of 80 columns, and how they end: a session for each file of golden/.

In a session `$ armour ...` is a command, with what it prints below, messages marked by `!`; `$ cat >NAME` makes a file
that ends with a line of one dot, and `$ cat NAME` shows one.  The shipped scenarios lie in the working folder, so that
messages name them alike everywhere.  ``python -m tests.cli.test_golden`` writes the sessions anew: read what changes.
"""

import os
import re
import shlex
import shutil
import sys
import tempfile
from pathlib import Path

import pytest

from armour.files import shipped
from tests.helpers.commands import invoke

GOLDEN = Path(__file__).parent / "golden"
SLOW = ("ballistic-limit", "calibrate", "plan-shots", "v50", "validate")
# A terminal of 80 columns without colours.
TERMINAL = {"FORCE_COLOR": "1", "TERM": "dumb", "COLUMNS": "80"}


def played(session: str) -> str:
    """Run the commands of a session in the working folder and return it with what they print now."""
    shutil.copytree(shipped("scenarios"), Path(), dirs_exist_ok=True)
    lines = []
    for command, given in re.findall(r"^\$ (.*)\n((?:[^$].*\n|\n)*)", session, re.MULTILINE):
        lines.append(f"$ {command}")
        if command.startswith("cat >"):
            Path(command.removeprefix("cat >")).write_text(given.removesuffix(".\n"))
            lines += given.splitlines()
            continue
        if command.startswith("cat "):
            lines += Path(command.removeprefix("cat ")).read_text().splitlines()
            continue
        done = invoke(shlex.split(command)[1:], env=TERMINAL)
        lines += [*done.stdout.splitlines(), *(f"! {line}" for line in done.stderr.splitlines())]
        lines += [f"exit code {done.exit_code}"] if done.exit_code else []
    return "".join(f"{line}\n" for line in lines)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name
        for name in sorted(path.stem for path in GOLDEN.glob("*.txt"))
    ],
)
@pytest.mark.usefixtures("folder")
def test_a_session(name: str):
    session = (GOLDEN / f"{name}.txt").read_text(encoding="utf-8")
    assert played(session) == session


if __name__ == "__main__":
    for path in [Path(name).resolve() for name in sys.argv[1:]] or sorted(GOLDEN.glob("*.txt")):
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            path.write_text(played(path.read_text(encoding="utf-8")), encoding="utf-8")
