"""Attack the kept compiled code: ``python -m campaigns.cache [TRIALS]``, some 15 minutes.

Each trial damages the archive, or puts the process in a hostile place, and computes a few limits in a fresh process.
They must be those of plain Python, bit for bit, and no code of another user may run.  Run by root, it also tries other
users.
"""

import json
import os
import pickle
import random
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from zipfile import ZipFile

from armour.engine import cache

ROOT = Path(__file__).resolve().parent.parent
FLIPS, TRUNCATIONS, KILLS = 100, 10, 10
STRANGER = 12345  # a user without an entry in the list of users
NOBODY = 65534

PROGRAM = """
import json
from armour.engine import batch, cache
from tests.helpers.runs import random_designs
rows = batch.packed(random_designs(3))
found = batch.ballistic_limits(rows, 20.0, 4000.0, 1e-3)
stats = getattr(cache.kernel("ballistic_limits"), "stats", None)
print(json.dumps({
    "numbers": [[x.hex() for x in ends.tolist()] for ends in (found.defeated, found.perforated)],
    "loaded": stats is not None and sum(stats.cache_hits.values()) > 0,
    "kept": cache.is_compiled(),
    "obstacle": cache.obstacle(),
}))
"""


class Place(NamedTuple):
    """Where a process runs: its files are below a directory of its own."""

    directory: Path
    environment: dict[str, str]

    @property
    def archive(self) -> Path:
        """The archive of compiled code."""
        return self.directory / "cache" / "armour" / archive_name()


class Evil:
    """Unpickled, it leaves a mark."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[Any, ...]:
        return Path.touch, (self.mark,)


def archive_name() -> str:
    """Return the name of the archive."""
    path = cache.archive_path()
    assert path is not None
    return path.name


def started(place: Place, user: int | None = None, options: tuple[str, ...] = (), **settings: Any) -> Any:
    """Start the program in a place."""
    account = {} if user is None else {"user": user, "group": user, "extra_groups": []}
    return subprocess.Popen(
        [sys.executable, *options, "-c", PROGRAM],
        **{"cwd": ROOT, "env": place.environment, **account, **settings},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def ended(process: Any) -> dict[str, Any]:
    """Wait for a program; what it printed."""
    out, err = process.communicate(timeout=600)
    return dict(json.loads(out)) if process.returncode == 0 else {"error": f"{process.returncode}: {err[-500:]}"}


# How a place is made hostile; the process that runs in it, or None for the usual one.
Attack = Callable[[Place], Any]


def flip(share: float, place: Place) -> None:
    """Flip the bit that stands at a share of the archive's length."""
    data = bytearray(place.archive.read_bytes())
    bit = int(share * 8 * len(data))
    data[bit // 8] ^= 1 << bit % 8
    place.archive.write_bytes(data)


def truncate(share: float, place: Place) -> None:
    """Keep a share of the archive."""
    os.truncate(place.archive, int(share * place.archive.stat().st_size))


def write(content: bytes, place: Place) -> None:
    """Replace the content of the archive."""
    place.archive.write_bytes(content)


def rename(place: Place) -> None:
    """Give the archive the name of another one and the other way round."""
    other = place.archive.with_name("0" * 64 + cache.SUFFIX)
    content = place.archive.read_bytes()[cache.CHECKSUM_BYTES :]
    place.archive.write_bytes(cache.checksum(other, content) + content)


def plant(place: Place, corrupted: bool = False) -> None:
    """Write an intact archive whose pickles leave a mark, or end early."""
    directory = place.directory / "planted"
    with ZipFile(place.archive) as archive:
        names = archive.namelist()
    for name in names:
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        content = pickle.dumps(Evil(place.directory / "mark"))
        path.write_bytes(content[:-5] if corrupted else content)
    content = cache.zipped(cache.contents(directory))
    shutil.rmtree(directory)
    place.archive.write_bytes(cache.checksum(place.archive, content) + content)


def plant_and(change: Callable[[Place], Any], place: Place) -> Any:
    """Plant an archive and change the place, so that another user could have done it."""
    plant(place)
    return change(place)


def mode(bits: int, below: str, place: Place) -> None:
    """Set the permissions of a file or directory, and owners of what is above to this user."""
    path = place.archive if below == "archive" else place.directory / below
    path.chmod(bits)


def owned(below: str, place: Place) -> None:
    """Give a file or directory to another user."""
    path = place.archive if below == "archive" else place.directory / below
    os.chown(path, NOBODY, NOBODY)


def linked(below: str, place: Place) -> None:
    """Put a link that another user has made in the place of a file or directory."""
    path = place.archive if below == "archive" else place.directory / below
    path.rename(place.directory / "elsewhere")
    path.symlink_to(place.directory / "elsewhere")
    os.chown(path, NOBODY, NOBODY, follow_symlinks=False)


def replaced(make: Callable[[Path], Any], below: str, place: Place) -> None:
    """Put something else in the place of a file or directory."""
    path = place.archive if below == "archive" else place.directory / below
    path.unlink() if path.is_file() else shutil.rmtree(path)
    make(path)


def with_variables(variables: dict[str, str | None], place: Place, **settings: Any) -> Any:
    """Set environment variables; {} stands for the directory of the place."""
    environment = dict(place.environment)
    for name, value in variables.items():
        environment.pop(name, None)
        if value is not None:
            environment[name] = value.format(place.directory)
    return started(place._replace(environment=environment), **settings)


def limited(place: Place) -> Any:
    """Let no file be longer than some kilobytes, as on a full disk."""
    place.archive.unlink()
    return started(place, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)))


