"""Output of the process itself: what it finds out about the terminal."""

import io
import json
import os
import pty
import re
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from armour.cli.app import app
from armour.cli.console import progress, show_json
from tests.helpers.cases import SCENARIOS

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    "words",
    ["optimise a.toml", "check a.toml", "simulate a.toml", "sensitivity a.toml", "library --json", "optimise b"],
)
def test_names_in_a_strangers_file_do_not_reach_the_terminal_raw(cli, folder: Path, words: str):
    """Where a command proposes the next one, too."""
    name = r"\u001b]0;pwn\u0007\u001b[31mX\u202e"
    (folder / "a.toml").write_text(
        f"""
[impact]
projectile = "7.62 mm AP"
velocity_m_s = 800.0
[armour]
ceramic = "{name}"
ceramic_thickness_mm = 8.0
backing = "6061-T6"
backing_thickness_mm = 6.0
[[design.ceramic]]
material = "{name}"
thickness_mm = [8.0, 9.0]
[[design.backing]]
material = "{name}"
thickness_mm = [6.0]
[library.ceramic."{name}"]
based_on = "AD85"
[library.metal."{name}"]
based_on = "6061-T6"
"""
    )
    found = cli(*words.split())
    shown = found.stdout + found.stderr
    assert len(shown.splitlines()) > 0
    assert all(line.isprintable() for line in shown.splitlines())


def test_a_real_terminal_has_its_width(monkeypatch: pytest.MonkeyPatch):
    """The standard output is a pseudo-terminal."""
    theirs, ours = pty.openpty()
    for name, value in {"COLUMNS": "80", "LINES": "24", "TERM": "dumb"}.items():
        monkeypatch.setenv(name, value)
    with os.fdopen(ours, "w") as terminal, monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", terminal)
        with pytest.raises(SystemExit):
            app(["simulate", "wilkins"])
    text = b""
    while True:
        try:
            block = os.read(theirs, 65536)
        except OSError:
            break
        if not block:
            break
        text += block
    os.close(theirs)
    lines = text.decode().replace("\r\n", "\n").splitlines()
    assert 70 < max(map(len, lines)) <= 80
    assert {"perforated", "277", "1067", "erodes"} <= {word for line in lines for word in line.split()}


def test_a_long_command_shows_progress_and_ends_when_interrupted(folder: Path):
    """Its standard error is a pseudo-terminal; it leaves no file behind."""
    theirs, ours = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "100", "LINES": "24"}
    options = ["--samples", "8192", "--plot", "u.svg"]
    command = [sys.executable, "-m", "armour", "uncertainty", str(SCENARIOS / "uncertain.toml"), *options]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=ours, env=environment, cwd=folder) as process:
        os.close(ours)
        shown = b""
        while b"samples/s" not in shown:
            shown += os.read(theirs, 4096)
        process.send_signal(signal.SIGINT)
        with suppress(OSError):
            while block := os.read(theirs, 4096):
                shown += block
        assert process.wait() == 130
    os.close(theirs)
    assert b"interrupted" in shown
    assert not list(folder.iterdir())


def test_the_rate_is_that_of_what_is_computed(monkeypatch: pytest.MonkeyPatch):
    """Rows of an earlier process are counted, and not timed."""
    terminal = io.StringIO()
    monkeypatch.setattr(terminal, "isatty", lambda: True)
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    with progress("rows", 100_000) as count:
        for _ in range(9):
            count(10_000, stored=True)
        count(1)
        time.sleep(0.1)
        count(10)
    *_, rate = re.findall(r"([\d,.]+) rows/s", terminal.getvalue())
    assert 0.0 < float(rate.replace(",", "")) <= 10.0 / 0.1
    assert "90011/100000" in terminal.getvalue()


def test_json_has_no_number_without_a_value_and_no_control_character(capsys: pytest.CaptureFixture[str]):
    text = "é µ\x1b\x9b\u202e\ufffe\udcff\U000e0001"
    show_json({text: [text, float("nan"), (float("-inf"), 0.1 + 0.2)], "n": None})
    shown = capsys.readouterr().out
    assert json.loads(shown) == {text: [text, None, [None, 0.1 + 0.2]], "n": None}
    assert shown.isascii()
    assert all(line.isprintable() for line in shown.splitlines())
