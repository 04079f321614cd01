"""Checkpoints of a long job: chunks of its table on disk, joined into one file at the end.

The chunks lie in a folder beside the output, named after it with the suffix ``.parts``.  Each is written whole or not
at all.  A file in the folder identifies the job, so that only the same job resumes with its chunks.
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
    """Chunks of a table that is being computed.

    Parameters
    ----------
    output : Path
        File of the table, CSV or Parquet by its suffix.
    job : str
        Identifies the job.

    Raises
    ------
    InputError
        If the output cannot be written or exists, or the folder holds the chunks of another job.
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
        """Whether a chunk is on disk."""
        return self._chunk(index).exists()

    def save(self, index: int, columns: Mapping[str, Any]) -> None:
        """Write a chunk, whole or not at all; NaN becomes an empty field in CSV."""
        import pyarrow as pa

        csv = self._is_csv()
        arrays = {name: pa.array(values, from_pandas=csv) for name, values in columns.items()}
        write_atomic(self._chunk(index), self._encoded(pa.table(arrays), header=index == 0))

    def finish(self, count: int) -> None:
        """Join ``count`` chunks into the output, and remove them."""
        whole = self.folder / f"whole{self.output.suffix}"
        chunks = [self._chunk(index) for index in range(count)]
        if self._is_csv():
            with whole.open("wb") as file:
                for chunk in chunks:
                    with chunk.open("rb") as part:
                        shutil.copyfileobj(part, file)
        else:
            _join_parquet(chunks, whole)
        whole.replace(self.output)
        shutil.rmtree(self.folder)

    def _chunk(self, index: int) -> Path:
        return self.folder / f"{index:08d}{self.output.suffix}"

    def _is_csv(self) -> bool:
        return self.output.suffix.lower() == ".csv"

    def _encoded(self, table: "pa.Table", *, header: bool) -> bytes:
        import pyarrow as pa

        sink = pa.BufferOutputStream()
        if self._is_csv():
            from pyarrow import csv

            csv.write_csv(table, sink, csv.WriteOptions(include_header=header, quoting_style="needed"))
        else:
            from pyarrow import parquet

            parquet.write_table(table, sink)
        return bytes(sink.getvalue())


def _join_parquet(chunks: Sequence[Path], whole: Path) -> None:
    """Join Parquet files into one, with a row group for each."""
    from pyarrow import parquet

    with parquet.ParquetWriter(whole, parquet.read_schema(chunks[0])) as writer:
        for chunk in chunks:
            writer.write_table(parquet.read_table(chunk))


def read_table(path: Path) -> dict[str, Any]:
    """Read the columns of a table written by a `Store` as arrays; empty fields are NaN."""
    import pyarrow as pa
    from pyarrow import csv, parquet

    table = csv.read_csv(path) if path.suffix.lower() == ".csv" else parquet.read_table(path)
    columns = {name: table.column(name) for name in table.column_names}
    return {
        name: (column.cast(pa.float64()) if pa.types.is_null(column.type) else column).to_numpy()
        for name, column in columns.items()
    }
