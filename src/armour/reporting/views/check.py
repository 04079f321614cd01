"""One armour against each of its threats."""

from collections.abc import Mapping
from math import inf
from xml.etree.ElementTree import Element

from armour.design.check import CheckedThreat, CheckResult
from armour.errors import listed
from armour.reporting.junit import TestCase, junit_suite
from armour.reporting.table import Column, Table, column_of, listing
from armour.reporting.text import Verdict, interval, percent, with_interval
from armour.reporting.words import STOPPING, chance, error_note, flow_stress_notes, why_unknown

PROBABILITY = Column("probability", prose=True)
INTERVAL = Column("95 % interval", "m/s", prose=True)
LIMIT = column_of("ballistic_limit_m_s", ".0f", "limit by the model")
WITH_ERROR = Column("with the model error", "m/s", prose=True)
MARGIN = column_of("margin_m_s", "+.0f")
# Words of the verdicts, of which one that is overlooked does harm.
VERDICTS = {"passes": "passes", "fails": "FAILS", "not known": "not known"}


def verdict(found: CheckedThreat | CheckResult) -> str:
    """Return whether an armour passes, in words."""
    return VERDICTS[found.verdict]


def required(threat: CheckedThreat) -> str:
    """Return what is required of an armour against a threat."""
    if threat.required_probability is not None:
        return f"at least {percent(threat.required_probability)}"
    margin = f" and a margin of {threat.required_margin_m_s:g} m/s" if threat.required_margin_m_s else ""
    return f"{threat.velocity_m_s:g} m/s{margin}"


def finding(threat: CheckedThreat) -> str:
    """Return what was found of an armour against a threat, beside what is required."""
    limit = threat.ballistic_limit_m_s
    by_model = "no ballistic limit found" if limit is None else f"ballistic limit by the model {limit:.0f} m/s"
    if threat.required_probability is None:
        return f"{by_model}, {required(threat)} required"
    found = (
        f"{STOPPING.label} {chance(threat.probability_of_stopping, threat.model_error)}, {required(threat)} required"
    )
    needed = threat.velocity_m_s + threat.required_margin_m_s
    return found if threat.probability_of_stopping is not None else f"{found}; {by_model}, {needed:g} m/s required"


def threat_table(result: CheckResult) -> Table:
    """Return each threat with the ballistic limit, the margin, the probability and the verdict."""
    probable = any(threat.probability_of_stopping is not None for threat in result.threats)
    return listing(
        result.threats,
        (Column("threat", prose=True), lambda of: of.threat),
        LIMIT,
        (WITH_ERROR, _with_error),
        MARGIN,
        (PROBABILITY, lambda of: chance(of.probability_of_stopping, of.model_error) if probable else "unknown"),
        (Column("verdict"), verdict),
    )


def _with_error(threat: CheckedThreat) -> str:
    """Return the median and the interval of the ballistic limit with the model error."""
    error, limit = threat.model_error, threat.ballistic_limit_m_s
    return "" if error is None or limit is None else with_interval(error.median(limit), threat.interval_m_s, ".0f")


def what_if_table(threat: CheckedThreat, title: str) -> Table:
    """Return an armour with each change against a threat: the probabilities or, where these are not known, margins."""
    known = threat.probability_of_stopping is not None
    return listing(
        (threat.as_given(), *threat.what_ifs),
        (Column("if", prose=True), lambda of: of.change),
        LIMIT,
        (INTERVAL, lambda of: interval(of.interval_m_s, ".0f")),
        (
            MARGIN,
            lambda of: None if known or of.ballistic_limit_m_s is None else of.ballistic_limit_m_s - of.velocity_m_s,
        ),
        (PROBABILITY, lambda of: chance(of.probability_of_stopping) if known else ""),
        title=title,
    )


def outcome(result: CheckResult) -> str:
    """Return whether an armour passes against all threats, or against which it does not."""
    if len(result.threats) == 1:
        return f"{verdict(result.threats[0])}: {finding(result.threats[0])}"
    if result.verdict == "passes":
        by_model = all(threat.required_probability is None for threat in result.threats)
        return f"passes against every threat{' by the computed limit' if by_model else ''}"
    named = {each: [of.threat for of in result.threats if of.verdict == each] for each in ("fails", "not known")}
    return "; ".join(f"{VERDICTS[each]} against {listed(names)}" for each, names in named.items() if names)


def governing(result: CheckResult) -> CheckedThreat:
    """Return the threat that most likely perforates the armour, as far as is known: of the worst verdict."""
    return min(result.threats, key=standing)


def standing(found: CheckedThreat) -> tuple[int, float]:
    """Return by what threats are ordered, those that most likely perforate first.

    A threat of an unknown probability comes first if it perforates by the model, and last otherwise.
    """
    if found.probability_of_stopping is not None:
        return 1, found.probability_of_stopping
    stopped = -inf if found.verdict == "fails" else inf
    margin = stopped if found.margin_m_s is None else found.margin_m_s - found.required_margin_m_s
    return (0 if margin < 0.0 else 2), margin


def tables(result: CheckResult) -> list[Table | str]:
    """Return the verdict, a table of the threats, and what changes would do against the one that governs, or each."""
    several, worst = len(result.threats) > 1, governing(result)
    found: list[Table | str] = [Verdict.of(outcome(result), good=result.verdict == "passes"), threat_table(result)]
    shown = result.threats if result.question.get("every_row") else (worst,)
    for threat in shown:
        against = f"against {threat.threat}"
        found += [f"{against}: {note}" if several else note for note in _rests_on(result, threat)]
        found.append(what_if_table(threat, f"with a change, {against}" if several else "with a change"))
    if len(shown) < len(result.threats):
        found.append("changes against the other threats with -v")
    return found


def _rests_on(result: CheckResult, threat: CheckedThreat) -> list[str]:
    """Return what the probability rests on, or why it is not known and what the flow stress must be."""
    if threat.model_error is not None:
        return [error_note(result, threat.model_error)]
    unknown = why_unknown(threat.reason, threat.probability_at_normal_incidence)
    return [*flow_stress_notes(threat.flow_stress), unknown]


def junit(result: CheckResult, file: str, seconds: float, origin: Mapping[str, str]) -> Element:
    """Return the check of a file's scenario as a test suite: a test case for every threat."""
    cases = []
    for threat in result.threats:
        kind = "" if threat.verdict == "passes" else "failure"
        cases.append(TestCase(file, threat.threat, kind, f"{verdict(threat)}: {finding(threat)}"))
    return junit_suite(" ".join(result.heading()[:1]), cases, seconds, origin)
