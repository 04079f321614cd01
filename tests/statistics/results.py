"""Results of statistics."""

from armour.analysis.estimates import Estimate
from armour.evidence.model_error import ModelError
from armour.statistics.uncertainty import Influence, ProbabilityCurve, UncertaintyResult


def uncertainty_result(*, known: bool = True) -> UncertaintyResult:
    """A probability that rises from 640 to 810 m/s, from two inputs, or what these alone give where it is unknown."""
    velocities = (600.0, 640.0, 680.0, 720.0, 770.0, 810.0, 900.0)
    probabilities = (0.0, 0.0, 0.05, 0.5, 0.95, 1.0, 1.0)
    return UncertaintyResult(
        samples=1024,
        seed=1,
        confidence=0.95,
        probability_of_perforation=Estimate(0.21, 0.2, 0.22) if known else None,
        limit_quantiles_m_s={
            "0.05": Estimate(680.0, 678.0, 682.0),
            "0.5": Estimate(720.0, 719.0, 721.0),
            "0.95": Estimate(770.0, 768.0, 772.0),
        },
        mean_m_s=721.0,
        mean_interval_m_s=(720.8, 721.2),
        standard_deviation_m_s=27.0,
        deterministic_m_s=723.8,
        curve=ProbabilityCurve(
            velocities,
            probabilities if known else None,
            None if known else probabilities,
            tuple(max(p - 0.01, 0.0) for p in probabilities),
            tuple(min(p + 0.01, 1.0) for p in probabilities),
        ),
        inputs=(
            Influence("ceramic.flow_stress_GPa", (677.0, 769.0)),
            Influence("projectile.penetrator_mass_g", (729.0, 718.0)),
        ),
        notes=(),
        model_error=ModelError(2.0, 7.0, 12.0, "tests") if known else None,
        perforated_by_distributions=None if known else Estimate(0.21, 0.2, 0.22),
    )
