"""Another user, who exchanges folders while a command runs, has nothing of his run and nothing of hers touched."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="needs root, to be two users"),
]
OTHER = 12_345


@contextmanager
def other_user(act: Callable[[], None]) -> Iterator[None]:
    """Repeat an act as another user, until the end; what the system refuses him fails."""
    child = os.fork()
    if not child:
        os.setgroups([])
        os.setgid(OTHER)
        os.setuid(OTHER)
        while True:
            with suppress(OSError):
                act()
            time.sleep(0.002)
    try:
        yield
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)


def run(*words: object, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a command in a folder."""
    command = [sys.executable, "-m", "armour", *map(str, words)]
    environment = {**os.environ, **variables}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


@pytest.fixture
def shared(tmp_path: Path) -> Path:
    """A folder that everybody can enter and write to, without the sticky bit."""
    for path in (tmp_path, *tmp_path.parents[:2]):
        path.chmod(0o755)
    folder = tmp_path / "shared"
    folder.mkdir()
    folder.chmod(0o777)
    return folder


@pytest.mark.parametrize("mode", [0o777, 0o1777])
def test_rows_of_a_sweep_in_a_folder_that_he_can_write_to(shared: Path, tmp_path: Path, mode: int):
    """He puts a link to her folder in the place of that of the rows: in a sticky folder, he cannot."""
    shared.chmod(mode)
    hers, parts, aside = tmp_path / "hers", shared / "a.csv.parts", shared / "aside"
    hers.mkdir()
    for name in ("job", "lock", "rows", "0000000000000.npz"):
        (hers / name).write_text("hers")

    def exchange() -> None:
        parts.rename(aside)
        parts.symlink_to(hers)

    over = "armour.ceramic_thickness_mm=6:14:0.008"
    with other_user(exchange):
        result = run("sweep", "wilkins", "--over", over, "-o", "a.csv", folder=shared)
    assert [path.read_text() for path in hers.iterdir()] == ["hers"] * 4
    if mode == 0o777:
        assert "a.csv: must be in a folder that no other user can exchange" in result.stderr
        assert (result.returncode, parts.exists()) == (2, False)
    else:
        assert (result.returncode, result.stderr) == (0, "wrote a.csv: 1001 rows\n")
