"""The folder of compiled code: used where it is the user's, made anew where a file in it is damaged."""

import logging
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numba
import pytest

from armour.core import equations
from armour.engine import batch, cache, kernels
from tests.helpers.cases import armour

pytestmark = pytest.mark.slow

CONFIG: Any = numba.config


def test_an_installation_in_a_folder_whose_name_is_no_text(tmp_path: Path):
    package = tmp_path / os.fsdecode(b"caf\xe9")
    for name in ("core", "engine"):
        shutil.copytree(cache.PACKAGE_FOLDER / name, package / name)
    assert cache.digest(package) not in ("", cache.digest())


class FakeCompiler:
    """Stands for `armour.engine.kernels.compiled`: leaves a file in the folder, as numba does."""

    def __init__(self) -> None:
        self.compiled = 0

    def __call__(self, name: str, folder: Path | None = None) -> str:
        file = None if folder is None else folder / f"loops.{name}-.nbi"
        if file is None or not file.exists():
            self.compiled += 1
        if file is not None:
            if file.exists() and file.read_text() != name:
                raise EOFError("such as unpickling raises")
            file.write_text(name)
        return name


@pytest.fixture
def compiler(monkeypatch: pytest.MonkeyPatch) -> FakeCompiler:
    made = FakeCompiler()
    monkeypatch.setattr(kernels, "compiled", made)
    return made


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's cache folder without compiled code."""
    folder = tmp_path / "cache" / "armour"
    monkeypatch.setattr(cache, "user_cache_dir", lambda *_args, **_kwargs: str(folder))
    return folder


def in_a_new_process(name: str = "impacts") -> None:
    found: object = cache.load(name)
    assert found == name


@pytest.fixture
def kept(home: Path, compiler: FakeCompiler) -> Path:
    """The file that a process has left."""
    in_a_new_process()
    assert compiler.compiled == 1
    [path] = home.glob("*/*.nbi")
    return path


@pytest.mark.usefixtures("home")
def test_only_the_first_process_compiles_and_only_what_is_asked_for(compiler: FakeCompiler):
    assert not cache.is_compiled("impacts")
    for name, compiled in (("impacts", 1), ("impacts", 1), ("ballistic_limits", 2)):
        in_a_new_process(name)
        assert compiler.compiled == compiled
        assert cache.is_compiled("impacts")


def test_others_may_read_compiled_code_and_not_change_it(home: Path, compiler: FakeCompiler):
    before = os.umask(0o002)
    in_a_new_process()
    os.umask(before)
    modes = {path.name: path.stat().st_mode & 0o777 for path in (home, *home.rglob("*"))}
    assert set(modes.values()) == {0o755, 0o644}
    next(home.glob("*/*.nbi")).chmod(0o664)
    assert not cache.is_compiled("impacts")
    in_a_new_process()
    assert (cache.is_compiled("impacts"), compiler.compiled) == (True, 2)


def test_what_cannot_be_written_is_used(kept: Path, compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch):
    """Such as that of a container image."""
    monkeypatch.setattr(os, "access", lambda *_: False)
    in_a_new_process()
    assert compiler.compiled == 1
    kept.write_text("damaged")
    assert_not_used(compiler, "which cannot be written")
    assert kept.exists()


@pytest.mark.parametrize("content", ["", "impac", "foreign"])
def test_a_damaged_file_is_made_anew(kept: Path, compiler: FakeCompiler, content: str):
    kept.write_text(content)
    assert not cache.is_compiled("impacts")
    in_a_new_process()
    assert cache.is_compiled("impacts")
    in_a_new_process()
    assert compiler.compiled == 2


def assert_not_used(compiler: FakeCompiler, reason: str) -> None:
    """Every process compiles, which the command line says."""
    assert reason in cache.folder()[1]
    assert not cache.is_compiled("impacts")
    before = compiler.compiled
    in_a_new_process()
    in_a_new_process()
    assert compiler.compiled == before + 2


@pytest.mark.parametrize("mode", [0o770, 0o707, 0o777, 0o1777])
@pytest.mark.parametrize("upwards", [0, 1])
def test_a_folder_that_others_can_write(kept: Path, compiler: FakeCompiler, mode: int, upwards: int):
    kept.parents[upwards].chmod(mode)
    assert_not_used(compiler, f"in {kept.parents[1]}, which other users can change")


def test_what_root_has_compiled_is_used(kept: Path, compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch):
    if kept.stat().st_uid:
        pytest.skip("needs root")
    monkeypatch.setattr(os, "geteuid", lambda: 12_345)
    in_a_new_process()
    assert compiler.compiled == 1


