"""Compare the model with simpler formulas for a scenario's armour."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

from armour.analysis.ballistic_limit import LimitResult, ballistic_limit, residual_velocity_curve
from armour.analysis.impact import ImpactResult
from armour.analysis.results import OnProgress, TableResult, ignore_progress
from armour.core.replaced import is_unchanged
from armour.errors import NoAnswerError, Note, refuse
from armour.scenario.checked import checked
from armour.scenario.inputs import ROLES
from armour.scenario.scenario import ANY_VELOCITY, Scenario
from armour.validation import formulas
from armour.validation.rivals import Error, areal_densities, measured_limits
from armour.validation.suite import Case, Suite, load_suite
from armour.validation.tested import MeasuredArmour, nearest_measured
from armour.validation.validate import paper_suite, validate

# Table of the paper's suite to which the areal density rule is fitted.
COMPARED_TESTS = "table 3, Wilkins' measurements"


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


@dataclass(frozen=True, repr=False)
class Comparison(TableResult):
    """Ballistic limit and residual velocities by the model and by simpler formulas.

    Attributes
    ----------
    areal_density_kg_m2, whole_areal_density_kg_m2 : float
        Areal density of the armour without and with a back plate that exists already, kg/m².
    limit : LimitResult
        Ballistic limit by the model.
    florence : tuple of FlorenceResult
        One per body with a known mass and diameter; empty if the metal lacks values that the formula needs.
    fits : tuple of ResidualVelocityFit
        Fits of Lambert and Jonas and of Recht and Ipson to the model's residual velocities.
    fitted_m_s : tuple of float
        Lowest and highest impact velocity of the fits, m/s.
    curve : tuple of ImpactResult
        Impacts by the model around and above the limit.
    tests : str
        Tests to which the areal density rule is fitted: number, round, materials and areal densities.
    rules : tuple of RuleResult
        The rule with p = 1 and with p fitted; empty if the tests used another round or other materials.
    errors : tuple of Error
        Errors of every method on these tests, with the attributes that `SuiteResult` lists; empty without rules.  The
        model has the values of the library.
    florence_missing : tuple of str
        Keys of the library that Florence's limit needs and the metal of the back plate lacks.
    measured : tuple of MeasuredArmour
        Tested armours whose ballistic limits are nearest to the one by the model: one with a ceramic, and one bare
        plate of each metal.  Only tests with a core like that of the scenario count.
    """

    areal_density_kg_m2: float
    limit: LimitResult
    florence: tuple[formulas.FlorenceResult, ...]
    fits: tuple[formulas.ResidualVelocityFit, ...]
    fitted_m_s: tuple[float, float]
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
            "fits": [asdict(fit) for fit in self.fits],
            "fitted_m_s": self.fitted_m_s,
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
    NoAnswerError
        If the range contains no velocities above the limit.
    """
    missing = formulas.missing_for_florence(scenario)
    refuse(missing if not scenario.armour.ceramic_thickness_mm > 0.0 else ())
    limit = ballistic_limit(scenario, on_progress=on_progress)
    limit_m_s, highest = limit.ballistic_limit_m_s, scenario.ballistic_limit.velocity_max_m_s
    if highest <= limit_m_s * (1.0 + 1e-9):
        raise NoAnswerError(
            f"no fit: the range of velocities ends at the ballistic limit, {highest:g} m/s; "
            "raise ballistic_limit.velocity_max_m_s"
        )
    curve = residual_velocity_curve(scenario, limit, on_progress)
    above = [impact for impact in curve if impact.impact_velocity_m_s > limit_m_s]
    velocities = [impact.impact_velocity_m_s for impact in above]
    residuals = [impact.residual_velocity_m_s for impact in above]
    rules, bodies = areal_density_rules(scenario, limit_m_s), [] if missing else formulas.bodies_of(scenario)
    return Comparison(
        areal_density_kg_m2=scenario.areal_density_kg_m2(),
        measured=nearest_measured(scenario, limit_m_s),
        whole_areal_density_kg_m2=scenario.areal_density_kg_m2(whole=True),
        limit=limit,
        florence=tuple(formulas.florence_result(scenario, body, on_progress) for body in bodies),
        fits=(
            formulas.fit_lambert_jonas(velocities, residuals, limit_m_s),
            formulas.fit_recht_ipson(velocities, residuals, limit_m_s),
        ),
        fitted_m_s=(velocities[0], velocities[-1]),
        curve=curve,
        tests=_tests_in_words(_tests().cases),
        rules=rules,
        errors=_errors() if rules and is_unchanged() else (),
        florence_missing=tuple(problem.key for problem in missing),
    ).of(scenario.subject(ANY_VELOCITY), scenario=scenario)


@cache
def _tests() -> Suite:
    """Return the part of the paper's suite with the measured limits to which the areal density rule is fitted."""
    return load_suite(paper_suite()).only(COMPARED_TESTS)


@cache
def _errors() -> tuple[Error, ...]:
    """Return the errors of every method on these tests."""
    return validate(_tests()).errors


def _tests_in_words(cases: Sequence[Case]) -> str:
    """Return number, round, materials and range of areal densities of tests, as text."""
    projectile, ceramic, backing = (cases[0].scenario.name_of(role) for role in ROLES)
    densities = areal_densities(cases)
    span = f"{densities.min():.1f} to {densities.max():.1f} kg/m²"
    return f"{len(cases)} tests of {projectile} on {ceramic} and {backing}, {span} ({COMPARED_TESTS})"


def areal_density_rules(scenario: Scenario, limit_m_s: float) -> tuple[RuleResult, ...]:
    """Return the results of the rule ``k (areal density)^p`` for an armour, with p = 1 and with p fitted.

    `limit_m_s` is the armour's limit by the model.  The result is empty if the tests to which the rule is fitted are of
    another round or of other materials.
    """
    cases, rules = _tests().cases, []
    if any(scenario.entry_of(role) != cases[0].scenario.entry_of(role) for role in ROLES):
        return ()
    for p in (1.0, None):
        rule = formulas.fit_areal_density_rule(areal_densities(cases), measured_limits(cases), p)
        areal_density = (limit_m_s / rule.k) ** (1.0 / rule.p) * scenario.cosine()
        rules.append(
            RuleResult(rule.k, rule.p, p is None, rule.limit(formulas.along_fire_kg_m2(scenario)), areal_density)
        )
    return tuple(rules)
