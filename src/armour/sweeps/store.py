"""Chunks of a sweep on disk, from which it resumes, and its table in CSV or Parquet.

A folder beside the output, named after it with the suffix ``.parts``, which only the user can enter, contains

* ``lock``, locked by the process at work; the system unlocks it when that process ends;
* ``job``, what the chunks belong to, and their number of rows;
* ``0000000000000.npz`` and so on, each named after its first row, counted from 0, with the columns and the warnings of
  its rows, and checksums.

Files are written under another name and renamed: a kill at any instant leaves each of them whole or missing.
An existing folder belongs to a sweep if it contains a job, or only what precedes one; nothing else in it is touched.
"""

import csv
import json
import os
import re
import secrets
import stat
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import sha256
from io import BytesIO, StringIO
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from filelock import FileLock, Timeout

from armour.errors import mistake, refuse
from armour.files import csv_cell, csv_value, exchangeable, make_private, reason, unwritable, wrong_ending

RESUME = "repeat the same command to resume"
# Rows of a row group of Parquet, whatever the size of a chunk.
ROW_GROUP = 100_000

_LOCK, _JOB = "lock", "job"
_CHUNK = re.compile(r"\d{13}\.npz")
# A file that is being written.
_PART = re.compile(r"\.armour-[0-9a-f]{16}")


class Chunk(NamedTuple):
    """Part of a table."""

    columns: Mapping[str, Any]
    warnings: Mapping[str, int]  # with the number of rows that each concerns


def parts_of(output: Path) -> Path:
    """Return the folder of the chunks of an output, which is there while its sweep is not finished."""
    return Path(f"{output}.parts")


class Store:
    """Chunks of a table, CSV or Parquet by the suffix of its file, open to one process at a time.

    A job that an earlier process began has chunks of a ``size``, which is 0 before.  With ``replace`` the table takes
    the place of an older file.
    """

    def __init__(self, output: Path, job: Mapping[str, str], *, replace: bool = False) -> None:
        self.output, self.folder, self.replace = output, parts_of(output), replace
        refuse(wrong_ending(output, (".csv", ".parquet")))
        self.is_csv = is_csv(output)
        self.job = {**job, "format": "CSV" if self.is_csv else "Parquet"}
        self._digest = sha256(json.dumps(self.job).encode()).hexdigest()
        self.size = 0
        self._written = False
        self._lock = FileLock(self.folder / _LOCK, timeout=0)

    def __enter__(self) -> "Store":
        refuse(unwritable(self.output))
        if exchangeable(self.output.parent, stat.S_IWOTH):
            message = "must be in a folder that no other user can exchange or, like /tmp, one with the sticky bit"
            raise mistake(self.output, "", message)
        with self._disk():
            self._acquire()
            try:
                self._open()
            except BaseException:
                self.__exit__()
                raise
        return self

    def __exit__(self, *_error: object) -> None:
        """Remove the folder if the output is written or no chunk is, and unlock it."""
        unused = self._written or not self.starts()
        if unused:
            self._remove()
        self._lock.release()
        if unused and sys.platform == "win32":  # which removes no open file
            self._remove()

    def begin(self, size: int) -> None:
        """Start a job with chunks of a number of rows."""
        self.size = size
        with self._new(self.folder / _JOB) as file:
            file.write(json.dumps({"job": self.job, "size": size}).encode())

    def starts(self) -> list[int]:
        """Return the first rows of the chunks on disk, ascending."""
        return sorted(int(path.stem) for path in self.folder.glob("*") if _CHUNK.fullmatch(path.name))

    def path(self, start: int) -> Path:
        """Return the file of the chunk of a first row."""
        return self.folder / f"{start:013d}.npz"

    def save(self, start: int, chunk: Chunk) -> None:
        """Write the chunk of a first row; zip adds a checksum of each column."""
        about = json.dumps([self._digest, list(chunk.columns), chunk.warnings])
        # Numpy 2.0 leaves its zip file open where writing fails: memory does not.
        content = BytesIO()
        np.savez(content, *chunk.columns.values(), about=about)
        with self._new(self.path(start)) as file:
            file.write(content.getbuffer())

    def load(self, start: int, rows: Mapping[str, Any]) -> Chunk | None:
        """Read the chunk of some rows, given by key; None if it is not what was written for them."""
        # zip and numpy raise many kinds of errors.
        with suppress(Exception), self.path(start).open("rb") as file, np.load(file) as content:
            job, names, warnings = json.loads(str(content["about"]))
            columns = {name: content[f"arr_{number}"] for number, name in enumerate(names)}
            same = all(np.array_equal(columns[key], values) for key, values in rows.items())
            if job == self._digest and same and len({len(values) for values in columns.values()}) == 1:
                return Chunk(columns, warnings)
        return None

    def finish(self, chunks: Iterable[Mapping[str, Any]]) -> None:
        """Write the table of some columns, a chunk after the other."""
        with self._new(self.output) as file:
            write_table(file, chunks, as_csv=self.is_csv)
            self._check_output()
        self._written = True

    def _acquire(self) -> None:
        """Make the folder and lock it; another process may be at work in it."""
        while True:
            with suppress(FileNotFoundError):  # another process has just finished and removed it
                if not make_private(self.folder):
                    message = "must belong to you and be writable by no other user; choose another output, or move it"
                    raise mistake(self.folder, "", message)
                names = [path.name for path in self.folder.glob("*")]
                others = [name for name in names if name != _LOCK and not _PART.fullmatch(name)]
                if others and self._known() is None:
                    message = f"contains other files, such as {others[0]}; choose another output, or move them"
                    raise mistake(self.folder, "", message)
                self._lock.acquire()
                if (self.folder / _LOCK).exists():
                    return
                self._lock.release()

    def _open(self) -> None:
        """Check that the folder and the output are this job's, or free."""
        known = self._known()
        others = [name for name in self.job if known and known["job"].get(name) != self.job[name]]
        # Without a chunk, it was left by a process that was killed before its first one.
        if others and self.starts():
            message = (
                f"contains chunks of another sweep, which differs in {' and '.join(others)}; "
                "finish that with its own command and program, or remove the folder to start again"
            )
            raise mistake(self.folder, "", message)
        self._check_output()
        self.size = known["size"] if known and not others else 0

    def _known(self) -> dict[str, Any] | None:
        """Return the job on disk and the size of its chunks, None if there is none."""
        try:
            known: dict[str, Any] = json.loads((self.folder / _JOB).read_bytes())
            if self.job.keys() <= known["job"].keys() and known["size"] > 0:
                return known
        except FileNotFoundError:
            return None
        except (ValueError, KeyError, TypeError, AttributeError):
            pass
        message = "does not identify its sweep; choose another output, or remove the folder to start again"
        raise mistake(self.folder / _JOB, "", message)

    @contextmanager
    def _new(self, path: Path) -> Iterator[BinaryIO]:
        """Give a new file, which takes the place of another when it is whole."""
        part = self.folder / f".armour-{secrets.token_hex(8)}"
        with self._disk():
            try:
                with part.open("xb") as file:
                    yield file
                    file.flush()
                    os.fsync(file.fileno())
                part.replace(path)
            finally:
                part.unlink(missing_ok=True)

    def _check_output(self) -> None:
        may_go = self.replace and self.output.is_file() and not self.output.is_symlink()
        if os.path.lexists(self.output) and not may_go:
            raise mistake(self.output, "", "exists already; choose another name, or remove it")

    def _remove(self) -> None:
        """Remove the sweep's own files and, if it is empty then, the folder."""
        with suppress(OSError):
            for path in self.folder.glob("*"):
                if _CHUNK.fullmatch(path.name) or _PART.fullmatch(path.name):
                    path.unlink()
            for name in (_JOB, _LOCK):
                (self.folder / name).unlink(missing_ok=True)
            self.folder.rmdir()

    @contextmanager
    def _disk(self) -> Iterator[None]:
        """Turn what the file system refuses into a message."""
        try:
            yield
        except Timeout:
            message = "another sweep is at work on this output; wait for it, or choose another"
            raise mistake(self.folder, "", message) from None
        except OSError as error:
            message = f"cannot be written: {reason(error)}"
            with suppress(OSError):
                message += f"; what is done is kept, {RESUME}" if self.starts() else ""
            raise mistake(error.filename or self.output, "", message) from None


