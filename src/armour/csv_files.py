"""Tables of shots, tests and cases, from CSV, a sheet, Parquet or Python; every mistake is reported, with its line."""

import csv
import json
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from io import BufferedReader, BytesIO, TextIOWrapper
from itertools import chain, islice, pairwise
from math import isclose, isfinite, nan
from os import PathLike
from pathlib import Path
from statistics import fmean
from typing import Any, NamedTuple

from armour.columns import GROUPS, MAX_NAME, RESULT_KEYS, Column, columns_of, is_code, is_unit, is_yes, letters, sums_up
from armour.errors import CHOOSE, InputError, Problem, choices, counted, joined, listed, mistake, refuse, suggestion
from armour.files import WORKBOOKS, csv_value, located, named, reason, refuse_pipe, shell_line, shipped_tests
from armour.foreign import Rows, records
from armour.units import key_hint
from armour.workbooks import Workbook, comments_of, content_of, parquet_columns, rows_of, workbook_of

# Greatest number of rows, more than anyone has tests or shots; a fit to so many takes about a minute.
MAX_TABLE_ROWS = 100_000
# Greatest length of a line; a device such as /dev/zero has no end of line.
MAX_LINE = 100_000
# Number of first lines among which the header is; least number of known names in a header that is not the first line.
HEAD, LEAST_NAMES = 40, 2
# Words for the separators of columns, those between which a comma may mark decimals, and words for encodings.
SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs"}
WITH_DECIMAL_COMMAS = (";", "\t")
ENCODINGS = {"utf-16-le": "UTF-16", "utf-16-be": "UTF-16", "cp1252": "Windows-1252"}
# Units that messages suggest.
USUAL_UNITS = ("m/s", "ft/s", "mm", "in", "g", "grain", "°")
# Relative difference of two numbers that are rounded in different units, and of several velocities of one shot.
SAME, AGREEING = 1e-3, 0.01
# Least number of numbers that may lie in two groups, and the least distance of these, in ranges of the wider one.
LEAST_GROUPED, GAP = 6, 2.0
MUST_SAY = 'must be "stopped" or "perforated" (or partial or complete, P or C, PP or CP, no or yes)'
# Two words, as in a remark.
_PHRASE = re.compile(r"[^\W\d_]{2,}\W+[^\W\d_]{2,}")
# Beginning of the key of a problem in a line.
_LINE = re.compile(r"(?:line|row) (\d+)")
# Bytes that are not UTF-8 text, as they are read.
_UNDECODED = re.compile("[\udc80-\udcff]")
# Numbers with groups of three digits, by the mark of their decimals.
_GROUPED = {
    mark: re.compile(rf"[+-]?[1-9]\d{{0,2}}([{other} \u00a0\u202f\u2009'\u2019])\d{{3}}(?:\1\d{{3}})*(?:\{mark}\d*)?")
    for mark, other in (".,", ",.")
}


# A line: its place, for messages, and its cells.
Line = tuple[str, list[str]]


