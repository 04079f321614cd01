"""Where own tests put the ballistic limits of other armours: the model error for a calibrated entry.

The logarithm of a measured limit is that of the model, for a law of the ceramic's flow stress, plus a normal error.
The flow stress, the exponent of the law and the standard deviation of the error have prior distributions and are
integrated over a grid; the weight of a law is its evidence, from equal weights.  The tests are one series with one flow
stress: the result is for armour of the same lots.  One test is enough.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import log
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import log_ndtr

from armour.analysis.estimates import TAIL
from armour.analysis.variants import Floats, variants_of
from armour.core.equations import THINNEST_CERAMIC
from armour.engine import batch
from armour.scenario.evidence import MEASURES, is_outside, tested_ceramics
from armour.scenario.library import FLOW_STRESS_LAW, LawEvidence, OwnEvidence, TestedRanges
from armour.scenario.mixture import Mixture
from armour.scenario.own_evidence import PRODUCT
from armour.scenario.scenario import NORMAL
from armour.statistics.likelihood import MODELS
from armour.statistics.measured import LIMIT, Tests
from armour.statistics.posterior import narrowed

# Priors: of AD85, of which there are tests, the flow stress and the standard deviation of its logarithm between series;
# of any other value its standard deviation about its own; of the exponents; and of the error, which is log-normal, the
# median, the factor and nodes.
TESTED_GPA, TESTED, UNTESTED = 5.2, 0.10, 0.40
EXPONENT = (0.33, 0.15)  # with its standard deviation
MEDIAN, FACTOR, DEVIATIONS = 0.04, 2.0, np.linspace(-2.1, 2.1, 8)
SCALES = MEDIAN * FACTOR**DEVIATIONS
# Nodes of flow stress and exponent, how far they reach in standard deviations of the prior, and how often they are
# narrowed to where the logarithm of the posterior is within a depth of its maximum.
NODES, REACH, NARROWINGS, DEPTH = (61, 41), 4.5, 3, 16.0


class Measured(NamedTuple):
    """Ballistic limits of n tests and the curves of the model's, over the logarithm of a flow stress."""

    values: Floats  # logarithms of the limits, or of velocities of shots, m/s, (n,)
    sides: Floats  # 0, or the side of the velocity on which the limit lies, (n,)
    uncertainties: Floats  # relative standard deviations of the measurements, 0 if not given, (n,)
    curves: Sequence[Callable[[Floats], Floats]]  # logarithm of the limit, n times


@dataclass(frozen=True)
class LawPosterior:
    """What tests tell of a law: a mixture of normal distributions of flow stress and exponent, one for each error.

    Attributes
    ----------
    weights : array, (k,)
        Probabilities of the law with each standard deviation of the error; those of all laws add up to 1.
    scales : array, (k,)
        Standard deviations of the error.
    means : array, (k, p)
        Of the logarithm of the flow stress and, if the law has one, of the exponent.
    covariances : array, (k, p, p)
    slope : float
        Relative change of the limit over that of the flow stress, at the tests.
    """

    weights: Floats
    scales: Floats
    means: Floats
    covariances: Floats
    slope: float

    @property
    def mean(self) -> Floats:
        """Mean of flow stress and exponent, (p,)."""
        found: Floats = self.weights @ self.means / self.weights.sum()
        return found

    def predicted(self, terms: Floats, curve: Callable[[Floats], Floats]) -> Floats:
        """Return weights, locations, scales and degrees of freedom of the mixture of an armour's limit, (4, k).

        The terms are 1 and, if the law has an exponent, what it multiplies, (p,).
        """
        locations = curve(np.array([self.mean @ terms])) + self.slope * ((self.means - self.mean) @ terms)
        variances = self.scales**2 + self.slope**2 * np.einsum("i,kij,j->k", terms, self.covariances, terms)
        return np.array([self.weights, locations, np.sqrt(variances), np.full(len(variances), NORMAL)])


def evidence_of(
    measured: Measured,
    covariates: Iterable[Floats | None],
    centre: float,
    deviation: float,
    exponent: tuple[float, float] = EXPONENT,
) -> list[LawPosterior]:
    """Return what tests tell of laws, which have equal weights without them.

    Parameters
    ----------
    measured : Measured
    covariates : iterable of array or None
        Of each law, what its exponent multiplies in the logarithm of the flow stress, (n,); None for no exponent.
    centre, deviation : float
        Mean and standard deviation of the prior of the logarithm of the flow stress.
    exponent : tuple of float
        The same of an exponent.
    """
    found = [_of_law(measured, each, centre, deviation, exponent) for each in covariates]
    greatest = max(log_weights.max() for log_weights, *_ in found)
    total = sum(np.exp(log_weights - greatest).sum() for log_weights, *_ in found)
    return [
        LawPosterior(np.exp(log_weights - greatest) / total, SCALES, means, covariances, slope)
        for log_weights, means, covariances, slope in found
    ]


