"""Names of the columns of tables that people write, in English, German and French, and the words in their cells."""

import re
import unicodedata
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from math import inf
from typing import NamedTuple

from armour.files import read_toml, shipped
from armour.units import words_and_unit

_DATA = read_toml(shipped("configs") / "columns.toml")
_COLUMNS = [(key, column["names"]) for column in _DATA["column"] for key in column["keys"]]
_COLUMNS += [(key, _DATA["averaged"]) for key in ("velocity_m_s", "impact.velocity_m_s")]
# Usual names of columns by key, without the unit; only letters and digits are compared, whatever their case.
USUAL_NAMES = {key: [name for other, names in _COLUMNS if other == key for name in names] for key, _ in _COLUMNS}
# Factors to the units of keys, by the units that people write.
UNITS: dict[str, dict[str, float]] = _DATA["units"]
# Pairs of words: for an armour that stopped a shot and one that was perforated; for no and yes, which are results only
# in a column whose header says of what; and for a shot that does not count and one that does, besides no and yes.
OUTCOME_WORDS, YES_OR_NO, COUNTED = (_DATA[key] for key in ("outcomes", "yes_or_no", "counted"))
# All pairs of words for no and yes, in some sense.
PAIRS = (*YES_OR_NO, *OUTCOME_WORDS, *COUNTED)
# Columns of text that tell the targets of shots apart.
GROUPS = ("panel", "target", "plate", "specimen", "lab", "lot")
# Columns whose names may have a word for "number" before or behind them.
NUMBERED = ("shot", "test", "panel", "target", "plate", "specimen", "lot")
_NUMBER = "(?:number|nummer|numero|no|nr|n°|#|id)"
# Columns of results, columns that say whether a shot counts, and columns of yes and no: whether yes means that a shot
# perforated, or counts.
RESULT_KEYS = ("result", "outcome")
COUNT_KEYS = ("counts", "excluded")
YES_MEANS = {"perforated": True, "stopped": False, "counts": True, "excluded": False}
# Bounds of the numbers of a column, by key or else by unit; they tell whether 1,234 means 1234 or 1.234.
BOUNDS = {
    **dict.fromkeys(("velocity_m_s", "impact.velocity_m_s", "ballistic_limit_m_s"), (10.0, 1e4)),
    "cost_per_m2": (10.0, 1e5),
    "m/s": (0.0, 1e4),
    "mm": (0.0, 1e3),
    "°": (0.0, 60.0),
}
# Greatest length of the name of a column; a longer text is none.
MAX_NAME = 500
_BRACKETS = re.compile(r"[(\[{]([^()\[\]{}]*)[)\]}]")
# Marks of a word that is not certain, such as "CP?" or "(CP)".
_DOUBT = re.compile(r"[^\w\s.,'\u2019/-]")
# Parts of a header: meanings of codes, as in "1 = perforated", and words between which cells choose, as in "yes/no".
_CODES = re.compile(r"([^\W_]+)\s*[=:]\s*([^\W\d_]+(?: [^\W\d_]+)*)")
_OR = r"(?:/|\bor\b|\boder\b|\bou\b)"
_EITHER = re.compile(rf"([^\W_]+)\s*{_OR}\s*([^\W_]+)")


