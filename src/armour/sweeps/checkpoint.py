"""Checkpoints of a long job: chunks of its table on disk, joined into one file at the end.

A folder beside the output, named after it with the suffix ``.parts``, which only the user can enter, holds

* ``lock``, locked by the process at work; the system unlocks it when that process ends;
* ``job``, what the chunks belong to: the job and the format of the table and, once it is joined, its checksum: after a
  kill, it tells that the output is this table;
* ``0000000000000.chunk`` and so on, each named after its first row, counted from 0: a line with its number of rows and
  two checksums and the warnings on its rows, and then these.

Files are written under another name, synced and renamed: a kill at any instant leaves each of them whole or missing.
The checksum of a chunk covers its job, place and content, so that a damaged, exchanged or foreign one is noticed.
A folder that exists is a sweep's if it has a job, or nothing but what precedes one; nothing else in it is touched.
Chunks have any number of rows: a process that resumes a job computes what is missing between them in chunks of its own.
"""

import json
import os
import re
import secrets
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

from armour.errors import InputError, Problem, refuse
from armour.files import reason, sync_folder, unwritable, wrong_ending
from armour.sweeps.job import Job, differences
from armour.sweeps.lock import NAME, holds, locked, make, unlock
from armour.sweeps.tables import count_rows, is_csv, join

RESUME = "repeat the same command to resume"

_JOB = "job"
_CHUNK = re.compile(r"\d{13}\.chunk")
# A file that is being written.
_PART = re.compile(r"\.armour-[0-9a-f]{16}")


class DamagedError(Exception):
    """A chunk on disk is not what was written."""


class Chunk(NamedTuple):
    """A chunk on disk."""

    rows: int
    source: str  # hash of the values that the rows were computed for
    warnings: Mapping[str, int]  # with the number of rows that each concerns
    content: bytes


def parts_of(output: Path) -> Path:
    """Return the folder of the chunks of an output, which is there while its sweep is not finished."""
    return output.with_name(f"{output.name}.parts")


