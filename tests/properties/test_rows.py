"""Rows of inputs are accepted if and only if the scenario with their values is."""

from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from armour.errors import InputError
from armour.scenario.scenario import Scenario
from tests.helpers.cases import scenario
from tests.helpers.examples import examples

AP = "7.62 mm AP"
MINE = {"based_on": AP, "penetrator_diameter_mm": 5.0}
CASES: list[dict[str, Any]] = [
    {},
    {"ceramic": None, "ceramic_mm": 0.0, "backing": "AA6082-T651"},
    # The scenario's own projectile: based on another one, and in place of that of its name.
    {"projectile": "a", "library": {"projectile": {"a": MINE, "c": {"based_on": "7.62 mm APM2"}}}},
    {"library": {"projectile": {AP: {"based_on": AP, "density_kg_m3": 7000.0}}}},
]
SCENARIOS = [scenario(**case) for case in CASES]
BOUNDS = (0.0, 5e-324, 1e-3, 1.0, 100.0, 1e3, 3e4, 1e4, 1e5, 1e6, 1e9, -1.0, np.nan, np.inf, -np.inf, 1e300)
FACTORS = st.one_of(st.floats(0.9, 1.1), st.sampled_from((0.1, 0.2, 4.0, 10.0, 30.0)))


@st.composite
def rows(draw: st.DrawFn) -> tuple[Scenario, dict[str, np.ndarray[Any, np.dtype[np.float64]]]]:
    case = draw(st.sampled_from(SCENARIOS))
    own = case.inputs()
    names = draw(st.lists(st.sampled_from(list(own)), min_size=1, max_size=4, unique=True))
    count = draw(st.integers(1, 3))
    return case, {
        name: np.array(
            [
                draw(st.one_of(FACTORS.map(own[name].__mul__), FACTORS.map(own[name].__mul__), st.sampled_from(BOUNDS)))
                for _ in range(count)
            ]
        )
        for name in names
    }


def accepted(case: Scenario, columns: dict[str, Any], row: int) -> bool:
    try:
        case.with_inputs({name: float(values[row]) for name, values in columns.items()})
    except InputError:
        return False
    return True


@examples(max_examples=60)
@given(rows())
@example(
    (
        SCENARIOS[0],
        {f"projectile.penetrator_{key}": np.array([v]) for key, v in (("diameter_mm", 65), ("mass_g", 5460))},
    )
)
def test_rows_are_accepted_as_scenarios_are(table: tuple[Scenario, dict[str, Any]]):
    case, columns = table
    count = len(next(iter(columns.values())))
    each = [accepted(case, columns, row) for row in range(count)]
    for row in range(count):
        assert each[row] == (not [*case.wrong_rows({name: values[row : row + 1] for name, values in columns.items()})])
    if all(each):
        case.check_rows(columns)
    else:
        with pytest.raises(InputError, match=f"row {each.index(False) + 1}: "):
            case.check_rows(columns)
