"""Sheets of workbooks (.xlsx), read as streams, and Parquet files, so that none takes minutes or gigabytes."""

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from datetime import datetime, timedelta
from functools import lru_cache, partial
from io import BytesIO
from pathlib import Path
from posixpath import dirname, join, normpath, split
from typing import Any, NamedTuple
from xml.parsers.expat import ParserCreate
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

from armour.errors import Problem, mistake, refuse
from armour.files import reason, refuse_pipe

# Greatest length of a workbook, bytes, also of all parts that are read, unpacked; and number of parts.
MAX_UNPACKED, MAX_PARTS = 100_000_000, 10_000
# Greatest number of columns, of cells and of characters in a sheet; a cell counts for each row that it fills or skips.
MAX_COLUMNS, MAX_CELLS, MAX_CHARACTERS = 1000, 500_000, 5_000_000
# Greatest number of rows that spreadsheet programs have.
MAX_ROWS = 1_048_576
# Greatest number of tags of a part, of their names, how deeply they are nested, and length of one, bytes.
MAX_TAGS, MAX_NAMES, MAX_DEPTH, MAX_TAG = 2_500_000, 1000, 100, 1_000_000
# Bytes that are parsed at once, and greatest number of pieces, of 8 kB, in which the parser gives one text.
CHUNK, MAX_PIECES = 1 << 16, 50
# Formats of dates and times that have a number only, and what does not count in the code of another format.
_DATES = {*range(14, 23), *range(27, 37), *range(45, 48), *range(50, 59)}
_LITERAL = re.compile(r'"[^"]*"|\[[^][]*\]|[\\_*].')

# A tag: "row" begins an element with these attributes, and "/v" ends one with this text.
Tag = tuple[str, Mapping[str, str], str]


class Archive(ZipFile):
    """The parts of a workbook, and how many more tags and bytes of them may be read."""

    def __init__(self, path: Path, content: bytes) -> None:
        super().__init__(BytesIO(content))
        self.path = path
        self.tags, self.bytes = 2 * MAX_TAGS, MAX_UNPACKED


class Workbook(NamedTuple):
    """A workbook: its sheets, and what their cells refer to."""

    archive: Archive
    sheets: dict[str, str]  # parts of the worksheets by name
    visible: list[str]  # names of those that are not hidden
    texts: list[str]  # shared by cells
    styles: list[tuple[bool, bool]]  # of cells: whether they show dates, and whether texts are struck through
    first_day: datetime


def content_of(path: Path) -> bytes:
    """Return the content of a workbook or a Parquet file; raise an InputError if it is too long or cannot be read."""
    try:
        refuse_pipe(path)
        with open(path, "rb") as file:
            content = file.read(MAX_UNPACKED + 1)
    except OSError as error:
        raise mistake(path, "", f"cannot be read: {reason(error)}") from None
    if len(content) > MAX_UNPACKED:
        raise mistake(path, "", f"must be at most {MAX_UNPACKED:,} bytes long")
    return content


def workbook_of(path: Path, content: bytes) -> Workbook:
    """Return the workbook in the content of a file, for `rows_of`; a broken one may raise an error of any kind."""
    if content.count(b"PK\1\2") > MAX_PARTS:
        raise mistake(path, "", f"must be a workbook of at most {MAX_PARTS:,} parts, found more")
    archive = Archive(path, content)
    main = next(part for kind, part in _related_parts(archive, "").values() if kind == "officeDocument")
    related = _related_parts(archive, main)
    sheets, visible, first_day = dict[str, str](), list[str](), datetime(1899, 12, 30)
    for name, attributes, _ in _tags(archive, main):
        if name == "workbookPr" and attributes.get("date1904") in ("1", "true"):
            first_day = datetime(1904, 1, 1)
        elif name == "sheet":
            kind, part = related[next(value for key, value in attributes.items() if key.endswith(":id"))]
            if kind == "worksheet":
                sheets[attributes["name"]] = part
                visible += [attributes["name"]] * (attributes.get("state", "visible") == "visible")
    parts = {kind: part for kind, part in related.values() if part in archive.NameToInfo}
    texts = [*_shared_texts(archive, parts["sharedStrings"])] if "sharedStrings" in parts else []
    styles = [*_styles(archive, parts["styles"])] if "styles" in parts else []
    return Workbook(archive, sheets, visible, texts, styles, first_day)


