"""Make the record of a firing: one page to file for each lot."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from armour import __version__
from armour.analysis.results import Result
from armour.reporting.by_result import drawing_of, headline
from armour.reporting.report import Report, ReportSection, origin_section, section_of
from armour.reporting.table import Column, Table, sentence
from armour.reporting.views import statistics as views
from armour.statistics.v50 import FiringResult, LotResults, MeanV50, Shots


def firing_report(result: Result, command: str) -> Report:
    """Return the record of a firing, or of lots, each on its own page; it shows `command`, which makes it."""
    if isinstance(result, FiringResult):
        return _page(result, command)
    assert isinstance(result, LotResults)
    lots = {name: lot for name, lot in result.results.items() if isinstance(lot, FiringResult)}
    pages = [_page(lot, command, name, views.difference_words(result, name)) for name, lot in lots.items()]
    unanswered = tuple(f"{name}: {reason}" for name, reason in result.unanswered.items())
    if not pages:
        return Report("Record of a firing", "", (), warnings=unanswered)
    return replace(pages[0], warnings=(*unanswered, *pages[0].warnings), pages=tuple(pages[1:]))


def _page(result: FiringResult, command: str, name: str = "", differences: Sequence[str] = ()) -> Report:
    """Return the page of a lot, whose `name` is that of a column and its value, as "lot A".

    `differences` has a line for each comparison with another lot.
    """
    shots, computed = result.question["shots"], result.subject()
    lines = shots.read.title if shots.read else ()
    used = ReportSection("Shots", tables=(_shot_table(shots, result.mean or next(iter(result.means), None)),))
    curve = ReportSection("Curve", pictures=(drawing_of(result),))
    others = ReportSection("Other lots", (*map(sentence, (*differences, views.ONE_SCATTER)),))
    file = Path(shots.file).name
    read = f"{file}: {shots.read.words}; SHA-256 {shots.read.sha256}." if shots.read else ""
    return Report(
        title=f"{', '.join(filter(None, ('Record of a firing', name)))}: {lines[0] if lines else computed}",
        text="; ".join((*lines[1:], computed) if lines else ()),
        lead=f"{headline(result)}.",
        passed=result.decision == "met" if result.decision else None,
        byline=(("table", file), ("program version", f"armour {__version__}")),
        facts=tuple(views.facts_of_firing(result)),
        warnings=tuple(map(str, result.notes)),
        sections=(
            used,
            section_of("V50", views.estimates(result)),
            *[others] * bool(differences),
            *[curve] * bool(result.fits),
            _not_used(shots, name),
            replace(origin_section(command, read, result.question.get("scenario")), folded=False),
        ),
        signed=("Fired by", "Checked by"),
    )


def _shot_table(shots: Shots, mean: MeanV50 | None) -> Table:
    """Tabulate the shots used, and mark those that the mean, if there is one, averages."""
    if mean is None:
        return views.shot_table(shots)
    # The mean is of the fastest partial and the slowest complete penetrations.
    order = sorted(range(len(shots.complete)), key=lambda i: shots.velocities_m_s[i])
    partial, complete = ([i for i in order if shots.complete[i] == kind] for kind in (False, True))
    averaged = {*partial[-mean.pairs :], *complete[: mean.pairs]}
    return views.shot_table(shots, averaged, f"in the mean of {mean.pairs} + {mean.pairs}")


def _not_used(shots: Shots, name: str) -> ReportSection:
    """Return the section with the rows of the table that are not used and why, without those of other lots."""
    unused = []
    if shots.read is not None:
        chosen = dict(shots.read.chosen)
        unused = [row for row in shots.read.not_used if name != f"{row.column} {chosen.get(row.column)}"]
    reason = Column("reason", prose=True), lambda row: f"{row.column}: {row.value or 'blank'}"
    written = Column("as written", prose=True), lambda row: "; ".join(filter(None, row.cells))
    tables = (Table.of(unused, Column.of("place", label="row"), reason, written),) if unused else ()
    return ReportSection("Shots not used", () if unused else ("none",), tables=tables)
