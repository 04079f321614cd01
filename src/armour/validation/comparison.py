"""Compare the model with simpler formulas for a scenario's armour, and with tests."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Self

import numpy as np

from armour.analysis.ballistic_limit import LimitResult, ballistic_limit
from armour.analysis.evaluate import evaluate
from armour.analysis.results import OnProgress, TableResult, by_column, ignore_progress
from armour.analysis.variants import Floats
from armour.errors import Note, refuse
from armour.scenario.checked import checked
from armour.scenario.inputs import ROLES
from armour.scenario.scenario import ANY_VELOCITY, Scenario
from armour.statistics.measured import LIMIT
from armour.validation.formulas import along_fire_kg_m2, fitted_factor, florence_limits, missing_for_florence
from armour.validation.tested import MeasuredArmour, nearest_measured, wilkins_tests


@dataclass(frozen=True)
class Prediction:
    """A ballistic limit by one method, the model or a simpler formula, and the errors of this method on tests.

    Attributes
    ----------
    method : str
        Name of the method, such as "the model".
    ballistic_limit_m_s : float
        Ballistic limit of the armour, m/s.
    mean_percent, largest_percent : float or None
        Mean and largest magnitude of the relative errors on the tests, %; None if these are of another round or of
        other materials.
    left_out_percent : float or None
        Mean error when the fit that predicts a test leaves this test out, %; None for a method not fitted to the tests.
    fitted : str
        What was fitted, and to what; empty if nothing was.
    """

    method: str
    ballistic_limit_m_s: float
    mean_percent: float | None = None
    largest_percent: float | None = None
    left_out_percent: float | None = None
    fitted: str = ""

    def on_tests(self, measured: Floats, predicted: Floats, left_out: Floats | None = None) -> Self:
        """Return the prediction with the errors of its method on tests.

        The arrays, (tests,), are limits, m/s: measured, predicted, and predicted by a fit that leaves out the test.
        """
        errors = 100.0 * np.abs(predicted / measured - 1.0)
        out = None if left_out is None else float(100.0 * np.abs(left_out / measured - 1.0).mean())
        mean, largest = float(errors.mean()), float(errors.max())
        return replace(self, mean_percent=mean, largest_percent=largest, left_out_percent=out)


@dataclass(frozen=True, repr=False)
class Comparison(TableResult):
    """Ballistic limit of an armour by the model and by simpler formulas, and measured ones of armours like it.

    Attributes
    ----------
    limit : LimitResult
        Ballistic limit by the model.
    predictions : tuple of Prediction
        By the model; by the rule that the limit is in proportion to the areal density, if the tests to which it is
        fitted are of this round and these materials; and by Florence's formula for each body with a known mass and
        diameter, if the metal has the values that it needs.
    tests : str
        Tests of the errors: number, round, materials and areal densities.
    florence_missing : tuple of str
        Keys of the library that Florence's limit needs and the metal of the back plate lacks.
    measured : tuple of MeasuredArmour
        Tested armours whose ballistic limits are nearest to the one by the model: one with a ceramic, and one bare
        plate of each metal.  Only tests with a core like that of the scenario count.
    """

    limit: LimitResult
    predictions: tuple[Prediction, ...]
    tests: str
    florence_missing: tuple[str, ...] = ()
    measured: tuple[MeasuredArmour, ...] = ()

    @property
    def notes(self) -> tuple[Note, ...]:
        """Notes on the ballistic limit by the model."""
        return self.limit.notes

    def _columns(self) -> dict[str, Any]:
        return by_column(map(asdict, self.predictions))


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
    missing = missing_for_florence(scenario)
    refuse(missing if not scenario.armour.ceramic_thickness_mm > 0.0 else ())
    limit = ballistic_limit(scenario, on_progress=on_progress)
    florence = {} if missing else florence_limits(scenario)
    return Comparison(
        limit=limit,
        predictions=tuple(predictions_of(scenario, limit.ballistic_limit_m_s, florence)),
        tests=wilkins_tests().words(),
        florence_missing=tuple(problem.key for problem in missing),
        measured=nearest_measured(scenario, limit.ballistic_limit_m_s),
    ).of(scenario.subject(ANY_VELOCITY), scenario=scenario)


def predictions_of(scenario: Scenario, limit_m_s: float, florence: Mapping[str, float]) -> Iterator[Prediction]:
    """Yield the predictions of an armour's ballistic limit, given those by the model and by Florence's formula, m/s.

    Those of the round and the materials of Wilkins' tests have the errors on these.
    """
    tests = wilkins_tests()
    wilkins, measured, densities = tests.scenarios[0], tests.limits, tests.areal_densities
    by_model = Prediction("the model", limit_m_s)
    by_florence = {body: Prediction(f"Florence, {body}", limit) for body, limit in florence.items()}
    if any(scenario.entry_of(role) != wilkins.entry_of(role) for role in ROLES):
        yield from (by_model, *by_florence.values())
        return
    name = wilkins.armour.ceramic or ""
    source = wilkins.entry("ceramic", name).values["flow_stress_GPa"].source
    by_model = replace(by_model, fitted=f"flow stress of {name}: {source}")
    yield by_model.on_tests(measured, evaluate(wilkins, tests.columns, [LIMIT])[LIMIT])
    k = fitted_factor(densities, measured)
    left_out = [fitted_factor(np.delete(densities, i), np.delete(measured, i)) * a for i, a in enumerate(densities)]
    fitted = f"k = {k:.2f} m/s per kg/m² to these tests"
    rule = Prediction("k times areal density, fitted", k * along_fire_kg_m2(scenario), fitted=fitted)
    yield rule.on_tests(measured, k * densities, np.array(left_out))
    for body, prediction in by_florence.items():
        yield prediction.on_tests(measured, np.array([florence_limits(each)[body] for each in tests.scenarios]))
