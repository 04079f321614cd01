"""Checkpoints of a long job: chunks of its table on disk, joined into one file at the end.

The chunks lie in a folder beside the output, named after it with the suffix ``.parts``.  Each is written
atomically.  A file in the folder identifies the job, so that only the same job resumes with its chunks.
"""

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import csv, parquet

from armour.errors import InputError, Problem
from armour.files import check_writable, write_atomic, wrong_ending


class Store:
    """Chunks of a table, CSV or Parquet by the suffix of its file; the text of a job identifies what it holds."""

    def __init__(self, output: Path, job: str) -> None:
        if problems := wrong_ending(output, (".csv", ".parquet")):
            raise InputError(problems)
        check_writable(output)
        self.output = output
        self.folder = output.with_name(output.name + ".parts")
        self.mark, self.job = self.folder / "job", job
        if self.folder.exists() and (not self.mark.is_file() or self.mark.read_text() != job):
            message = "holds chunks of another sweep; finish that with its own command, or remove the folder"
            raise InputError([Problem(str(self.folder), "", message)])
        if output.exists():
            raise InputError([Problem(str(output), "", "exists already; choose another name, or remove it")])

    def has(self, index: int) -> bool:
        """Return whether a chunk is on disk."""
        return self._chunk(index).exists()

    def save(self, index: int, columns: Mapping[str, Any]) -> None:
        """Write a chunk atomically, the first one in a new folder; NaN becomes an empty field in CSV."""
        as_csv = _is_csv(self.output)
        table = pa.table({name: pa.array(values, from_pandas=as_csv) for name, values in columns.items()})
        content = pa.BufferOutputStream()
        if as_csv:
            csv.write_csv(table, content, csv.WriteOptions(include_header=index == 0, quoting_style="needed"))
        else:
            parquet.write_table(table, content)
        if not self.mark.exists():
            self.folder.mkdir(exist_ok=True)
            write_atomic(self.mark, self.job.encode())
        write_atomic(self._chunk(index), bytes(content.getvalue()))

    def finish(self, count: int) -> None:
        """Join n chunks into the output, in Parquet with a row group for each, and remove them."""
        whole = self.folder / f"whole{self.output.suffix}"
        chunks = [self._chunk(index) for index in range(count)]
        if _is_csv(self.output):
            with whole.open("wb") as file:
                for chunk in chunks:
                    with chunk.open("rb") as part:
                        shutil.copyfileobj(part, file)
        else:
            with parquet.ParquetWriter(whole, parquet.read_schema(chunks[0])) as writer:
                for chunk in chunks:
                    writer.write_table(parquet.read_table(chunk))
        whole.replace(self.output)
        shutil.rmtree(self.folder)

    def _chunk(self, index: int) -> Path:
        return self.folder / f"{index:08d}{self.output.suffix}"


def read_table(path: Path) -> dict[str, Any]:
    """Read the columns of a table written by a `Store` as arrays; empty fields are NaN."""
    table = csv.read_csv(path) if _is_csv(path) else parquet.read_table(path)
    columns = {name: table.column(name) for name in table.column_names}
    return {
        name: (column.cast(pa.float64()) if pa.types.is_null(column.type) else column).to_numpy()
        for name, column in columns.items()
    }


def _is_csv(path: Path) -> bool:
    return path.suffix.lower() == ".csv"
