"""The flow stress with which a ceramic without tests stops a threat, and the ballistic limits over its sources."""

from dataclasses import dataclass

import numpy as np

from armour.analysis.variants import Floats, ballistic_limits, variants_of
from armour.evidence.fit import fits
from armour.evidence.mixture import Mixture
from armour.evidence.tests import is_untested
from armour.scenario.scenario import Scenario
from armour.scenario.schema import FASTEST_M_S, SLOWEST_M_S

FLOW_STRESS = "ceramic.flow_stress_GPa"
# Range of flow stresses that is searched, GPa; the number of values in a grid, and the number of grids, each finer than
# the one before, until two neighbours differ by less than 0.01 %.
RANGE_GPA, POINTS, GRIDS = (0.1, 100.0), 64, 3
# Probability that is used if the scenario requires none.
USUAL = 0.9


@dataclass(frozen=True)
class NeededFlowStress:
    """Flow stress with which a ceramic without tests stops a threat, and the ballistic limits over its sources.

    Attributes
    ----------
    ceramic : str
    needed_GPa : float or None
        Least flow stress from which on the ballistic limit by the model is at least the velocity required, GPa; None
        if 100 GPa is too little.
    probability : float
        Probability of stopping the threat that is required.
    needed_for_probability_GPa : float or None
        Least flow stress from which on the probability of stopping the threat is at least this, with the model error of
        AD85, of constant flow stress, GPa; None if 100 GPa is too little.
    sources_GPa : tuple of float
        Least and greatest flow stress that sources give, GPa, or one number, or none.
    limits_m_s : tuple of float
        Ballistic limits by the model with these, m/s.
    """

    ceramic: str
    needed_GPa: float | None
    probability: float
    needed_for_probability_GPa: float | None
    sources_GPa: tuple[float, ...]
    limits_m_s: tuple[float, ...]


def needed_flow_stress(
    scenario: Scenario, required_m_s: float, probability: float | None = None
) -> NeededFlowStress | None:
    """Return the flow stress that a ceramic without tests needs; None if the armour has no such ceramic.

    Parameters
    ----------
    scenario : Scenario
    required_m_s : float
        Least ballistic limit, m/s.
    probability : float, optional
        Required probability of stopping the projectile at the impact velocity; by default 0.9.
    """
    ceramic = scenario.entry_of("ceramic")
    if ceramic is None or not scenario.armour.ceramic_thickness_mm or not is_untested(ceramic):
        return None
    required, sources = probability or USUAL, ceramic.flow_stress_sources_GPa
    likely_m_s = scenario.impact.velocity_m_s / float(constant_law_error().quantile(1.0 - required))
    return NeededFlowStress(
        ceramic.name,
        _needed(scenario, required_m_s),
        required,
        _needed(scenario, max(required_m_s, likely_m_s)),
        sources,
        tuple(limits_over(scenario, np.array(sources)).tolist()),
    )


def constant_law_error() -> Mixture:
    """Return the ratio of measured to computed limits of AD85 with a constant flow stress, which has no trend."""
    fit = fits()["constant"]
    scale = np.sqrt(fit.variance + fit.covariance[:, 0])
    return Mixture(np.ones(1), fit.coefficients, scale, np.array([fit.degrees_of_freedom]))


def limits_over(scenario: Scenario, flow_stresses_GPa: Floats) -> Floats:
    """Return the ballistic limits with flow stresses of the ceramic, m/s, (n,), at least 20 and at most 10,000 m/s."""
    rows = variants_of(scenario, {FLOW_STRESS: flow_stresses_GPa}, len(flow_stresses_GPa))
    return ballistic_limits(rows, (SLOWEST_M_S, FASTEST_M_S)).clip(SLOWEST_M_S, FASTEST_M_S)


def _needed(scenario: Scenario, required_m_s: float) -> float | None:
    """Return the least flow stress from which on the ballistic limit is at least the one required, GPa."""
    low, high = RANGE_GPA
    for _ in range(GRIDS):
        grid = np.geomspace(low, high, POINTS)
        short = np.flatnonzero(limits_over(scenario, grid) < required_m_s)
        if not len(short):
            return low
        if short[-1] == POINTS - 1:
            return None
        low, high = grid[short[-1] : short[-1] + 2].tolist()
    return high