def rows_of(book: Workbook, sheet: str) -> Iterator[tuple[int, list[str], str]]:
    """Yield the number, the cells and the mark of each row of a sheet that is not empty.

    A row is as wide as those above.  The mark says why it may not be meant: "hidden", "struck through" or "".
    """
    number = column = width = 0
    cells, cells_left, characters_left = list[str](), MAX_CELLS, MAX_CHARACTERS
    is_reading, kind, style, value, mark = True, "", 0, "", ""
    for name, attributes, text in _tags(book.archive, book.sheets[sheet]):
        match name:
            case "row":
                earlier, number = number, int(attributes.get("r", number + 1))
                if not earlier < number <= MAX_ROWS:
                    message = f"must be numbered from 1 to {MAX_ROWS:,} in increasing order, found {number}"
                    raise mistake(book.archive.path, f"rows of the sheet {sheet}", message)
                column, cells = 0, []
                mark = "hidden" if attributes.get("hidden") in ("1", "true") else ""
            case "c":
                place = attributes.get("r")
                column = _column_number(place.rstrip("0123456789")) if place else column + 1
                kind, style, value = attributes.get("t", "n"), int(attributes.get("s", 0)), ""
            case "rPh" | "/rPh":  # how a text is pronounced
                is_reading = name == "/rPh"
            case "/v" | "/t" if is_reading:
                value += text
            case "/c" if found := _text_of_cell(book, kind, style, value):
                if column > MAX_COLUMNS:
                    raise mistake(
                        book.archive.path, f"row {number}", f"must have at most {MAX_COLUMNS:,} columns, found more"
                    )
                characters_left -= len(found)
                cells += [""] * (column - len(cells))
                cells[column - 1] = found
                if 0 <= style < len(book.styles) and book.styles[style][1]:
                    mark = mark or "struck through"
            case "/row" if cells:
                width = max(width, len(cells))
                cells_left -= width
                yield number, cells + [""] * (width - len(cells)), mark
        if min(cells_left, characters_left) < 0:
            most = f"{MAX_CELLS:,} cells and {MAX_CHARACTERS:,} characters in a sheet"
            raise mistake(book.archive.path, "", f"must have at most {most}")


def comments_of(book: Workbook, sheet: str) -> list[str]:
    """Return the cells of a sheet that have a comment, such as "C4"."""
    folder, name = split(book.sheets[sheet])
    if join(folder, "_rels", f"{name}.rels") not in book.archive.NameToInfo:
        return []
    parts = [part for kind, part in _related_parts(book.archive, book.sheets[sheet]).values() if kind == "comments"]
    tags = (tag for part in parts for tag in _tags(book.archive, part))
    return [attributes["ref"] for name, attributes, _ in tags if name == "comment"]


def _tags(archive: Archive, part: str) -> Iterator[Tag]:
    """Yield the tags of a part of a workbook, their names without the namespace."""
    tags: list[Tag] = []
    pieces: list[str] = []
    names = dict[str, str]()
    depth = count = length = 0

    def begin(name: str, attributes: dict[str, str]) -> None:
        """Add an opening tag with its attributes."""
        nonlocal depth
        depth += 1
        pieces.clear()
        tags.append((name.rpartition(":")[2], attributes, ""))

    def end(name: str) -> None:
        """Add the closing tag, "/name", with the text before it."""
        nonlocal depth
        depth -= 1
        tags.append((f"/{name.rpartition(':')[2]}", {}, "".join(pieces)))
        pieces.clear()

    def refuse(*_declared: object) -> None:
        """Raise a ValueError for a document type."""
        raise ValueError("a document type, whose entities may be of any length")

    parser = ParserCreate(intern=names)
    parser.buffer_text = True
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.CharacterDataHandler, parser.StartDoctypeDeclHandler = pieces.append, refuse
    if archive.getinfo(part).compress_type not in (ZIP_STORED, ZIP_DEFLATED):
        raise ValueError("a compression that may need any memory")
    with archive.open(part) as stream:
        for chunk in iter(partial(stream.read, CHUNK), b""):
            parser.Parse(chunk)
            count, length = count + len(tags), length + len(chunk)
            archive.tags, archive.bytes = archive.tags - len(tags), archive.bytes - len(chunk)
            if archive.bytes < 0:
                raise mistake(archive.path, "", f"must be at most {MAX_UNPACKED:,} bytes long when it is unpacked")
            is_unfinished = length - parser.CurrentByteIndex > MAX_TAG or len(pieces) > MAX_PIECES
            if count > MAX_TAGS or archive.tags < 0 or len(names) > MAX_NAMES or depth > MAX_DEPTH or is_unfinished:
                raise mistake(archive.path, "", "must be a workbook with fewer or shorter cells; save the sheet as CSV")
            yield from tags
            tags.clear()
    parser.Parse(b"", True)
    yield from tags


def _related_parts(archive: Archive, part: str) -> dict[str, tuple[str, str]]:
    """Return the parts that a part of a workbook refers to, by the ids in it: the kind and the name of each.

    `part` is "" for the parts that the workbook itself begins with.
    """
    folder, name = split(part)
    return {
        attributes["Id"]: (
            attributes["Type"].rpartition("/")[2],
            normpath(join("/", dirname(part), attributes["Target"])).lstrip("/"),
        )
        for tag, attributes, _ in _tags(archive, join(folder, "_rels", f"{name}.rels"))
        if tag == "Relationship"
    }