class Store:
    """Chunks of a table, CSV or Parquet by the suffix of its file, open to one process at a time.

    ``begun`` tells whether an earlier process began the job.  ``finished`` is the number of rows of the output once it
    is this job's.  With ``replace`` it takes the place of an older file.
    """

    def __init__(self, output: Path, job: Job, *, replace: bool = False) -> None:
        self.output, self.folder, self.replace = output, parts_of(output), replace
        refuse(wrong_ending(output, (".csv", ".parquet")))
        self.is_csv = is_csv(output)
        self.job = {**job, "format": "CSV" if self.is_csv else "Parquet"}
        self.begun = False
        self.finished: int | None = None

    def __enter__(self) -> "Store":
        refuse(unwritable(self.output))
        with self._disk():
            make(self.folder)
            self._check_free()
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

    def begin(self) -> None:
        """Start a job that is not begun."""
        if not self.begun:
            with self._disk():
                self._write(_JOB, json.dumps(self.job).encode())
                sync_folder(self.output.parent)

    def starts(self) -> list[int]:
        """Return the first rows of the chunks on disk, ascending."""
        return sorted(int(path.stem) for path in self._files(_CHUNK))

    def path(self, start: int) -> Path:
        """Return the file of the chunk of a first row."""
        return self.folder / f"{start:013d}.chunk"

    def chunk(self, start: int) -> Chunk | None:
        """Read the chunk of a first row, None if it is not on disk; raise a DamagedError if it is not intact."""
        return self._chunk(start) if self.path(start).exists() else None

    def save(self, start: int, rows: int, source: str, content: bytes, warnings: Mapping[str, int]) -> None:
        """Write a chunk, given its first row, its parts, and the hash of the values behind it."""
        told = json.dumps(warnings)
        head = f"{rows} {source} {self._checksum(start, rows, source, told, content)} {told}\n"
        with self._disk():
            self._check_folder()
            self._write(self.path(start).name, head.encode() + content)

    def finish(self, rows: int) -> int:
        """Join the chunks into the output, which must have a number of rows, and return the number that it has.

        Raise a DamagedError if a chunk is not what was written.
        """
        whole = self._part()
        with self._disk():
            try:
                with whole.open("xb") as file:
                    join(file, self._contents(rows), as_csv=self.is_csv)
                    file.flush()
                    os.fsync(file.fileno())
                if (found := count_rows(whole, as_csv=self.is_csv)) != rows:
                    raise _problem(whole, f"must have {rows} rows, found {found}; {RESUME}")
                self._write(_JOB, json.dumps({**self.job, "table": self._record(whole, found)}).encode())
                self._check_folder()
                self._check_output()
                whole.replace(self.output)
                sync_folder(self.output.parent)
            finally:
                whole.unlink(missing_ok=True)
            self.finished = found
        return found

    def rows(self) -> int:
        """Return the number of rows in the chunks on disk."""
        count = 0
        for start in self.starts():
            with suppress(OSError, ValueError, IndexError), self.path(start).open("rb") as file:
                count += int(file.readline().split()[0])
        return count

    def _check_free(self) -> None:
        """Check that a sweep made the folder; another process may be at work in it."""
        if self._known_job() is not None:
            return
        with suppress(FileNotFoundError):  # another process has just removed its own
            for path in self.folder.glob("*"):
                if not (_PART.fullmatch(path.name) or (path.name == NAME and not path.lstat().st_size)):
                    message = f"holds files of something else, {path.name} for one; choose another output, or move them"
                    raise _problem(self.folder, message)

    def _open(self) -> None:
        """Check that the folder and the output are this job's, or free."""
        job = self._known_job()
        others = differences(self.job, job) if job else []
        # Without a chunk, it is what a process left that was killed before its first one.
        if others and self.starts():
            message = (
                f"holds chunks of another sweep, which differs in {' and '.join(others)}; "
                "finish that with its own command and program, or remove the folder to start anew"
            )
            raise _problem(self.folder, message)
        self.begun = job is not None and not others
        self.finished = self._rows_of_output(job or {})
        if self.finished is None:
            self._check_output()

    def _known_job(self) -> Mapping[str, str] | None:
        """Return the job on disk, None if there is none."""
        try:
            job = json.loads((self.folder / _JOB).read_bytes())
            if self.job.keys() <= job.keys():
                return dict(job)
        except FileNotFoundError:
            return None
        except (ValueError, AttributeError):
            pass
        message = "does not say which sweep it belongs to; choose another output, or remove the folder to start anew"
        raise _problem(self.folder / _JOB, message)

    def _rows_of_output(self, job: Mapping[str, str]) -> int | None:
        """Return the rows of the output if a process of this job wrote it and was killed before it removed the rest."""
        with suppress(OSError, ValueError, IndexError):
            record = job.get("table", "")
            rows = int(record.split()[0])
            return rows if record == self._record(self.output, rows) else None
        return None

    def _record(self, table: Path, rows: int) -> str:
        """Return what tells a joined table: its number of rows, and a checksum of the job and the file."""
        found = sha256(json.dumps(self.job).encode())
        with table.open("rb") as file:
            while block := file.read(1 << 20):
                found.update(block)
        return f"{rows} {found.hexdigest()}"

    def _contents(self, rows: int) -> Iterator[bytes]:
        """Yield the contents of the chunks of a number of rows."""
        start = 0
        while start < rows:
            chunk = self._chunk(start)
            yield chunk.content
            start += chunk.rows

    def _chunk(self, start: int) -> Chunk:
        """Read a chunk and verify it."""
        try:
            head, _, content = self.path(start).read_bytes().partition(b"\n")
            rows, source, checksum, told = head.decode("ascii").split(" ", 3)
            if checksum == self._checksum(start, int(rows), source, told, content):
                return Chunk(int(rows), source, json.loads(told), content)
        except (OSError, ValueError):
            pass
        raise DamagedError(self.path(start))

    def _checksum(self, start: int, rows: int, source: str, told: str, content: bytes) -> str:
        found = sha256(f"{json.dumps(self.job)} {start} {rows} {source} {told}\n".encode())
        found.update(content)
        return found.hexdigest()

    def _write(self, name: str, content: bytes) -> None:
        """Write a file of the folder and see it on disk."""
        part = self._part()
        with part.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        part.replace(self.folder / name)
        sync_folder(self.folder)

    def _part(self) -> Path:
        """Return a new name in the folder, for a file that is being written."""
        return self.folder / f".armour-{secrets.token_hex(8)}"

    def _files(self, name: re.Pattern[str]) -> list[Path]:
        return [path for path in self.folder.glob("*") if name.fullmatch(path.name)]

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
            unused = holds(self._lock, self.folder) and (self.finished is not None or not self.starts())
            if unused:
                # The record of a finished job goes last.
                for path in (*self._files(_CHUNK), *self._files(_PART), self.folder / _JOB):
                    path.unlink(missing_ok=True)
        unlock(self._lock, self.folder, remove=unused)

    @contextmanager
    def _disk(self) -> Iterator[None]:
        """Turn what the file system refuses into a message."""
        try:
            yield
        except OSError as error:
            message = f"cannot be written: {reason(error)}"
            with suppress(OSError):
                message += f"; what is done is kept, {RESUME}" if self.starts() else ""
            raise _problem(error.filename or self.output, message) from None


def _problem(path: Path | str, message: str) -> InputError:
    return InputError([Problem(str(path), "", message)])
