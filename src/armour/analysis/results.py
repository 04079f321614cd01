"""Base classes of results, with their conversion to plain data and data frames; how computations report progress."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass
from importlib import import_module
from math import nan
from typing import Any, ClassVar, Self

from armour.errors import Note
from armour.files import finite
from armour.scenario.scenario import Scenario


def installed(packages: Iterable[str]) -> list[tuple[str, str]]:
    """Return those of the named packages that are installed, each with its version."""
    from importlib.metadata import PackageNotFoundError, version  # slow to import

    versions = []
    for name in packages:
        with suppress(PackageNotFoundError):
            versions.append((name, version(name)))
    return versions


def made_by(scenario: Scenario | None, command: str) -> dict[str, str]:
    """Return the origin of an output, by key: versions, command, and the hash of the scenario's content, if any."""
    from armour import MODEL_VERSION, __version__  # whose public names include those of this module

    origin = {"version": __version__, "model_version": MODEL_VERSION}
    origin |= {"command": command} if command else {}
    return origin | ({} if scenario is None else {"scenario_sha256": scenario.digest()})


@dataclass(frozen=True, repr=False)
class Result:
    """Result of a computation; the base class of all results.

    Attributes
    ----------
    question : mapping
        What tables and figures show beside the data: ``computed``, what was computed, in words; ``scenario``;
        ``shots``; ``name`` and ``labels`` of an offer; ``confidence``, the result that has the probability of an
        impact; ``changed``, equations that are not those of this program, in words; ``every_row``, whether to
        show details and all rows (option -v).  Each may be missing.
    """

    question: ClassVar[Mapping[str, Any]] = {}

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader should know beside the answer: the texts of the notes of the result and of its scenario."""
        notes: Iterable[Note] = getattr(self, "notes", ())
        return (*map(str, notes), *getattr(self.question.get("scenario"), "notes", ()))

    def of(self, computed: str | None = None, **question: Any) -> Self:
        """Record the question that this result answers, in the result itself, and return the result.

        `computed` says what was computed, in words; `question` has the other entries of the attribute ``question``.
        """
        words = {} if computed is None else {"computed": computed}
        object.__setattr__(self, "question", {**self.question, **words, **question})
        return self

    def subject(self) -> str:
        """Return what was computed, in words, such as for titles; "" for a result whose question is not recorded."""
        scenario = self.question.get("scenario")
        words: str = self.question.get("computed") or (scenario.subject() if scenario else "")
        return words

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data, with None for NaN and infinity."""
        data: dict[str, Any] = finite(_plain(self))
        return data

    def __repr__(self) -> str:
        # How results are shown belongs to a higher layer.
        line: str = import_module("armour.reporting.by_result").in_a_line(self)
        return f"<{': '.join(filter(None, [type(self).__name__, self.subject(), line]))}>"

    def _repr_html_(self) -> str | None:
        """Return the tables that the command prints, as HTML for a notebook; None if there are none."""
        in_html: str | None = import_module("armour.reporting.show").in_html(self)
        return in_html


def _plain(value: Any) -> Any:
    """Return a value as dictionaries, lists and plain values; the notes of a result become its warnings."""
    if isinstance(value, Mapping):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [*map(_plain, value)]
    if not is_dataclass(value):
        return value
    data = {item.name: getattr(value, item.name) for item in fields(value)}
    if isinstance(value, Result) and data.pop("notes", None) is not None:
        data["warnings"] = value.warnings
    return _plain(data)


@dataclass(frozen=True, repr=False)
class EachResult(Result):
    """Results of several tables, or of parts of one, by name; and, by name, why others have no answer."""

    results: Mapping[str, Result]
    unanswered: Mapping[str, str]

    @property
    def notes(self) -> tuple[Note, ...]:
        """Warnings of all results, each after the name of its result."""
        return tuple(Note(text, name) for name, result in self.results.items() for text in result.warnings)

    def to_dict(self) -> dict[str, Any]:
        """Return the results as plain data, by name."""
        results = {name: result.to_dict() for name, result in self.results.items()}
        return {**results, **{name: {"no_answer": reason} for name, reason in self.unanswered.items()}}


@dataclass(frozen=True, repr=False)
class TableResult(Result):
    """Result with rows; iteration gives each row as a dictionary, so that ``pandas.DataFrame(result)`` works."""

    def __iter__(self) -> Iterator[dict[str, Any]]:
        columns = self._columns()
        return (dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True))

    def to_dataframe(self) -> Any:
        """Return the rows as a data frame of pandas.

        The rows are the stages of an impact, the instants of a history, the predictions of a comparison, the designs
        of the frontier, the fitted curves of a V50, the residuals of a calibration, the inputs of a sensitivity, the
        points of the curve of an uncertainty, the threats and changes of a check, the checks of a suite or the rows of
        a sweep.
        """
        return data_frame(self._columns())

    def _columns(self) -> Mapping[str, Any]:
        """Return the columns by name, each with a value per row."""
        raise NotImplementedError


def data_frame(columns: Mapping[str, Any]) -> Any:
    """Return columns as a data frame of pandas; a column of None alone stands for numbers that are not known."""
    empty = [key for key, values in columns.items() if isinstance(values, list) and set(values) == {None}]
    return import_module("pandas").DataFrame({**columns, **{key: [nan] * len(columns[key]) for key in empty}})


def by_column(rows: Any) -> dict[str, list[Any]]:
    """Return rows, which are mappings with the same keys, as columns: a list of values by key."""
    rows = list(rows)
    return {key: [row[key] for row in rows] for key in (rows[0] if rows else ())}


def same_columns(columns: Mapping[str, Any], expected: Mapping[str, Any]) -> bool:
    """Return whether two tables have the same columns, arrays by name; NaN equals NaN."""
    return columns.keys() == expected.keys() and all(
        values.dtype == expected[name].dtype and values.tobytes() == expected[name].tobytes()
        for name, values in columns.items()
    )


# Called with the work done since the last call and the total, None if that is unknown.
OnProgress = Callable[[int, int | None], None]


def ignore_progress(_done: int, _total: int | None) -> None:
    """Do nothing: the progress of a computation that nobody watches."""


def portions(count: int, most: int) -> Iterator[slice]:
    """Yield slices of at most `most` rows that make up `count` rows, to bound the memory and show the progress."""
    for start in range(0, count, most):
        yield slice(start, min(start + most, count))
