"""Fit the model error to the shipped tests, and write the fits and the digest of the core to configs/evidence.toml.

    python -m tools.evidence

Of bare plates, the logarithm of the measured over the computed limit has a linear mixed model in each group:
coefficients of properties of plate and round, and random effects of the alloy and of the round, by restricted maximum
likelihood with a half-Cauchy prior of the round's standard deviation, as there are few rounds.  Of AD85 on aluminium,
each law of the flow stress is fitted with an effect of the series of tests; its standard deviation and that of the rest
are integrated.  docs/howto/confidence.md says what is done with them.
"""

import csv
import json
from dataclasses import dataclass
from functools import cache
from math import log
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import Bounds, brentq, minimize, minimize_scalar
from scipy.special import ndtr
from scipy.stats import t

from armour.analysis.evaluate import evaluate
from armour.analysis.variants import Floats, Ints
from armour.evidence.core_digest import core_digest
from armour.evidence.fit import CONSTRAINT, RODS, Fit, Quantities, matrix_of
from armour.scenario.inputs import BACKING, OBLIQUITY
from armour.scenario.library import shipped_library
from armour.scenario.scenario import load_scenario
from armour.units import GPA, MPA

ROOT = Path(__file__).parents[1]
EVIDENCE = ROOT / "configs" / "evidence.toml"
MARK = "# What follows is written by python -m tools.evidence.\n"
# Keys of a ceramic that make a law of its flow stress.
FLOW_STRESS = ("flow_stress_GPa", "flow_stress_backing_exponent", "flow_stress_product_exponent")
# The one bullet's core of which two names are in the table.
SAME_ROUND = {".30 APM2 core": ".30 APM2"}
# The question about a test that is not used.
OUTLIER = "half the V50 of the plate of 11.9 mm"
# Most oblique tests, degrees, and densest rods, kg/m3, that are used.
MOST_OBLIQUE, DENSEST = 30.0, 15_000.0
# Scale of the half-Cauchy prior of the standard deviation between rounds.
ROUND_SCALE = 0.05
# Standard deviations between alloys, between rounds and of the rest at which a fit starts.
STARTS = (0.04, 0.03, 0.04)
# Ends of the logarithm of the standard deviation of a trend.
TRENDS = (log(1e-3), 0.0)
# Tolerances of the fit.
OPTIONS: Any = {"xatol": 1e-5, "fatol": 1e-9, "maxiter": 2000}


class Plates(NamedTuple):
    """n tests of bare plates; arrays, (n,)."""

    error: Floats  # logarithm of the measured over the computed limit
    quantities: Quantities
    alloy: Any  # names
    round: Any
    obliquity_deg: Floats
    measured: Floats  # m/s

    def at(self, where: Any) -> "Plates":
        """Return some of the tests."""
        some = {name: column[where] for name, column in self.quantities.items()}
        return Plates._make(some if column is self.quantities else column[where] for column in self)


@dataclass(frozen=True)
class Group:
    """Tests of a kind of round on a metal, and the terms of their model."""

    kind: str
    metal: str
    terms: tuple[str, ...]
    reference: tuple[float, float]  # thickness over the diameter, and strength, MPa
    prior: tuple[str, float, float] | None = None  # mean and standard deviation of the coefficient of a term


GROUPS = {
    "cores_aluminium": Group("armour-piercing", "aluminium", ("1", "x", "x2", "Y", "s"), (5.0, 300.0)),
    "cores_aluminium_tensile": Group("armour-piercing", "aluminium", ("1", "x", "x2", "Y", "u", "s"), (5.0, 300.0)),
    "cores_steel": Group("armour-piercing", "steel", ("1", "x", "Y", "o"), (1.5, 1300.0)),
    "fragments_aluminium": Group("fragment simulator", "aluminium", ("1", "h", "Y"), (1.2, 350.0)),
    "fragments_steel": Group("fragment simulator", "steel", ("1", "Y"), (1.0, 1200.0), ("Y", -0.35, 0.4)),
}


