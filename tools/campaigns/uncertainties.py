"""How often the 95 % intervals of `armour uncertainty` contain the truth.

The truth is that of 2^18 samples, whose error is about a tenth of the intervals', with the model error integrated for
the probability.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from armour.analysis.estimates import Estimate
from armour.analysis.results import portions
from armour.analysis.samples import by_laws, columns_of, own_errors, own_values, points_of, sampled, section_of
from armour.analysis.variants import ballistic_limits
from armour.scenario.inputs import ERROR
from armour.scenario.scenario import Scenario, load_scenario
from armour.statistics.uncertainty import QUANTILES, SAMPLES_AT_A_TIME, sample_limits, uncertainty
from tools.campaigns.verdict import Share

SHIPPED = Path(__file__).resolve().parents[2] / "scenarios" / "uncertain.toml"
# Least share of the intervals of a method that must contain the truth, per cent.
LEAST = 93.0
REFERENCE = {"uncertainty.samples": 2**18, "uncertainty.seed": 1_000_000}
CORRELATED = {
    "uncertainty.armour.ceramic_thickness_mm": {"distribution": "uniform", "min": 5.75, "max": 6.95},
    "uncertainty.backing.dynamic_yield_strength_MPa": {"distribution": "normal", "standard_deviation_percent": 10.0},
    "uncertainty.correlation": [
        {"between": ["ceramic.flow_stress_GPa", "backing.dynamic_yield_strength_MPa"], "coefficient": 0.6},
        {"between": ["armour.ceramic_thickness_mm", "projectile.penetrator_mass_g"], "coefficient": -0.4},
    ],
}


def truths(scenario: Scenario) -> dict[str, float]:
    """Return the quantities of a scenario from many samples."""
    scenario = scenario.replaced(REFERENCE)
    section, own = section_of(scenario), own_values(scenario)
    points = points_of(section)
    stopping, limits = np.zeros((2, len(points)))
    errors = own_errors(scenario)
    for part in portions(len(points), SAMPLES_AT_A_TIME):
        columns, count = columns_of(section, own, points[part]), part.stop - part.start
        limits[part] = sample_limits(sampled(scenario, columns, count))
        del columns[ERROR]
        exact = sampled(scenario, columns, count).variants
        for law, [weight] in enumerate(errors.ratio.weights.tolist()):
            of_law = errors.of_shots.of_law(law).times(ballistic_limits(by_laws(exact, errors, np.full(count, law))))
            stopping[part] += weight * of_law.probability_above(exact.velocities)
    found = {"probability": float(1.0 - stopping.mean()), "mean": float(limits.mean())}
    return found | {str(chance): float(np.quantile(limits, chance)) for chance in QUANTILES}


def estimates(scenario: Scenario) -> Iterator[tuple[str, Estimate]]:
    """Yield the same quantities by `uncertainty`."""
    result = uncertainty(scenario)
    assert result.probability_of_perforation is not None
    yield "probability", result.probability_of_perforation
    yield "mean", Estimate(result.mean_m_s, *result.mean_interval_m_s)
    yield from result.limit_quantiles_m_s.items()


def shares(seeds: int, first: int) -> Iterator[Share]:
    """Yield the shares of runs whose interval contains the truth, by quantity, and those of all together."""
    shipped = load_scenario(SHIPPED)
    for name, scenario in (("independent", shipped), ("correlated", shipped.replaced(CORRELATED))):
        true = truths(scenario)
        counts = dict.fromkeys(true, 0)
        for seed in range(first, first + seeds):
            for key, estimate in estimates(scenario.replaced({"uncertainty.seed": seed})):
                counts[key] += estimate.low <= true[key] <= estimate.high
        case = f"{name} inputs"
        for key, count in counts.items():
            yield Share(case, f"{key}, {true[key]:.5f}", count, seeds)
        yield Share(case, "all", sum(counts.values()), seeds * len(counts), LEAST)
