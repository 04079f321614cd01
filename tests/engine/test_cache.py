"""The archive of compiled code: checked before use, and written anew where it is missing, damaged or not private."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any

import numba
import pytest

from armour.engine import cache, kernels
from armour.errors import ArmourError

CODE = bytes(range(256)) * 4
RESULT: dict[str, Any] = {"impacts": CODE}
CONFIG: Any = numba.config


class FakeCompiler:
    """Stands for `armour.engine.kernels.compiled`: leaves a file in the directory, as numba does."""

    def __init__(self) -> None:
        self.compiled = 0

    def __call__(self, *_names: str, directory: Path | None = None) -> dict[str, Any]:
        if directory is None:
            self.compiled += 1
            return RESULT
        assert directory.stat().st_mode & 0o777 == 0o700
        file = directory / "engine" / "impacts.nbc"
        if not file.exists():
            self.compiled += 1
            file.parent.mkdir()
            file.write_bytes(CODE)
        if file.read_bytes() != CODE:
            raise EOFError("such as unpickling raises")
        return {"impacts": file.read_bytes()}


@pytest.fixture
def compiler(monkeypatch: pytest.MonkeyPatch) -> FakeCompiler:
    made = FakeCompiler()
    monkeypatch.setattr(kernels, "compiled", made)
    return made


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's cache directory without an archive."""
    directory = tmp_path / "cache" / "armour"
    monkeypatch.setattr(cache, "user_cache_dir", lambda *_args, **_kwargs: str(directory))
    return directory


@pytest.fixture
def archive(home: Path, compiler: FakeCompiler) -> Path:
    """The archive that a process has left."""
    cache.load_kernels()
    assert compiler.compiled == 1
    (path,) = home.iterdir()
    return path


def assert_made_anew(compiler: FakeCompiler) -> None:
    """The next process compiles, with the right result, and the one after it loads."""
    assert not cache.is_compiled()
    before = compiler.compiled
    assert cache.load_kernels() == RESULT
    assert compiler.compiled == before + 1
    assert cache.is_compiled()
    assert cache.load_kernels() == RESULT
    assert compiler.compiled == before + 1


def test_only_the_first_process_compiles(home: Path, compiler: FakeCompiler):
    assert not home.exists()
    assert_made_anew(compiler)
    assert home.stat().st_mode & 0o777 == 0o700
    assert [path.stat().st_mode & 0o777 for path in home.iterdir()] == [0o600]


