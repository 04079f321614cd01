"""Predict whether a ceramic/metal light armour stops a projectile, and design the lightest that does.

>>> from armour import load_scenario, simulate
>>> simulate(load_scenario("scenarios/wilkins.toml")).outcome
'perforated'
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from armour.analysis.ballistic_limit import Crossing, LimitResult, ballistic_limit
    from armour.analysis.comparison import Comparison, compare
    from armour.analysis.impact import History, ImpactResult, StageRecord, simulate
    from armour.analysis.least_thickness import Design
    from armour.design.catalogue import StudyResult, study
    from armour.design.optimisation import BestDesign, OptimumResult, optimise
    from armour.errors import ArmourError, InputError, NoAnswerError, NoDesignError, NoLimitError, Problem
    from armour.scenario.library import Library, LibraryEntry, Value, read_library, shipped_library
    from armour.scenario.loading import Scenario, load_scenario, parse_scenario, save_scenario
    from armour.statistics.calibration import CalibrationResult, calibrate
    from armour.statistics.sensitivity import SensitivityResult, sensitivity
    from armour.statistics.test_data import read_tests
    from armour.statistics.uncertainty import UncertaintyResult, uncertainty
    from armour.statistics.v50 import FiringResult, Shots, read_shots, v50
    from armour.validation.suite import Case, Suite, load_suite
    from armour.validation.validate import Check, SuiteResult, paper_suite, validate

__version__ = "0.1.0"
# Of the equations and their readings (first number), and of the numbers that they give to all their digits (second).
MODEL_VERSION = "1.1"

# Where the public names are; each is imported when it is first asked for, so that a command starts with what it needs.
_HOMES = {
    "ArmourError": "errors",
    "BestDesign": "design.optimisation",
    "CalibrationResult": "statistics.calibration",
    "Case": "validation.suite",
    "Check": "validation.validate",
    "Comparison": "analysis.comparison",
    "Crossing": "analysis.ballistic_limit",
    "Design": "analysis.least_thickness",
    "FiringResult": "statistics.v50",
    "History": "analysis.impact",
    "ImpactResult": "analysis.impact",
    "InputError": "errors",
    "Library": "scenario.library",
    "LibraryEntry": "scenario.library",
    "LimitResult": "analysis.ballistic_limit",
    "NoAnswerError": "errors",
    "NoDesignError": "errors",
    "NoLimitError": "errors",
    "OptimumResult": "design.optimisation",
    "Problem": "errors",
    "Scenario": "scenario.loading",
    "SensitivityResult": "statistics.sensitivity",
    "Shots": "statistics.v50",
    "StageRecord": "analysis.impact",
    "StudyResult": "design.catalogue",
    "Suite": "validation.suite",
    "SuiteResult": "validation.validate",
    "UncertaintyResult": "statistics.uncertainty",
    "Value": "scenario.library",
    "ballistic_limit": "analysis.ballistic_limit",
    "calibrate": "statistics.calibration",
    "compare": "analysis.comparison",
    "load_scenario": "scenario.loading",
    "load_suite": "validation.suite",
    "optimise": "design.optimisation",
    "paper_suite": "validation.validate",
    "parse_scenario": "scenario.loading",
    "read_library": "scenario.library",
    "read_shots": "statistics.v50",
    "read_tests": "statistics.test_data",
    "save_scenario": "scenario.loading",
    "sensitivity": "statistics.sensitivity",
    "shipped_library": "scenario.library",
    "simulate": "analysis.impact",
    "study": "design.catalogue",
    "uncertainty": "statistics.uncertainty",
    "v50": "statistics.v50",
    "validate": "validation.validate",
}

__all__ = [
    "ArmourError",
    "BestDesign",
    "CalibrationResult",
    "Case",
    "Check",
    "Comparison",
    "Crossing",
    "Design",
    "FiringResult",
    "History",
    "ImpactResult",
    "InputError",
    "Library",
    "LibraryEntry",
    "LimitResult",
    "NoAnswerError",
    "NoDesignError",
    "NoLimitError",
    "OptimumResult",
    "Problem",
    "Scenario",
    "SensitivityResult",
    "Shots",
    "StageRecord",
    "StudyResult",
    "Suite",
    "SuiteResult",
    "UncertaintyResult",
    "Value",
    "ballistic_limit",
    "calibrate",
    "compare",
    "load_scenario",
    "load_suite",
    "optimise",
    "paper_suite",
    "parse_scenario",
    "read_library",
    "read_shots",
    "read_tests",
    "save_scenario",
    "sensitivity",
    "shipped_library",
    "simulate",
    "study",
    "uncertainty",
    "v50",
    "validate",
]


def __getattr__(name: str) -> Any:
    """Import a public name."""
    if name not in _HOMES:
        raise AttributeError(f"module 'armour' has no attribute {name!r}")
    thing = getattr(import_module(f"armour.{_HOMES[name]}"), name)
    globals()[name] = thing
    return thing


def __dir__() -> list[str]:
    """Names of the package, those not imported yet included."""
    return sorted({*globals(), *__all__})
