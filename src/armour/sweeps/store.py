"""Keep the rows of an unfinished sweep, so that it can resume; write and read its table, in CSV or Parquet.

A folder beside the output, named after it with the suffix ``.parts`` and open only to the user, contains a SQLite
database: the job, which identifies the sweep, and the rows so far, in chunks.  SQLite keeps the database intact if the
process is killed, and open to one process at a time; checksums detect damage on the disk.  On a file system without
locks, as on some networks, the database is in a second folder, among the temporary files.  Both folders are removed
when the table is written.

Such a folder may come with the files of somebody else.  It is therefore checked like any input: it may contain only
plain files, the database only two plain tables, and these only rows that the sweep can have.  A row of each chunk,
drawn at random, must be computed again before the others are used.
"""

import csv
import json
import os
import re
import shutil
import sqlite3
import stat
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from functools import partial
from hashlib import sha256
from io import StringIO
from itertools import chain
from pathlib import Path
from secrets import randbelow
from tempfile import gettempdir
from time import time
from typing import Annotated, Any, BinaryIO, NamedTuple

import numpy as np
from pydantic import Field, TypeAdapter

from armour.errors import InputError, mistake, refuse
from armour.files import csv_cell, csv_value, exchangeable, make_private, printable, reason, unwritable, wrong_ending

RESUME = "repeat the same sweep to resume"
# Number of rows in a row group of Parquet, independent of the size of a chunk.
ROW_GROUP = 100_000
# Names of the database and of new files, such as one to try locks or a table being written, and of their journals.
FILE_NAME = re.compile(r"(rows|\.armour-[0-9a-f]{16})(-journal)?")
# Tables of the database, as SQLite itself spells them.
TABLES = (
    "CREATE TABLE job (checksum, content)",
    "CREATE TABLE chunk (start integer primary key, checksum, content)",
)
# End of a journal that names a further file, which SQLite would delete; the journal of a single database names none.
NAMES_A_FILE = bytes.fromhex("d9d505f920a163d7")
START_AGAIN = "remove the folder to start again"
BEGUN_ELSEWHERE = f"if you began it on another machine, finish it there, otherwise {START_AGAIN}"

Tell = Callable[[str], None]


class Chunk(NamedTuple):
    """Consecutive rows of a table, with the warnings that concern them."""

    columns: Mapping[str, Any]  # by name, (rows,) each
    warnings: Mapping[str, int]  # number of rows that each warning concerns

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(next(iter(self.columns.values())))


class About(NamedTuple):
    """Header of a stored chunk, before the values."""

    columns: dict[str, Annotated[str, Field(pattern=r"^[<>](f8|U[1-9]\d{0,2})$")]]  # type of each in numpy
    warnings: dict[str, Annotated[int, Field(ge=1, strict=True)]]  # number of rows of each


ABOUT, JOB = TypeAdapter(About), TypeAdapter(dict[str, str])


def parts_of(output: Path) -> Path:
    """Return the folder for the rows of an output; it exists while the sweep is unfinished."""
    return Path(f"{output}.parts")