def _of_law(
    measured: Measured,
    covariate: Floats | None,
    centre: float,
    deviation: float,
    prior: tuple[float, float],
) -> tuple[Floats, Floats, Floats, float]:
    """Return logarithms of the weights, (k,), means and covariances of a law by the error, and the slope."""
    ends = np.array([[centre], [prior[0]]]) + REACH * np.outer([deviation, prior[1]], [-1.0, 1.0])
    for _ in range(NARROWINGS):
        stress, exponent = (np.linspace(low, high, count) for (low, high), count in zip(ends, NODES, strict=True))
        if covariate is None:
            exponent = np.array([prior[0]])
        score = ((stress[:, None] - centre) / deviation) ** 2 + ((exponent - prior[0]) / prior[1]) ** 2
        # By the error, the flow stress and the exponent.
        logarithm = -0.5 * score - 0.5 * (DEVIATIONS**2)[:, None, None]
        for i, curve in enumerate(measured.curves):
            shift = 0.0 if covariate is None else exponent * covariate[i]
            away = curve((stress[:, None] + shift).ravel()).reshape(len(stress), -1) - measured.values[i]
            spread = np.hypot(SCALES, measured.uncertainties[i])[:, None, None]
            side = measured.sides[i]
            logarithm += log_ndtr(side * away / spread) if side else -0.5 * (away / spread) ** 2 - np.log(spread)
        kept = logarithm > logarithm.max() - DEPTH
        steps = [(axis[1] - axis[0]) if len(axis) > 1 else 1.0 for axis in (stress, exponent)]
        ends[0] = narrowed(stress, kept.any(axis=(0, 2)))
        if covariate is not None:
            ends[1] = narrowed(exponent, kept.any(axis=(0, 1)))
    greatest = logarithm.max(axis=(1, 2))
    weights = np.exp(logarithm - greatest[:, None, None])
    totals = weights.sum(axis=(1, 2))
    points = np.stack(np.meshgrid(stress, exponent, indexing="ij"), axis=-1).reshape(-1, 2)
    points = points[:, : 1 if covariate is None else 2]
    parts = (weights / totals[:, None, None]).reshape(len(SCALES), -1)
    means = parts @ points
    away = points - means[:, None]
    covariances = np.einsum("kn,kni,knj->kij", parts, away, away)
    of_error = np.exp(greatest - greatest.max()) * totals
    middle = float(of_error @ means[:, 0] / of_error.sum())
    shifts = np.zeros(len(measured.values)) if covariate is None else covariate * prior[0]
    places = [np.array([middle - 0.05, middle + 0.05]) + shift for shift in shifts]
    slope = np.mean([np.diff(curve(at))[0] / 0.1 for curve, at in zip(measured.curves, places, strict=True)])
    # The prior of the exponent has a density over its nodes, which a law without one has not.
    volume = steps[0] / deviation * (1.0 if covariate is None else steps[1] / prior[1] / (2.0 * np.pi) ** 0.5)
    return greatest + np.log(totals) + log(volume), means, covariances, float(slope)


# Values of the fitted input over its own one, for the curves.
RATIOS = np.geomspace(0.12, 8.0, 60)
# Keys of the exponents of the laws of the flow stress; of a constant one, "".
EXPONENTS = ("", "flow_stress_backing_exponent", PRODUCT)
# Digits of what is written, and the least probability of a component.
DIGITS, LEAST = 6, 1e-6


def covariate(exponent: str, ceramic: Floats, backing: Floats) -> Floats | None:
    """Return what the exponent of a law multiplies, given thicknesses over the diameter; None for no exponent."""
    if not exponent:
        return None
    return np.log(ceramic * backing if exponent == PRODUCT else backing)


