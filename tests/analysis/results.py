"""Results of analysis."""

from functools import cache

from armour.analysis.impact import ImpactResult, simulate
from tests.helpers.cases import scenario


@cache
def impact(velocity: float = 800.0) -> ImpactResult:
    """The impact of the Wilkins case, with its history."""
    return simulate(scenario(velocity=velocity), history=True)
