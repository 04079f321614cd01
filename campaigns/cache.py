"""Attack the compiled code that is kept: ``python -m campaigns.cache [NAME]``, some 20 minutes on two cores.

Each trial damages the archive, or puts the process in a hostile place, and finds a few limits in a fresh process.  They
must be those of plain Python, bit by bit, and no code that another user has planted may run.  Run by root, it acts as
other users too.
"""

import json
import os
import pickle
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from zipfile import ZipFile

from armour.engine import cache

ROOT = Path(__file__).resolve().parent.parent
FLIPS, TRUNCATIONS, KILLS = 100, 10, 10
NOBODY, UNLISTED = 65534, 12345

PROGRAM = """
import json
from armour.engine import batch, cache
from tests.helpers.runs import random_designs
found = batch.ballistic_limits(batch.packed(random_designs(3)), 20.0, 4000.0, 1e-3)
stats = getattr(cache.kernel("ballistic_limits"), "stats", None)
print(json.dumps({
    "numbers": [[end.hex() for end in ends.tolist()] for ends in (found.defeated, found.perforated)],
    "loaded": stats is not None and sum(stats.cache_hits.values()) > 0,
    "kept": cache.is_compiled(),
    "obstacle": cache.obstacle(),
}))
"""


class Place(NamedTuple):
    """A directory with a home and the archive in its cache, and the environment of a process in it."""

    directory: Path
    environment: dict[str, str]

    def path(self, below: str) -> Path:
        """Return the path of the archive or of what is below the directory."""
        return self.archive if below == "archive" else self.directory / below

    @property
    def archive(self) -> Path:
        """The path of the archive."""
        path = cache.archive_path()
        assert path is not None
        return self.directory / "cache" / "armour" / path.name


# Makes a place hostile; returns the process to judge, or None for the usual one.
Attack = Callable[[Place], Any]


