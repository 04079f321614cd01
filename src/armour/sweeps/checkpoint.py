"""Checkpoints of a long job: chunks of its table on disk, joined into one file at the end.

A folder beside the output, named after it with the suffix ``.parts``, holds

* ``lock``, locked by the process at work; the system unlocks it when that process ends;
* ``job``, what the chunks belong to: the job, the format of the table and the number of rows of a chunk;
* ``00000000.chunk`` and so on, each a line with its number of rows and two checksums, and then its rows;
* ``whole``, the table while it is joined;
* ``joined``, the checksum of the joined table: after a kill, it tells that the output is this table.

Files are written under another name, synced and renamed: a kill at any instant leaves each of them whole or missing.
The checksum of a chunk covers its job, place and content, so that a damaged, exchanged or foreign one is noticed.
"""

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

from armour.errors import InputError, Problem, refuse
from armour.files import reason, sync_folder, unwritable, wrong_ending
from armour.sweeps.job import Job, differences
from armour.sweeps.lock import holds, locked, unlock
from armour.sweeps.tables import count_rows, encoded, is_csv, join

RESUME = "repeat the same command to resume"

# In the order in which they are removed: the record of a finished job goes last.
_FILES = ("*.chunk", "*.new", "whole", "job", "joined")


class DamagedError(Exception):
    """A chunk on disk is not what was written."""


class _Chunk(NamedTuple):
    rows: int
    source: str  # hash of the values that the rows were computed for
    content: bytes


def parts_of(output: Path) -> Path:
    """Return the folder of the chunks of an output, which is there while its sweep is not finished."""
    return output.with_name(f"{output.name}.parts")


