"""Write a suite that shows whether answers for scenarios change: with bands, but without expected values."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import tomli_w

from armour.analysis.results import OnProgress, ignore_progress
from armour.design.catalogue import asks_for_design
from armour.errors import NoAnswerError
from armour.scenario.library import THREAT_KEYS
from armour.scenario.scenario import Scenario
from armour.scenario.schema import DesignSection, at_angle
from armour.validation.questions import OPTIMUM, Subject, answer

HEAD = """\
# What the program computes for these scenarios, to show that nothing moves unnoticed.
# `armour validate FILE --update` writes the computed values as `expected`; `armour validate FILE` compares with them.
# The bands are half of the last digit that `armour check` shows, and of a best design 0.1 %.

"""
LIMIT, PROBABILITY = "ballistic_limit_m_s", "probability_of_stopping"
BANDS: dict[str, dict[str, Any]] = {LIMIT: {"band": 0.5}, PROBABILITY: {"band": 0.005}}
# Keys of an impact on which the ballistic limit depends.
ROUND = [key for key in THREAT_KEYS if key != "velocity_m_s"]


def new_suite(scenarios: Mapping[str, Scenario], on_progress: OnProgress = ignore_progress) -> str:
    """Return the text of a suite that watches the answers for scenarios, given by the names that they have in its file.

    It watches the ballistic limit and the probability of stopping against each threat and, if a scenario asks for a
    design, the objective of the best one.  A question without an answer is not scored, for this reason.  `on_progress`
    is called with the number of scenarios done since the last call, and of all.
    """
    cases: list[dict[str, Any]] = []
    for name, scenario in scenarios.items():
        cases += (_case_table(name, *question) for question in _questions(scenario))
        on_progress(1, len(scenarios))
    return HEAD + tomli_w.dumps({"title": "What the program computes", "regression": True, "case": cases})


def _questions(scenario: Scenario) -> Iterator[tuple[str, str, Scenario, Sequence[str]]]:
    """Yield the questions about a scenario that a suite watches.

    Each has its words, the quantity, the scenario to compute it for, and the keys of the impact that the case must set.
    """
    asked = [(threat, scenario.against(threat)) for threat in scenario.threats()]
    keys = (ROUND, THREAT_KEYS) if scenario.threat else ((), ())
    # Threats that differ only in velocity have the same limit.
    rounds = {str(changed.impact.model_dump(include={*ROUND})): (threat, changed) for threat, changed in asked}
    for threat, changed in rounds.values():
        yield f"ballistic limit against {threat.round_name}{at_angle(threat)}", LIMIT, changed, keys[0]
    for threat, changed in asked:
        yield f"probability of stopping {threat.title}", PROBABILITY, changed, keys[1]
    if asks_for_design(scenario):
        yield "best design", OPTIMUM + (scenario.design or DesignSection()).minimise, scenario, ()


def _case_table(name: str, words: str, quantity: str, asked: Scenario, keys: Sequence[str]) -> dict[str, Any]:
    """Return a case as a table of the suite's file; `name` is that of the scenario, the others as in `_questions`."""
    judged = BANDS.get(quantity, {"band_percent": 0.1})
    try:
        answer(quantity, Subject(asked))
    except NoAnswerError as error:
        judged = {"not_scored": str(error)}
    changes = {"set": {"impact": asked.impact.model_dump(include={*keys})}} if keys else {}
    title = f"{name.removesuffix('.toml')}: {words}"
    return {"name": title, "scenario": name, "quantity": quantity, **judged, **changes}