@dataclass
class Source:
    """A table that is being read: its name for messages, its header, and the lines below."""

    file: str
    place: str = ""  # of the header
    header: Sequence[str] = ()
    lines: Iterator[Line] = field(default_factory=lambda: iter(()))
    above: Sequence[str] = ()  # lines above the header
    separator: str = ""  # of the columns of CSV
    encoding: str = "utf-8"  # of CSV; "cp1252" once a line is not UTF-8
    sheet: str = ""  # of a workbook
    conversions: list[str] = field(default_factory=list)  # other ways in which cells are not plain, in words
    digest: Any = field(default_factory=sha256)  # of the content, once all lines are read
    problems: list[Problem] = field(default_factory=list)  # in the lines
    marked: dict[str, str] = field(default_factory=dict)  # rows of a sheet that are hidden or struck through, by place
    options: list[str] = field(default_factory=list)  # that mend problems, two words for each

    def wrong(self, key: str, message: str) -> None:
        """Record what is wrong in a line or a cell; `key` is its place, as "line 3: velocity_m_s"."""
        self.problems.append(Problem(self.file, key, message))

    def title(self, place: int) -> str:
        """Return the name of a column, or its number if it has no name."""
        return self.header[place] or f"column {place + 1}"

    def check_kept(self, keep: Iterable[str]) -> None:
        """Raise an InputError unless the table has all columns to keep, given by name."""
        unknown = [name for name in keep if name not in self.header]
        wrong = (f'must name a column, found "{name}"{choices(name, self.header)}' for name in unknown)
        refuse(Problem(self.file, "keep", message) for message in wrong)

    def check_marks(self, places: Iterable[str]) -> None:
        """Record as wrong the rows that count although they are hidden or struck through in a sheet.

        `places` are those of the rows that count.
        """
        for place in self.marked.keys() & {*places}:
            self.wrong(place, f'must not be {self.marked[place]} if it counts; show it, or "no" in a column "counts"')

    def divided(self, name: str, cells: Sequence[str], noun: str, unread: str = "") -> None:
        """Record as wrong that the values of a column divide the rows into groups, and which options help.

        `noun` is for a row, such as "shot"; `unread` is the beginning of the message for a column that is not read.
        """
        counts = Counter(cells).most_common()
        found = listed([f"{value or 'blank'} ({counted(count, noun)})" for value, count in counts])
        options, word = ("--where", f"{name}={counts[0][0]}"), shell_line([name])
        are_lots = noun == "shot" and counts[-1][1] > 1 and "" not in cells and None in map(is_yes, cells)
        each = f"--each {word} gives an answer for each, " * are_lots
        ways = f"{shell_line(options)} chooses one, {each}--ignore {word} takes all together"
        self.wrong(name, f"{unread}divides the {noun}s: {found}; {ways}")
        self.options += options

    def numbers(
        self, name: str, column: Column, places: Sequence[str], cells: Sequence[str], *, needed: bool = False
    ) -> list[float | None]:
        """Return the numbers in the cells of a column, in the unit of its key.

        `name` is the column's in the table, and `places` are those of the cells, for messages.  A cell that is no
        number, or has two meanings, gives None and is recorded as wrong, unless it is blank and not `needed`.
        """
        mark = decimal_mark(cells, column, self.separator) or ""
        values = [number_as(cell, mark or ".") for cell in cells]
        for index, cell in enumerate(cells):
            message = "" if mark else two_meanings(cell)
            if message or (values[index] is None and (cell or needed)):
                self.wrong(f"{places[index]}: {name}", message or f'must be a number, found "{cell}"')
                values[index] = None
        commas = mark == "," and any("," in cell for cell in cells)
        self.conversions += [*["decimal commas"] * commas, *[column.in_unit] * bool(column.unit)]
        return [None if value is None else value * column.factor for value in values]

    def refuse(self) -> None:
        """Raise an InputError if problems are recorded: those of the file as a whole first, then by line."""
        if problems := sorted(self.problems, key=lambda problem: int((_LINE.match(problem.key) or [0, 0])[1])):
            raise InputError(problems, self.options if len(self.options) == 2 * len(problems) else ())

    def told(self, rows: str, notes: Sequence[str] = ()) -> tuple[str, bool]:
        """Return in words how the table was read, and whether it was read as it stands, with nothing converted.

        `rows` are words for how many rows there are; `notes` say what was left out or averaged.
        """
        form = (
            SEPARATORS.get(self.separator, ""),
            ENCODINGS.get(self.encoding, ""),
            f"sheet {self.sheet}" * bool(self.sheet),
            f"{counted(len(self.above), 'line')} above the header" * bool(self.above),
            *self.conversions,
        )
        words = [*dict.fromkeys(filter(None, form))]
        return ", ".join([*words, rows, *notes]), words in ([], ["commas"]) and not notes


@dataclass(frozen=True)
class NotUsed:
    """A row that is not used: its place, the column and the value that decide, and its cells as written."""

    place: str
    column: str
    value: str
    cells: tuple[str, ...]


@dataclass(frozen=True)
class TableRead:
    """How a table was read.

    Attributes
    ----------
    words : str
        Separator, encoding, units and number of rows, in words.
    plain : bool
        Whether nothing was converted, interpreted or left out.
    left_out : tuple of str
        Places of the rows that do not count.
    ignored : tuple of str
        Columns that were not read and do not divide the rows, or were to be ignored.
    sha256 : str
        Hash of the file, or of the rows given.
    warnings : tuple of str
        Remarks on the rows, in columns that were not read, and such columns as may be inputs.
    title : tuple of str
        Lines above the header.
    not_used : tuple of NotUsed
        Rows that do not count or are not among those asked for: ``place``, the ``column`` that decides, its ``value``
        and all ``cells``.
    chosen : tuple of tuple of str
        Columns by which rows were chosen, each with the value asked for.
    """

    words: str
    plain: bool
    left_out: tuple[str, ...]
    ignored: tuple[str, ...]
    sha256: str
    warnings: tuple[str, ...] = ()
    title: tuple[str, ...] = ()
    not_used: tuple[NotUsed, ...] = ()
    chosen: tuple[tuple[str, str], ...] = ()


class CsvRow(NamedTuple):
    """A row of a table: its cells by column, without the empty ones."""

    place: str  # for messages, such as "line 3"
    numbers: dict[str, float]  # without the cells that should be numbers and are not
    texts: dict[str, str]  # all cells


class CsvTable(NamedTuple):
    """The rows of a table, and how they were read; the source has the mistakes, to which the caller adds its own."""

    rows: list[CsvRow]
    read: TableRead
    groups: dict[str, list[str]]  # cells of the columns that tell targets apart, by name