@pytest.mark.parametrize("mark", [".git", ".hg", ".svn"])
def test_a_work_tree(home: Path, compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch, mark: str):
    """Its files may be somebody else's, unless it is the home."""
    (home.parents[1] / mark).mkdir()
    assert_not_used(compiler, f"in {home}, which is in the work tree {home.parents[1]}")
    assert not home.exists()
    monkeypatch.setenv("HOME", str(home.parents[1]))
    in_a_new_process()
    assert cache.is_compiled("impacts")


def test_the_root_folder_is_nobody_elses(monkeypatch: pytest.MonkeyPatch):
    """As in a container that starts there, for a user without a home."""
    monkeypatch.chdir("/")
    monkeypatch.setattr(Path, "home", Mock(side_effect=RuntimeError))
    assert cache.project_around(Path("/opt/cache/armour")) == ""


@pytest.mark.parametrize("upwards", [0, 1])
def test_the_current_folder(home: Path, compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch, upwards: int):
    """Its files may be somebody else's, unless it is the home or above it; also through a link."""
    home.parent.mkdir()
    monkeypatch.chdir(home.parents[upwards + 1] if upwards else home.parent)
    assert_not_used(compiler, f"in {home}, which is in the current folder")
    link = home.parents[1] / "link"
    link.symlink_to(home.parent)
    monkeypatch.setattr(cache, "user_cache_dir", lambda *_args, **_kwargs: str(link / "armour"))
    assert_not_used(compiler, "which is in the current folder")
    monkeypatch.setenv("HOME", str(home.parent))
    in_a_new_process()
    assert cache.is_compiled("impacts")


def test_a_folder_of_another_user(kept: Path, compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch):
    user = os.geteuid()
    if user:
        monkeypatch.setattr(os, "geteuid", lambda: user + 1)
    else:
        os.chown(kept.parent, 12_345, -1)
    assert_not_used(compiler, "which other users can change")


def test_a_link_to_a_folder(kept: Path, compiler: FakeCompiler, tmp_path: Path, caplog: pytest.LogCaptureFixture):
    caplog.set_level(logging.INFO)
    kept.parent.rename(tmp_path / "elsewhere")
    kept.parent.symlink_to(tmp_path / "elsewhere")
    assert_not_used(compiler, "which other users can change")
    said = f"cannot be kept in {kept.parents[1]}, which other users can change; XDG_CACHE_HOME names another folder"
    assert said in caplog.text


def no_home(*_args: Any, **_kwargs: Any) -> str:
    raise RuntimeError


def unexpanded(*_args: Any, **_kwargs: Any) -> str:
    return "~/.cache/armour"


@pytest.mark.parametrize("user_cache_dir", [no_home, unexpanded])
def test_a_user_without_a_home(
    compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, user_cache_dir: Callable[..., str]
):
    """Newer and older versions of platformdirs."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(cache, "user_cache_dir", user_cache_dir)
    assert_not_used(compiler, "without a user cache directory")
    assert not list(tmp_path.iterdir())


def test_a_home_that_cannot_be_written(home: Path, compiler: FakeCompiler):
    """A file where the folder should be, which holds for root too."""
    home.parent.write_text("a file")
    assert_not_used(compiler, "which cannot be written")


ROWS = batch.packed([armour("7.62 mm AP", "AD85", "6061-T6", 8.0, 6.0)] * 2)


@pytest.fixture
def unsaid(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing has been said of plain Python in this process."""
    monkeypatch.setattr(cache, "_logged", set())


def limits() -> list[float]:
    return batch.ballistic_limits(ROWS, 20.0, 4000.0, 0.01).perforated.tolist()


@pytest.mark.usefixtures("unsaid")
def test_without_numba_python_computes_the_same(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture):
    compiled = limits()
    assert not caplog.records
    monkeypatch.setattr(cache, "find_spec", lambda _name: None)
    assert limits() == compiled
    assert limits() == compiled
    [record] = caplog.records
    assert record.getMessage() == "computing in plain Python, about a hundred times slower: numba is not installed"


@pytest.mark.usefixtures("unsaid")
def test_by_the_environment_python_computes(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture):
    compiled = limits()
    monkeypatch.setenv("ARMOUR_COMPILED", "0")
    assert not cache.is_compiled("ballistic_limits")
    assert limits() == compiled
    assert "ARMOUR_COMPILED is 0" in caplog.text