@pytest.mark.parametrize("position", range(30))
def test_a_flipped_bit(archive: Path, compiler: FakeCompiler, position: int):
    data = bytearray(archive.read_bytes())
    data[position * (len(data) - 1) // 29] ^= 1 << (position % 8)
    archive.write_bytes(data)
    assert_made_anew(compiler)


@pytest.mark.parametrize("length", [0, 1, 32, 100, -1])
def test_a_truncated_archive(archive: Path, compiler: FakeCompiler, length: int):
    archive.write_bytes(archive.read_bytes()[:length])
    assert_made_anew(compiler)


def test_an_archive_of_another_name(archive: Path, compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch):
    content = archive.read_bytes()
    monkeypatch.setattr(cache, "digest", lambda: "another version")
    path = cache.archive_path()
    assert path is not None
    path.write_bytes(content)
    path.chmod(0o600)
    assert_made_anew(compiler)


@pytest.mark.parametrize("mode", [0o620, 0o602, 0o666])
def test_an_archive_that_others_can_write(archive: Path, compiler: FakeCompiler, mode: int):
    archive.chmod(mode)
    assert_made_anew(compiler)
    assert archive.stat().st_mode & 0o777 == 0o600


def assert_not_used(compiler: FakeCompiler, archive: Path, reason: str) -> None:
    """The archive is neither read nor written, which the command line says: every process compiles."""
    content = archive.read_bytes()
    assert cache.archive_path() == archive
    assert reason in cache.obstacle()
    assert not cache.is_compiled()
    before = compiler.compiled
    for count in (1, 2):
        assert cache.load_kernels() == RESULT
        assert compiler.compiled == before + count
    assert archive.read_bytes() == content


@pytest.mark.parametrize("mode", [0o770, 0o707, 0o777, 0o1777])
def test_a_directory_that_others_can_write(archive: Path, compiler: FakeCompiler, mode: int):
    archive.parent.chmod(mode)
    assert_not_used(compiler, archive, f"in {archive.parent}, which other users can change")


def test_a_directory_of_another_user(archive: Path, compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch):
    user = os.geteuid() + 1
    monkeypatch.setattr(os, "geteuid", lambda: user)
    assert_not_used(compiler, archive, "which other users can change")


@pytest.mark.parametrize(("mode", "reason"), [(0o1777, ""), (0o777, "which other users can change")])
def test_a_directory_that_others_can_replace(archive: Path, compiler: FakeCompiler, mode: int, reason: str):
    """In a directory such as /tmp they cannot."""
    archive.parent.parent.chmod(mode)
    if reason:
        assert_not_used(compiler, archive, reason)
    else:
        assert not cache.obstacle()
        assert cache.is_compiled()


def test_a_link_that_others_can_replace(home: Path, archive: Path, compiler: FakeCompiler, tmp_path: Path):
    """A link on the way is followed: as safe as where it stands and where it leads."""
    (tmp_path / "elsewhere").mkdir()
    home.rename(tmp_path / "elsewhere" / "armour")
    home.symlink_to(Path("..") / "elsewhere" / "armour")
    assert cache.is_compiled()
    (tmp_path / "elsewhere").chmod(0o777)
    assert_not_used(compiler, archive, "which other users can change")


def test_links_that_lead_in_a_circle(home: Path, compiler: FakeCompiler):
    home.parent.mkdir()
    home.symlink_to(home)
    assert cache.load_kernels() == RESULT
    assert "which cannot be written" in cache.obstacle()
    assert compiler.compiled == 1


def test_a_link_in_place_of_the_archive(archive: Path, compiler: FakeCompiler, tmp_path: Path):
    archive.rename(tmp_path / "elsewhere")
    archive.symlink_to(tmp_path / "elsewhere")
    assert_made_anew(compiler)
    assert not archive.is_symlink()


def test_an_intact_archive_of_no_use(archive: Path, compiler: FakeCompiler):
    for content in (b"no zip file", cache.zipped({"engine/impacts.nbc": b"no code"})):
        archive.write_bytes(cache.checksum(archive, content) + content)
        assert cache.is_compiled()
        before = compiler.compiled
        assert cache.load_kernels() == cache.load_kernels() == RESULT
        assert compiler.compiled == before + 1


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
    assert cache.archive_path() is None
    assert not cache.is_compiled()
    assert cache.load_kernels() == RESULT
    assert compiler.compiled == 1
    assert "without a user cache directory" in cache.obstacle()
    assert not list(tmp_path.iterdir())


def test_a_relative_cache_directory_is_ignored(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    path = cache.archive_path()
    assert path is None or tmp_path not in path.parents


def test_a_home_that_cannot_be_written(home: Path, compiler: FakeCompiler):
    """A file where the directory should be, which holds for root too."""
    home.parent.write_text("a file")
    home.parent.chmod(0o666)  # such as /dev/null
    assert cache.load_kernels() == RESULT
    assert compiler.compiled == 1
    assert not cache.is_compiled()
    assert "which cannot be written" in cache.obstacle()


def refuse(*_args: Any, **_kwargs: Any) -> None:
    raise PermissionError


def test_a_home_that_can_only_be_read(archive: Path, compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(cache, "write_archive", refuse)
    assert cache.load_kernels() == RESULT
    assert compiler.compiled == 1
    assert archive.exists()


def test_no_temporary_directory(home: Path, compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(tempfile, "gettempdir", refuse)
    assert cache.load_kernels() == RESULT
    assert compiler.compiled == 1
    assert not home.exists()


def test_a_temporary_directory_that_others_can_replace(
    archive: Path, compiler: FakeCompiler, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    (tmp_path / "temporary").mkdir()
    (tmp_path / "temporary").chmod(0o777)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    assert cache.load_kernels() == RESULT
    assert compiler.compiled == 2
    assert archive.exists()


@pytest.mark.usefixtures("home", "compiler")
def test_the_temporary_directory_is_removed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    cache.load_kernels()
    assert not list((tmp_path / "temporary").iterdir())


# Gets a signal while the code loads.
SIGNALLED = """
import os, signal, sys
from armour.engine import cache, kernels
number = getattr(signal, sys.argv[1])
if sys.argv[2:]:
    signal.signal(number, signal.SIG_IGN)
before = signal.getsignal(number)
def compiled(*names, directory):
    (directory / "code").write_bytes(b"code")
    os.kill(os.getpid(), number)
    return {}
kernels.compiled = compiled
cache.load_kernels()
assert signal.getsignal(number) == before
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs signals")
@pytest.mark.parametrize(("name", "ends"), [("SIGTERM", True), ("SIGHUP", True), ("SIGHUP", False)])
def test_a_process_that_a_signal_ends_leaves_nothing(tmp_path: Path, name: str, ends: bool):
    """A signal that is ignored, as nohup has it, stays so."""
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), "TMPDIR": str(temporary)}
    program = [sys.executable, "-c", SIGNALLED, name, *([] if ends else ["ignored"])]
    done = subprocess.run(program, env=environment, check=False)
    assert done.returncode == (-getattr(signal, name) if ends else 0)
    assert not list(temporary.iterdir())


def test_numbas_settings_are_restored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(CONFIG, "CACHE_DIR", "of the user")
    with kernels.numba_cache(tmp_path):
        assert str(tmp_path) == CONFIG.CACHE_DIR
    assert CONFIG.CACHE_DIR == "of the user"


def test_numbas_settings_are_those_of_the_user_while_it_compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Other threads may make functions with a cache of their own meanwhile."""
    seen = []

    class Dispatcher:
        def __init__(self, _function: Any) -> None:
            pass

        def enable_caching(self) -> None:
            seen.append(CONFIG.CACHE_DIR)

        def compile(self, _signature: Any) -> None:
            seen.append(CONFIG.CACHE_DIR)

        def disable_compile(self) -> None:
            pass

    monkeypatch.setattr(CONFIG, "CACHE_DIR", "of the user")
    monkeypatch.setattr(numba, "njit", lambda **_options: Dispatcher)
    kernels.compiled("impacts", directory=tmp_path)
    assert seen == [str(tmp_path), "of the user"]


@pytest.mark.usefixtures("compiler")
def test_a_system_without_users(home: Path, monkeypatch: pytest.MonkeyPatch):
    """Such as Windows."""
    monkeypatch.delattr(os, "geteuid")
    monkeypatch.delattr(os, "getuid")
    cache.load_kernels()
    home.chmod(0o777)
    assert cache.is_compiled()
    assert not cache.obstacle()


@pytest.mark.usefixtures("compiler")
def test_an_archive_in_use_that_cannot_be_replaced(archive: Path, monkeypatch: pytest.MonkeyPatch):
    """As on Windows."""
    archive.write_bytes(b"damaged")
    monkeypatch.setattr(os, "replace", refuse)
    assert cache.load_kernels() == RESULT
    assert [path.name for path in archive.parent.iterdir()] == [archive.name]


def missing(package: str) -> str:
    raise PackageNotFoundError(package)


def test_without_numba(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(cache, "version", missing)
    with pytest.raises(
        ArmourError, match=r"^numba is not installed; .*: type `python -m pip install --upgrade numba`$"
    ):
        cache.is_compiled()


def test_with_a_numba_that_cannot_be_imported(monkeypatch: pytest.MonkeyPatch):
    """Numba refuses versions of numpy that are too new for it."""
    monkeypatch.setitem(sys.modules, "armour.engine.kernels", None)
    with pytest.raises(ArmourError, match=r"^numba cannot be imported: .*; .*: type `python -m pip"):
        cache.load_kernels()


@pytest.mark.usefixtures("compiler")
def test_the_oldest_archives_are_deleted(home: Path):
    home.mkdir(parents=True, mode=0o700)
    for age in range(7):
        other = home / f"{age}{cache.SUFFIX}"
        other.write_bytes(b"")
        os.utime(other, (1e9 - age, 1e9 - age))
    (home / "notes.txt").write_text("of the user")
    cache.load_kernels()
    assert {path.name for path in home.iterdir() if path.name[0].isdigit() and path.stat().st_size == 0} == {
        f"{age}{cache.SUFFIX}" for age in range(4)
    }
    assert (home / "notes.txt").exists()
    assert cache.is_compiled()


def test_a_change_of_any_file_of_the_core_is_another_archive(tmp_path: Path):
    package = tmp_path / "armour"
    for name in ("core", "engine"):
        shutil.copytree(cache.PACKAGE / name, package / name)
    before = cache.digest()
    assert cache.digest(package) == before
    for path in [*(package / "core").glob("*.py"), package / "engine" / "kernels.py"]:
        text = path.read_text()
        path.write_text(text + "\n")
        assert cache.digest(package) != before
        path.write_text(text)
    (package / "engine" / "batch.py").write_text("")
    assert cache.digest(package) == before


def test_another_version_of_numba_is_another_archive(monkeypatch: pytest.MonkeyPatch):
    before = cache.archive_path()
    monkeypatch.setattr(cache, "version", lambda _package: "0.0")
    assert cache.archive_path() != before


# With a small kernel in place of the searches, which take long to compile.
PROGRAM = """
import numpy as np
from armour.engine import batch, cache, kernels
from tests.helpers.cases import armour
from tests.helpers.small_kernel import doubled
rows, *_, ends = kernels.SIGNATURES[kernels.impacts]
kernels.SIGNATURES = {kernels.impacts: kernels.SIGNATURES[kernels.impacts], doubled: (rows, ends)}
print(batch.impacts(batch.packed([armour()]), np.array([800.0])).V[0])
print(sum(cache.kernel("impacts").stats.cache_hits.values()))
print(sum(sum(kernel.stats.cache_hits.values()) for kernel in cache.load_kernels().values()))
"""


def test_processes_with_numba(tmp_path: Path):
    """The first compiles, for its archive is damaged; the second loads what it needs."""
    # Numba's optimisation takes most of the time.
    settings = {"XDG_CACHE_HOME": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path), "NUMBA_OPT": "0"}
    environment = {**os.environ, **settings}

    def outputs(program: str) -> list[str]:
        done = subprocess.run(
            [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
        )
        assert not done.stderr
        return done.stdout.split()

    (path,) = outputs("from armour.engine import cache; print(cache.archive_path())")
    Path(path).parent.mkdir(mode=0o700)
    Path(path).write_bytes(b"damaged")
    velocity, hits, _ = outputs(PROGRAM)
    assert outputs(PROGRAM) == [velocity, "1", "2"]
    assert hits == "0"
    assert [file.name for file in Path(path).parent.iterdir()] == [Path(path).name]


def test_the_plain_commands_do_not_import_numba():
    program = (
        "import sys; from armour import ballistic_limit, load_scenario, simulate; s = load_scenario(sys.argv[1]);"
        "simulate(s); ballistic_limit(s); print('numba' in sys.modules, 'scipy.stats' in sys.modules)"
    )
    scenario = Path(__file__).parent.parent.parent / "scenarios" / "wilkins.toml"
    done = subprocess.run([sys.executable, "-c", program, scenario], capture_output=True, text=True, check=True)
    assert done.stdout == "False False\n"