def is_csv(path: Path) -> bool:
    """Return whether a table is CSV; otherwise it is Parquet, which needs pyarrow."""
    if path.suffix.lower() == ".csv":
        return True
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        raise mistake("sweep", str(path), "needs pyarrow; pip install 'armour[parquet]', or write .csv") from None
    return False


def write_table(file: BinaryIO, chunks: Iterable[Mapping[str, Any]], *, as_csv: bool) -> None:
    """Write columns by name, a chunk after the other."""
    if as_csv:
        for number, columns in enumerate(chunks):
            file.write(csv_of(columns, header=number == 0))
        return
    # Imported here because it is not installed with the program by default.
    import pyarrow as pa
    from pyarrow import parquet

    tables = (pa.table({name: pa.array(values) for name, values in columns.items()}) for columns in chunks)
    first = next(tables)
    kept = first.slice(0, 0)
    with parquet.ParquetWriter(file, first.schema) as writer:
        for table in chain([first], tables):
            kept = pa.concat_tables([kept, table])
            while kept.num_rows >= ROW_GROUP:
                writer.write_table(kept.slice(0, ROW_GROUP).combine_chunks())
                kept = kept.slice(ROW_GROUP)
        if kept.num_rows:
            writer.write_table(kept.combine_chunks())


def csv_of(columns: Mapping[str, Any], *, header: bool = False) -> bytes:
    """Return columns as CSV, with or without header; NaN is an empty field."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    if header:
        writer.writerow(columns)
    writer.writerows(zip(*map(_cells, columns.values()), strict=True))
    return text.getvalue().encode()


def _cells(values: Any) -> list[Any]:
    """Return the values of a column as cells of CSV: None, which gives an empty field, for NaN."""
    column = np.asarray(values)
    cells: list[Any] = column.tolist()
    if column.dtype.kind not in "fiu":
        return [csv_cell(cell) for cell in cells]
    if column.dtype.kind == "f" and np.isnan(column).any():
        return [None if cell != cell else cell for cell in cells]
    return cells


def read_table(path: Path) -> dict[str, Any]:
    """Read the columns of a table as arrays; empty fields are NaN."""
    if not is_csv(path):
        from pyarrow import parquet

        table = parquet.read_table(path)
        return {name: table.column(name).to_numpy() for name in table.column_names}
    with path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    return {name: _column(cells) for name, cells in zip(header, zip(*rows, strict=True), strict=True)}


def _column(cells: Iterable[str]) -> Any:
    """Return cells of CSV as an array of numbers or, where one is a text, of texts."""
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array([csv_value(cell) for cell in cells])
