"""Predict whether a ceramic/metal light armour stops a projectile, and design the lightest that does.

>>> from armour import load_scenario, simulate
>>> simulate(load_scenario("scenarios/wilkins.toml")).outcome
'perforated'
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from armour.calibration import CalibrationResult, calibrate, read_tests
    from armour.catalogue import StudyResult, study
    from armour.comparison import Comparison, compare
    from armour.elasticities import SensitivityResult, sensitivity
    from armour.errors import ArmourError, InputError, NoAnswerError, NoDesignError, NoLimitError, Problem
    from armour.firing import FiringResult, Shots, read_shots, v50
    from armour.library import Library, LibraryEntry, Value, read_library, shipped_library
    from armour.limit import Crossing, LimitResult, ballistic_limit
    from armour.optimisation import BestDesign, OptimumResult, optimise
    from armour.propagation import UncertaintyResult, uncertainty
    from armour.requirement import Design
    from armour.scenario import Scenario, load_scenario, parse_scenario, save_scenario
    from armour.simulation import History, ImpactResult, StageRecord, simulate
    from armour.suite import Case, Suite, load_suite
    from armour.validation import Check, SuiteResult, paper_suite, validate

__version__ = "0.1.0"
# Of the equations and their readings (first number), and of the numbers that they give to all their digits (second).
MODEL_VERSION = "1.1"

# Where the public names are; each is imported when it is first asked for, so that a command starts with what it needs.
_HOMES = {
    "ArmourError": "errors",
    "BestDesign": "optimisation",
    "CalibrationResult": "calibration",
    "Case": "suite",
    "Check": "validation",
    "Comparison": "comparison",
    "Crossing": "limit",
    "Design": "requirement",
    "FiringResult": "firing",
    "History": "simulation",
    "ImpactResult": "simulation",
    "InputError": "errors",
    "Library": "library",
    "LibraryEntry": "library",
    "LimitResult": "limit",
    "NoAnswerError": "errors",
    "NoDesignError": "errors",
    "NoLimitError": "errors",
    "OptimumResult": "optimisation",
    "Problem": "errors",
    "Scenario": "scenario",
    "SensitivityResult": "elasticities",
    "Shots": "firing",
    "StageRecord": "simulation",
    "StudyResult": "catalogue",
    "Suite": "suite",
    "SuiteResult": "validation",
    "UncertaintyResult": "propagation",
    "Value": "library",
    "ballistic_limit": "limit",
    "calibrate": "calibration",
    "compare": "comparison",
    "load_scenario": "scenario",
    "load_suite": "suite",
    "optimise": "optimisation",
    "paper_suite": "validation",
    "parse_scenario": "scenario",
    "read_library": "library",
    "read_shots": "firing",
    "read_tests": "calibration",
    "save_scenario": "scenario",
    "sensitivity": "elasticities",
    "shipped_library": "library",
    "simulate": "simulation",
    "study": "catalogue",
    "uncertainty": "propagation",
    "v50": "firing",
    "validate": "validation",
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