class TableKind(NamedTuple):
    """What the rows of a table are, and its columns, by key."""

    noun: str  # for a row
    numbers: tuple[str, ...]
    texts: tuple[str, ...]  # the first names the row
    needed: tuple[str, ...] = ()
    usual: str = ""  # columns that a message lists, by default all but the exact ones
    exact: tuple[str, ...] = ()  # texts that no other column is a misspelling of

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of all its columns."""
        return (*self.numbers, *self.texts)


def open_table(
    table: str | PathLike[str] | Rows,
    known: Callable[[str], bool],
    sheet: str | None = None,
    content: bytes | None = None,
    *,
    own: bool = False,
) -> Source:
    """Open a table: a file, a shipped file by its name unless it must be the user's ``own``, or rows given in Python.

    ``known`` tells whether a text names a column; the header is the one of the first lines with the most such names.
    ``content`` replaces that of a CSV file; ``sheet`` is that of a workbook, by default the only visible one with a
    table.
    """
    if not isinstance(table, str | PathLike):
        return _of_rows(table)
    path = Path(table) if own or content is not None else located(Path(table), shipped_tests())
    name = named(path)
    source = Source(name if name == str(path) else f"{name} (shipped)")
    if path.suffix.lower() in WORKBOOKS:
        return _with_header(source, _sheet_lines(path, source, sheet, known), known)
    if sheet is not None:
        raise mistake(path, "", "must be a workbook (.xlsx) for a sheet to be chosen")
    if path.suffix.lower() == ".parquet":
        content = content_of(path)
        return _of_rows(parquet_columns(path, content, MAX_TABLE_ROWS), source.file, sha256(content))
    return _csv_source(path, source, known, content)


def _csv_source(path: Path, source: Source, known: Callable[[str], bool], content: bytes | None) -> Source:
    """Return a source with the separator, the header and the lines of a CSV file; `content` replaces the file's."""
    texts = _texts(path, source, content)
    head = [*islice(texts, HEAD)]
    declared = re.fullmatch(r"sep=([,;\t])\s*", head[0]) if head else None
    if head and declared:
        head[0] = "\n"
    filled = [text for text in head if text.strip(",;\t\r\n ")]

    def fit(separator: str) -> tuple[int, int]:
        """Return how well a separator fits: the known names in the header, and the number of its columns."""
        rows = [next(csv.reader([text], delimiter=separator), [""]) for text in filled]
        count, place = _most_known(rows, known)
        return count, len(rows[place]) if rows else 0

    source.separator = declared[1] if declared else max(SEPARATORS, key=fit)
    return _with_header(source, _cells(path, chain(head, texts), source.separator), known)


def _most_known(rows: Sequence[Sequence[str]], known: Callable[[str], bool]) -> tuple[int, int]:
    """Return the greatest number of known names in a row, and the index of the header among the rows.

    The header is the row with the most known names, if these are at least LEAST_NAMES, or else the first.
    """
    # Words such as "no" are names too, but not twice.
    counts = [sum(known(cell.strip()) for cell in {*row}) for row in rows]
    most = max(counts, default=0)
    return most, counts.index(most) if most >= LEAST_NAMES else 0


def _with_header(source: Source, lines: Iterator[Line], known: Callable[[str], bool]) -> Source:
    """Return a source with the header of a table and the lines below it, taken from all its lines.

    `known` tells whether a text names a column.  If the line below the header has only units, they are added to the
    names.
    """
    head = [*islice(lines, HEAD)]
    if not head:
        return source
    above = _most_known([cells for _, cells in head], known)[1]
    source.above = [", ".join(filter(None, cells)) for _, cells in head[:above]]
    (source.place, header), *head = head[above:]
    while header and not header[-1] and not any(cells[len(header) - 1 : len(header)] > [""] for _, cells in head):
        header.pop()
    if any(len(name) > MAX_NAME for name in header):
        raise mistake(source.file, source.place, f"must have names of at most {MAX_NAME} characters")
    units = head[0][1] if head else []
    if any(map(is_unit, units)) and all(is_unit(unit) or unit in ("", "-", "[-]") for unit in units):
        head = head[1:]
        pairs = zip(header, units, strict=False)
        header = [f"{name} [{unit.strip('()[] ')}]" if is_unit(unit) else name for name, unit in pairs]
    source.header = header

    def trimmed() -> Iterator[Line]:
        """Yield the lines below the header, without blank cells beyond its width."""
        for place, cells in chain(head, lines):
            while len(cells) > len(header) and not cells[-1]:
                cells.pop()
            yield place, cells

    source.lines = trimmed()
    return source


def _texts(path: Path, source: Source, content: bytes | None) -> Iterator[str]:
    """Yield the lines of a CSV file: in UTF-8, UTF-16 with its mark, or Windows-1252 where it is not UTF-8.

    `content` replaces that of the file.  The encoding and the digest of the source are set on the way.
    """
    try:
        if content is None:
            refuse_pipe(path)
        with open(path, "rb") if content is None else BufferedReader(BytesIO(content)) as file:
            start = file.peek(2)[:2]
            source.encoding = encoding = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}.get(start, "utf-8")
            errors = "surrogateescape" if encoding == "utf-8" else "strict"
            with TextIOWrapper(file, encoding, errors, newline="") as text:
                for place, line in enumerate(iter(lambda: text.readline(MAX_LINE), ""), 1):
                    if len(line) == MAX_LINE:
                        raise mistake(path, f"line {place}", f"must be shorter than {MAX_LINE:,} characters")
                    if "\0" in line:
                        raise mistake(path, f"line {place}", "must be text, found a binary file")
                    source.digest.update(line.encode(encoding, errors))
                    if not line.isascii() and _UNDECODED.search(line):
                        source.encoding = "cp1252"
                        line = line.encode("utf-8", "surrogateescape").decode("cp1252", "replace")
                    yield line.removeprefix("\ufeff") if place == 1 else line
    except (OSError, ValueError) as error:
        raise mistake(path, "", f"cannot be read: {reason(error)}") from None


