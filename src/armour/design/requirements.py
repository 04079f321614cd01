"""Judge an armour: what is required of it, what it has, and the verdict, the same in all commands and pages."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

from armour.analysis.estimates import Estimate
from armour.core.state import Parameters
from armour.evidence.caveats import LEAST_METAL_KG_M3, is_limit_too_low, is_no_metal
from armour.evidence.tests import LEAST_SOURCES, lacks_sources
from armour.scenario.library import LibraryEntry
from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES, DesignSection, Threat

# From the worst to the best; an armour has the worst of the verdicts on it.  Only a required probability that is known
# to be reached passes.  The words of the model stand where no probability is required, and none is known.
Verdict = Literal["fails", "perforated by the model", "not known", "stopped by the model", "expected to stop", "passes"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
# Verdicts with which a command ends with the exit code 0.
GOOD = VERDICTS[VERDICTS.index("stopped by the model") :]
# Probability of stopping that an armour must have if none is required: its expected limit is then the velocity.
EVEN = 0.5
# Largest fraction of an areal density, a thickness or a cost that counts as a rounding error.
SLACK_ROUNDING = 1e-12


@dataclass(frozen=True)
class Requirement:
    """One quantity that is required of an armour, what the armour has of it, and the verdict.

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
    """Return the worst of some verdicts, such as those on an armour against each threat; "passes" if there are none."""
    return min(verdicts, key=VERDICTS.index, default="passes")


def verdict_of_samples(perforation: Estimate, bound: float) -> Verdict:
    """Return the verdict on a sampled probability of perforation, given the greatest one allowed, `bound`.

    It is "not known" if the 95 % interval of the estimate contains the bound.
    """
    return "passes" if perforation.high <= bound else "fails" if perforation.low > bound else "not known"


class Standing(NamedTuple):
    """What is known of an armour against a threat."""

    limit_m_s: float  # lowest ballistic limit by the model
    expected_m_s: float | None  # its expected limit; None if the model error is not known
    stops: bool  # whether the model stops the projectile at the velocity plus the margin
    probability: float | None  # of stopping a shot, without its upper bound; None if it is not known
    greatest_probability: float  # of stopping, that is stated; it falls with the distance from the tests
    sampled: Estimate | None  # probability of perforation, if uncertain inputs are sampled


def against_threat(
    scenario: Scenario, threat: Threat, armour: Parameters, ceramic: LibraryEntry | None, standing: Standing
) -> tuple[Verdict, tuple[Requirement, ...]]:
    """Return the verdict on an armour against a threat, and the requirements that decide it.

    Where the model does not hold, the verdict is "not known" whatever it computes: for a back plate that does not count
    as a metal, a layer between tile and back plate, or a ceramic whose flow stress lacks sources.  Otherwise a margin
    is required if the threat gives one, and a probability if the scenario or the threat gives one.  Without a required
    probability, a known one must be at least 0.5; if it is not known, the verdict is that of the model.

    Parameters
    ----------
    scenario : Scenario
        Gives the probability that is required against all threats, the tolerance of the ballistic limit, and the number
        of layers between tile and back plate, which no shipped test has.
    threat : Threat
    armour : Parameters
        Parameters of armour and projectile, SI units.  For some, the limit is known to be too low, see
        `evidence.caveats`; such a limit alone never fails.
    ceramic : LibraryEntry or None
        Entry of the ceramic; None for a bare plate.
    standing : Standing
        Limits and probabilities that were computed for the armour.
    """
    unsound = list[tuple[str, float, float]]()
    if is_no_metal(armour.rho_B):
        unsound.append(("backing_density_kg_m3", LEAST_METAL_KG_M3, armour.rho_B))
    if scenario.interlayers:
        unsound.append(("interlayers", 0.0, scenario.interlayers))
    if ceramic is not None and armour.Hc0 and lacks_sources(ceramic):
        unsound.append(("flow_stress_sources", LEAST_SOURCES, ceramic.sources))
    if unsound:
        rows = [Requirement(key, threat.title, least, found, "not known") for key, least, found in unsound]
        return "not known", tuple(rows)
    rows = []
    bound, expected_m_s = (scenario.design or DesignSection()).bound(threat), standing.expected_m_s
    margin_m_s = (standing.limit_m_s if expected_m_s is None else expected_m_s) - threat.velocity_m_s
    if expected_m_s is None and margin_m_s >= threat.margin_m_s and not standing.stops:
        margin_m_s -= scenario.ballistic_limit.tolerance_m_s
    reaches = margin_m_s >= threat.margin_m_s
    verdict_if_short: Verdict = "not known" if expected_m_s is None and is_limit_too_low(armour) else "fails"
    if threat.margin_m_s > 0.0:
        by_margin: Verdict = "passes" if reaches else verdict_if_short
        rows.append(Requirement("margin_m_s", threat.title, threat.margin_m_s, margin_m_s, by_margin))
    least, probability, interval = EVEN if bound is None else 1.0 - bound, standing.probability, None
    verdict: Verdict
    if probability is None:
        verdict = "not known" if reaches else verdict_if_short
    elif bound is not None and standing.sampled is not None:
        sampled = standing.sampled.at_least(1.0 - standing.greatest_probability)
        verdict, interval = verdict_of_samples(standing.sampled, bound), (1.0 - sampled.high, 1.0 - sampled.low)
    else:
        verdict = "passes" if probability >= least else "fails"
    if probability is not None:
        verdict = "not known" if verdict == "passes" and standing.greatest_probability < least else verdict
        probability = min(probability, standing.greatest_probability)
    if bound is not None:
        rows.append(Requirement("probability_of_stopping", threat.title, least, probability, verdict, interval))
    elif probability is not None:
        verdict = "expected to stop" if verdict == "passes" else verdict
    elif reaches:
        verdict = "stopped by the model"
    elif verdict_if_short == "fails":
        verdict = "perforated by the model"
    return verdict_of((verdict, *(row.verdict for row in rows))), tuple(rows)


def of_armour(section: DesignSection, amounts: Mapping[str, float | None]) -> Iterator[Requirement]:
    """Yield the requirements whatever the threat: greatest areal density, thickness and cost, of those that are given.

    `amounts` has the areal density, kg/m², thickness, mm, and cost per m² of the armour by key; None if not known.
    """
    for key, words in OBJECTIVES.items():
        most, found = getattr(section, words.bound), amounts[key]
        if most is not None:
            kept: Verdict = "passes" if (found or 0.0) <= most * (1.0 + SLACK_ROUNDING) else "fails"
            yield Requirement(key, "", most, found, "not known" if found is None else kept)
