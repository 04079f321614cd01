"""Requirements on an armour and whether it meets them; all commands and pages judge an armour by this list."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from armour.analysis.estimates import Estimate
from armour.core.state import Parameters
from armour.evidence.caveats import LEAST_METAL_KG_M3, is_limit_too_low, is_no_metal
from armour.evidence.tests import LEAST_SOURCES, lacks_sources
from armour.scenario.library import LibraryEntry
from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES, DesignSection, Threat

Verdict = Literal["passes", "fails", "not known"]
# Largest relative excess that is rounding.
SLACK_ROUNDING = 1e-12


@dataclass(frozen=True)
class Requirement:
    """What is required of an armour, and what it has.

    Attributes
    ----------
    quantity : str
        "margin_m_s", "probability_of_stopping", "flow_stress_sources", "backing_density_kg_m3", "interlayers", or a key
        of a design such as "thickness_mm".
    threat : str
        The threat that it is about; empty if it is about none.
    required : float
        The least margin, probability, number of sources or density of a metal, or the greatest number of layers between
        tile and back plate, areal density, thickness or cost.
    found : float or None
        What the armour has; None if that is not known.
    verdict : {"passes", "fails", "not known"}
    interval : tuple of float or None
        95 % interval of a probability that is sampled.
    """

    quantity: str
    threat: str
    required: float
    found: float | None
    verdict: Verdict
    interval: tuple[float, float] | None = None


def verdict_of(verdicts: Iterable[Verdict]) -> Verdict:
    """Return the verdict on an armour, the worst of the verdicts on its requirements."""
    distinct = set(verdicts)
    return "fails" if "fails" in distinct else "not known" if "not known" in distinct else "passes"


def verdict_of_samples(perforation: Estimate, bound: float) -> Verdict:
    """Return the verdict on a sampled probability of perforation: not known if its 95 % interval contains the bound."""
    return "passes" if perforation.high <= bound else "fails" if perforation.low > bound else "not known"


def against_threat(
    scenario: Scenario,
    threat: Threat,
    armour: Parameters,
    ceramic: LibraryEntry | None,
    limit_m_s: float,
    probability: float | None,
    sampled: Estimate | None,
    *,
    stops: bool,
    greatest: float = 1.0,
) -> Iterator[Requirement]:
    """Yield what is required of an armour against a threat.

    A margin is required if the threat gives one; if no probability is required, the margin must be at least 0.  A
    probability that is not known fails if the ballistic limit by the model is below the velocity plus the margin.  A
    limit that is known to be too low never fails: the verdict is "not known" instead.  For a back plate that does
    not count as a metal, the only requirement is a metal, with the verdict "not known".

    Parameters
    ----------
    scenario : Scenario
        Gives the probability that is required against all threats, the tolerance of the ballistic limit, and the number
        of layers between tile and back plate, which no shipped test has.
    threat : Threat
    armour : Parameters
        Armour and projectile.  For some, the limit is known to be too low, see `evidence.caveats`.
    ceramic : LibraryEntry or None
        Without tests and with fewer than two sources of its flow stress, it is not known whether the armour stops the
        threat.
    limit_m_s : float
        Ballistic limit by the model, m/s.
    probability : float or None
        Probability that the armour stops a shot; None if it is not known.
    sampled : Estimate or None
        Probability of perforation, if uncertain inputs are sampled.
    stops : bool
        Whether the armour stops the projectile, by the model, at the velocity plus the margin.
    greatest : float
        Greatest probability that is stated.  If more is required, but not more than `probability`, the verdict is "not
        known".
    """
    if is_no_metal(armour.rho_B):
        yield Requirement("backing_density_kg_m3", threat.title, LEAST_METAL_KG_M3, armour.rho_B, "not known")
        return
    bound, margin_m_s = (scenario.design or DesignSection()).bound(threat), limit_m_s - threat.velocity_m_s
    if margin_m_s >= threat.margin_m_s and not stops:
        margin_m_s -= scenario.ballistic_limit.tolerance_m_s
    reaches = margin_m_s >= threat.margin_m_s
    short: Verdict = "not known" if is_limit_too_low(armour) else "fails"
    if threat.margin_m_s > 0.0 or bound is None:
        verdict: Verdict = "passes" if reaches else short
        yield Requirement("margin_m_s", threat.title, threat.margin_m_s, margin_m_s, verdict)
    if ceramic is not None and armour.Hc0 and lacks_sources(ceramic):
        yield Requirement("flow_stress_sources", threat.title, LEAST_SOURCES, ceramic.sources, "not known")
    if scenario.interlayers:
        yield Requirement("interlayers", threat.title, 0.0, scenario.interlayers, "not known")
    if bound is None:
        return
    interval = None
    if sampled is not None:
        verdict = verdict_of_samples(sampled, bound)
        interval = (min(1.0 - sampled.high, greatest), min(1.0 - sampled.low, greatest))
    elif probability is not None:
        verdict = "passes" if probability >= 1.0 - bound else "fails"
    else:
        verdict = "not known" if reaches else short
    if probability is not None:
        probability = min(probability, greatest)
        verdict = "not known" if verdict == "passes" and 1.0 - bound > greatest else verdict
    yield Requirement("probability_of_stopping", threat.title, 1.0 - bound, probability, verdict, interval)


def of_armour(section: DesignSection, amounts: Mapping[str, float | None]) -> Iterator[Requirement]:
    """Yield what is required of an armour whatever the threat: the limits of the section ``design``.

    `amounts` has the areal density, kg/m², thickness, mm, and cost per m² of the armour by key; None if not known.
    """
    for key, words in OBJECTIVES.items():
        most, found = getattr(section, words.bound), amounts[key]
        if most is not None:
            verdict: Verdict = "not known"
            if found is not None:
                verdict = "passes" if found <= most * (1.0 + SLACK_ROUNDING) else "fails"
            yield Requirement(key, "", most, found, verdict)
