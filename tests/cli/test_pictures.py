"""Files of pictures do not depend on settings of matplotlib, which it reads as it is imported."""

import os
from collections.abc import Mapping
from pathlib import Path

import pytest

from tests.helpers.commands import run_in_a_row

COMMANDS = ("simulate wilkins --plot p.png",)


def files_made(folder: Path, environment: Mapping[str, str]) -> dict[str, bytes]:
    """The files that the commands make in a folder; they run in a process of their own."""
    codes, said = run_in_a_row(COMMANDS, folder, os.environ | environment)
    assert codes == dict.fromkeys(COMMANDS, 0), said
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != "matplotlibrc"}


@pytest.mark.slow
def test_settings_of_a_folder_or_a_user_change_no_picture(tmp_path: Path):
    plain, other = tmp_path / "plain", tmp_path / "other"
    plain.mkdir()
    other.mkdir()
    (other / "matplotlibrc").write_bytes(b"\xff\xfe")
    (tmp_path / "rc").write_text("font.size: 30\n")
    made = files_made(plain, {})
    assert {*made} == {"p.png"}
    assert files_made(other, {"MPLBACKEND": "none", "MATPLOTLIBRC": str(tmp_path / "rc")}) == made
