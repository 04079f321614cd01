"""Compare the model with simpler formulas for a scenario's armour, and with tests."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from armour.analysis.ballistic_limit import LimitResult, ballistic_limit, residual_velocity_curve
from armour.analysis.evaluate import evaluate
from armour.analysis.impact import ImpactResult
from armour.analysis.results import OnProgress, TableResult, ignore_progress
from armour.analysis.variants import Floats
from armour.errors import Note, refuse
from armour.scenario.checked import checked
from armour.scenario.inputs import ROLES
from armour.scenario.scenario import ANY_VELOCITY, Scenario
from armour.statistics.measured import LIMIT
from armour.validation import formulas
from armour.validation.formulas import FlorenceResult
from armour.validation.tested import COMPARED_TESTS, MeasuredArmour, nearest_measured, wilkins_tests


@dataclass(frozen=True)
class RuleResult:
    """Ballistic limit of an armour by the rule ``k (areal density)^p``, m/s, fitted to tests of the same materials.

    Attributes
    ----------
    k : float
        Factor, m/s, for areal densities in kg/m².
    p : float
        Exponent.
    p_fitted : bool
        Whether the exponent is fitted; otherwise it is 1.
    ballistic_limit_m_s : float
        Ballistic limit of the armour, m/s.
    areal_density_kg_m2 : float
        Areal density at which the rule gives the ballistic limit by the model, kg/m².
    """

    k: float
    p: float
    p_fitted: bool
    ballistic_limit_m_s: float
    areal_density_kg_m2: float = 0.0


@dataclass(frozen=True)
class Error:
    """Mean and largest magnitude of the relative errors of a method, ``predictor``, on the ``count`` tests of a table.

    ``fitted`` describes the fit of the method and its tests, if there was one.  If it was fitted to the table itself,
    ``left_out_percent`` is the mean error when the fit that predicts a test leaves this test out.
    """

    table: str
    predictor: str
    count: int
    mean_percent: float
    largest_percent: float
    left_out_percent: float | None = None
    fitted: str = ""

    @classmethod
    def of(
        cls, predictor: str, limits: Floats, predicted: Floats, left_out: Floats | None = None, fitted: str = ""
    ) -> "Error":
        """Return the error of predicted limits, m/s, (tests,), given the measured ones."""
        off = 100.0 * np.abs(predicted / limits - 1.0)
        out = None if left_out is None else float(100.0 * np.abs(left_out / limits - 1.0).mean())
        return cls(COMPARED_TESTS, predictor, len(off), float(off.mean()), float(off.max()), out, fitted)


@dataclass(frozen=True, repr=False)
class Comparison(TableResult):
    """Ballistic limit by the model and by simpler formulas, and residual velocities by the model.

    Attributes
    ----------
    areal_density_kg_m2, whole_areal_density_kg_m2 : float
        Areal density of the armour without and with a back plate that exists already, kg/m².
    limit : LimitResult
        Ballistic limit by the model.
    florence : tuple of FlorenceResult
        One per body with a known mass and diameter; empty if the metal lacks values that the formula needs.
    curve : tuple of ImpactResult
        Impacts by the model around and above the limit.
    tests : str
        Tests to which the areal density rule is fitted: number, round, materials and areal densities.
    rules : tuple of RuleResult
        The rule with p = 1 and with p fitted; empty if the tests used another round or other materials.
    errors : tuple of Error
        Errors on these tests of the model, which has the values of the library, of `florence` and of `rules`, in this
        order; empty without rules.  Each has the ``table``, the ``predictor`` and the ``count`` of tests;
        ``mean_percent`` and ``largest_percent``, the mean and the largest magnitude of the relative errors; ``fitted``,
        what was fitted, if anything; and ``left_out_percent``, the mean with each test left out of the fit that
        predicts it, None without a fit to these tests.
    florence_missing : tuple of str
        Keys of the library that Florence's limit needs and the metal of the back plate lacks.
    measured : tuple of MeasuredArmour
        Tested armours whose ballistic limits are nearest to the one by the model: one with a ceramic, and one bare
        plate of each metal.  Only tests with a core like that of the scenario count.
    """

    areal_density_kg_m2: float
    limit: LimitResult
    florence: tuple[FlorenceResult, ...]
    curve: tuple[ImpactResult, ...]
    tests: str
    rules: tuple[RuleResult, ...]
    errors: tuple[Error, ...]
    florence_missing: tuple[str, ...] = ()
    whole_areal_density_kg_m2: float = 0.0
    measured: tuple[MeasuredArmour, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return the comparison, without the curve, as plain data."""
        return {
            "areal_density_kg_m2": self.areal_density_kg_m2,
            "whole_areal_density_kg_m2": self.whole_areal_density_kg_m2,
            "ballistic_limit_m_s": self.limit.ballistic_limit_m_s,
            "florence": [asdict(result) for result in self.florence],
            "tests": self.tests,
            "areal_density_rules": [asdict(rule) for rule in self.rules],
            "measured": [asdict(armour) for armour in self.measured],
            "errors": [asdict(error) for error in self.errors],
            "florence_missing": self.florence_missing,
            "warnings": self.warnings,
        }

    @property
    def notes(self) -> tuple[Note, ...]:
        """Notes on the ballistic limit by the model."""
        return self.limit.notes

    def _columns(self) -> dict[str, Any]:
        names = "impact_velocity_m_s", "residual_velocity_m_s", "plug_velocity_m_s"
        return {name: [getattr(impact, name) for impact in self.curve] for name in names}