def matched_pairs() -> list[tuple[float, float]]:
    """Return angles of limits, degrees, and the limits over the greatest at normal incidence.

    Both are of a plate and round of one report, with thicknesses within 2 %.
    """
    with (ROOT / "scenarios" / "tests" / "plates.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    numbers = [[float(row[name]) for name in (BACKING, OBLIQUITY, "ballistic_limit_m_s")] for row in rows]
    found = []
    for row, (thickness, angle, limit) in zip(rows, numbers, strict=True):
        normal = [
            other_limit
            for other, (other_thickness, other_angle, other_limit) in zip(rows, numbers, strict=True)
            if other_angle == 0.0 and abs(other_thickness - thickness) < 0.02 * thickness
            if all(other[name] == row[name] for name in ("plate", "round", "report"))
        ]
        if angle and normal:
            found.append((angle, limit / max(normal)))
    return found


@cache
def plates_of(kind: str, metal: str) -> Plates:
    """Return the tests of a kind of round on a metal that the fits use; repeats are dropped."""
    with (ROOT / "scenarios" / "tests" / "plates.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if (row["kind"], row["metal"]) == (kind, metal)]
    for row in rows:
        row["round"] = SAME_ROUND.get(row["round"], row["round"])
    names = "round", "plate", BACKING, OBLIQUITY, "ballistic_limit_m_s"
    distinct = {tuple(row[name] for name in names): row for row in reversed(rows)}
    used = [
        row
        for row in reversed(distinct.values())
        if float(row[OBLIQUITY]) <= MOST_OBLIQUE and float(row["projectile.density_kg_m3"]) <= DENSEST
        if row["question"] != OUTLIER
    ]

    def column(name: str) -> Floats:
        return np.array([float(row[name] or "nan") for row in used])

    angles, strength = column(OBLIQUITY), column("backing.dynamic_yield_strength_MPa")
    path = 1.0 / np.cos(np.radians(angles))
    inputs = (
        "projectile.penetrator_diameter_mm",
        "projectile.penetrator_mass_g",
        "projectile.density_kg_m3",
        "backing.density_kg_m3",
        "backing.dynamic_yield_strength_MPa",
    )
    columns = {name: column(name) for name in inputs} | {BACKING: column(BACKING) * path}
    diameter, mass = columns[inputs[0]], columns[inputs[1]]
    computed = evaluate(load_scenario("bare_plate"), columns, ["ballistic_limit_m_s"])["ballistic_limit_m_s"]
    measured = column("ballistic_limit_m_s")
    alloy, rounds = (np.array([row[name] for row in used]) for name in ("plate", "round"))
    quantities = {
        **dict.fromkeys(("ceramic_thickness_ratio", *RODS), np.zeros(len(used))),
        "backing_density_kg_m3": columns["backing.density_kg_m3"],
        "backing_thickness_ratio": columns[BACKING] / diameter,
        "backing_strength_GPa": strength * CONSTRAINT * MPA / GPA,
        "tensile_MPa": column("ultimate_tensile_strength_MPa"),
        "rod_mass_ratio": mass / diameter**3,
        "path_ratio": path,
        "rod_diameter_mm": diameter,
    }
    return Plates(np.log(measured / computed), quantities, alloy, rounds, angles, measured)


def fitted(group: Group, plates: Plates) -> Fit:
    """Fit the model of a group to tests by restricted maximum likelihood.

    The standard deviation of the coefficient of the thickness between alloys is fitted given the others.
    """
    X, y = matrix_of(group.terms, group.reference, plates.quantities), plates.error
    terms, alloys = X.shape[1], np.unique(plates.alloy)
    effects = np.column_stack([numbers[:, None] == np.unique(numbers) for numbers in (plates.alloy, plates.round)])
    # Products of effects, terms and errors are all that the likelihood depends on.
    columns = np.column_stack([effects, X, y])
    products, random = columns.T @ columns, effects.shape[1]
    known = np.zeros((terms + 1, terms + 1))
    if group.prior:
        term, mean, deviation = group.prior
        place = [group.terms.index(term), terms]
        known[np.ix_(place, place)] = np.outer([1.0, mean], [1.0, mean]) / deviation**2

    def solved(logs: Floats) -> tuple[float, Floats, Floats]:
        """Return the loss, the coefficients and their covariance, given logarithms of the standard deviations."""
        alloy, between_rounds, rest = np.exp(2.0 * logs)
        variances = np.repeat([alloy, between_rounds], [len(alloys), random - len(alloys)])
        # The effects are eliminated from the normal equations, by which V itself need not be inverted.
        inner = products[:random, :random] / rest + np.diag(1.0 / variances)
        across = products[:random, random:] / rest
        reduced = products[random:, random:] / rest - across.T @ np.linalg.solve(inner, across) + known
        precision, right = reduced[:-1, :-1], reduced[:-1, -1]
        found = np.linalg.solve(precision, right)
        logarithm = len(y) * np.log(rest) + np.log(variances).sum() + np.linalg.slogdet(inner)[1]
        found_loss = 0.5 * (logarithm + np.linalg.slogdet(precision)[1] + reduced[-1, -1] - right @ found)
        # The mode is that of the logarithm of the standard deviation, which is never 0.
        found_loss += log(1.0 + between_rounds / ROUND_SCALE**2) - logs[1]
        return float(found_loss), found, np.linalg.inv(precision)

    def loss(logs: Floats, *_: Any) -> float:
        return solved(logs)[0]

    best = minimize(loss, np.log(STARTS), method="Nelder-Mead", bounds=Bounds(log(1e-4), 0.0), options=OPTIONS)
    _, coefficients, covariance = solved(best.x)
    deviations, freedom = np.exp(best.x), len(alloys) - terms
    variance = float((deviations**2).sum())
    trend = _trend(group, plates, deviations) if {"x", "h"} & {*group.terms} else 0.0
    given = *deviations.tolist(), trend
    return Fit("", group.terms, group.reference, coefficients, covariance, variance, freedom, given)


def _trend(group: Group, plates: Plates, deviations: Floats) -> float:
    """Return the standard deviation of the second coefficient between alloys, by restricted maximum likelihood."""
    X, y = matrix_of(group.terms, group.reference, plates.quantities), plates.error
    same_alloy, same_round = (numbers[:, None] == numbers for numbers in (plates.alloy, plates.round))
    alloy, between_rounds, rest = deviations**2
    known = alloy * same_alloy + between_rounds * same_round + rest * np.eye(len(y))

    def loss(logarithm: float) -> float:
        V = known + np.exp(2.0 * logarithm) * same_alloy * np.outer(X[:, 1], X[:, 1])
        inverse = np.linalg.inv(V)
        precision = X.T @ inverse @ X
        residual = y - X @ np.linalg.solve(precision, X.T @ inverse @ y)
        return float(np.linalg.slogdet(V)[1] + np.linalg.slogdet(precision)[1] + residual @ inverse @ residual)

    return float(np.exp(minimize_scalar(loss, bounds=TRENDS, method="bounded", options={"xatol": 1e-4}).x))


# Series of Wilkins' tests, by their order in the table.
SERIES = np.repeat([0, 1, 2], [4, 5, 4])
# Scale and degrees of freedom of the half-t prior of the standard deviation between series; nodes of it and of that of
# the rest, whose prior is log-uniform.
BETWEEN_SERIES, FREEDOM = 0.04, 3.0
BETWEEN, REST = np.geomspace(0.001, 0.25, 41), np.geomspace(0.008, 0.08, 31)
# Standard deviation of the exponent of a law between lots, times the change of the limit with the flow stress.
TREND = 0.62 * 0.10
# Standard deviation between rounds, as that of plates: all tests were fired with one round.
BETWEEN_ROUNDS = 0.04
# Probabilities at which Student's t distribution has the quantiles of what is integrated.
MATCHED = np.array([0.8, 0.975])


@dataclass(frozen=True)
class FlowStressLaw:
    """A law of the flow stress: the entry of the library, and the terms that its coefficients multiply."""

    ceramic: str
    terms: tuple[str, ...]


LAWS = {
    "constant": FlowStressLaw("AD85", ("1",)),
    "backing": FlowStressLaw("AD85 backing law", ("1", "x")),
    "product": FlowStressLaw("AD85 product law", ("1", "cb")),
}


class Tiles(NamedTuple):
    """n tests of AD85 on aluminium, by a law; arrays, (n,)."""

    error: Floats  # logarithm of the measured over the computed limit
    matrix: Floats  # terms of the law, (n, terms)
    series: Ints
    quantities: Quantities

    def at(self, where: Any) -> "Tiles":
        """Return some of the tests."""
        some = {name: column[where] for name, column in self.quantities.items()}
        return Tiles(self.error[where], self.matrix[where], self.series[where], some)


@cache
def tiles_of(law: FlowStressLaw) -> Tiles:
    """Return Wilkins' tests, with the limits by a law."""
    table = np.loadtxt(ROOT / "scenarios" / "tests" / "wilkins.csv", delimiter=",", skiprows=1)
    columns = {"armour.ceramic_thickness_mm": table[:, 0], "armour.backing_thickness_mm": table[:, 1]}
    scenario = load_scenario("wilkins", {"armour.ceramic": law.ceramic})
    computed = evaluate(scenario, columns, ["ballistic_limit_m_s"])["ballistic_limit_m_s"]
    ratios = (table[:, :2] / scenario.inputs()["projectile.penetrator_diameter_mm"]).T
    quantities = {
        **dict.fromkeys(RODS, np.zeros(len(table))),
        **dict.fromkeys(("backing_density_kg_m3", "backing_strength_GPa"), np.ones(len(table))),
        "ceramic_thickness_ratio": ratios[0],
        "backing_thickness_ratio": ratios[1],
        "path_ratio": np.ones(len(table)),
    }
    return Tiles(np.log(table[:, 2] / computed), matrix_of(law.terms, (1.0, 1.0), quantities), SERIES, quantities)


def fitted_law(law: FlowStressLaw, tiles: Tiles) -> tuple[Fit, float]:
    """Fit the correction of a law, with an effect of the series, to tests.

    With it is the logarithm of the probability density of the tests.
    """
    X, y = tiles.matrix, tiles.error
    same = tiles.series[:, None] == tiles.series
    variances = np.array([(between**2, rest**2) for between in BETWEEN for rest in REST])
    # The nodes are even in the logarithm.
    weights = t.logpdf(np.sqrt(variances[:, 0]) / BETWEEN_SERIES, FREEDOM) + 0.5 * np.log(variances[:, 0])
    V = variances[:, 0, None, None] * same + variances[:, 1, None, None] * np.eye(len(y))
    inverse = np.linalg.inv(V)
    precision, right = X.T @ inverse @ X, X.T @ inverse @ y
    covariances = np.linalg.inv(precision)
    found = np.einsum("nij,nj->ni", covariances, right)
    weights += 0.5 * np.linalg.slogdet(covariances)[1] - 0.5 * np.linalg.slogdet(V)[1]
    weights -= 0.5 * (y @ inverse @ y - np.einsum("ni,ni->n", right, found))
    evidence = float(np.logaddexp.reduce(weights))
    weights = np.exp(weights - evidence)
    coefficients = weights @ found
    spread = found - coefficients
    covariance = np.einsum("n,nij->ij", weights, covariances + spread[:, :, None] * spread[:, None, :])
    variance = float(weights @ variances.sum(axis=1))
    # Student's t has the quantiles of a new series of the tests' mean armour.
    z = X.mean(axis=0)
    deviations = np.sqrt(variances.sum(axis=1) + np.einsum("i,nij,j->n", z, covariances, z))
    scale = np.sqrt(variance + z @ covariance @ z)
    wanted = _quantiles(weights, spread @ z, deviations) / scale
    freedom = float(brentq(lambda df: np.divide(*t.ppf(MATCHED, df)) - np.divide(*wanted), 1.0, 100.0))
    factor = float(wanted[1] / t.ppf(MATCHED[1], freedom)) ** 2
    scaled = factor * covariance, factor * variance
    between, rest = np.sqrt(factor * (weights @ variances))
    deviations = float(between), BETWEEN_ROUNDS, float(rest), TREND * (len(law.terms) > 1)
    return Fit("", law.terms, (1.0, 1.0), coefficients, *scaled, freedom, deviations), evidence


def _quantiles(weights: Floats, means: Floats, deviations: Floats) -> Floats:
    """Return quantiles of a mixture of normal distributions at the probabilities that are matched."""
    values = np.linspace(-1.0, 1.0, 4001)
    below = weights @ ndtr((values - means[:, None]) / deviations[:, None])
    return np.interp(MATCHED, below, values)


def tables() -> dict[str, dict[str, object]]:
    """Return the fits as tables of configs/evidence.toml, by name."""
    found: dict[str, dict[str, object]] = {}
    for name, law in LAWS.items():
        entry = shipped_library().entries["ceramic"][law.ceramic]
        found[name] = _table(fitted_law(law, tiles_of(law))[0]) | {
            "flow_stress": {key: entry[key] if key in entry.values else 0.0 for key in FLOW_STRESS}
        }
    for name, group in GROUPS.items():
        plates = plates_of(group.kind, group.metal)
        found[name] = _table(fitted(group, plates))
    return found


def _table(fit: Fit) -> dict[str, object]:
    names = "coefficients", "covariance", "variance", "degrees_of_freedom", "standard_deviations"
    numbers = {name: _rounded(getattr(fit, name)) for name in names}
    return {"terms": list(fit.terms), "reference": list(fit.reference), **numbers}


def _rounded(values: ArrayLike) -> object:
    """Return numbers with six digits."""
    return np.vectorize(lambda value: float(f"{value:.6g}"))(values).tolist()


def main() -> None:
    """Write the fits to configs/evidence.toml, with the digest of the code that computed the limits."""
    head, mark, _ = EVIDENCE.read_text(encoding="utf-8").partition(MARK)
    lines = ["", "[core]", f'sha256 = "{core_digest()}"']
    for name, table in tables().items():
        # A table of TOML by JSON, a key a line, is shorter than by tomli_w, which breaks lists.
        stress = table.pop("flow_stress", None)
        lines += ["", f"[fit.{name}]", *(f"{key} = {json.dumps(value)}" for key, value in table.items())]
        if isinstance(stress, dict):
            lines.append(f"flow_stress = {{ {', '.join(f'{key} = {value}' for key, value in stress.items())} }}")
    EVIDENCE.write_text(head + mark + "\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
