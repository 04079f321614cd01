"""Write and read the table of a sweep, in CSV or Parquet."""

import csv
import json
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from armour.errors import mistake
from armour.files import csv_cell, csv_value

# Number of rows in a row group of Parquet, independent of the size of a chunk.
ROW_GROUP = 100_000


def is_csv(path: Path) -> bool:
    """Return whether a path is that of a CSV table; any other is Parquet, and refused without pyarrow."""
    if path.suffix.lower() == ".csv":
        return True
    if find_spec("pyarrow") is None:
        raise mistake("sweep", str(path), 'needs pyarrow; pip install "pyarrow>=17", or write .csv')
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
    rest = next(tables)
    with pyarrow.parquet.ParquetWriter(file, rest.schema) as writer:
        for table in tables:
            if full := rest.num_rows // ROW_GROUP * ROW_GROUP:  # number of rows in full groups
                writer.write_table(rest.slice(0, full).combine_chunks(), ROW_GROUP)
            rest = pyarrow.concat_tables([rest.slice(full), table])
        writer.write_table(rest.combine_chunks(), ROW_GROUP)


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
    if column.dtype.kind in "fiu":
        return [None if cell != cell else cell for cell in column.tolist()]
    return [csv_cell(cell) for cell in column.tolist()]


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
