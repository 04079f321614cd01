"""One armour against each of its threats."""

from collections.abc import Mapping
from dataclasses import replace
from math import inf
from xml.etree.ElementTree import Element

from armour.design.check import CheckedThreat, CheckResult, WhatIf
from armour.errors import joined
from armour.reporting.junit import TestCase, junit_suite
from armour.reporting.table import Column, Table, column_of, listing
from armour.reporting.text import Verdict, interval, percent
from armour.reporting.words import STOPPING, basis_notes, chance

PROBABILITY = Column("probability", prose=True)
INTERVAL = Column("95 % interval", "m/s", prose=True)
LIMIT = column_of("ballistic_limit_m_s", label="limit")
MARGIN = column_of("margin_m_s", "+.0f")
# Words of the verdicts, of which one that is overlooked does harm.
VERDICTS = {"passes": "passes", "fails": "FAILS", "not known": "not known"}


def verdict(threat: CheckedThreat) -> str:
    """Return whether an armour passes against a threat, in words."""
    return VERDICTS[threat.verdict]


def required(threat: CheckedThreat) -> str:
    """Return what is required of an armour against a threat."""
    if threat.required_probability is not None:
        return f"at least {percent(threat.required_probability)}"
    margin = f" and a margin of {threat.required_margin_m_s:g} m/s" if threat.required_margin_m_s else ""
    return f"{threat.velocity_m_s:g} m/s{margin}"


def finding(threat: CheckedThreat) -> str:
    """Return the probability or the ballistic limit of an armour against a threat, and the required one."""
    limit = threat.ballistic_limit_m_s
    by_model = "no ballistic limit found" if limit is None else f"ballistic limit by the model {limit:.0f} m/s"
    probability = chance(threat.probability_of_stopping, threat.model_error)
    if threat.required_probability is None:
        return f"{by_model}, {required(threat)} required; probability {probability}"
    words = f"{STOPPING.label} {probability}, {required(threat)} required"
    needed = threat.velocity_m_s + threat.required_margin_m_s
    return words if threat.probability_of_stopping is not None else f"{words}; {by_model}, {needed:g} m/s required"


def threat_table(result: CheckResult) -> Table:
    """Return each threat with the ballistic limit and its interval, the margin, the probability and the verdict."""
    return listing(
        result.threats,
        column_of("threat", prose=True),
        LIMIT,
        (replace(INTERVAL, label="interval"), lambda threat: interval(threat.interval_m_s, ".0f")),
        MARGIN,
        (PROBABILITY, lambda threat: chance(threat.probability_of_stopping, threat.model_error)),
        (Column("verdict"), verdict),
    )


def what_if_tables(threat: CheckedThreat, title: str) -> list[Table]:
    """Return an armour with each change against a threat: the probabilities or, where these are not known, margins.

    There is no table if no velocity perforates the armour, changed or not.
    """
    is_known = threat.probability_of_stopping is not None
    table = listing(
        (threat.as_given(), *threat.what_ifs),
        (Column("if", prose=True), lambda what_if: what_if.change),
        LIMIT,
        (INTERVAL, lambda what_if: interval(what_if.interval_m_s, ".0f")),
        (MARGIN, lambda what_if: None if is_known else _margin(what_if)),
        (PROBABILITY, lambda what_if: chance(what_if.probability_of_stopping) if is_known else ""),
        title=title,
    )
    return [table] if len(table.columns) > 1 else []


def _margin(what_if: WhatIf) -> float | None:
    return None if what_if.ballistic_limit_m_s is None else what_if.ballistic_limit_m_s - what_if.velocity_m_s


def outcome(result: CheckResult) -> str:
    """Return whether an armour passes against all threats, or against which it does not."""
    if len(result.threats) == 1:
        return f"{verdict(result.threats[0])}: {finding(result.threats[0])}"
    if result.verdict == "passes":
        by_model = all(threat.required_probability is None for threat in result.threats)
        return f"passes against every threat{' by the computed limit' if by_model else ''}"
    words = []
    for missed in ("fails", "not known"):
        if names := [threat.threat for threat in result.threats if threat.verdict == missed]:
            words.append(f"{VERDICTS[missed]} against {joined(names)}")
    return "; ".join(words)


def standing(threat: CheckedThreat) -> tuple[int, float]:
    """Return a key that sorts threats, those most likely to perforate first.

    A threat of unknown probability comes first if it perforates by the model, and last otherwise.
    """
    if threat.probability_of_stopping is not None:
        return 1, threat.probability_of_stopping
    unlimited = -inf if threat.verdict == "fails" else inf
    margin = unlimited if threat.margin_m_s is None else threat.margin_m_s - threat.required_margin_m_s
    return (0 if margin < 0.0 else 2), margin


def tables(result: CheckResult) -> list[Table | str]:
    """Return the verdict, the threats, and what changes do against the one most likely to perforate, or each."""
    several = len(result.threats) > 1
    shown: list[Table | str] = [Verdict(outcome(result), good=result.verdict == "passes"), threat_table(result)]
    explained = result.threats if result.question.get("every_row") else (min(result.threats, key=standing),)
    for threat in explained:
        against = f"against {threat.threat}"
        shown += [f"{against}: {note}" if several else note for note in basis_notes(threat)]
        shown += what_if_tables(threat, f"with a change, {against}" if several else "with a change")
    if len(explained) < len(result.threats):
        shown.append("changes against the other threats with -v")
    return shown


def summary(results: Mapping[str, CheckResult]) -> Verdict:
    """Return how many armours pass, each of a file, and which do not."""
    words = [f"passes: {sum(result.verdict == 'passes' for result in results.values())} of {len(results)}"]
    for missed in ("fails", "not known"):
        if files := [file for file, result in results.items() if result.verdict == missed]:
            words.append(f"{VERDICTS[missed]}: {', '.join(files)}")
    return Verdict("; ".join(words), good=len(words) == 1)


def junit(result: CheckResult, file: str, seconds: float, origin: Mapping[str, str]) -> Element:
    """Return the check of a file's scenario as a test suite: a test case for every threat.

    The first one has the time, in seconds, of all of them.
    """
    cases: list[TestCase] = []
    for threat in result.threats:
        kind = "" if threat.verdict == "passes" else "failure"
        took = None if cases else seconds
        cases.append(TestCase(file, threat.threat, kind, f"{verdict(threat)}: {finding(threat)}", took))
    return junit_suite(" ".join(result.heading()[:1]), cases, seconds, origin)
