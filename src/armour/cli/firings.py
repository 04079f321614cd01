"""Answer questions on tables of shots: for each value of a column, for the next shot, and after adding a shot."""

from collections.abc import Callable, Sequence
from os.path import exists
from pathlib import Path
from typing import NamedTuple

import armour
from armour.analysis.results import EachResult, Result
from armour.cli.console import say
from armour.cli.runner import Files, say_how_read, wrong_option
from armour.columns import perforates
from armour.csv_files import MUST_SAY, open_table
from armour.errors import InputError, NoAnswerError, Note, mistake
from armour.planning.firing import ShotPlan, far_from
from armour.planning.shot_file import content_of, with_shot, without_last
from armour.scenario.keys import describe
from armour.statistics.v50 import SHOTS, Shots, is_of_shots, lots_of, shots_of


class Choice(NamedTuple):
    """Which rows of a table are read: values by column, columns to ignore, and the sheet of a workbook."""

    where: dict[str, str] = {}
    ignore: Sequence[str] = ()
    sheet: str | None = None

    def read(self, table: Path, *, one_kind: bool = True) -> Shots:
        """Read shots, and say how if that was not obvious."""
        return say_how_read(table, armour.read_shots(table, one_kind=one_kind, **self._asdict()))

    def shots_in(self, table: Path, content: bytes) -> Shots:
        """Read shots from the content that a table is to have."""
        source = open_table(table, is_of_shots, content=content)
        return shots_of(source, one_kind=True, where=self.where, ignore=self.ignore)


def each_result(answer: Callable[[Shots], Result], table: Path, column: str, choice: Choice) -> EachResult:
    """Return what `answer` returns for the shots of each value of a column, by column and value, as "panel A".

    Shots that have no answer do not stop the others.
    """
    results, unanswered = {}, {}
    for name, value in lots_of(table, column, choice.where, choice.sheet, choice.ignore):
        try:
            fired = choice._replace(where={**choice.where, name: value}).read(table)
        except InputError as error:
            problems = [problem._replace(key=f"{name} {value}: {problem.key}") for problem in error.problems]
            raise InputError(problems) from None  # options that suit this lot need not suit the others
        try:
            results[f"{name} {value}"] = answer(fired)
        except NoAnswerError as error:
            unanswered[f"{name} {value}"] = str(error)
        except InputError as error:
            if any(problem.file != fired.file for problem in error.problems):
                raise  # a wrong option
            unanswered[f"{name} {value}"] = "; ".join(problem.message for problem in error.problems)
    return EachResult(results, unanswered)


def next_plan(
    plan: Callable[..., ShotPlan], table: Path | None, each: str | None, choice: Choice
) -> EachResult | ShotPlan:
    """Return what `plan` returns for the shots of a table or, if `each` names a column, for each value of this column.

    Without a table, and before the first shot has been written into it, `plan` is called with None.
    """
    is_new = table is not None and table.suffix == ".csv" and not exists(table)
    if is_new:
        say(f"note: {table}: no such file, so no shot has been fired; --result makes the file")
    if table is not None and each is not None:
        return each_result(plan, table, each, choice)
    return plan(None if table is None or is_new else choice.read(table))


def plan_after(
    plan: Callable[..., ShotPlan], table: Path, shot: tuple[str, float | None, str], choice: Choice
) -> tuple[ShotPlan, list[Note], Files]:
    """Plan the next shot after adding one to a table.

    ``shot`` has its result, its velocity, m/s, by default the planned one, and its target, which a new table names.
    Return the plan, its notes and those on the added shot, and the table as a file to write.
    """
    result, velocity_m_s, target = shot
    if perforates(result) is None:
        raise wrong_option("--result", f"{MUST_SAY}, found {describe(result)}")

    earlier_content = content_of(table)
    before = plan(Shots((), (), str(table)) if earlier_content is None else choice.shots_in(table, earlier_content))
    planned, limit = before.next_velocity_m_s, before.prior.v50_m_s
    velocity = planned if velocity_m_s is None else velocity_m_s
    if velocity is None:
        raise wrong_option("--velocity-m-s", "must be given: no further shot was planned")
    if message := far_from(limit, velocity):
        raise wrong_option("--velocity-m-s", message)
    notes = []
    if planned is not None and abs(velocity - planned) > 0.1 * planned:
        notes.append(Note(f"the shot at {velocity:g} m/s added to {table} is far from the {planned:g} m/s planned"))
    content = with_shot(table, velocity, result, choice.where, target)
    after = plan(say_how_read(table, choice.shots_in(table, content)))
    *_, (place, cells) = open_table(table, is_of_shots, content=content).lines
    if len(cells) > len(SHOTS.keys):
        say(f"note: {table}: added {place}: {'; '.join(filter(None, cells))}")
    if velocity_m_s is None:
        say(f"note: {table}: recorded the planned {velocity:g} m/s, as --velocity-m-s was not given")
    return after, [*notes, *after.notes], {table: _replacing(table, earlier_content, content)}


def plan_without_last(plan: Callable[..., ShotPlan], table: Path, choice: Choice) -> tuple[ShotPlan, list[Note], Files]:
    """Plan the next shot after taking the last one back from a table; see `plan_after`."""
    earlier_content = content_of(table)
    content, taken = without_last(table, choice.where, choice.ignore)
    fired = choice.shots_in(table, content)
    after = plan(fired)
    say(f"note: {table}: removed {taken}")
    say_how_read(table, fired)
    return after, [*after.notes], {table: _replacing(table, earlier_content, content)}


def _replacing(table: Path, earlier: bytes | None, content: bytes) -> Callable[[Path], bytes]:
    """Return a function that returns the new content of a table, unless the table no longer has the earlier one."""

    def replaced(_path: Path) -> bytes:
        if content_of(table) != earlier:
            raise mistake(table, "", "cannot be written: it has changed since it was read; repeat the command")
        return content

    return replaced
