"""One armour against each of its threats."""

from armour.design.check import CheckedThreat, CheckResult
from armour.reporting import charts
from armour.reporting.junit import junit_xml
from armour.reporting.table import Column, Table, column_of, listing
from armour.reporting.text import Verdict, interval, percent
from armour.reporting.views.confidence import STOPPING, chance, error_note, why_unknown

PROBABILITY = Column("probability", prose=True)
INTERVAL = Column("95 % interval", "m/s", prose=True)
LIMIT = column_of("ballistic_limit_m_s", ".0f", "limit")


def verdict(threat: CheckedThreat) -> str:
    """Return whether an armour passes against a threat, in words."""
    return "passes" if threat.passed else "FAILS"


def required(threat: CheckedThreat) -> str:
    """Return what is required of an armour against a threat."""
    if threat.required_probability is not None:
        return f"at least {percent(threat.required_probability)}"
    margin = f" and a margin of {threat.required_margin_m_s:g} m/s" if threat.required_margin_m_s else ""
    return f"{threat.velocity_m_s:g} m/s{margin}"


def finding(threat: CheckedThreat) -> str:
    """Return what was found of an armour against a threat, beside what is required."""
    if threat.required_probability is not None:
        found = chance(threat.probability_of_stopping, threat.model_error)
        return f"{STOPPING.label} {found}, {required(threat)} required"
    limit = threat.ballistic_limit_m_s
    found = "no ballistic limit found" if limit is None else f"limit {limit:.0f} m/s"
    return f"{found}, required {required(threat)}"


def what_if_table(threat: CheckedThreat, title: str) -> Table:
    """Return an armour as it is and with each change against a threat."""
    return listing(
        (threat.as_given(), *threat.what_ifs),
        (Column("if", prose=True), lambda of: of.change),
        LIMIT,
        (INTERVAL, lambda of: interval(of.interval_m_s, ".0f")),
        (PROBABILITY, lambda of: chance(of.probability_of_stopping)),
        title=title,
    )


def outcome(result: CheckResult) -> str:
    """Return whether an armour passes against all threats, or why or against which it fails."""
    failed = [threat.threat for threat in result.threats if not threat.passed]
    if len(result.threats) == 1:
        return f"{verdict(result.threats[0])}: {finding(result.threats[0])}"
    return f"FAILS against {' and '.join(failed)}" if failed else "passes against every threat"


def tables(result: CheckResult) -> list[Table | str]:
    """Return the verdict, and for each threat a table of the armour as it is and with each change."""
    several = len(result.threats) > 1
    found: list[Table | str] = [Verdict.of(outcome(result), good=all(threat.passed for threat in result.threats))]
    notes = [_rests_on(result, threat) for threat in result.threats]
    for threat, note in zip(result.threats, notes, strict=True):
        title = f"{threat.threat}: {verdict(threat)}, {finding(threat)}" if several else ""
        found.append(what_if_table(threat, title))
        found += [note] if len({*notes}) > 1 else []
    return found if len({*notes}) > 1 else [*found, notes[0]]


def _rests_on(result: CheckResult, threat: CheckedThreat) -> str:
    """Return what the probability against a threat rests on, or why it is not known."""
    error = threat.model_error
    if error is None:
        return why_unknown(threat.reason, threat.probability_at_normal_incidence)
    return error_note(result, error)


def chart(result: CheckResult) -> charts.Chart:
    """Describe the ballistic limits with their intervals, change by change, beside the velocity of each threat."""
    panels = tuple(_panel(threat, named=not place) for place, threat in enumerate(result.threats))
    return charts.Chart(outcome(result), panels, "Percentages: probability that the armour stops the projectile.")


def _panel(threat: CheckedThreat, *, named: bool) -> charts.Panel:
    rows = (threat.as_given(), *threat.what_ifs)
    names = tuple(f"{of.change}: {chance(of.probability_of_stopping)}" for of in rows)
    # An interval that is not known is drawn as the limit.
    known = [
        (limit, float(place), of.interval_m_s or (limit, limit))
        for place, of in enumerate(rows)
        if (limit := of.ballistic_limit_m_s) is not None
    ]
    limits, ends = [limit for limit, *_ in known], tuple(of for *_, of in known)
    velocity, name = ("velocity of the round", "ballistic limit, 95 % interval") if named else ("", "")
    series = (
        charts.Points(limits, [place for _, place, _ in known], label=name, x_ends=ends),
        charts.Points([of.velocity_m_s for of in rows], range(len(rows)), "D", label=velocity, colour="vermilion"),
    )
    x = charts.Axis("velocity", "m/s")
    return charts.Panel(x, charts.Axis(categories=names), series, f"{threat.threat}: {verdict(threat)}")


def junit(result: CheckResult) -> bytes:
    """Format a check: a test case for every threat."""
    cases = []
    for threat in result.threats:
        limit = "" if threat.ballistic_limit_m_s is None else f", limit {threat.ballistic_limit_m_s:.1f} m/s"
        found = (
            f"required {required(threat)}, found {chance(threat.probability_of_stopping, threat.model_error)}{limit}"
        )
        cases.append(("threat", threat.threat, "" if threat.passed else "failure", found))
    return junit_xml(" ".join(result.heading()[:1]), cases)
