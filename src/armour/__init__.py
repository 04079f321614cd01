"""Predict whether a ceramic/metal light armour stops a projectile, and design the lightest that does.

>>> from armour import load_scenario, simulate
>>> simulate(load_scenario("scenarios/wilkins.toml")).outcome
'perforated'
"""

from armour.errors import (
    ArmourError,
    InputError,
    NoAnswerError,
    NoDesignError,
    NoLimitError,
    Problem,
)
from armour.library import Library, LibraryEntry, Value, read_library, shipped_library
from armour.limit import Crossing, LimitResult, ballistic_limit
from armour.optimise import BestDesign, Design, OptimumResult, optimise
from armour.scenario import Scenario, load_scenario, parse_scenario, save_scenario
from armour.simulate import History, ImpactResult, StageRecord, simulate

__version__ = "0.1.0"

__all__ = [
    "ArmourError",
    "BestDesign",
    "Crossing",
    "Design",
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
    "StageRecord",
    "Value",
    "ballistic_limit",
    "load_scenario",
    "optimise",
    "parse_scenario",
    "read_library",
    "save_scenario",
    "shipped_library",
    "simulate",
]