def _cells(path: Path, texts: Iterator[str], separator: str) -> Iterator[Line]:
    """Yield the place and the cells of each line of CSV that is not blank; `path` names the file in messages.

    An InputError says if a cell spans several lines.
    """
    last_line = 0
    reader = csv.reader(texts, delimiter=separator, strict=True)
    try:
        for cells in reader:
            if reader.line_num > last_line + 1:
                raise csv.Error
            last_line += 1
            stripped = [cell.strip() for cell in cells]
            if any(stripped):
                yield f"line {last_line}", stripped
    except csv.Error:
        before = {",": "a comma", ";": "a semicolon", "\t": "a tab"}[separator]
        message = f"must close each quote on its line, before {before} or the end of the line; only these divide cells"
        raise mistake(path, f"line {last_line + 1}", message) from None


def _sheet_lines(path: Path, source: Source, sheet: str | None, known: Callable[[str], bool]) -> Iterator[Line]:
    """Yield the rows that are not blank of a sheet of a workbook, by default of the only visible one with a table.

    What the source says of the content is set on the way; `known` tells whether a text names a column.
    """
    try:
        content = content_of(path)
        source.digest.update(content)
        workbook = workbook_of(path, content)
        if sheet is not None and sheet not in workbook.sheets:
            raise mistake(path, "", f"must have the sheet {sheet}, found {listed([*workbook.sheets])}")
        source.sheet = _only_table(workbook, known) if sheet is None else sheet
        if places := comments_of(workbook, source.sheet):
            source.conversions.append(f"without the comments of {listed(places)}")
        for number, cells, mark in rows_of(workbook, source.sheet):
            source.marked |= {f"row {number}": mark} if mark else {}
            yield f"row {number}", cells
    except InputError:
        raise
    except Exception:  # of any kind, depending on what is broken
        raise mistake(path, "", "must be a workbook of a spreadsheet program (.xlsx)") from None


def _only_table(workbook: Workbook, known: Callable[[str], bool]) -> str:
    """Return the name of the only visible sheet or, of several, of the only one with a table."""
    names = workbook.visible
    if len(names) > 1:
        heads = [[cells for _, cells, _ in islice(rows_of(workbook, name), HEAD)] for name in names]
        names = [name for name, head in zip(names, heads, strict=True) if _most_known(head, known)[0] >= LEAST_NAMES]
    if len(names) != 1:
        found = f"found {listed(names) or 'none'}; --sheet chooses from {listed([*workbook.sheets])}"
        raise mistake(workbook.archive.path, "", f"must have one visible sheet with a table, {found}")
    return names[0]


def shipped_rows(name: str) -> list[dict[str, str]]:
    """Return the rows of a shipped table by column."""
    source = open_table(shipped_tests()[name], lambda _name: False, own=True)
    return [dict(zip(source.header, cells, strict=True)) for _, cells in source.lines]


def _of_rows(table: Any, file: str = "rows", digest: Any = None) -> Source:
    """Return a source for rows given in Python: mappings, columns by name, or a data frame.

    Columns that were read from a `file` have its name and a `digest` of its content.
    """
    try:
        rows = records(table)
    except (TypeError, ValueError):
        message = "must be a path, rows as mappings, columns of equal length, or a data frame with different names"
        raise mistake(file, "", f"{message}, found a {type(table).__name__}") from None
    header = [*dict.fromkeys(name for row in rows for name in row)]
    lines = [(f"row {place}", [row.get(name, "") for name in header]) for place, row in enumerate(rows, 1)]
    digest = digest or sha256(json.dumps([header, *(cells for _, cells in lines)]).encode())
    return Source(file, "header" if header else "", header, iter(lines), digest=digest)


