"""Laws of the ceramic's flow stress, and the coefficients that a calibration fits."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from armour.analysis.variants import Floats
from armour.scenario.parameters import BACKING, CERAMIC, inputs_of
from armour.statistics.test_data import MaterialGroup, Tests

FLOW_STRESS = "ceramic.flow_stress_GPa"

Law = Literal["constant", "linear", "proportional", "thicknesses"]
# Suffixes of the coefficients' names, by term: a constant, or a multiple of a thickness.
TERMS = ("", " per mm of ceramic", " per mm of backing")
# Terms of each law.
LAWS: dict[Law, tuple[int, ...]] = {
    "constant": (0,),
    "linear": (0, 1),
    "proportional": (1,),
    "thicknesses": (0, 1, 2),
}
# Bounds of a coefficient in units of its scale; slopes of a law may be negative.
MIN_RATIO, MAX_RATIO = 0.1, 10.0
# Least value of an input by a law, as a multiple of the scenario's own value.
MIN_VALUE_RATIO = 0.05


class Coefficients(NamedTuple):
    """The k coefficients to fit, each of an input and a term of its law."""

    inputs: tuple[str, ...]
    terms: tuple[int, ...]
    scales: Floats  # the scenario's own value, divided by the mean thickness of the term, (k,)
    lower: Floats  # lower bounds, divided by the scales, (k,)

    def names(self) -> list[str]:
        """Return the names of the coefficients."""
        return [name + TERMS[term] for name, term in zip(self.inputs, self.terms, strict=True)]


def coefficients_of(tests: Tests, inputs: Sequence[str], law: Law) -> Coefficients:
    """Return the coefficients of inputs to fit; only the flow stress follows the law."""
    own = inputs_of(tests.groups[0].scenario)
    means = (1.0, _mean(tests, CERAMIC), _mean(tests, BACKING))
    pairs = [(name, term) for name in inputs for term in (LAWS[law] if name == FLOW_STRESS else LAWS["constant"])]
    return Coefficients(
        inputs=tuple(name for name, _ in pairs),
        terms=tuple(term for _, term in pairs),
        scales=np.array([own[name] / means[term] for name, term in pairs]),
        lower=np.array([-MAX_RATIO if term and law != "proportional" else MIN_RATIO for _, term in pairs]),
    )


def _mean(tests: Tests, name: str) -> float:
    """Return the mean of a thickness over the tests; 1 where it is 0."""
    return float(np.concatenate([group.column(name) for group in tests.groups]).mean()) or 1.0


def input_values(coefficients: Coefficients, x: Floats, group: MaterialGroup) -> dict[str, Floats]:
    """Return the fitted inputs of a group's tests, given the coefficients over their scales, (k,) or (k, tests)."""
    own_x = x[:, group.where] if x.ndim > 1 else x[:, None]
    thicknesses = (np.ones(len(group.where)), group.column(CERAMIC), group.column(BACKING))
    found: dict[str, Floats] = {}
    for name, term, value in zip(
        coefficients.inputs, coefficients.terms, own_x * coefficients.scales[:, None], strict=True
    ):
        found[name] = found.get(name, 0.0) + value * thicknesses[term]
    own = inputs_of(group.scenario)
    return {name: np.maximum(values, MIN_VALUE_RATIO * own[name]) for name, values in found.items()}
