"""Tables of sweeps as CSV and Parquet: in pieces, joined, counted and read."""

from collections.abc import Iterable, Mapping
from io import BytesIO
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO

import pyarrow as pa
from pyarrow import csv, parquet

# Rows of a row group of Parquet, whatever the size of a piece.
ROW_GROUP = 100_000


def is_csv(path: Path) -> bool:
    """Return whether a table is CSV; otherwise it is Parquet."""
    return path.suffix.lower() == ".csv"


def encoded(columns: Mapping[str, Any], *, as_csv: bool, header: bool = False) -> bytes:
    """Return columns as CSV, with or without header, where NaN is an empty field, or as Parquet."""
    table = pa.table({name: pa.array(values, from_pandas=as_csv) for name, values in columns.items()})
    content = BytesIO()
    if as_csv:
        csv.write_csv(table, content, csv.WriteOptions(include_header=header, quoting_style="needed"))
    else:
        parquet.write_table(table, content)
    return content.getvalue()


def read_table(path: Path) -> dict[str, Any]:
    """Read the columns of a table as arrays; empty fields are NaN."""
    table = csv.read_csv(path) if is_csv(path) else parquet.read_table(path)
    columns = {name: table.column(name) for name in table.column_names}
    return {
        name: (column.cast(pa.float64()) if pa.types.is_null(column.type) else column).to_numpy()
        for name, column in columns.items()
    }


def count_rows(path: Path, *, as_csv: bool) -> int:
    """Count the rows of a table."""
    if not as_csv:
        return int(parquet.read_metadata(path).num_rows)
    with path.open("rb") as file:
        return sum(block.count(b"\n") for block in iter(lambda: file.read(1 << 20), b"")) - 1


def join(file: BinaryIO, pieces: Iterable[bytes], *, as_csv: bool) -> None:
    """Write pieces of a table, of which the first has a header, one after the other."""
    if not as_csv:
        _join_parquet(file, pieces)
        return
    for piece in pieces:
        file.write(piece)


def _join_parquet(file: BinaryIO, pieces: Iterable[bytes]) -> None:
    tables = (parquet.read_table(BytesIO(piece)) for piece in pieces)
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