def read_rows(
    source: Source,
    kind: TableKind,
    where: Mapping[str, str] | None = None,
    least: int = 1,
    ignore: Collection[str] = (),
    *,
    closed: bool = True,
) -> CsvTable:
    """Read the rows of an open table of a kind; at least ``least`` must be left.

    Rows are left out if they do not count, or if their cells differ from those that ``where`` requires, by column.
    If the table is ``closed`` to what is not read, no such column may divide the rows into groups of equal cells,
    unless ``ignore`` names it.
    """
    columns, where = columns_of(source.header, kind.keys), where or {}
    chosen = [(i, str(value)) for name, value in where.items() for i in places_of(source, columns, name)]
    unwanted = {i for name in ignore for i in places_of(source, columns, name, "--ignore")}
    columns = [Column(source.header[i], known=False) if i in unwanted else each for i, each in enumerate(columns)]
    unread = {i for i, each in enumerate(columns) if not each.known and not each.averaged} - {*dict(chosen)} - unwanted
    columns, every, reasons = _usable_lines(source, kind, columns, unread, least)
    lines = _chosen_lines(source, columns, every, chosen, reasons)
    unused = [(place, reasons[place], cells) for place, cells in every if place in reasons]
    not_used = tuple(NotUsed(place, source.title(index), cells[index], (*cells,)) for place, index, cells in unused)
    left_out = tuple(place for place, _ in lines if place in reasons)
    lines = [line for line in lines if line[0] not in reasons]
    source.check_marks(place for place, _ in lines)
    rows = [CsvRow(place, {}, {}) for place, _ in lines]
    averaged = _fill_rows(source, kind, columns, lines, rows)
    groups, ignored, warnings = dict[str, list[str]](), list[str](), list[str]()
    for index, column in enumerate(columns):
        name, cells = source.title(index), [cells[index] for _, cells in lines]
        if column.known and column.key in GROUPS and column.key not in kind.keys:
            groups[name] = cells
        elif not column.known and index not in dict(chosen):
            ignored += [name] * bool(source.header[index] or any(cells))
            if index in unread and are_remarks(cells):
                warnings.append(_remarks_quoted(name, rows, cells))
            elif index in unread and closed:
                _check_not_dividing(source, name, cells, kind.noun)
    repeated = _repeated_shots(source, kind.texts[0], rows, lines)
    if len(rows) < least:
        raise InputError(source.problems or [Problem(source.file, "", "must have rows that count")])
    notes = [f"{name} {value or 'blank'}" for name, value in where.items()]
    for index, value in chosen:
        others = [cells[index] for place, cells in every if reasons.get(place) == index]
        alike = ", ".join({cell: 0 for cell in others if cell.lower().split() == value.lower().split()})
        also = f", even {alike}, which differs in case or blanks alone" * bool(alike)
        notes += [f"without {counted(len(others), 'row')} of other {source.title(index)}{also}"] * bool(others)
    notes += [f"mean of {joined(names)}" for names in averaged]
    notes += [f"without {', '.join(ignored)}"] * bool(ignored)
    notes += [f"without {listed(left_out)}, which {'does' if len(left_out) == 1 else 'do'} not count"] * bool(left_out)
    told = source.told(counted(len(rows), kind.noun), [*notes, *repeated])
    digest, asked = source.digest.hexdigest(), tuple((source.title(index), value) for index, value in chosen)
    read = TableRead(*told, left_out, (*ignored,), digest, (*warnings,), (*source.above,), not_used, asked)
    return CsvTable(rows, read, groups)


def _fill_rows(
    source: Source, kind: TableKind, columns: Sequence[Column], lines: Sequence[Line], rows: Sequence[CsvRow]
) -> list[list[str]]:
    """Fill empty rows, one for each line, with the cells of the columns that the kind of table has.

    Return, for each quantity whose mean is taken over several columns, their names.
    """
    repeated: dict[str, dict[str, list[float | None]]] = {}
    for index, column in enumerate(columns):
        name, cells = source.title(index), [cells[index] for _, cells in lines]
        if source.sheet and column.key in kind.needed and {*cells} == {""}:
            message = "must have values, found none; save the workbook after its last calculation"
            raise mistake(source.file, name, message)
        if column.known and column.key in kind.numbers:
            numbers = source.numbers(name, column, [row.place for row in rows], cells)
            if column.averaged:
                repeated.setdefault(column.key, {})[name] = numbers
            for row, cell, number in zip(rows, cells, numbers, strict=True):
                row.texts.update({column.key: cell} if cell else {})
                row.numbers.update({} if number is None else {column.key: number})
        elif column.known and column.key in kind.texts:
            _fill_texts(source, name, column, cells, rows)
    for key, by_name in repeated.items():
        _average(source, key, by_name, rows)
    return [[*by_name] for by_name in repeated.values() if len(by_name) > 1]


def _remarks_quoted(name: str, rows: Sequence[CsvRow], cells: Sequence[str]) -> str:
    """Return a warning that quotes the remarks in a column that is not read, with the places of their rows.

    `name` is that of the column, and `cells` has its cell in each of the rows.
    """
    said = dict[str, list[str]]()
    for row, cell in zip(rows, cells, strict=True):
        said.setdefault(cell, []).append(row.place)
    texts = [f'"{text}" in {listed(places)}' for text, places in said.items() if text]
    return f"{name}, which is not read, says {'; '.join(texts)}"


def are_remarks(cells: Sequence[str]) -> bool:
    """Return whether the cells of a column are remarks: texts in some rows, or a different text in each.

    The texts in some rows are longer than a code, and neither numbers nor yes or no; of different ones, one has two
    words.
    """
    texts = {*cells} - {""}
    if "" in cells and texts:
        return not any(is_code(text) or is_number(text) or is_yes(text) is not None for text in texts)
    return len(texts) == len(cells) and any(map(_PHRASE.search, texts))


