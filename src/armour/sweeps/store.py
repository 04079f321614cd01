"""Keep the rows of an unfinished sweep, so that it can resume.

A folder beside the output, named after it with the suffix ``.parts`` and open only to the user, contains a SQLite
database of the rows so far, in chunks, each with the job, which identifies the sweep.  SQLite keeps the database intact
if the process is killed, by a write-ahead log, and open to one process at a time; checksums detect damage on the disk.
The folder is removed when the table is written.

Such a folder may come with the files of somebody else.  It is therefore checked like any input: it may contain only
plain files, the database only one plain table, and this only rows that the sweep can have.  A row of each chunk, drawn
at random, must be computed again before the others are used.
"""

import os
import re
import shutil
import sqlite3
import stat
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from secrets import randbelow
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import PositiveInt, TypeAdapter

from armour.errors import InputError, mistake, refuse
from armour.files import exchangeable, make_private, printable, reason, unwritable, wrong_ending
from armour.sweeps.tables import is_csv, write_table

RESUME = "repeat the same sweep to resume"
# The database with its log, and a new file for the table.  A journal is none of them: SQLite would remove a file that
# it names.
FILE_NAME = re.compile(r"rows(-wal)?|\.armour-[0-9a-f]{16}")
# The table of the database.
TABLE = "chunk (start integer primary key, checksum, content)"
START_AGAIN = "remove the folder to start again"
BUSY = "another sweep is writing this output, or its disk cannot lock files; wait, or choose another output"


class Chunk(NamedTuple):
    """Consecutive rows of a table, with the warnings that concern them."""

    columns: Mapping[str, Any]  # by name, (rows,) each
    warnings: Mapping[str, int]  # number of rows that each warning concerns

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(next(iter(self.columns.values())))


# Returns labels of rows by name, (n,) each, given their indices, (n,).
Labels = Callable[[NDArray[np.int64]], Mapping[str, Any]]
# Before the values of a stored chunk: the job, and the number of rows of each warning.
ABOUT = TypeAdapter(tuple[dict[str, str], dict[str, PositiveInt]])