class Store:
    """Rows of an unfinished table: the first ``done`` rows, and the number of rows that each warning concerns.

    ``drawn`` has the values of a row of each chunk found, by its index, and ``age_s`` the time since the last chunk was
    written, s.  The store is open to one process at a time.  ``job`` identifies the sweep.  ``tell`` is called with a
    line if rows are damaged, or kept elsewhere than beside the output.  With ``replace``, the table replaces an older
    file.  ``fits`` is called with the index of the first row of a chunk and the chunk, and returns whether the sweep
    can have it.
    """

    def __init__(
        self,
        output: Path,
        job: Mapping[str, str],
        tell: Tell,
        *,
        replace: bool = False,
        fits: Callable[[int, Chunk], bool] = lambda _start, _chunk: True,
    ) -> None:
        refuse(wrong_ending(output, (".csv", ".parquet")))
        self.fits = fits
        self.output, self.folder, self.tell, self.replace = output, parts_of(output), tell, replace
        self.is_csv = is_csv(output)
        self.job = {**job, "format": "CSV" if self.is_csv else "Parquet"}
        self.path = self.folder / "rows"
        self.done, self.warnings = 0, Counter[str]()
        self.drawn, self.age_s = dict[int, tuple[Any, ...]](), 0.0
        self._written = False

    def __enter__(self) -> "Store":
        refuse(unwritable(self.output))
        if exchangeable(self.output.parent, stat.S_IWOTH):
            message = "must be in a folder that no other user can exchange or, like /tmp, one with the sticky bit"
            raise mistake(self.output, "", message)
        self._check_output()
        with self._disk():
            make_folder(self.folder)
            if not has_locks(self.folder):
                place = Path(gettempdir(), f"armour-{sha256(bytes(self.output.absolute())).hexdigest()[:16]}.parts")
                make_folder(place)
                self.path = place / "rows"
                self.tell(f"{self.folder}: cannot be locked; rows are kept in {place}: only this machine can resume")
            try:
                self._open()
            except sqlite3.OperationalError:
                raise
            except sqlite3.DatabaseError:
                self.tell(f"{self.path}: damaged, all rows are computed again")
                for path in self.path.parent.glob("rows*"):
                    path.unlink()
                self._open()
        return self

    def __exit__(self, *_error: object) -> None:
        """Close the database; remove the folders if the table is written or there are no rows."""
        self._database.close()
        if self._written or not self.done:
            for folder in (self.path.parent, self.folder):
                shutil.rmtree(folder, ignore_errors=True)

    def check_drawn(self, chunks: Iterable[Chunk]) -> None:
        """Compare the rows drawn with the same rows, computed again; if any value or warning differs, refuse them all.

        They must agree to the last bit, so that the table is the one that a single machine writes.
        """
        warnings, drawn = Counter[str](), iter(self.drawn.items())
        for chunk in chunks:
            warnings.update(chunk.warnings)
            for computed, (row, stored) in zip(zip(*chunk.columns.values(), strict=True), drawn, strict=False):
                for name, value, found in zip(chunk.columns, computed, stored, strict=True):
                    if value != found and (value == value or found == found):
                        other = f"{name} = {found} in row {row + 1}, but computed {value}"
                        raise self._strange(other, BEGUN_ELSEWHERE)
        if not warnings <= self.warnings:
            raise self._strange("too few warnings")

    def append(self, chunk: Chunk) -> None:
        """Store the next rows."""
        content = packed(chunk)
        with self._disk():
            values = (self.done, self._checksum(self.done, content), content)
            self._database.execute("insert into chunk values (?, ?, ?)", values)
        self._count(chunk)

    def finish(self, made_by: Mapping[str, str] | None = None) -> None:
        """Write the table from all chunks; a Parquet file records ``made_by``, the program and command that made it."""
        part = new_file(self.folder)
        with self._disk():
            try:
                with part.open("xb") as file:
                    write_table(file, (chunk.columns for chunk in self._chunks()), as_csv=self.is_csv, made_by=made_by)
                    file.flush()
                    os.fsync(file.fileno())
                self._check_output()
                part.replace(self.output)
            finally:
                part.unlink(missing_ok=True)
        self._written = True

    def _open(self) -> None:
        """Open and lock the database and count its rows; remove the first damaged chunk and all after it."""
        self.done, self.warnings, self.drawn = 0, Counter(), {}
        with suppress(FileNotFoundError):
            self.age_s = time() - self.path.stat().st_mtime
        self._database = sqlite3.connect(self.path, timeout=0.0, isolation_level=None)
        try:
            # Damaged text does not raise an error, but its checksum differs.
            self._database.text_factory = partial(str, encoding="utf-8", errors="replace")
            self._database.execute("pragma locking_mode = exclusive")
            self._database.execute("begin exclusive")
            existing_tables = self._database.execute("select sql from sqlite_master limit 3").fetchall()
            for table in () if existing_tables else TABLES:
                self._database.execute(table)
            self._database.execute("commit")
            if existing_tables and existing_tables != [(table,) for table in TABLES]:
                raise self._strange("tables that no sweep makes")
            if self._database.execute("select start from chunk").fetchone():
                self._check_job()
            else:
                job = json.dumps(self.job)
                self._database.execute("delete from job")
                self._database.execute("insert into job values (?, ?)", [checksum_of(job), job])
            intact_chunks = 0
            with suppress(sqlite3.DataError):
                for chunk in self._chunks():
                    row = randbelow(chunk.rows)
                    self.drawn[self.done + row] = tuple(values[row] for values in chunk.columns.values())
                    self._count(chunk)
                    intact_chunks += 1
            removed = self._database.execute("delete from chunk where start >= ?", [self.done]).rowcount
            if self._database.execute("select count(*) from chunk").fetchone() != (intact_chunks,):
                raise sqlite3.DatabaseError("damaged table")
            if removed:
                self.tell(f"{self.path}: damaged, all but the first {self.done:,} rows are computed again")
        except BaseException:
            self._database.close()
            raise

    def _check_job(self) -> None:
        """Check that the stored rows belong to this job."""
        checksum, content = self._database.execute("select * from job").fetchone() or ("", "")
        if checksum != checksum_of(content):
            raise sqlite3.DatabaseError("damaged job")
        try:
            stored_job = JOB.validate_json(content)
        except ValueError:
            raise self._strange("no sweep") from None
        differing = [name for name, value in self.job.items() if stored_job.get(name) != value]
        if differing:
            message = (
                f"contains rows of another sweep, which differs in {' and '.join(differing)}; "
                f"finish that with its own command and program, or {START_AGAIN}"
            )
            raise mistake(self.path.parent, "", message)

    def _count(self, chunk: Chunk) -> None:
        self.done += chunk.rows
        self.warnings.update(chunk.warnings)

    def _chunks(self) -> Iterator[Chunk]:
        """Yield all chunks; raise an error at the first one that is damaged."""
        done = 0
        for start, checksum, content in self._database.execute("select * from chunk order by start"):
            if start != done or type(content) is not bytes or checksum != self._checksum(start, content):
                raise sqlite3.DataError("damaged rows")
            try:
                chunk = unpacked(content)
            except ValueError:
                raise self._strange("rows that no sweep has") from None
            if not self.fits(done, chunk):
                raise self._strange("rows that this sweep cannot have")
            yield chunk
            done += chunk.rows
        if done < self.done:
            raise sqlite3.DataError("missing rows")

    def _strange(self, found: str, way_out: str = START_AGAIN) -> InputError:
        return mistake(self.path.parent, "", f"must have rows of this sweep, found {found}; {way_out}")

    def _checksum(self, start: int, content: bytes) -> str:
        """Return a checksum of the job, of the index of the first row of a chunk, and of its content."""
        return sha256(f"{self.job} {start} ".encode() + content).hexdigest()

    def _check_output(self) -> None:
        is_replaceable = self.replace and self.output.is_file() and not self.output.is_symlink()
        if os.path.lexists(self.output) and not is_replaceable:
            raise mistake(self.output, "", "exists already; choose another name, or remove it")

    @contextmanager
    def _disk(self) -> Iterator[None]:
        """Turn errors of the file system and the database into an InputError."""
        try:
            yield
        except OSError as error:
            path, obstacle = error.filename or self.output, reason(error)
        except sqlite3.Error as error:
            path, obstacle = self.path, str(error)
            if getattr(error, "sqlite_errorcode", None) == sqlite3.SQLITE_BUSY:
                message = "another sweep is at work on this output; wait for it, or choose another"
                raise mistake(self.folder, "", message) from None
        else:
            return
        way_out = f"; finished rows are kept, {RESUME}" if self.done else ""
        raise mistake(path, "", f"cannot be written: {obstacle}{way_out}")