def _check_not_dividing(source: Source, name: str, cells: Sequence[str], noun: str) -> None:
    """Record as wrong if a column that is not read divides the rows into groups: some cells equal, others different.

    Numbers of which more than half differ are measured, and divide the rows only if they lie in two groups far apart,
    as yaw angles do of which some are too great.  Lengths that differ from test to test may be inputs.
    """
    values, mark = {*cells}, decimal_mark(cells, Column(name), source.separator) or "."
    numbers = [number_as(cell, mark) for cell in cells if cell]
    measured = sorted(number for number in numbers if number is not None)
    low, high = max(pairwise(measured), key=lambda ends: ends[1] - ends[0], default=(0.0, 0.0))
    if noun == "test" and Column(name).key_unit == "mm" and len({*measured}) > 1:
        source.wrong(
            name, f"is not read and differs between tests: name it by its key, or --ignore {shell_line([name])}"
        )
    elif len(measured) < len(numbers) or len(values) <= max(2, len(cells) / 2):
        if 1 < len(values) < len(cells):
            source.divided(name, cells, noun, "is not read and ")
    elif len(measured) >= LEAST_GROUPED and high - low > GAP * max(low - measured[0], measured[-1] - high):
        ways = f'a column "counts" with "no" leaves {noun}s out, --ignore {shell_line([name])} counts all'
        source.wrong(name, f"is not read and divides the {noun}s: up to {low:g}, from {high:g}; {ways}")


def _usable_lines(
    source: Source, kind: TableKind, columns: list[Column], unread: Collection[int], least: int
) -> tuple[list[Column], list[Line], dict[str, int]]:
    """Return the columns of a table, the lines that are as wide as its header, and `_lines_left_out`.

    Lines of another width are recorded as wrong; wrong columns raise an InputError.  `unread` has the indices of the
    columns that are not read; `least` is the least number of lines.
    """
    file, header = source.file, source.header
    if not source.place:
        needed_columns = f" with {' and '.join(kind.needed)}" if kind.needed else ""
        raise mistake(file, "", f"must have a header{needed_columns}, found an empty file")
    lines = [*islice(source.lines, MAX_TABLE_ROWS + 1)]
    if len(lines) > MAX_TABLE_ROWS:
        raise mistake(file, "", f"must have at most {MAX_TABLE_ROWS} rows below its header, found more")
    full_lines = [line for line in lines if len(line[1]) == len(header)]
    uncounted = _lines_left_out(source, columns, full_lines, kind.texts[0])
    columns = _without_copies(source, columns, [line for line in full_lines if line[0] not in uncounted])
    refuse(Problem(file, key, message) for key, message in _wrong_columns(source, columns, unread, kind))
    for place, cells in lines:
        if len(cells) != len(header):
            source.wrong(place, wrong_width(cells, header))
    if len(lines) < least:
        source.problems = [Problem(file, "", "must have at least one row below its header")]
    return columns, full_lines, uncounted


def _average(source: Source, key: str, by_name: Mapping[str, Sequence[float | None]], rows: Sequence[CsvRow]) -> None:
    """Fill the rows with the mean of several numbers of one quantity, which must agree.

    `key` is that of the quantity; `by_name` has the numbers by name of column, one for each row.
    """
    for index, row in enumerate(rows):
        found = {name: number for name, numbers in by_name.items() if (number := numbers[index]) is not None}
        if found:
            row.numbers[key] = fmean(found.values())
            if max(found.values()) - min(found.values()) > AGREEING * row.numbers[key]:
                values = joined([f"{value:.5g}" for value in found.values()])
                message = f"must agree within {100.0 * AGREEING:g} %, found {values}; leave those that are wrong blank"
                source.wrong(f"{row.place}: {joined([*found])}", message)


def _fill_texts(source: Source, name: str, column: Column, cells: Sequence[str], rows: Sequence[CsvRow]) -> None:
    """Fill the rows with the cells of a column of texts; yes and no become words for a result where they mean one."""
    words = column.words(cells)
    for row, cell in zip(rows, words, strict=True):
        is_word = is_yes(cell) is not None
        if is_word and column.unit:
            message = f'must be "stopped" or "perforated", found "{cell}", which may mean both'
            source.wrong(f"{row.place}: {name}", message)
        if is_word and column.yes is not None:
            row.texts[column.key] = "perforated" if column.says(cell) else "stopped"
        elif cell:
            row.texts[column.key] = csv_value(cell)
    source.conversions += ["x for yes"] * (words is not cells)


def _without_copies(source: Source, columns: list[Column], lines: Sequence[Line]) -> list[Column]:
    """Return the columns; one that repeats another in another unit or in opposite words is not `known` any more."""

    def values(place: int) -> list[float]:
        """Return the numbers in the column at an index, or 1 and 0 for words; NaN for other cells."""
        column, cells = columns[place], [cells[place] for _, cells in lines]
        if column.yes is not None:
            return [nan if (said := column.says(cell)) is None else said for cell in column.words(cells)]
        mark = decimal_mark(cells, column, source.separator) or "."
        return [nan if (value := number_as(cell, mark)) is None else value * column.factor for cell in cells]

    kept, first_places = [*columns], dict[str, int]()
    for place, column in sorted(enumerate(columns), key=lambda pair: pair[1].factor != 1.0):
        if column.known and column.factor and (column.unit or column.yes is not None) and not column.counts:
            first = first_places.setdefault(column.key, place)
            is_other = (columns[first].unit, columns[first].yes) != (column.unit, column.yes)
            pairs = zip(values(first), values(place), strict=True)
            if is_other and all(isclose(*pair, rel_tol=SAME) for pair in pairs):
                kept[place] = Column(source.header[place], known=False)
    return kept