def _shared_texts(archive: Archive, part: str) -> Iterator[str]:
    """Yield the texts that cells share and refer to by index."""
    is_reading, pieces, left = True, list[str](), MAX_CHARACTERS
    for name, _, text in _tags(archive, part):
        match name:
            case "rPh" | "/rPh":
                is_reading = name == "/rPh"
            case "/t" if is_reading:
                pieces.append(text)
                left -= len(text)
            case "/si":
                yield "".join(pieces).strip()
                pieces = []
        if left < 0:
            raise mistake(archive.path, "", f"must have at most {MAX_CHARACTERS:,} characters")


def _styles(archive: Archive, part: str) -> Iterator[tuple[bool, bool]]:
    """Yield for each style of cells, in order, whether it shows dates or times, and whether it strikes through."""
    formats, struck, is_of_cells = {*map(str, _DATES)}, list[bool](), False
    for name, attributes, _ in _tags(archive, part):
        match name:
            case "numFmt":
                code = _LITERAL.sub("", attributes["formatCode"]).partition(";")[0].lower()
                if {*code} & {*"dmyhs"}:
                    formats.add(attributes["numFmtId"])
            case "font":
                struck.append(False)
            case "strike" if struck:
                struck[-1] = attributes.get("val", "1") in ("1", "true")
            case "cellXfs" | "/cellXfs":
                is_of_cells = name == "cellXfs"
            case "xf" if is_of_cells:
                font = int(attributes.get("fontId", 0))
                yield attributes.get("numFmtId") in formats, 0 <= font < len(struck) and struck[font]


@lru_cache(MAX_COLUMNS)
def _column_number(letters: str) -> int:
    """Return the number of a column: 1 for A, 27 for AA."""
    if not re.fullmatch("[A-Z]{1,3}", letters):
        raise ValueError("not a cell")
    number = 0
    for letter in letters:
        number = 26 * number + ord(letter) - ord("A") + 1
    return number


def _text_of_cell(book: Workbook, kind: str, style: int, value: str) -> str:
    """Return a cell as text, given its value in the file; dates and times are in ISO form.

    `kind` is its type: "s" for a shared text, given by its index, "b" for true or false, "n" for a number or date; the
    value of any other is the text.  `style` is the index of its style.
    """
    value = value.strip()
    if kind == "s" and value:
        if int(value) < 0:
            raise ValueError("not a place of a text")
        return book.texts[int(value)]
    if kind == "b" and value:
        return str(value == "1")
    if kind != "n" or not value:
        return value
    number = float(value) if {*".eE"} & {*value} else int(value)
    if 0 <= style < len(book.styles) and book.styles[style][0]:
        with suppress(OverflowError, ValueError):
            moment = book.first_day + timedelta(days=number)
            return str(moment if number >= 1 else moment.time())  # of a time of day
    return str(number)


def parquet_columns(path: Path, content: bytes, most_rows: int) -> dict[str, Any]:
    """Return the columns, by name, of a Parquet file of at most ``most_rows`` rows, given its content.

    Its size, unpacked, is bounded as the file states it: one that lies may take up to 2 GB for a moment.
    """
    try:
        from pyarrow import ArrowException, BufferReader, compute, parquet, types
    except ImportError:
        raise mistake(path, "", 'needs pyarrow; pip install "pyarrow>=17", or save it as CSV') from None
    try:
        file = parquet.ParquetFile(BufferReader(content))
        about, schema = file.metadata, file.schema_arrow
        size = sum(about.row_group(group).total_byte_size for group in range(about.num_row_groups))
        wrong = {
            f"must have at most {most_rows} rows": about.num_rows > most_rows,
            f"must have at most {MAX_COLUMNS} columns": about.num_columns > MAX_COLUMNS,
            f"must be at most {MAX_UNPACKED:,} bytes long, unpacked": size > MAX_UNPACKED,
            "must have different names of columns": len({*schema.names}) < len(schema.names),
            "must have a single value in each cell": any(map(types.is_nested, schema.types)),
        }
        refuse(Problem(str(path), "", message) for message, is_so in wrong.items() if is_so)
        # A text that fills many rows is kept once.
        texts = [each.name for each in schema if not types.is_primitive(each.type)]
        table = parquet.read_table(BufferReader(content), read_dictionary=texts)
        chunks = [chunk for text in texts for chunk in table.column(text).chunks]
        lengths = (compute.take(compute.binary_length(chunk.dictionary), chunk.indices) for chunk in chunks)
        if sum(compute.sum(length).as_py() or 0 for length in lengths) > MAX_CHARACTERS:
            raise mistake(path, "", f"must have at most {MAX_CHARACTERS:,} characters")
    except (ArrowException, OSError) as error:
        raise mistake(path, "", f"must be a Parquet file: {error}") from None
    return {each: table.column(each) for each in schema.names}