def make_folder(folder: Path) -> None:
    """Make the folder of a sweep, unless it exists; refuse one that other users can change, or with other files."""
    if not make_private(folder):
        message = "must belong to you and be writable by no other user; choose another output, or move it"
        raise mistake(folder, "", message)
    other_names = [path.name for path in folder.iterdir() if not is_part(path)]
    if other_names:
        raise mistake(
            folder, "", f"contains other files, such as {other_names[0]}; choose another output, or move them"
        )


def is_part(path: Path) -> bool:
    """Return whether a file is one that sweeps make: a plain file, not a link, nor a journal that names a file."""
    if not FILE_NAME.fullmatch(path.name) or not stat.S_ISREG(path.lstat().st_mode):
        return False
    with path.open("rb") as file:
        file.seek(-min(len(NAMES_A_FILE), path.stat().st_size), os.SEEK_END)
        return not path.name.endswith("-journal") or file.read() != NAMES_A_FILE


def has_locks(folder: Path) -> bool:
    """Return whether SQLite can lock a file in a folder."""
    path = new_file(folder)
    path.touch()
    try:
        with closing(sqlite3.connect(path)) as database:
            database.execute("begin exclusive")
        return True
    except sqlite3.OperationalError:
        return False
    finally:
        path.unlink()


def new_file(folder: Path) -> Path:
    """Return a new random path in the folder of a sweep."""
    return folder / f".armour-{os.urandom(8).hex()}"