def _wrong_columns(
    source: Source, columns: Sequence[Column], unread: Collection[int], kind: TableKind
) -> Iterator[tuple[str, str]]:
    """Yield the mistakes in the header of a table: the name of a column, and what is wrong with it.

    `unread` has the indices of the columns that are not read.
    """
    keys = kind.keys
    usual = kind.usual or ", ".join(key for key in keys if key not in kind.exact)
    known_keys = [column.key for column in columns if column.known]
    sections = {key.partition(".")[0] for key in keys if "." in key}
    missing, several = [key for key in keys if key not in {*known_keys, *kind.exact}], set[str]()
    for place, (name, column) in enumerate(zip(source.header, columns, strict=True)):
        if column.known and column.factor == 0.0 and column.units is None:
            yield name, f'must agree with the words for results or yes and no, found "{column.unit}"'
        elif column.known and column.factor == 0.0:
            stem = re.sub(r"\s*[(\[].*", "", name)
            ways = joined([f'"{stem} ({unit})"' for unit in column.units or () if unit in USUAL_UNITS], "or")
            yield name, f"must have its unit, as {ways}"
        elif column.averaged and source.header.count(name) == 1:
            continue
        elif column.known and known_keys.count(column.key) > 1 and column.key not in several:
            several.add(column.key)
            same = [name for name, other in zip(source.header, columns, strict=True) if other.key == column.key]
            key = f"{source.place}: {name}" if name else source.place
            also = "" if len({*same}) == 1 else f": {joined(same)}"
            yield key, f"must be the name of one column, found several{also}"
        elif place in unread and name:
            like = key_hint(name, missing) or suggestion(name, missing)
            is_key = "." in name and name.partition(".")[0] in sections
            if like or is_key or not known_keys:
                yield name, f"unknown column{like or CHOOSE + usual}"
    missing_column = f"is missing and must be a column, found {listed([name for name in source.header if name])}"
    yield from ((key, missing_column) for key in kind.needed if key not in known_keys)


def _chosen_lines(
    source: Source, columns: Sequence[Column], lines: list[Line], chosen: list[tuple[int, str]], reasons: dict[str, int]
) -> list[Line]:
    """Return the lines that have the chosen values; `chosen` has pairs of the index of a column and its value.

    `reasons` has, by place of a line that is not used, the index of the column that decides this: first the lines that
    do not count, in which a chosen column may be blank.  Those that are not chosen are added.
    """
    uncounted = {*reasons}
    for index, value in chosen:
        name, values = source.title(index), dict.fromkeys(cells[index] for _, cells in lines)
        if value not in values:
            message = f'must be one of {", ".join(filter(None, values))}, found "{value}"'
            raise mistake(source.file, f"--where {name}", message)
        if columns[index].known and columns[index].key in GROUPS:
            blank = [place for place, cells in lines if not cells[index] and place not in uncounted]
            refuse(not_filled(source.file, name, blank))
        reasons |= {place: index for place, cells in lines if cells[index] != value}
        lines = [line for line in lines if line[1][index] == value]
    return lines


def places_of(source: Source, columns: Sequence[Column], name: str, option: str = "--where") -> list[int]:
    """Return the indices of the columns with exactly this name or else a similar one; refuse a name of none."""
    titles = [*map(source.title, range(len(columns)))]
    exact = [i for i, title in enumerate(titles) if title == name]
    like = [i for i, title in enumerate(titles) if name == columns[i].key or letters(name) == letters(title)]
    if not like:
        raise mistake(source.file, option, f'must name a column, found "{name}"{choices(name, source.header)}')
    return exact or like


def _lines_left_out(source: Source, columns: Sequence[Column], lines: Sequence[Line], naming: str) -> dict[str, int]:
    """Return the lines to leave out: by place, the index of the column that says so.

    They do not count, or their name, in the column whose key is `naming`, is that of a summary, such as "mean".
    """
    by_key = {column.key: place for place, column in enumerate(columns) if column.known}
    name, index = by_key.get(naming), next((place for place in by_key.values() if columns[place].counts), None)
    places = {place: name for place, cells in lines if name is not None and sums_up(cells[name])}
    if index is None:
        return places
    for (place, _), cell in zip(lines, columns[index].words([cells[index] for _, cells in lines]), strict=True):
        counts = columns[index].says(cell)
        if counts is None and place not in places:
            source.wrong(f"{place}: {source.header[index]}", f'must be yes or no, found "{cell}"')
        elif not counts:
            places[place] = index
    return places


