"""Laws of the ceramic's flow stress: the inputs that a calibration fits beside the flow stress itself."""

from typing import Any, Literal

from armour.scenario.keys import key_name
from armour.scenario.library import FLOW_STRESS_LAW
from armour.scenario.scenario import Scenario

FLOW_STRESS = "ceramic.flow_stress_GPa"

Law = Literal["constant", "ceramic", "backing", "product", "linear"]
# Keys of the ceramic that each law fits.
LAWS: dict[Law, tuple[str, ...]] = {
    "constant": (),
    "ceramic": ("flow_stress_ceramic_slope",),
    "backing": ("flow_stress_backing_exponent",),
    "product": ("flow_stress_product_exponent",),
    "linear": ("flow_stress_ceramic_slope", "flow_stress_backing_slope"),
}


def law_of(scenario: Scenario) -> str:
    """Return the law of the scenario's ceramic; several laws at once are "combined"."""
    nonzero = {key for key in FLOW_STRESS_LAW if _value(scenario, key)}
    return next((law for law, keys in LAWS.items() if nonzero == set(keys)), "combined")


def with_law(scenario: Scenario, law: Law) -> Scenario:
    """Return the scenario with the coefficients of one law, 0 where its ceramic lacks them, and of no other."""
    changes = {key: 0.0 for key in FLOW_STRESS_LAW if (key in LAWS[law]) != bool(_value(scenario, key))}
    return with_ceramic(scenario, changes) if changes else scenario


def with_ceramic(scenario: Scenario, values: dict[str, float]) -> Scenario:
    """Return the scenario with other values of its ceramic, by key, which its entry may lack."""
    entry = scenario.entry_of("ceramic")
    assert entry is not None
    table: dict[str, Any] = dict(values)
    if entry.name not in scenario.library.ceramic:
        table["based_on"] = entry.name
    return scenario.replaced({key_name(["library", "ceramic", entry.name]): table})


def _value(scenario: Scenario, key: str) -> float:
    entry = scenario.entry_of("ceramic")
    return entry[key] if entry is not None and key in entry.values else 0.0
