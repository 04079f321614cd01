"""Make the record of a firing: one page to file for each lot."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from armour import __version__
from armour.analysis.results import Result
from armour.reporting.by_result import by_result, draw
from armour.reporting.report import Report, ReportSection, origin_section
from armour.reporting.table import Column, Table, percent
from armour.reporting.views import statistics as views
from armour.statistics.v50 import FiringResult, LotResults, MeanV50, Shots

SIGNED = ("Fired by", "Checked by")
RESULTS = {False: "partial", True: "complete"}


def firing_report(result: Result, command: str) -> Report:
    """Make the record of a firing, or of several lots, each on a page of its own; `command` makes the record."""
    if isinstance(result, FiringResult):
        return _page(result, command)
    assert isinstance(result, LotResults)
    pages = [
        _page(lot, command, name, views.difference_words(result, name))
        for name, lot in result.results.items()
        if isinstance(lot, FiringResult)
    ]
    unanswered = tuple(f"{name}: {reason}" for name, reason in result.unanswered.items())
    if not pages:
        return Report("Record of a firing", "", (), warnings=unanswered)
    return replace(pages[0], warnings=(*unanswered, *pages[0].warnings), pages=tuple(pages[1:]))


def _page(result: FiringResult, command: str, name: str = "", differences: Sequence[str] = ()) -> Report:
    """Make the page of a lot, whose `name` is that of a column and its value, as "lot A"."""
    shots, computed, scenario = result.question["shots"], result.subject(), result.question.get("scenario")
    lines = shots.read.title if shots.read else ()
    mean = result.mean or next(iter(result.means), None)
    verdict = views.decision(result) if result.decision else ""
    found = [f"{name}: {words}" for name, words in views.points(result).items()]
    sections = [
        ReportSection("Shots", tables=(_shot_table(shots, mean),)),
        _v50_section(result, found),
        ReportSection("Mean of velocities", () if mean else ("none",), tables=(_mean_table(result),) if mean else ()),
        _not_used(shots, name),
    ]
    if result.fits:
        picture = lambda sheet: by_result(draw, result)(result, sheet, alone=True)  # noqa: E731
        sections.insert(1, ReportSection("Curve", pictures=(picture,)))
    if differences:
        sections.append(ReportSection("Other lots", (*map(_sentence, (*differences, views.ONE_SCATTER)),)))
    read = shots.read and f"{Path(shots.file).name}: {shots.read.words}; SHA-256 {shots.read.sha256}."
    origin = origin_section(command, read or "", scenario)
    *hashes, made_by = origin.paragraphs
    versions = f"{', '.join(f'{program} {version}' for program, version in origin.tables[0].rows)}."
    origin = replace(origin, paragraphs=(*hashes, versions, made_by), tables=(), folded=False)
    names = (("table", Path(shots.file).name), ("program version", f"armour {__version__}"))
    return Report(
        title=f"{', '.join(filter(None, ('Record of a firing', name)))}: {lines[0] if lines else computed}",
        text="; ".join((*lines[1:], computed) if lines else ()),
        lead=_sentence("; ".join(filter(None, (verdict, _v50_fact(result))))),
        passed=result.decision == "met" if verdict else None,
        byline=names,
        facts=(_mean_fact(result, mean), _asked_fact(result)),
        warnings=tuple(map(str, result.notes)),
        sections=(*sections, origin),
        signed=SIGNED,
    )


def _sentence(words: str) -> str:
    """Return words as a sentence."""
    return f"{words[:1].upper()}{words[1:]}."


def _v50_section(result: FiringResult, notes: Sequence[str]) -> ReportSection:
    """Return the section with the recommended curve and, if there is one, the posterior."""
    tables = []
    if result.recommended is not None:
        tables.append(views.recommended_table(result.recommended, result.confidence))
    if result.prior is not None and result.posterior is not None:
        tables.append(views.prior_table(result.prior, result.posterior, result.confidence))
    return ReportSection("V50", tuple(notes), tables=tuple(tables))


def _shot_table(shots: Shots, mean: MeanV50 | None) -> Table:
    """Tabulate the shots used, and which of them a mean is of."""
    rows = range(len(shots.complete))
    averaged = _averaged(shots, mean.pairs) if mean else set[int]()
    heading = f"in the mean of {mean.pairs} + {mean.pairs}" if mean else ""
    heading += "" if mean is None or mean.is_allowed else ", spread exceeded"
    return Table.of(
        rows,
        (Column("shot"), lambda i: shots.names[i] if shots.names else str(i + 1)),
        (Column("velocity", "m/s", ".1f"), lambda i: shots.velocities_m_s[i]),
        (Column("result"), lambda i: RESULTS[shots.complete[i]]),
        (Column(heading), lambda i: "yes" if i in averaged else ""),
    )


def _averaged(shots: Shots, pairs: int) -> set[int]:
    """Return the indices of the shots in the mean: those of the fastest partial and slowest complete penetrations."""
    order = sorted(range(len(shots.complete)), key=lambda i: shots.velocities_m_s[i])
    partial, complete = ([i for i in order if shots.complete[i] == kind] for kind in (False, True))
    return {*partial[-pairs:], *complete[:pairs]}


def _not_used(shots: Shots, name: str) -> ReportSection:
    """Return the section with the rows of the table that are not used and why, without those of other lots."""
    left = []
    if shots.read is not None:
        chosen = dict(shots.read.chosen)
        left = [row for row in shots.read.not_used if name != f"{row.column} {chosen.get(row.column)}"]
    reason = Column("reason", prose=True), lambda row: f"{row.column}: {row.value or 'blank'}"
    written = Column("as written", prose=True), lambda row: "; ".join(filter(None, row.cells))
    tables = (Table.of(left, Column.of("place", label="row"), reason, written),) if left else ()
    return ReportSection("Shots not used", () if left else ("none",), tables=tables)


def _mean_table(result: FiringResult) -> Table:
    """Tabulate the means that were tried, with the spread obtained and allowed."""
    return Table.of(
        result.means,
        (Column("shots averaged"), lambda mean: f"{mean.pairs} + {mean.pairs}"),
        Column.of("v50_m_s", ".1f", "mean"),
        Column.of("span_m_s", ".4g", "spread obtained"),
        Column.of("span_allowed_m_s", ".4g", "allowed"),
        (Column("spread"), lambda mean: "within" if mean.is_allowed else "exceeds"),
    )


def _v50_fact(result: FiringResult) -> str:
    """Return V50, its interval and its lower bound, at the confidence asked for."""
    fit, level = result.recommended, percent(result.confidence)
    if fit is None or result.extrapolated:
        return "V50 not bounded by these shots"
    lower = "no lower bound" if fit.v50_lower_m_s is None else f"at least {fit.v50_lower_m_s:.0f} m/s"
    return f"{views.at_one_level(result)}; {lower} with {level}"


def _mean_fact(result: FiringResult, mean: MeanV50 | None) -> str:
    """Return the mean of the standard, or why there is none."""
    name = views.MEANS[mean.rule if mean else "usual span"]
    if mean is None:
        return f"{name}: none, too few shots of each kind."
    found = f"{mean.v50_m_s:.0f} m/s" if result.mean else "none, spread exceeded"
    spread = f"spread {mean.span_m_s:.4g} of {mean.span_allowed_m_s:.4g} m/s allowed"
    return f"{name}: {found}; {mean.pairs} + {mean.pairs} shots, {spread}."


def _asked_fact(result: FiringResult) -> str:
    """Return what was asked."""
    asked = "V50"
    if result.requirement_m_s is not None:
        name = views.velocity_name(result.requirement_fraction)
        asked = f"{name} of at least {result.requirement_m_s:g} m/s"
    return f"Asked for: {asked}, confidence {percent(result.confidence)}."