def _repeated_shots(source: Source, naming: str, rows: Sequence[CsvRow], lines: Sequence[Line]) -> list[str]:
    """Return in words which shots without a name equal earlier ones, and which have the number of an earlier one.

    Any other repeated row is recorded as wrong; `naming` is the key of the column of names.
    """
    places: dict[tuple[str, ...], str] = {}
    named, told = dict[str, str](), dict[str, list[str]]()
    for row, (place, cells) in zip(rows, lines, strict=True):
        first = places.setdefault(tuple(cells), place)
        if first != place and naming not in row.texts and {*RESULT_KEYS} & row.texts.keys():
            told.setdefault("equal to an earlier row", []).append(place)
        elif first != place:
            source.wrong(place, f"repeats {first}; if both are meant, name them apart in the column {naming}")
        elif named.setdefault(row.texts.get(naming, place), place) != place and "result" in row.texts:
            told.setdefault("with the number of an earlier shot", []).append(place)
    return [f"{listed(each)} {words}, counted" for words, each in told.items()]


def decimal_mark(cells: Iterable[str], column: Column, separator: str) -> str | None:
    """Return the decimal mark of a column, "." or ",", by its cells and the bounds of its quantity; None if unclear.

    The mark is a point in a table with commas between its columns, unless a cell has a comma.
    """
    cells = [cell for cell in cells if cell]
    has_commas = any("," in cell for cell in cells)
    if not has_commas and separator not in WITH_DECIMAL_COMMAS:
        return "."
    low, high = column.bounds
    read: dict[str, list[float | None]] = {}
    fitting, readable = [], []
    for mark in ",." if has_commas else ".,":
        read[mark] = values = [number_as(cell, mark) for cell in cells]
        numbers = [value * column.factor for value in values if value is not None]
        if len(numbers) == len(values):
            readable.append(mark)
            fitting += [mark] if not numbers or low <= min(numbers) <= max(numbers) <= high else []
    if len(fitting) == 2 and read["."] != read[","]:
        return None
    usual = ",." if separator in WITH_DECIMAL_COMMAS else ".,"
    return [*fitting, *readable, min(usual, key=lambda mark: read[mark].count(None))][0]


def two_meanings(cell: str) -> str:
    """Return what is wrong with a number whose comma or point may mark decimals or thousands; "" for any other cell."""
    meanings = [f"{value:.12g}" for value in sorted({number_as(cell, mark) or 0.0 for mark in ".,"})]
    return f'must be a number with one meaning, found "{cell}": {" or ".join(meanings)}' if len(meanings) > 1 else ""


def is_number(cell: str) -> bool:
    """Return whether a cell is a number with either decimal mark."""
    return any(number_as(cell, mark) is not None for mark in ".,")


def number_as(cell: str, mark: str) -> float | None:
    """Return the number in a cell, with the decimal `mark` "." or ","; None if the cell is not a number."""
    value = number(cell if mark == "." else "" if "." in cell else cell.replace(",", "."))
    if value is None and (grouped := _GROUPED[mark].fullmatch(cell)):
        return number_as(cell.replace(grouped[1], ""), mark)
    return value


def targets_of(source: Source, table: CsvTable, name: str, perforated: Sequence[bool | None]) -> list[str]:
    """Return the values of a column of groups that stand for targets of shots, unlike serial numbers of shots.

    `perforated` has the result of each row.  At least three shots have such a value, or shots with both results.  Blank
    cells, as in merged cells of a sheet, are refused if there are other values.
    """
    values, shots = table.groups[name], dict[str, list[bool | None]]()
    for value, result in zip(values, perforated, strict=True):
        shots.setdefault(value, []).append(result)
    targets = [value for value, results in shots.items() if len(results) >= 3 or len({*results}) == 2]
    if targets and len(shots) > 1:
        blank = [row.place for row, value in zip(table.rows, values, strict=True) if not value]
        refuse(not_filled(source.file, name, blank))
    return [*filter(None, targets)]


def wrong_result(text: str) -> str:
    """Return the message on a text that is neither "stopped" nor "perforated", nor another word for one."""
    hint = 'a column "counts" with "no" leaves it out'
    hint = hint if is_yes(text) is None else 'such a column needs the name "perforated" or "stopped"'
    return f'{MUST_SAY}, found "{text}"; {hint}'


def not_filled(file: str, name: str, blank: Sequence[str]) -> Iterator[Problem]:
    """Yield the problem of a column of a file that names targets and is blank in some rows, given their places."""
    if blank:
        yield Problem(file, name, f"must be filled in every row that counts, found blank cells in {listed(blank)}")


def wrong_width(cells: Sequence[str], header: Sequence[str]) -> str:
    """Return the message on a row that has more or fewer cells than the header."""
    hint = "; write decimals with points, texts with commas in quotes, and all headings" * (len(cells) > len(header))
    return f"must have {counted(len(header), 'cell')} as the header has, found {len(cells)}{hint}"


def number(cell: str) -> float | None:
    """Return a finite decimal number as people write it; None for any other text, such as "7_00"."""
    try:
        value = float(cell) if cell.isascii() and "_" not in cell else nan
    except ValueError:
        return None
    return value if isfinite(value) else None
