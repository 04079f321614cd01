"""Make the report on a scenario: its answer, and the results that explain it and show how reliable it is."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from armour import __version__
from armour.analysis.ballistic_limit import ballistic_limit, not_monotonic
from armour.analysis.impact import simulate
from armour.analysis.results import OnProgress, ignore_progress
from armour.analysis.samples import misplaced
from armour.design.catalogue import asks_for_design
from armour.design.check import CheckedThreat, check, deciding
from armour.design.optimise import DesignResult, optimise
from armour.errors import NoAnswerError, Note
from armour.evidence.model_error import given_error
from armour.evidence.tests import armours_of
from armour.reporting import words as phrases
from armour.reporting.by_result import by_result, drawing_of, headline, tables_of
from armour.reporting.report import Report, ReportSection, origin_section, reference_notes, section_of
from armour.reporting.table import Column, Table, in_words
from armour.reporting.views import design as design_view
from armour.reporting.views.library import entry_table
from armour.scenario.inputs import INPUTS, NAMES, ROLES
from armour.scenario.scenario import Scenario
from armour.statistics.sensitivity import sensitivity
from armour.statistics.uncertainty import uncertainty

# Assumptions of the model; docs/howto/confidence.md has more.
ASSUMPTIONS = (
    ("Penetrator", "a flat-ended cylinder of one material; jacket, tip, sabot and fracture of the core are left out"),
    ("Flight", "straight, without ricochet or yaw; an angle acts through the thickness along the line of fire"),
    ("Armour", "layers in contact; adhesive, covers and spall liners do not resist"),
    ("Hits", "a single one, far from the edges and joints of an unconfined tile or plate"),
    ("Back plate", "resists by its strength and fails by a plug; dishing, petalling, tearing and cracks are left out"),
    ("Stopped", "no perforation; deformation behind the armour and spall are not assessed"),
    ("Probability", "based on the errors of the model on tests; the materials have the values listed here"),
    ("Use", "does not replace firing tests: do not rely on this report alone for anyone's protection"),
)
ONE_SHOT = "One shot, far from edges and joints; this report does not replace firing tests."


def scenario_report(
    scenario: Scenario, command: str, on_progress: OnProgress = ignore_progress, *, as_is: bool = False
) -> Report:
    """Compute a scenario and return the report on it.

    The armour reported is the best design if the scenario asks for one, unless `as_is` keeps its own armour.  `command`
    makes the report, which shows it.
    """

    def on_part(done: int, _total: int | None) -> None:
        on_progress(done, None)

    search = optimise(scenario, on_progress=on_part) if asks_for_design(scenario) and not as_is else None
    checked = check(scenario, on_progress=on_part) if search is None else search.shown.check
    armour: Scenario = checked.question["scenario"]
    threat = deciding(checked)
    reported = armour.against(armour.threats()[checked.threats.index(threat)])
    is_uncertain = scenario.distributions() and not misplaced(scenario.distributions(), scenario, reported)
    limit = _or_none(ballistic_limit, reported, ignore_progress)
    explaining = {
        "Results under uncertain inputs": _or_none(uncertainty, reported, on_part) if is_uncertain else None,
        "The impact, stage by stage": simulate(reported, history=True),
        "Sensitivity to the inputs": _or_none(sensitivity, reported, on_part),
    }
    exact = scenario.unused_distributions() if explaining["Results under uncertain inputs"] else ()
    also = "" if search is None else design_view.nearly_as_good(search)
    facts = design_view.facts(checked, armour=armour.armour_words(), also=also)
    notes = (*(checked if search is None else search).notes, *(() if limit is None else not_monotonic(limit)))
    texts = {"scenario": scenario.title, "project": scenario.project, "author": scenario.author, "date": scenario.date}
    designs = []
    if search is not None:
        designs.append(section_of("Designs", design_view.tables_of_search(search), drawing_of(search, title="")))
    sections = (
        section_of("Threats", design_view.details(checked)),
        *_own_tests(reported),
        *designs,
        ReportSection("Assumptions and limits", notes=ASSUMPTIONS),
        ReportSection("References", notes=reference_notes(_sources(scenario, reported, threat))),
        *(
            section_of(name, by_result(tables_of, result)(result), drawing_of(result, title=""))
            for name, result in explaining.items()
            if result is not None
        ),
        ReportSection("Values and their sources", tables=tuple(_values(reported)), folded=True),
        ReportSection("Scenario", code=scenario.to_toml(), language="toml", folded=True),
        origin_section(command, scenario=scenario),
    )
    return Report(
        title=reported.subject(threats=scenario.threat),
        lead=f"{headline(checked)}.",
        passed={"passes": True, "expected to stop": None, "stopped by the model": None}.get(checked.verdict, False),
        byline=(*((name, text) for name, text in texts.items() if text), ("program version", f"armour {__version__}")),
        sections=sections,
        facts=(*facts, ONE_SHOT, *filter(None, [_which_armour(scenario, search)])),
        warnings=tuple(_warning(note) for note in notes if note not in exact),
        cross_section=reported,
    )


def _or_none(question: Callable[..., Any], scenario: Scenario, on_progress: OnProgress) -> Any:
    """Return what `question`, a function such as `ballistic_limit`, answers for a scenario; None without an answer.

    An armour that no velocity perforates, for example, has no ballistic limit.
    """
    try:
        return question(scenario, on_progress=on_progress)
    except NoAnswerError:
        return None


def _warning(note: Note) -> str:
    """Return a note as a warning, which names an input by its label instead of its key."""
    name = note.key.removeprefix("uncertainty.")
    is_input = name in INPUTS or name in NAMES.values()
    return str(replace(note, key=note.key.replace(name, in_words(name)))) if is_input else str(note)


def _own_tests(reported: Scenario) -> Iterator[ReportSection]:
    """Yield a section for each material of the armour with own tests, with their source."""
    for entry in filter(None, map(reported.entry_of, ("ceramic", "backing"))):
        tests = next((value.tests for value in entry.values.values() if value.tests), [])
        if entry.evidence is not None and tests:
            source = f"{entry.name}: {entry.evidence.source}, calibrated with armour."
            labels = {key: key * (key == "outcome") for test in tests for key in test}  # of the model's by default
            columns = (
                (Column.of(key, label=word), lambda test, key=key: test.get(key)) for key, word in labels.items()
            )
            yield ReportSection("Own tests", (source,), tables=(Table.of(tests, *columns),))


def _sources(scenario: Scenario, reported: Scenario, threat: CheckedThreat) -> Iterator[str]:
    """Yield texts that cite the sources of the model, of its error, of the values and of the threats as "[key]".

    `reported` is `scenario` with the reported armour against the deciding threat.
    """
    yield "[Paper]"
    if threat.model_error is not None and given_error(reported) is None:
        yield from (evidence.source for evidence, _ in armours_of(reported).by_evidence)
    for entry in filter(None, map(reported.entry_of, ROLES)):
        yield from (value.source for value in entry.values.values())
    yield from phrases.threat_sources(scenario)


def _values(reported: Scenario) -> Iterator[Table]:
    """Yield a table of the values of each material and of the projectile, with their sources."""
    for entry in filter(None, map(reported.entry_of, ROLES)):
        table = entry_table(entry, Column("quantity", prose=True), in_words)
        yield replace(table, title=f"{entry.kind.capitalize()}: {entry.name}")


def _which_armour(scenario: Scenario, search: DesignResult | None) -> str:
    """Return which armour is reported if the scenario asks for a design, and how to report on the other; else "".

    `search` is the result of the search for a design, None if there was none.
    """
    if search is not None and (own := scenario.armour_words()) != search.shown.scenario.armour_words():
        return f"This report is about the design found, not the scenario's own armour, {own}; use --as-is for that."
    if search is None and asks_for_design(scenario):
        return "This report is about the scenario's own armour; without --as-is it is about the design found."
    return ""