def own_evidence(tests: Tests, fitted: Mapping[str, float]) -> tuple[OwnEvidence, tuple[float, float]] | None:
    """Return what tests tell of an entry, and the error of its limits at them, given fitted values by name of input.

    The error is the 95 % interval of the limit of an armour over that of the fitted model, less 1, %, in the mean of
    the tests.  None if the fitted inputs are several, other than those of a law, or no ballistic limit was measured.
    """
    names = [name for name in fitted if name.partition(".")[2] not in FLOW_STRESS_LAW]
    shots = [m for m in tests.measurements if m.quantity == LIMIT]
    if len(names) != 1 or not shots:
        return None
    [name] = names
    role, _, key = name.partition(".")
    of_law = name == "ceramic.flow_stress_GPa"
    entry = tests.groups[0].scenario.entry_of(role)
    assert entry is not None
    rows = {test: (group, place) for group in tests.groups for place, test in enumerate(group.where.tolist())}
    parameters, cosines, curves = [], [], []
    for shot in shots:
        group, place = rows[shot.test]
        columns = {of: np.full(len(RATIOS), values[place]) for of, values in group.columns.items()}
        columns |= {f"ceramic.{coefficient}": np.zeros(len(RATIOS)) for coefficient in FLOW_STRESS_LAW if of_law}
        variants = variants_of(group.scenario, columns | {name: entry[key] * RATIOS}, len(RATIOS))
        parameters.append(variants.parameters[0])
        cosines.append(variants.cosines[0])
        curves.append(CubicSpline(np.log(entry[key] * RATIOS), np.log(MODELS[LIMIT](variants))))
    armours = batch.fields(np.array(parameters))
    exponents = EXPONENTS if of_law else ("",)
    thicknesses = np.maximum(armours.Hc0 / armours.D0, THINNEST_CERAMIC), armours.Hb / armours.D0
    covariates = [covariate(exponent, *thicknesses) for exponent in exponents]
    measured = Measured(
        np.log([shot.value for shot in shots]),
        np.array([float(shot.side) for shot in shots]),
        np.array([(shot.uncertainty or 0.0) / shot.value for shot in shots]),
        curves,
    )
    armour = tests.groups[0].scenario.core_armour()
    tested = of_law and any(one.measured and not is_outside(one.kind, armour) for one in tested_ceramics().values())
    centre, deviation = (log(TESTED_GPA), TESTED) if tested else (log(entry[key]), UNTESTED)
    posteriors = evidence_of(measured, covariates, centre, deviation)
    ranges = {of: np.asarray(MEASURES[of].of(armours)) for of in TestedRanges.model_fields}
    number = len({shot.test for shot in shots})
    evidence = OwnEvidence(
        source=f"{number} own test{'s' if number > 1 else ''} in {Path(tests.file).name}",
        key=key,
        measured=TestedRanges(**{of: (float(f"{v.min():.4g}"), float(f"{v.max():.4g}")) for of, v in ranges.items()}),
        steepest_deg=rounded(float(np.degrees(np.arccos(min(cosines))))),
        law=tuple(_section(exponent, posterior) for exponent, posterior in zip(exponents, posteriors, strict=True)),
    )
    return evidence, _error_at(measured, covariates, posteriors, exponents, fitted, name)


def rounded(value: float) -> float:
    """Return a number with the digits of what is written."""
    return float(f"{value:.{DIGITS}g}")


def _section(exponent: str, posterior: LawPosterior) -> LawEvidence:
    """Return what tests tell of a law as a section of a library file."""
    rows = []
    for weight, scale, mean, covariance in zip(
        posterior.weights, posterior.scales, posterior.means, posterior.covariances, strict=True
    ):
        if weight < LEAST:
            continue
        errors = np.sqrt(np.diag(covariance))
        row = [weight, scale, np.exp(mean[0]), errors[0]]
        if exponent:
            row += [mean[1], errors[1], covariance[0, 1] / (errors[0] * errors[1])]
        rows.append(tuple(rounded(value) for value in row))
    return LawEvidence(exponent=exponent, slope=rounded(posterior.slope), components=tuple(rows))


def _error_at(
    measured: Measured,
    covariates: Sequence[Floats | None],
    posteriors: Sequence[LawPosterior],
    exponents: Sequence[str],
    fitted: Mapping[str, float],
    name: str,
) -> tuple[float, float]:
    """Return the 95 % interval of limits like those of the tests over those of the fitted model, less 1, %."""
    ends = []
    for i, curve in enumerate(measured.curves):
        own = log(fitted[name]) + sum(
            fitted.get(f"ceramic.{exponent}", 0.0) * values[i]
            for exponent, values in zip(exponents, covariates, strict=True)
            if values is not None
        )
        parts = []
        for values, posterior in zip(covariates, posteriors, strict=True):
            terms = np.array([1.0] if values is None else [1.0, values[i]])
            parts.append(posterior.predicted(terms, curve))
        limits = Mixture(*np.concatenate(parts, axis=1)).quantile(np.array([TAIL, 1.0 - TAIL]))
        ends.append(limits / np.exp(curve(np.array([own])))[0] - 1.0)
    low, high = (100.0 * np.mean(ends, axis=0)).tolist()
    return low, high
