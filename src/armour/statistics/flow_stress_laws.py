"""Laws of the ceramic's flow stress, and the coefficients that a calibration fits."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from armour.analysis.variants import Floats
from armour.scenario.parameters import BACKING, CERAMIC, inputs_of
from armour.statistics.test_data import MaterialGroup, Tests

FLOW_STRESS = "ceramic.flow_stress_GPa"

Law = Literal["constant", "linear", "proportional", "thicknesses"]
# Which terms each law has: a constant, the ceramic thickness, the back plate thickness.
LAWS: dict[Law, tuple[bool, bool, bool]] = {
    "constant": (True, False, False),
    "linear": (True, True, False),
    "proportional": (False, True, False),
    "thicknesses": (True, True, True),
}
# Suffixes of the coefficients' names, by term.
TERMS = ("", " per mm of ceramic", " per mm of backing")
# Least value of an input by a law, as a multiple of the scenario's own value.
MIN_VALUE_RATIO = 0.05


class Coefficients(NamedTuple):
    """Coefficients to fit: the input and the term of its law that each belongs to."""

    inputs: tuple[str, ...]
    terms: tuple[int, ...]
    scales: Floats  # the scenario's own value, divided by the mean thickness of the term

    def names(self) -> list[str]:
        """Return the names of the coefficients."""
        return [name + TERMS[term] for name, term in zip(self.inputs, self.terms, strict=True)]


def coefficients_of(tests: Tests, inputs: Sequence[str], law: Law) -> Coefficients:
    """Return the coefficients of inputs to fit; only the flow stress follows the law."""
    own = inputs_of(tests.groups[0].scenario)
    means = [1.0, _mean(tests, CERAMIC), _mean(tests, BACKING)]
    pairs = [
        (name, term)
        for name in inputs
        for term, present in enumerate(LAWS[law] if name == FLOW_STRESS else LAWS["constant"])
        if present
    ]
    scales = np.array([own[name] / means[term] for name, term in pairs])
    return Coefficients(tuple(name for name, _ in pairs), tuple(term for _, term in pairs), scales)


def _mean(tests: Tests, name: str) -> float:
    """Mean of a thickness over the tests; 1 where it is 0."""
    values = [thickness for group in tests.groups for thickness in group.column(name)]
    return float(sum(values) / len(values)) or 1.0


def input_values(coefficients: Coefficients, x: Floats, group: MaterialGroup) -> dict[str, Floats]:
    """Compute the fitted inputs of a group's tests.

    Parameters
    ----------
    coefficients : Coefficients
    x : array, (k,)
        Values of the coefficients, divided by their scales.
    group : MaterialGroup
    """
    thicknesses = (np.ones(len(group.where)), group.column(CERAMIC), group.column(BACKING))
    found: dict[str, Floats] = {}
    for name, term, value in zip(coefficients.inputs, coefficients.terms, x * coefficients.scales, strict=True):
        found[name] = found.get(name, 0.0) + value * thicknesses[term]
    own = inputs_of(group.scenario)
    return {name: np.maximum(values, MIN_VALUE_RATIO * own[name]) for name, values in found.items()}