class Column(NamedTuple):
    """A column of a table.

    For a column of results or of yes and no, `unit` is the text in brackets in its header if this is not understood;
    the factor is 0 if that text contradicts the words for results.
    """

    key: str  # its name if it has no key
    factor: float = 1.0  # from its unit to that of the key
    unit: str = ""  # as written; "" if the header is the key itself, or has no unit
    known: bool = True
    yes: bool | None = None  # whether yes means that a shot perforated, or counts, where the header says of what
    averaged: bool = False  # whether it has one of several velocities of a shot

    @property
    def units(self) -> Mapping[str, float] | None:
        """The units that its numbers may have, with their factors; None for numbers without a unit and for words."""
        return UNITS.get(words_and_unit(self.key)[1])

    @property
    def key_unit(self) -> str:
        """The unit of keys for the unit at the end of its name, such as "mm" for "Tile (in)"; "" if it has none."""
        unit = _UNIT_NAMES.get(_unit_at_end(folded(self.key)), "")
        return next((key_unit for key_unit, units in UNITS.items() if unit in units), "")

    @property
    def bounds(self) -> tuple[float, float]:
        """The least and the greatest possible number, in the unit of the key."""
        return BOUNDS.get(self.key) or BOUNDS.get(words_and_unit(self.key)[1], (-inf, inf))

    @property
    def counts(self) -> bool:
        """Whether it says which rows count."""
        return self.key == COUNT_KEYS[0]

    @property
    def in_unit(self) -> str:
        """The quantity and the unit that it has in the table, in words, such as "velocity in ft/s"."""
        return f"{words_and_unit(self.key)[0]} in {'inches' if self.unit == 'in' else self.unit}"

    def says(self, word: str) -> bool | None:
        """Return whether a word in the column says that a shot perforated, or counts; None if it says neither."""
        said = None if self.yes is None else is_yes(word)
        words = _COUNTED if self.key in COUNT_KEYS else PERFORATED
        return _meaning(word, words) if said is None else said == self.yes

    def words(self, cells: Sequence[str]) -> Sequence[str]:
        """Return the cells, with yes and no for crosses and blanks if it is of yes and no and has no other.

        If all cells are blank, they mean no only in a column that marks the rows to leave out.  Where all others say
        that a row does not count, a blank cell says that it does.
        """
        given = {cell.casefold() for cell in cells} - {""}
        if self.counts and {*map(self.says, given)} == {False}:
            return [cell or ("no" if self.yes is False else "yes") for cell in cells]
        if self.yes is None or given - {"x"} or not (given or (self.counts and self.yes is False)):
            return cells
        return ["yes" if cell else "no" for cell in cells]


def folded(text: str) -> str:
    """Return a text in lower case without accents, as words of letters and digits, divided by underscores."""
    plain = unicodedata.normalize("NFKD", text.casefold())
    return "_".join(re.findall(r"[^\W_]+|[#°]", "".join(c for c in plain if not unicodedata.combining(c))))


@lru_cache
def letters(text: str) -> str:
    """Return the letters and digits of a text, in lower case without accents, by which names are compared."""
    return folded(text).replace("_", "")


def _by_word(pairs: Sequence[Sequence[str]]) -> dict[str, bool]:
    """Return for each word, by its letters, whether it is the second one of its pair, such as "perforated"."""
    return {letters(word): place == 1 for pair in pairs for place, word in enumerate(pair)}


_UNIT_NAMES = {folded(unit): unit for units in UNITS.values() for unit in units}
PERFORATED, _COUNTED = _by_word(OUTCOME_WORDS), _by_word(COUNTED)
# Exactly, as "-1" is not 1.
_YES = {word: place == 1 for pair in YES_OR_NO for place, word in enumerate(pair)}
_AVERAGED = {*map(letters, _DATA["averaged"])}
_SUMMARIES = {*map(letters, _DATA["summaries"])}


def perforates(word: str) -> bool | None:
    """Return True for a word that says that an armour was perforated, False if it stopped the shot, otherwise None."""
    return _meaning(word, PERFORATED)


def _meaning(word: str, words: Mapping[str, bool]) -> bool | None:
    """Return the meaning that `words` gives a word, by its letters; None if it has none or is marked as uncertain."""
    return None if _DOUBT.search(word) else words.get(letters(word))


def is_yes(word: str) -> bool | None:
    """Return whether a word says yes; None if it says neither yes nor no."""
    return _YES.get(word.casefold())


def is_code(text: str) -> bool:
    """Return whether a text is as short as a code, such as PP, which does not say what yes means."""
    return len(letters(text)) <= 3


def sums_up(name: str) -> bool:
    """Return whether the name of a row says that it sums up others, as "V50 (3 + 3)" does."""
    return not name.isdecimal() and letters(_BRACKETS.sub("", name)) in _SUMMARIES


def _unit_at_end(text: str) -> str:
    """Return the unit at the end of a header, both as `folded` returns them; "" if it has none."""
    return max((unit for unit in _UNIT_NAMES if text.endswith(f"_{unit}")), key=len, default="")


def is_unit(text: str) -> bool:
    """Return whether a text is a unit, perhaps in brackets."""
    return folded(text) in _UNIT_NAMES


@cache
def _keys_by_name(columns: tuple[str, ...]) -> dict[str, str]:
    """Return keys by the letters of each name that their columns may have, without the unit; `columns` are the keys."""
    keys = {letters(name): key for key in reversed(columns) for name in USUAL_NAMES.get(key, ())}
    for key in columns:
        unit = words_and_unit(key)[1]
        keys[letters(folded(key).removesuffix(f"_{folded(unit)}" if unit in UNITS else ""))] = key
    return keys