def checksum_of(job: object) -> str:
    """Return a checksum of a job."""
    return sha256(f"{job}".encode()).hexdigest()


def packed(chunk: Chunk) -> bytes:
    """Return a chunk as bytes: a line with its header, and the values of one column after the other."""
    arrays = {name: np.asarray(values) for name, values in chunk.columns.items()}
    header = About({name: array.dtype.str for name, array in arrays.items()}, dict(chunk.warnings))
    return b"".join([ABOUT.dump_json(header), b"\n", *(array.tobytes() for array in arrays.values())])


def unpacked(content: bytes) -> Chunk:
    """Return the chunk in bytes made by `packed`; raise a ValueError if they are no chunk."""
    line, _, values = content.partition(b"\n")
    header = ABOUT.validate_json(line)
    types = {name: np.dtype(kind) for name, kind in header.columns.items()}
    row_bytes = sum(kind.itemsize for kind in types.values())
    if not row_bytes or not values or len(values) % row_bytes:
        raise ValueError("incomplete rows")
    rows, place, columns = len(values) // row_bytes, 0, {}
    for name, kind in types.items():
        columns[name] = np.frombuffer(values, kind, rows, place)
        place += rows * kind.itemsize
    if any(count > rows or printable(words) != words for words, count in header.warnings.items()):
        raise ValueError("warnings of more rows, or not of one line")
    return Chunk(columns, header.warnings)


def is_csv(path: Path) -> bool:
    """Return whether a path is that of a CSV table; any other is Parquet, and refused without pyarrow."""
    if path.suffix.lower() == ".csv":
        return True
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        raise mistake("sweep", str(path), 'needs pyarrow; pip install "pyarrow>=17", or write .csv') from None
    return False


def write_table(
    file: BinaryIO, chunks: Iterable[Mapping[str, Any]], *, as_csv: bool, made_by: Mapping[str, str] | None = None
) -> None:
    """Write a table chunk by chunk; each chunk is columns by name.  A Parquet file records its origin, ``made_by``."""
    if as_csv:
        for number, columns in enumerate(chunks):
            file.write(csv_of(columns, header=number == 0))
        return
    import pyarrow.parquet  # an optional dependency

    metadata = {"armour": json.dumps(made_by)}
    tables = (pyarrow.table(dict(columns), metadata=metadata) for columns in chunks)
    first = next(tables)
    rest = first.slice(0, 0)
    with pyarrow.parquet.ParquetWriter(file, first.schema) as writer:
        for table in chain([first], tables):
            rest = pyarrow.concat_tables([rest, table])
            while rest.num_rows >= ROW_GROUP:
                writer.write_table(rest.slice(0, ROW_GROUP).combine_chunks())
                rest = rest.slice(ROW_GROUP)
        if rest.num_rows:
            writer.write_table(rest.combine_chunks())


def csv_of(columns: Mapping[str, Any], *, header: bool = False) -> bytes:
    """Return columns, by name, as CSV, with or without a header; NaN becomes an empty field."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    if header:
        writer.writerow(columns)
    writer.writerows(zip(*map(_cells, columns.values()), strict=True))
    return text.getvalue().encode()


def _cells(values: Any) -> list[Any]:
    """Return the values of a column as cells of CSV; NaN becomes None, which is written as an empty field."""
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
    """Return the cells of a CSV column as numbers, or as texts if any cell is no number; empty numbers are NaN."""
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array([csv_value(cell) for cell in cells])
