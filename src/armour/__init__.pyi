"""The public names of armour, each stated here once; `armour/__init__.py` imports them on first use."""

from .analysis.ballistic_limit import Crossing as Crossing
from .analysis.ballistic_limit import LimitResult as LimitResult
from .analysis.ballistic_limit import ballistic_limit as ballistic_limit
from .analysis.confidence import ConfidenceResult as ConfidenceResult
from .analysis.confidence import confidence as confidence
from .analysis.history import History as History
from .analysis.impact import ImpactResult as ImpactResult
from .analysis.impact import StageRecord as StageRecord
from .analysis.impact import simulate as simulate
from .design.optimise import BestDesign as BestDesign
from .design.optimise import Design as Design
from .design.optimise import DesignResult as DesignResult
from .design.optimise import Pair as Pair
from .design.optimise import optimise as optimise
from .errors import ArmourError as ArmourError
from .errors import InputError as InputError
from .errors import NoAnswerError as NoAnswerError
from .errors import NoDesignError as NoDesignError
from .errors import NoLimitError as NoLimitError
from .errors import Problem as Problem
from .scenario.evidence import ModelError as ModelError
from .scenario.library import Library as Library
from .scenario.library import LibraryEntry as LibraryEntry
from .scenario.library import Value as Value
from .scenario.library import read_library as read_library
from .scenario.library import shipped_library as shipped_library
from .scenario.loading import Scenario as Scenario
from .scenario.loading import load_scenario as load_scenario
from .scenario.loading import parse_scenario as parse_scenario
from .scenario.loading import save_scenario as save_scenario
from .statistics.calibration import CalibrationResult as CalibrationResult
from .statistics.calibration import calibrate as calibrate
from .statistics.sensitivity import SensitivityResult as SensitivityResult
from .statistics.sensitivity import sensitivity as sensitivity
from .statistics.test_data import read_tests as read_tests
from .statistics.uncertainty import UncertaintyResult as UncertaintyResult
from .statistics.uncertainty import uncertainty as uncertainty
from .statistics.v50 import FiringResult as FiringResult
from .statistics.v50 import Shots as Shots
from .statistics.v50 import read_shots as read_shots
from .statistics.v50 import v50 as v50
from .validation.comparison import Comparison as Comparison
from .validation.comparison import compare as compare
from .validation.suite import Case as Case
from .validation.suite import Suite as Suite
from .validation.suite import load_suite as load_suite
from .validation.validate import Check as Check
from .validation.validate import SuiteResult as SuiteResult
from .validation.validate import paper_suite as paper_suite
from .validation.validate import validate as validate

__version__: str
MODEL_VERSION: str
