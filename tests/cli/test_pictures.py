"""Files of pictures do not depend on settings of matplotlib, which it reads as it is imported."""

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest


def files_made(folder: Path, environment: Mapping[str, str], command: str) -> dict[str, bytes]:
    """The files that a command makes in a folder; it runs in a process of its own."""
    words = [sys.executable, "-P", "-m", "armour", *command.split()]
    subprocess.run(words, cwd=folder, env=os.environ | environment, check=True, capture_output=True, timeout=120)
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != "matplotlibrc"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "command", ["simulate wilkins --plot p.svg", "figures . --only fig09", "report wilkins -o r.html"]
)
def test_settings_of_a_folder_or_a_user_change_no_picture(tmp_path: Path, command: str):
    plain, other = tmp_path / "plain", tmp_path / "other"
    plain.mkdir()
    other.mkdir()
    (other / "matplotlibrc").write_bytes(b"\xff\xfe")
    (tmp_path / "rc").write_text("font.size: 30\n")
    settings = {"MPLBACKEND": "none", "MATPLOTLIBRC": str(tmp_path / "rc")}
    made = files_made(plain, {}, command)
    assert made
    assert files_made(other, settings, command) == made
