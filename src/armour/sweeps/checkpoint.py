"""A long job's table: chunks written as they are done, each whole or not at all, and put together at the end.

The chunks lie beside the output, in a folder of its name and ``.parts``.  What is there is not computed again, so that
an interrupted job goes on where it stopped; the folder says which job it belongs to.
"""

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from armour.errors import InputError, Problem
from armour.files import check_writable, write_atomic, wrong_ending

if TYPE_CHECKING:
    import pyarrow as pa

FORMATS = (".csv", ".parquet")
JOB = "job"


class Store:
    """The chunks of a table that is being computed.

    Parameters
    ----------
    output : Path
        The table's file, CSV or Parquet by its ending.
    job : str
        What tells this job from any other.

    Raises
    ------
    InputError
        If the output cannot be written, is there already, or another job's chunks are.
    """

    def __init__(self, output: Path, job: str) -> None:
        if problems := wrong_ending(output, FORMATS):
            raise InputError(problems)
        check_writable(output)
        self.output = output
        self.folder = output.with_name(output.name + ".parts")
        mark = self.folder / JOB
        if self.folder.exists() and (not mark.is_file() or mark.read_text() != job):
            message = "holds chunks of another sweep; finish that with its own command, or remove the folder"
            raise InputError([Problem(str(self.folder), "", message)])
        if output.exists():
            raise InputError([Problem(str(output), "", "exists already; choose another name, or remove it")])
        self.folder.mkdir(exist_ok=True)
        write_atomic(mark, job.encode())

    def has(self, index: int) -> bool:
        """Whether a chunk is there."""
        return self._part(index).exists()

    def save(self, index: int, columns: Mapping[str, Any]) -> None:
        """Write a chunk, whole or not at all."""
        import pyarrow as pa

        write_atomic(self._part(index), self._encoded(pa.table(dict(columns)), header=index == 0))

    def finish(self, count: int) -> None:
        """Put so many chunks together, and remove them."""
        whole = self.folder / f"whole{self.output.suffix}"
        parts = [self._part(index) for index in range(count)]
        if self.output.suffix.lower() == ".csv":
            with whole.open("wb") as file:
                for part in parts:
                    with part.open("rb") as chunk:
                        shutil.copyfileobj(chunk, file)
        else:
            _join_parquet(parts, whole)
        whole.replace(self.output)
        shutil.rmtree(self.folder)

    def _part(self, index: int) -> Path:
        return self.folder / f"{index:08d}{self.output.suffix}"

    def _encoded(self, table: "pa.Table", *, header: bool) -> bytes:
        import pyarrow as pa

        sink = pa.BufferOutputStream()
        if self.output.suffix.lower() == ".csv":
            from pyarrow import csv

            csv.write_csv(table, sink, csv.WriteOptions(include_header=header, quoting_style="needed"))
        else:
            from pyarrow import parquet

            parquet.write_table(table, sink)
        return bytes(sink.getvalue())


def _join_parquet(parts: Sequence[Path], whole: Path) -> None:
    """One file of many, a group of rows each."""
    from pyarrow import parquet

    with parquet.ParquetWriter(whole, parquet.read_schema(parts[0])) as writer:
        for part in parts:
            writer.write_table(parquet.read_table(part))


def read_table(path: Path) -> dict[str, Any]:
    """The columns of a table that a store has written, as arrays."""
    from pyarrow import csv, parquet

    table = csv.read_csv(path) if path.suffix.lower() == ".csv" else parquet.read_table(path)
    return {name: table.column(name).to_numpy() for name in table.column_names}