class Harmful:
    """Leaves a mark when it is unpickled."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[Any, ...]:
        return Path.touch, (self.mark,)


def start(
    place: Place,
    variables: Mapping[str, str | None] = {},
    options: tuple[str, ...] = (),
    user: int | None = None,
    **settings: Any,
) -> Any:
    """Start the program in a place, with some variables of the environment; {} in them is the directory."""
    changed = {**place.environment, **variables}
    environment = {name: value.format(place.directory) for name, value in changed.items() if value is not None}
    if user is not None:
        settings |= {"user": user, "group": user, "extra_groups": []}
    return subprocess.Popen(
        [sys.executable, *options, "-c", PROGRAM],
        **{"cwd": ROOT, "env": environment, **settings},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def end(process: Any) -> dict[str, Any]:
    """Wait for a process and return what it printed."""
    out, err = process.communicate(timeout=600)
    return dict(json.loads(out)) if process.returncode == 0 else {"error": f"{process.returncode}: {err[-500:]}"}


def together(*attacks: Attack) -> Attack:
    """Return an attack of several steps."""

    def attack(place: Place) -> Any:
        return [step(place) for step in attacks][-1]

    return attack


def unchanged(_: Place) -> None:
    """Do nothing."""


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
    """Write a file in the place of the archive."""
    place.archive.write_bytes(content)


def rename(place: Place) -> None:
    """Write an archive that was made under another name."""
    other = place.archive.with_name("0" * 64 + cache.SUFFIX)
    content = place.archive.read_bytes()[cache.CHECKSUM_BYTES :]
    place.archive.write_bytes(cache.checksum(other, content) + content)


def plant(place: Place, bytes_missing: int = 0) -> None:
    """Write an intact archive of pickles that leave a mark, or that are cut."""
    harmful = pickle.dumps(Harmful(place.directory / "mark"))
    with ZipFile(place.archive) as archive:
        content = cache.zipped({name: harmful[: len(harmful) - bytes_missing] for name in archive.namelist()})
    place.archive.write_bytes(cache.checksum(place.archive, content) + content)


def replace(make: Callable[[Path], Any], below: str, place: Place) -> None:
    """Make something else in the place of a file or directory."""
    path = place.path(below)
    path.unlink() if path.is_file() else shutil.rmtree(path)
    make(path)


def permit(below: str, mode: int, place: Place) -> None:
    """Set the permissions of a file or directory."""
    place.path(below).chmod(mode)


def own(below: str, place: Place) -> None:
    """Give a file or directory to another user."""
    os.chown(place.path(below), NOBODY, NOBODY)


def link(below: str, place: Place) -> None:
    """Put a link of another user in the place of a file or directory."""
    path = place.path(below)
    path.rename(place.directory / "elsewhere")
    path.symlink_to(place.directory / "elsewhere")
    os.chown(path, NOBODY, NOBODY, follow_symlinks=False)


def own_all(user: int, place: Place) -> None:
    """Give the place to another user."""
    for path in [place.directory, *place.directory.rglob("*")]:
        os.chown(path, user, user)


def on_a_full_disk(place: Place) -> Any:
    """Let no file be longer than some kilobytes."""
    return start(place, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)))


def start_two(place: Place) -> Any:
    """Start two processes at a time."""
    both = start(place), start(place)
    assert "error" not in end(both[0])
    return both[1]


def kill(seconds: float, place: Place) -> None:
    """Kill a process after a while."""
    process = start(place)
    time.sleep(seconds)
    process.kill()
    process.communicate()


def settings_beside(place: Place) -> Any:
    """Start where another user has left settings of numba."""
    (place.directory / ".numba_config.yaml").write_text("cache_dir: planted\ndisable_jit: 1\nopt: 0\n")
    return start(place, cwd=place.directory)


def read_only_package(place: Place) -> Any:
    """Import the package from a directory that cannot be written."""
    for name in ("src", "configs"):
        shutil.copytree(ROOT / name, place.directory / name, ignore=shutil.ignore_patterns("__pycache__"))
    for path in [place.directory / "src", *(place.directory / "src").rglob("*")]:
        path.chmod(0o555)
    return start(place, {"PYTHONPATH": f"{{}}/src{os.pathsep}{ROOT}"})


def attacks() -> Iterator[tuple[str, Attack]]:
    """Yield what is tried, by name."""
    rng = random.Random(12)
    for i in range(FLIPS):
        # One in ten in the checksum, one in ten in the list of the files.
        yield "a flipped bit", partial(flip, rng.uniform(*{0: (0.0, 7e-5), 1: (0.999, 1.0)}.get(i % 10, (0.0, 1.0))))
    for _ in range(TRUNCATIONS):
        yield "a truncated archive", partial(truncate, rng.random())
    yield "nothing", unchanged
    yield "an empty file", partial(write, b"")
    yield "a foreign file", partial(write, b"PK\x03\x04 foreign" * 1000)
    yield "an archive of another name", rename
    yield "an intact archive of cut pickles", partial(plant, bytes_missing=5)
    yield "a directory as archive", partial(replace, Path.mkdir, "archive")
    yield "a pipe as archive", partial(replace, os.mkfifo, "archive")
    for below, mode in (("archive", 0o666), ("archive", 0o620), ("cache/armour", 0o777), ("cache/armour", 0o1777)):
        yield "planted where others can write", together(plant, partial(permit, below, mode))
    yield "planted below where others can write", together(plant, partial(permit, "cache", 0o777))
    yield "below a directory such as /tmp", partial(permit, "cache", 0o1777)
    without_archive = partial(replace, lambda _: None, "archive")
    if os.geteuid() == 0:
        for below in ("archive", "cache/armour", "cache"):
            yield "planted by another user", together(plant, partial(own, below))
            yield "planted behind a link of another user", together(plant, partial(link, below))
    for value in ("relative", "", "{}/missing/cache", "/dev/null", "/proc/nowhere"):
        yield "XDG_CACHE_HOME relative, empty, missing, a file", partial(start, variables={"XDG_CACHE_HOME": value})
    for value in ("{}/missing", "/dev/null", "/proc"):
        yield "TMPDIR missing, a file, read-only", partial(start, variables={"TMPDIR": value})
    yield (
        "TMPDIR where others can write",
        together(partial(permit, "temporary", 0o777), partial(start, variables={"TMPDIR": "{}/temporary"})),
    )
    yield "unpacked to a full disk", on_a_full_disk
    yield "written to a full disk", together(without_archive, on_a_full_disk)
    yield "two processes at a time", together(without_archive, start_two)
    for _ in range(KILLS):
        yield "after a killed process", together(without_archive, partial(kill, rng.uniform(1.0, 25.0)), unchanged)
    for variable in (
        "NUMBA_CACHE_DIR={}/numba",
        "NUMBA_CACHE_LOCATOR_CLASSES=unknown",
        "NUMBA_DISABLE_JIT=1",
        "NUMBA_NUM_THREADS=1",
        "NUMBA_OPT=0",
        "NUMBA_CPU_NAME=generic",
        "NUMBA_BOUNDSCHECK=1",
        "PYTHONPYCACHEPREFIX={}/bytecode",
        "PYTHONDONTWRITEBYTECODE=1",
    ):
        name, value = variable.split("=")
        for before in (unchanged, without_archive):
            yield "settings of numba and Python", together(before, partial(start, variables={name: value}))
    for option in ("-O", "-OO", "-P", "-X utf8"):
        yield "options of Python", partial(start, options=tuple(option.split()))
    yield "settings of numba in the working directory", settings_beside
    yield "a read-only package", read_only_package
    if os.geteuid() == 0 and can_start(NOBODY):
        nothing = {"HOME": None, "XDG_CACHE_HOME": None}
        yield "no HOME and no such user", partial(start, variables=nothing, user=UNLISTED)
        yield "another user's home", partial(start, user=NOBODY)
        as_nobody = together(partial(own_all, NOBODY), partial(start, user=NOBODY))
        yield "an archive in a read-only home", together(partial(permit, "cache/armour", 0o555), as_nobody)
        without_cache = partial(replace, lambda _: None, "cache")
        yield "a read-only home", together(without_cache, partial(permit, "", 0o555), as_nobody)


def can_start(user: int) -> bool:
    """Return whether another user can start this Python and read this checkout."""
    command = [sys.executable, "-c", "import armour.engine.batch, tests"]
    try:
        done = subprocess.run(command, cwd=ROOT, user=user, group=user, extra_groups=[], capture_output=True)
    except OSError:
        return False
    return done.returncode == 0


def judged(attack: Attack, kept: bytes, right: Any) -> tuple[str, str]:
    """Return how a trial ended, and details."""
    with tempfile.TemporaryDirectory(prefix="campaign-", ignore_cleanup_errors=True) as home:
        place = Place(
            Path(home),
            {
                **{name: os.environ[name] for name in ("PATH", "LD_LIBRARY_PATH") if name in os.environ},
                "HOME": home,
                "XDG_CACHE_HOME": f"{home}/cache",
                "PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(ROOT)]),
            },
        )
        place.path("temporary").mkdir()
        place.archive.parent.mkdir(mode=0o700, parents=True)
        place.archive.write_bytes(kept)
        place.archive.chmod(0o600)
        found = end(attack(place) or start(place))
        if place.path("mark").exists():
            return "BAD: planted code ran", str(found)
    if "error" in found:
        return "BAD: an error", found["error"]
    if found["numbers"] != right:
        return "BAD: wrong numbers", str(found)
    return f"right, {'loaded' if found['loaded'] else 'made anew' if found['kept'] else 'not kept'}", found["obstacle"]


def main() -> None:
    """Run the attacks and print a table of counts."""
    with tempfile.TemporaryDirectory() as name:
        place = Place(Path(name), {**os.environ, "XDG_CACHE_HOME": f"{name}/cache"})
        right = end(start(place, {"NUMBA_DISABLE_JIT": "1"}))["numbers"]
        assert end(start(place))["numbers"] == right
        kept = place.archive.read_bytes()
    # What is planted harms: here nobody else could have written it.
    assert judged(plant, kept, right)[0] == "BAD: planted code ran"
    chosen = [(name, attack) for name, attack in attacks() if "".join(sys.argv[1:2]) in name]
    table: dict[str, Counter[str]] = defaultdict(Counter)
    with ThreadPoolExecutor(2) as pool:
        for (name, _), (outcome, details) in zip(
            chosen, pool.map(lambda one: judged(one[1], kept, right), chosen), strict=True
        ):
            table[name][outcome] += 1
            if details:
                print(f"{name}: {outcome}: {details}", flush=True)
    print()
    for name, counts in table.items():
        print(f"{name:50} {'; '.join(f'{outcome}: {count}' for outcome, count in counts.items())}")
    bad = sum(count for counts in table.values() for outcome, count in counts.items() if outcome.startswith("BAD"))
    print(f"{len(chosen)} trials, {bad} bad")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