def _key_of(name: str, keys: Mapping[str, str]) -> str | None:
    """Return the key of a name, which may have a word for "number" before or behind it; None if it has no key.

    `keys` are those of `_keys_by_name`.
    """
    name = letters(name)
    if (key := keys.get(name)) is not None:
        return key
    key = keys.get(re.sub(f"^{_NUMBER}(?:de|du)?|{_NUMBER}$", "", name))
    return key if key in NUMBERED else None


def column_of(header: str, columns: Sequence[str]) -> Column:
    """Return the column that a header names: one of the keys `columns`, by any usual name and in any unit.

    If it names none of these, the column is not `known`.  The factor is 0 if the unit is missing or does not fit.
    """
    if header in columns:
        return Column(header, yes=YES_MEANS.get(header))
    if len(header) > MAX_NAME:
        return Column(header, known=False)
    keys = _keys_by_name(tuple(columns))
    name = _BRACKETS.sub(lambda bracket: bracket[0] if is_unit(bracket[1]) else " ", header)
    for text in map(folded, (header, name)):
        ending = _unit_at_end(text)
        stem = re.sub("_(in|en)$", "", text.removesuffix(f"_{ending}")) if ending else text
        whole_key = _key_of(text, keys)
        key = _key_of(stem, keys) or whole_key
        if key is None:
            continue
        units = UNITS.get(words_and_unit(key)[1])
        if units is None:
            return _column_of_words(key, header) if whole_key else Column(header, known=False)
        unit = _UNIT_NAMES.get(ending, "")
        return Column(key, units.get(unit, 0.0), unit, averaged=letters(stem) in _AVERAGED)
    return Column(header, known=False)


def columns_of(header: Sequence[str], keys: Sequence[str]) -> list[Column]:
    """Return the columns of a table, given the names in its header and the keys that they may mean.

    Other names for a key do not count if the key itself is there, nor several velocities beside that of the impact.
    """
    result = next((key for key in RESULT_KEYS if key in keys), "")
    names = (*keys, *GROUPS, *(YES_MEANS if result else COUNT_KEYS))
    columns = []
    for name in header:
        column = column_of(name, names)
        if column.known and column.key in YES_MEANS:
            column = column._replace(key=COUNT_KEYS[0] if column.key in COUNT_KEYS else result)
        columns.append(Column(name, known=False) if column.key in header and name != column.key else column)
    alone = {column.key for column in columns if not column.averaged}
    return [
        column._replace(key=name, known=False) if column.averaged and column.key in alone else column
        for name, column in zip(header, columns, strict=True)
    ]


def _column_of_words(key: str, header: str) -> Column:
    """Return the column of a key for words, whose header may tell in brackets what yes means.

    This concerns columns of results and of yes and no, as in "Result (1 = perforated)".
    """
    column = Column(key, yes=YES_MEANS.get(key))
    bracketed = " ".join(_BRACKETS.findall(header)).replace("?", "")
    if key not in (*RESULT_KEYS, *YES_MEANS) or not bracketed:
        return column
    # Codes and what each means, as in "1 = perforated", which must agree with what yes means.
    of_yes = column._replace(yes=column.yes is not False)
    if codes := [(code, word) for code, word in _CODES.findall(bracketed) if of_yes.says(code) is not None]:
        agree = {None if of_yes.says(word) is None else of_yes.says(code) == of_yes.says(word) for code, word in codes}
        has_yes = all(is_yes(code) is not None for code, _ in codes)
        if agree == {True}:
            return of_yes if has_yes else column
        return of_yes._replace(yes=not of_yes.yes) if agree == {False} and has_yes else Column(key, 0.0, bracketed)
    # What else is in the brackets; "yes/no" alone does not say what yes means.
    rest = _EITHER.sub(lambda two: two[0] if None in map(is_yes, two.groups()) else " ", bracketed)
    meant = {column._replace(yes=None).says(words) for words in re.split(f"[,;]|{_OR}", rest) if letters(words)}
    if meant in (set(), {False, True}) or (column.yes is not None and None in meant):
        return column
    if None in meant or is_code(rest):
        return Column(key, unit=bracketed)
    return column._replace(yes=meant == {True}) if column.yes in (None, *meant) else Column(key, 0.0, bracketed)
