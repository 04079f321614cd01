"""Write and read the tables of a sweep, in CSV or Parquet depending on the suffix of the file."""

import csv
import json
from collections.abc import Iterable, Mapping
from io import StringIO
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from armour.errors import mistake
from armour.files import csv_cell, csv_value

# Number of rows in a row group of Parquet, independent of the size of a chunk.
ROW_GROUP = 100_000


def is_csv(path: Path) -> bool:
    """Return whether a table is CSV and not Parquet, which needs pyarrow."""
    if path.suffix.lower() == ".csv":
        return True
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        raise mistake("sweep", str(path), "needs pyarrow; pip install 'armour[parquet]', or write .csv") from None
    return False


def write_table(
    file: BinaryIO, chunks: Iterable[Mapping[str, Any]], *, as_csv: bool, made_by: Mapping[str, str] | None = None
) -> None:
    """Write columns by name, chunk by chunk; a Parquet file records its origin, ``made_by``."""
    if as_csv:
        for number, columns in enumerate(chunks):
            file.write(csv_of(columns, header=number == 0))
        return
    # Imported here because it is an optional dependency.
    import pyarrow as pa
    from pyarrow import parquet

    about = {"armour": json.dumps(made_by)}
    tables = (
        pa.table({name: pa.array(values) for name, values in columns.items()}, metadata=about) for columns in chunks
    )
    first = next(tables)
    rest = first.slice(0, 0)
    with parquet.ParquetWriter(file, first.schema) as writer:
        for table in chain([first], tables):
            rest = pa.concat_tables([rest, table])
            while rest.num_rows >= ROW_GROUP:
                writer.write_table(rest.slice(0, ROW_GROUP).combine_chunks())
                rest = rest.slice(ROW_GROUP)
        if rest.num_rows:
            writer.write_table(rest.combine_chunks())


def csv_of(columns: Mapping[str, Any], *, header: bool = False) -> bytes:
    """Return columns as CSV, with or without header; NaN is an empty field."""
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
    """Return cells of CSV as an array of numbers, or of texts if one is not a number."""
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array([csv_value(cell) for cell in cells])