def full_temporary_directory(place: Place) -> Any:
    """Unpack to a full disk."""
    return started(place, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)))


def two(place: Place) -> Any:
    """Start two processes without an archive."""
    place.archive.unlink()
    other = started(place)
    process = started(place)
    assert "error" not in ended(other)
    return process


def killed(seed: int, place: Place) -> None:
    """Kill a process at a random moment before, in or after writing."""
    place.archive.unlink()
    process = started(place)
    time.sleep(random.Random(seed).uniform(1.0, 10.0))
    process.send_signal(signal.SIGKILL)
    process.communicate()


def in_a_zip_file(place: Place) -> Any:
    """Import the package from a zip file."""
    path = shutil.make_archive(str(place.directory / "package"), "zip", ROOT / "src")
    return with_variables({"PYTHONPATH": os.pathsep.join([path, str(ROOT)])}, place)


def read_only_package(place: Place) -> Any:
    """Import the package from a directory that cannot be written."""
    shutil.copytree(ROOT / "src", place.directory / "src", ignore=shutil.ignore_patterns("__pycache__"))
    for path in [place.directory / "src", *(place.directory / "src").rglob("*")]:
        path.chmod(0o555)
    return with_variables({"PYTHONPATH": os.pathsep.join([str(place.directory / "src"), str(ROOT)])}, place)


def settings_in_the_working_directory(place: Place) -> Any:
    """Start where another user has left settings of numba."""
    (place.directory / ".numba_config.yaml").write_text("cache_dir: planted\ndisable_jit: 1\nopt: 0\n")
    return started(place, cwd=place.directory)


def as_user(user: int, variables: dict[str, str | None], place: Place) -> Any:
    """Run as another user, who owns the place."""
    for path in [place.directory, *place.directory.rglob("*")]:
        os.chown(path, user, user)
    return with_variables(variables, place, user=user)