class Store:
    """Chunks of a table, CSV or Parquet by the suffix of its file, open to one process at a time.

    ``size`` is the number of rows of a chunk, None until `begin` where the job is not begun.  ``finished`` is the
    number of rows of the output once it is this job's.  With ``replace`` it takes the place of an older file.
    """

    def __init__(self, output: Path, job: Job, *, replace: bool = False) -> None:
        self.output, self.folder, self.replace = output, parts_of(output), replace
        refuse(wrong_ending(output, (".csv", ".parquet")))
        self.is_csv = is_csv(output)
        self.job = {**job, "format": "CSV" if self.is_csv else "Parquet"}
        self.size: int | None = None
        self.finished: int | None = None

    def __enter__(self) -> "Store":
        refuse(unwritable(self.output))
        with self._disk():
            lock = locked(self.folder)
            if lock is None:
                raise _problem(self.folder, "another sweep is at work on this output; wait for it, or choose another")
            self._lock = lock
            try:
                self._open()
            except BaseException:
                self._close()
                raise
        return self

    def __exit__(self, *_error: object) -> None:
        self._close()

    def begin(self, size: int) -> int:
        """Start with chunks of a number of rows, or go on with that of the chunks on disk; return the number."""
        if self.size is None:
            self.size = size
            with self._disk():
                self._write("job", json.dumps({**self.job, "size": size}).encode())
                sync_folder(self.output.parent)
        return self.size

    def has(self, index: int, values: Mapping[str, Any]) -> bool:
        """Return whether the chunk for values by key is on disk; raise a DamagedError if it is, but is not intact."""
        if not self._path(index).exists():
            return False
        if self._chunk(index).source != _hash_of(values):
            raise DamagedError(self._path(index))
        return True

    def save(self, index: int, values: Mapping[str, Any], results: Mapping[str, Any]) -> None:
        """Write a chunk: values by key, and what was computed for them."""
        content = encoded({**values, **results}, as_csv=self.is_csv, header=index == 0)
        rows = len(next(iter(values.values())))
        source = _hash_of(values)
        head = f"{rows} {source} {self._checksum(index, rows, source, content)}\n"
        with self._disk():
            self._check_folder()
            self._write(self._path(index).name, head.encode() + content)

    def finish(self, count: int, rows: int) -> int:
        """Join n chunks into the output, which must have a number of rows, and return the number that it has.

        Raise a DamagedError if a chunk is not what was written.
        """
        whole = self.folder / "whole"
        with self._disk():
            try:
                with whole.open("wb") as file:
                    chunks = (self._chunk(index).content for index in range(count))
                    join(file, chunks, as_csv=self.is_csv)
                    file.flush()
                    os.fsync(file.fileno())
                if (found := count_rows(whole, as_csv=self.is_csv)) != rows:
                    raise _problem(whole, f"must have {rows} rows, found {found}; {RESUME}")
                self._write("joined", self._record(whole, found))
                self._check_folder()
                self._check_output()
                whole.replace(self.output)
                sync_folder(self.output.parent)
            finally:
                whole.unlink(missing_ok=True)
            self.finished = found
        return found

    def chunks(self) -> int:
        """Return the number of chunks on disk."""
        return len(list(self.folder.glob("*.chunk")))

    def _open(self) -> None:
        """Check that the folder and the output are this job's, or free."""
        if self.chunks():
            self.size = self._read_job()
        elif strange := [path for path in self.folder.iterdir() if not any(map(path.match, (*_FILES, "lock")))]:
            message = f"holds files of something else, {strange[0].name} for one; choose another output, or move them"
            raise _problem(self.folder, message)
        else:
            with suppress(InputError):  # what a process left that was killed before its first chunk
                self.size = self._read_job()
        if self.folder.stat().st_dev != self.output.parent.stat().st_dev:
            raise _problem(self.folder, f"must be on the file system of {self.output.parent}, to which it is moved")
        self.finished = self._rows_of_output()
        if self.finished is None:
            self._check_output()

    def _read_job(self) -> int:
        """Return the number of rows of a chunk of the job on disk, which must be this one."""
        try:
            job = json.loads((self.folder / "job").read_bytes())
            size = int(job["size"])
        except (FileNotFoundError, ValueError, KeyError, TypeError):
            message = "does not say which sweep it belongs to; remove the folder to start anew"
            raise _problem(self.folder / "job", message) from None
        if others := differences(self.job, job):
            message = (
                f"holds chunks of another sweep, which differs in {' and '.join(others)}; "
                "finish that with its own command and program, or remove the folder to start anew"
            )
            raise _problem(self.folder, message)
        return size

    def _rows_of_output(self) -> int | None:
        """Return the rows of the output if a process of this job wrote it and was killed before it removed the rest."""
        try:
            record = (self.folder / "joined").read_bytes()
            rows = int(record.split()[0])
            return rows if record == self._record(self.output, rows) else None
        except (OSError, ValueError, IndexError):
            return None

    def _record(self, table: Path, rows: int) -> bytes:
        """Return what tells a joined table: its number of rows, and a checksum of the job and the file."""
        found = sha256(json.dumps(self.job).encode())
        with table.open("rb") as file:
            while block := file.read(1 << 20):
                found.update(block)
        return f"{rows} {found.hexdigest()}".encode()

    def _chunk(self, index: int) -> _Chunk:
        """Read a chunk and verify it."""
        try:
            head, _, content = self._path(index).read_bytes().partition(b"\n")
            rows, source, checksum = head.decode("ascii").split(" ")
            if checksum == self._checksum(index, int(rows), source, content):
                return _Chunk(int(rows), source, content)
        except (OSError, ValueError):
            pass
        raise DamagedError(self._path(index))

    def _checksum(self, index: int, rows: int, source: str, content: bytes) -> str:
        found = sha256(f"{json.dumps(self.job)} {self.size} {index} {rows} {source}\n".encode())
        found.update(content)
        return found.hexdigest()

    def _write(self, name: str, content: bytes) -> None:
        """Write a file of the folder and see it on disk."""
        part = self.folder / f"{name}.new"
        with part.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        part.replace(self.folder / name)
        sync_folder(self.folder)

    def _path(self, index: int) -> Path:
        return self.folder / f"{index:08d}.chunk"

    def _check_folder(self) -> None:
        if not holds(self._lock, self.folder):
            raise _problem(self.folder, f"must stay during the sweep, and was removed; {RESUME}")

    def _check_output(self) -> None:
        may_go = self.replace and self.output.is_file() and not self.output.is_symlink()
        if os.path.lexists(self.output) and not may_go:
            raise _problem(self.output, "exists already; choose another name, or remove it")

    def _close(self) -> None:
        """Remove the folder if the output is written or no chunk is, and unlock it."""
        unused = False
        with suppress(OSError):
            unused = holds(self._lock, self.folder) and (self.finished is not None or not self.chunks())
            if unused:
                for path in (path for pattern in _FILES for path in self.folder.glob(pattern)):
                    path.unlink()
        unlock(self._lock, self.folder, remove=unused)

    @contextmanager
    def _disk(self) -> Iterator[None]:
        """Turn what the file system refuses into a message."""
        try:
            yield
        except OSError as error:
            message = f"cannot be written: {reason(error)}"
            with suppress(OSError):
                message += f"; what is done is kept, {RESUME}" if self.chunks() else ""
            raise _problem(error.filename or self.output, message) from None


def _hash_of(values: Mapping[str, Any]) -> str:
    found = sha256(repr(list(values)).encode())
    for column in values.values():
        found.update(column.tobytes())
    return found.hexdigest()


def _problem(path: Path | str, message: str) -> InputError:
    return InputError([Problem(str(path), "", message)])