@pytest.mark.usefixtures("unsaid")
def test_a_numba_that_does_not_work(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture):
    """Numba refuses versions of numpy that are too new for it."""
    compiled = limits()
    monkeypatch.setattr(cache, "_kernels", {})
    monkeypatch.setitem(sys.modules, "armour.engine.kernels", None)
    assert limits() == compiled
    assert "numba does not work: " in caplog.text


def test_a_replaced_function_of_the_core_is_used(monkeypatch: pytest.MonkeyPatch):
    before, velocity = limits(), equations.crack_velocity

    def slow(Ec: float, rho_c: float) -> float:
        return 0.5 * velocity(Ec, rho_c)

    slow.__module__ = "mathematics"  # which begins like a module that the core uses
    monkeypatch.setattr(equations, "crack_velocity", slow)
    slower = limits()
    assert slower[0] == slower[1] > before[0]
    assert cache.obstacle() == "armour.core.equations.crack_velocity replaced"
    monkeypatch.undo()
    assert limits() == before


@pytest.mark.usefixtures("compiler")
def test_a_system_without_users(home: Path, monkeypatch: pytest.MonkeyPatch):
    """Such as Windows."""
    monkeypatch.delattr(os, "geteuid")
    in_a_new_process()
    home.chmod(0o777)
    assert cache.is_compiled("impacts")


@pytest.mark.usefixtures("compiler")
def test_the_oldest_folders_are_deleted(home: Path):
    for age in range(7):
        other = home / f"kernels-{age}"
        other.mkdir(parents=True)
        os.utime(other, (1e9 - age, 1e9 - age))
    (home / "notes.txt").write_text("of the user")
    home.chmod(0o700)
    in_a_new_process()
    assert cache.is_compiled("impacts")
    names = {path.name for path in home.iterdir()}
    assert names == {"notes.txt", f"kernels-{cache.digest()}", *(f"kernels-{age}" for age in range(4))}


def test_another_processor_is_another_folder(monkeypatch: pytest.MonkeyPatch):
    assert len(cache.processor()) > 3 or not Path("/proc/cpuinfo").exists()
    before = cache.digest()
    monkeypatch.setenv("NUMBA_CPU_NAME", "generic")
    assert cache.processor() == [platform.machine(), "generic", ""]
    assert cache.digest() != before


def test_a_change_of_any_file_of_the_core_and_another_installation_are_another_folder(tmp_path: Path):
    package = tmp_path / "armour"
    for name in ("core", "engine"):
        shutil.copytree(cache.PACKAGE_FOLDER / name, package / name)
    before = cache.digest(package)
    assert before != cache.digest()
    engine = package / "engine"
    for path in [*(package / "core").glob("*.py"), engine / "kernels.py", engine / "loops.py"]:
        text = path.read_text()
        path.write_text(text + "\n")
        assert cache.digest(package) != before
        path.write_text(text)
    (package / "engine" / "batch.py").write_text("")
    assert cache.digest(package) == before


PROGRAM = """
import numpy as np
from armour.engine import cache, kernels, loops
import numba

def doubled(values):
    values[0] *= 2.0

loops.doubled, kernels.SIGNATURES["doubled"] = doubled, (numba.float64[::1],)
values = np.array([21.0])
kernel = cache.kernel("doubled")
kernel(values)
print(values[0], sum(kernel.stats.cache_hits.values()))
"""


def test_processes_with_numba(tmp_path: Path):
    """The first compiles, the second loads, and the third finds a damaged file; by a kernel that is soon compiled.

    Settings of numba in the current folder are ignored.
    """
    program, here = tmp_path / "program.py", tmp_path / "here"
    program.write_text(PROGRAM)
    here.mkdir()
    (here / ".numba_config.yaml").write_text("opt: unknown\n")
    settings = {"XDG_CACHE_HOME": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}
    found = []
    for damaged in (False, False, True):
        for path in tmp_path.glob("armour/*/*.nb?") if damaged else ():
            path.write_bytes(path.read_bytes()[:100])
        command = [sys.executable, str(program)]
        environment = {**os.environ, **settings}
        done = subprocess.run(command, env=environment, cwd=here, capture_output=True, text=True, check=False)
        assert not done.stderr
        found.append(done.stdout.split())
    assert found == [["42.0", "0"], ["42.0", "1"], ["42.0", "0"]]


def test_the_seal_covers_code_from_any_module(tmp_path: Path):
    code = tmp_path / "other.impacts-1.py311.nbc"
    code.write_bytes(b"whole")
    whole = cache.content_of(tmp_path, "impacts")
    code.write_bytes(b"damaged")
    assert cache.content_of(tmp_path, "impacts") != whole