class Store:
    """Rows of an unfinished table: the first ``done`` rows, and the number of rows that each warning concerns.

    ``drawn`` has the values of a row of each chunk found, by its index.  The store is open to one process at a time.
    ``job`` identifies the sweep, and ``types`` are those of the columns.  With ``replace``, the table replaces an older
    file.  ``fits`` is called with the index of the first row of a chunk and the chunk, and returns whether the sweep
    can have it.
    """

    def __init__(
        self,
        output: Path,
        job: Mapping[str, str],
        types: Mapping[str, "np.dtype[Any] | str"],
        *,
        replace: bool = False,
        fits: Callable[[int, Chunk], bool] = lambda _start, _chunk: True,
    ) -> None:
        refuse(wrong_ending(output, (".csv", ".parquet")))
        self.output, self.folder, self.replace, self.fits = output, Path(f"{output}.parts"), replace, fits
        self.job = {**job, "format": "CSV" if is_csv(output) else "Parquet"}
        self.type = np.dtype([*types.items()])
        self._new_file = self.folder / f".armour-{os.urandom(8).hex()}"
        self.done, self.warnings, self.drawn = 0, Counter[str](), dict[int, tuple[Any, ...]]()
        self._written = False

    def __enter__(self) -> "Store":
        """Open the database, which is made if there is none, and check the chunks in it."""
        refuse(unwritable(self.output))
        if exchangeable(self.output.parent):
            message = "must be in a folder that no other user can exchange or, like /tmp, one with the sticky bit"
            raise mistake(self.output, "", message)
        self._check_output()
        with self._disk_errors():
            make_folder(self.folder)
            self._database = sqlite3.connect(self.folder / "rows", timeout=1.0, isolation_level=None)
            try:
                self._read()
            except BaseException:
                self._database.close()
                raise
        return self

    def __exit__(self, *_error: object) -> None:
        """Close the database; remove the folder if the table is written or there are no rows."""
        self._database.close()
        self._new_file.unlink(missing_ok=True)
        if self._written or not self.done:
            shutil.rmtree(self.folder, ignore_errors=True)

    def check_drawn(self, chunks: Iterable[Chunk]) -> None:
        """Compare the rows drawn with the same rows, computed again; if any value or warning differs, refuse them all.

        They must agree to the last bit, so that the table is the one that a single machine writes.
        """
        warnings, drawn = Counter[str](), iter(self.drawn.items())
        for chunk in chunks:
            warnings.update(chunk.warnings)
            for computed, (row, stored) in zip(zip(*chunk.columns.values(), strict=True), drawn, strict=False):
                for name, value, found in zip(chunk.columns, computed, stored, strict=True):
                    if value != found and (value == value or found == found):  # NaN agrees with NaN
                        difference = f"{name} = {found} in row {row + 1}, but computed {value}"
                        way_out = "if you began it on another machine, finish it there, otherwise "
                        raise self._strange(difference, f"{way_out}{START_AGAIN}")
        if not warnings <= self.warnings:
            raise self._strange("too few warnings")

    def append(self, chunk: Chunk) -> None:
        """Store a chunk, whose rows follow those that are done."""
        values = np.rec.fromarrays([*chunk.columns.values()], dtype=self.type)
        content = ABOUT.dump_json((self.job, dict(chunk.warnings))) + b"\n" + values.tobytes()
        with self._disk_errors():
            row = (self.done, checksum_of(self.done, content), content)
            self._database.execute("insert into chunk values (?, ?, ?)", row)
        self.done += chunk.rows
        self.warnings.update(chunk.warnings)

    def finish(self, made_by: Mapping[str, str] | None = None, labels: Labels = lambda _places: {}) -> None:
        """Write the table from all chunks, with labels of the rows.

        A Parquet file records ``made_by``, the program and command that made it.
        """
        with self._disk_errors():
            with self._new_file.open("xb") as file:
                write_table(file, self._labelled(labels), as_csv=is_csv(self.output), made_by=made_by)
                file.flush()
                os.fsync(file.fileno())
            self._check_output()
            self._new_file.replace(self.output)
        self._written = True

    def _labelled(self, labels: Labels) -> Iterator[Mapping[str, Any]]:
        """Yield the columns of each chunk by name: first the labels of its rows, then their values."""
        done = 0
        for chunk in self._chunks():
            yield {**labels(np.arange(done, done + chunk.rows)), **chunk.columns}
            done += chunk.rows

    def _read(self) -> None:
        """Lock and check the database, and read its chunks: count rows and warnings, and draw a row of each."""
        self._database.text_factory = bytes  # of damaged text too
        # The change to a log is made without a journal in a file.
        for pragma in ("locking_mode = exclusive", "journal_mode = memory", "journal_mode = wal"):
            self._database.execute(f"pragma {pragma}")
        self._database.execute("begin exclusive")
        self._database.execute(f"create table if not exists {TABLE}")
        tables = self._database.execute("select sql from sqlite_master limit 2").fetchall()
        if tables != [(f"CREATE TABLE {TABLE}".encode(),)]:
            raise self._strange("tables that no sweep makes")
        self._database.execute("commit")
        for chunk in self._chunks():
            row = randbelow(chunk.rows)
            self.drawn[self.done + row] = tuple(values[row] for values in chunk.columns.values())
            self.done += chunk.rows
            self.warnings.update(chunk.warnings)

    def _chunks(self) -> Iterator[Chunk]:
        """Yield all chunks; raise an error at the first one that is damaged."""
        done = 0
        for start, checksum, content in self._database.execute("select * from chunk order by start"):
            if start != done or type(content) is not bytes or checksum != checksum_of(start, content):
                raise sqlite3.DataError("damaged rows")
            chunk = self._chunk_of(content)
            if chunk is None or not self.fits(done, chunk):
                raise self._strange("rows that this sweep cannot have")
            yield chunk
            done += chunk.rows
        if done < self.done:
            raise sqlite3.DataError("missing rows")

    def _chunk_of(self, content: bytes) -> Chunk | None:
        """Return the chunk that `content` encodes, None if it encodes none; refuse one of another job."""
        line, _, values = content.partition(b"\n")
        try:
            job, warnings = ABOUT.validate_json(line)
            if differing := [name for name, value in self.job.items() if job.get(name) != value]:
                other = f"another sweep, which differs in {' and '.join(differing)}"
                way_out = f"repeat the other sweep's command with the version it was begun with, or {START_AGAIN}"
                raise mistake(self.folder, "", f"contains rows of {other}; {way_out}")
            rows = np.frombuffer(values, self.type)
        except ValueError:
            return None
        if not len(rows) or any(count > len(rows) or printable(words) != words for words, count in warnings.items()):
            return None
        return Chunk({name: rows[name].copy() for name in self.type.names or ()}, warnings)

    def _strange(self, found: str, way_out: str = START_AGAIN) -> InputError:
        """Return the error of a folder with something that this sweep cannot have stored."""
        return mistake(self.folder, "", f"must have rows of this sweep, found {found}; {way_out}")

    def _check_output(self) -> None:
        """Refuse an output that exists, unless it is a plain file to replace."""
        if self.output.is_symlink() or (self.output.exists() and not (self.replace and self.output.is_file())):
            raise mistake(self.output, "", "exists already; choose another name, or remove it")

    @contextmanager
    def _disk_errors(self) -> Iterator[None]:
        """Turn errors of the file system and the database in the block into an InputError."""
        try:
            yield
        except sqlite3.OperationalError as error:
            if error.sqlite_errorcode == sqlite3.SQLITE_BUSY:
                raise mistake(self.folder, "", BUSY) from None
            raise self._unwritable(self.folder, str(error)) from None
        except sqlite3.DatabaseError as error:
            raise mistake(self.folder, "", f"is damaged: {error}; {START_AGAIN}") from None
        except OSError as error:
            raise self._unwritable(error.filename or self.output, reason(error)) from None

    def _unwritable(self, path: str | Path, obstacle: str) -> InputError:
        """Return the error of a file or folder that cannot be written."""
        way_out = f"; finished rows are kept, {RESUME}" if self.done else ""
        return mistake(path, "", f"cannot be written: {obstacle}{way_out}")


def make_folder(folder: Path) -> None:
    """Make the folder of a sweep, unless it exists; refuse one that other users can change, or with other files."""
    if not make_private(folder):
        message = "must belong to you and be writable by no other user; choose another output, or move it"
        raise mistake(folder, "", message)
    for path in folder.iterdir():
        if not FILE_NAME.fullmatch(path.name) or not stat.S_ISREG(path.lstat().st_mode):
            raise mistake(folder, "", f"contains other files, such as {path.name}; choose another output, or move them")


def checksum_of(start: int, content: bytes) -> bytes:
    """Return a checksum of the index of the first row of a chunk, and of its content."""
    return sha256(b"%d %b" % (start, content)).digest()
