"""The views of results: a module for each class of result."""

from importlib import import_module
from typing import Any

# By the name of the class, so that no other class need be imported.  Each module has ``tables(result)``, and where a
# result is drawn or written ``chart(result)`` and ``csv(result)``.
VIEWS = {
    "CalibrationResult": "calibration",
    "Comparison": "comparison",
    "ConfidenceResult": "confidence",
    "DesignResult": "design",
    "FiringResult": "v50",
    "ImpactResult": "impact",
    "LimitResult": "ballistic_limit",
    "PlannedTests": "planned_tests",
    "SensitivityResult": "sensitivity",
    "ShotPlan": "planned_shots",
    "SuiteResult": "suite",
    "SweepResult": "sweep",
    "UncertaintyResult": "uncertainty",
}


def view_of(result: object) -> Any:
    """Return the module that shows a result; None for what is not shown by itself, such as a history."""
    name = VIEWS.get(type(result).__name__)
    return None if name is None else import_module(f"armour.reporting.views.{name}")
