"""Output of the process itself: what it finds out about the terminal."""

import os
import pty
import subprocess
import sys

from tests.helpers.cases import SCENARIOS


def test_a_real_terminal_has_its_width():
    """The standard output is a pseudo-terminal."""
    theirs, ours = pty.openpty()
    environment = {**os.environ, "COLUMNS": "80", "LINES": "24", "TERM": "dumb"}
    command = [sys.executable, "-m", "armour", "simulate", str(SCENARIOS / "wilkins.toml")]
    subprocess.run(command, stdout=ours, stderr=subprocess.DEVNULL, check=True, env=environment)
    os.close(ours)
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
    assert max(map(len, lines)) == 80
    assert {"residual", "277.38", "1067.2", "penetrated;"} <= {word for line in lines for word in line.split()}