@checked
def compare(scenario: Scenario, *, on_progress: OnProgress = ignore_progress) -> Comparison:
    """Compare the model with simpler formulas for a scenario's armour.

    Parameters
    ----------
    scenario : Scenario
        Its impact velocity is not used.
    on_progress : callable, optional
        Called with the number of impacts computed since the last call, and None, as their total is not known.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        If the armour has no ceramic.
    NoLimitError
        If the scenario's range contains no ballistic limit.
    """
    missing = formulas.missing_for_florence(scenario)
    refuse(missing if not scenario.armour.ceramic_thickness_mm > 0.0 else ())
    limit = ballistic_limit(scenario, on_progress=on_progress)
    rules = areal_density_rules(scenario, limit.ballistic_limit_m_s)
    return Comparison(
        areal_density_kg_m2=scenario.areal_density_kg_m2(),
        whole_areal_density_kg_m2=scenario.areal_density_kg_m2(whole=True),
        limit=limit,
        florence=() if missing else formulas.florence_results(scenario),
        curve=residual_velocity_curve(scenario, limit, on_progress),
        tests=wilkins_tests().words(),
        rules=rules,
        errors=tuple(_errors()) if rules else (),
        florence_missing=tuple(problem.key for problem in missing),
        measured=nearest_measured(scenario, limit.ballistic_limit_m_s),
    ).of(scenario.subject(ANY_VELOCITY), scenario=scenario)


def areal_density_rules(scenario: Scenario, limit_m_s: float) -> tuple[RuleResult, ...]:
    """Return the results of the rule ``k (areal density)^p`` for an armour, with p = 1 and with p fitted.

    `limit_m_s` is the armour's limit by the model.  The result is empty if the tests to which the rule is fitted are of
    another round or of other materials.
    """
    tests, rules = wilkins_tests(), []
    if any(scenario.entry_of(role) != tests.scenarios[0].entry_of(role) for role in ROLES):
        return ()
    for p in (1.0, None):
        rule = formulas.fit_areal_density_rule(tests.areal_densities, tests.limits, p)
        areal_density = (limit_m_s / rule.k) ** (1.0 / rule.p) * scenario.cosine()
        limit = rule.limit(formulas.along_fire_kg_m2(scenario))
        rules.append(RuleResult(rule.k, rule.p, p is None, limit, areal_density))
    return tuple(rules)


def _errors() -> Iterator[Error]:
    """Yield the errors on Wilkins' tests of the model, of Florence's formula and of the areal density rules."""
    scenarios, columns, densities, limits = wilkins_tests()
    name, fit = scenarios[0].armour.ceramic or "", formulas.fit_areal_density_rule
    fitted = f"flow stress of {name}: {scenarios[0].entry('ceramic', name).values['flow_stress_GPa'].source}"
    yield Error.of("this model", limits, evaluate(scenarios[0], columns, [LIMIT])[LIMIT], fitted=fitted)
    for results in zip(*map(formulas.florence_results, scenarios), strict=True):
        predicted = np.array([result.ballistic_limit_m_s for result in results])
        yield Error.of(formulas.florence_name(results[0]), limits, predicted)
    for p, name in ((1.0, "p = 1"), (None, "p fitted")):
        rule = fit(densities, limits, p)
        left_out = [
            fit(np.delete(densities, place), np.delete(limits, place), p).limit(density)
            for place, density in enumerate(densities)
        ]
        fitted = f"k = {rule.k:.2f}{'' if p else f' and p = {rule.p:.3f}'} to these tests"
        predicted = np.array([*map(rule.limit, densities)])
        yield Error.of(f"areal density rule, {name}", limits, predicted, np.array(left_out), fitted)