def attacks() -> Iterator[tuple[str, Attack]]:
    """Yield what is tried."""
    rng = random.Random(20261122)
    for i in range(FLIPS):
        # A tenth in the checksum, a tenth in the list of the files.
        yield "a flipped bit", partial(flip, rng.uniform(*{0: (0.0, 7e-5), 1: (0.999, 1.0)}.get(i % 10, (0.0, 1.0))))
    for _ in range(TRUNCATIONS):
        yield "a truncated archive", partial(truncate, rng.random())
    yield "nothing", lambda _: None
    yield "an empty archive", partial(write, b"")
    yield "a foreign file", partial(write, b"PK\x03\x04 foreign" * 1000)
    yield "an archive of another name", rename
    yield "an intact archive, its pickles corrupted", partial(plant, corrupted=True)
    yield "a directory in place of the archive", partial(replaced, Path.mkdir, "archive")
    yield "a pipe in place of the archive", partial(replaced, os.mkfifo, "archive")
    for below, bits in (("archive", 0o666), ("archive", 0o620), ("cache/armour", 0o777), ("cache/armour", 0o1777)):
        yield "planted: others can write file or directory", partial(plant_and, partial(mode, bits, below))
    yield "planted: others can write a parent", partial(plant_and, partial(mode, 0o777, "cache"))
    yield "a parent like /tmp", partial(mode, 0o1777, "cache")
    if os.geteuid() == 0:
        for below in ("archive", "cache/armour", "cache"):
            yield "planted: owned by another user", partial(plant_and, partial(owned, below))
            yield "planted: linked by another user", partial(plant_and, partial(linked, below))
    for value in ("relative", "", "{}/missing/cache", "/dev/null", "/proc/nowhere"):
        yield "XDG_CACHE_HOME relative, empty, missing, a file", partial(with_variables, {"XDG_CACHE_HOME": value})
    for value in ("{}/missing", "/dev/null", "/proc"):
        yield "TMPDIR missing, a file, read-only", partial(with_variables, {"TMPDIR": value})
    yield (
        "TMPDIR that others can write",
        lambda place: (
            mode(0o777, "temporary", place),
            with_variables({"TMPDIR": "{}/temporary"}, place),
        )[1],
    )
    yield "a full disk, writing", limited
    yield "a full disk, unpacking", full_temporary_directory
    yield "two processes at a time", two
    for seed in range(KILLS):
        yield "a process killed", partial(killed, seed)
    for variables in (
        {"NUMBA_CACHE_DIR": "{}/numba"},
        {"NUMBA_CACHE_LOCATOR_CLASSES": "unknown"},
        {"NUMBA_DISABLE_JIT": "1"},
        {"NUMBA_NUM_THREADS": "1"},
        {"NUMBA_OPT": "0"},
        {"NUMBA_CPU_NAME": "generic"},
        {"NUMBA_BOUNDSCHECK": "1"},
        {"PYTHONPYCACHEPREFIX": "{}/bytecode"},
        {"PYTHONDONTWRITEBYTECODE": "1"},
    ):
        yield "settings of numba and Python", partial(with_variables, variables)
    for option in ("-O", "-OO", "-B", "-X utf8"):
        yield "options of Python", partial(started, options=tuple(option.split()))
    yield "settings in the working directory", settings_in_the_working_directory
    yield "a read-only package", read_only_package
    yield "a package in a zip file", in_a_zip_file
    if os.geteuid() == 0 and can_run(STRANGER):
        nothing = {"HOME": None, "XDG_CACHE_HOME": None}
        yield "no HOME, no entry in the list of users", partial(as_user, STRANGER, nothing)
        yield "another user's home", lambda place: with_variables({}, place, user=NOBODY)
        yield (
            "a read-only home with an archive",
            lambda place: (
                mode(0o555, "cache/armour", place),
                as_user(NOBODY, {}, place),
            )[1],
        )
        yield (
            "a read-only home",
            lambda place: (
                shutil.rmtree(place.directory / "cache"),
                place.directory.chmod(0o555),
                as_user(NOBODY, {}, place),
            )[2],
        )


def can_run(user: int) -> bool:
    """Return whether another user can start this Python and read this checkout."""
    with tempfile.TemporaryDirectory() as name:
        place = Place(Path(name), {"PYTHONPATH": str(ROOT / "src")})
        try:
            process = started(place, user=user, options=("-c", "import armour.engine.batch, tests"))
        except OSError:
            return False
        process.communicate()
        return bool(process.returncode == 0)


def tried(attack: Attack, kept: bytes, right: Any) -> tuple[str, str]:
    """Return how an attack ended, and details where it ended badly."""
    with tempfile.TemporaryDirectory(prefix="campaign-", ignore_cleanup_errors=True) as name:
        directory = Path(name)
        (directory / "temporary").mkdir()
        environment = {
            "PATH": os.environ["PATH"],
            "HOME": str(directory),
            "XDG_CACHE_HOME": str(directory / "cache"),
            "PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(ROOT)]),
        }
        place = Place(directory, environment)
        place.archive.parent.mkdir(mode=0o700, parents=True)
        place.archive.write_bytes(kept)
        place.archive.chmod(0o600)
        found = ended(attack(place) or started(place))
        if (directory / "mark").exists():
            return "foreign code ran", str(found)
        if "error" in found:
            return "an error", found["error"]
        if found["numbers"] != right:
            return "wrong numbers", str(found)
        if found["loaded"]:
            return "right, loaded", ""
        return ("right, made anew" if found["kept"] else "right, not kept"), found["obstacle"]


def main() -> None:
    """Run the attacks and print a table of counts."""
    with tempfile.TemporaryDirectory() as name:
        place = Place(Path(name), {**os.environ, "XDG_CACHE_HOME": f"{name}/cache"})
        plain = ended(with_variables({"NUMBA_DISABLE_JIT": "1"}, place))["numbers"]
        compiled = ended(started(place))
        assert compiled["numbers"] == plain
        kept = place.archive.read_bytes()
    chosen = [(name, attack) for name, attack in attacks() if not sys.argv[1:] or sys.argv[1] in name]
    with ThreadPoolExecutor(2) as pool:
        ends = list(pool.map(lambda one: tried(one[1], kept, plain), chosen))
    table: dict[str, Counter[str]] = {}
    for (name, _), (end, details) in zip(chosen, ends, strict=True):
        table.setdefault(name, Counter())[end] += 1
        if details:
            print(f"{name}: {end}: {details}")
    print()
    for name, counts in table.items():
        print(f"{name:50} {'; '.join(f'{end}: {count}' for end, count in counts.items())}")
    bad = sum(end[:5] != "right" for end, _ in ends)
    print(f"{len(ends)} trials, {bad} of them bad")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
