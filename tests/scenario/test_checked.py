import inspect
from collections.abc import Callable, Mapping
from os import PathLike
from typing import Annotated, Any, Literal

import numpy as np
import pytest
import scipy.special
from pydantic import Field

from armour import ModelError, Scenario, load_scenario, plot, read_shots, v50
from armour.errors import InputError
from armour.scenario.checked import Names, checked
from tests.helpers.foreign import NotAvailable, Quantity
from tests.helpers.known import known


@checked
def f(
    scenario: Scenario | None = None,
    *,
    path: Mapping[str, float] | str | PathLike[str] = "",
    names: Names = (),
    number: Annotated[int, Field(ge=1)] | None = None,
    confidence: Annotated[float, Field(ge=0.5, le=0.9999)] = 0.95,
    law: Literal["backing", "ceramic"] = "backing",
    limits: Annotated[tuple[float, float], Field(strict=False)] | None = None,
    prior: bool = False,
    call: Callable[[int], None] = print,
) -> tuple[Any, ...]:
    """Return what it is given."""
    return scenario, path, names, number, confidence, law, limits, prior, call


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"scenario": {}}, "scenario: must be a Scenario, found a dict; load_scenario makes one"),
        ({"scenario": "x"}, 'scenario: must be a Scenario, found the text "x"; load_scenario makes one'),
        ({"path": 3}, "path: must be a mapping or a path, found 3"),
        ({"names": 5}, "names: must be a name or a sequence of names, found 5"),
        ({"names": ["a", 5]}, "names: must be a name or a sequence of names, found 5 in it"),
        ({"names": ["a", "a"]}, 'names: must not name anything twice, found the text "a" twice'),
        ({"number": 0}, "number: must be at least 1, found 0"),
        ({"confidence": 0.2}, "confidence: must be at least 0.5, found 0.2"),
        ({"confidence": 95}, "confidence: must be at most 0.9999, found 95; did you mean 0.95?"),
        ({"law": "backin"}, 'law: must be "backing" or "ceramic", found the text "backin"; did you mean "backing"?'),
        ({"limits": [3.0, "x"]}, 'limits[1]: must be a number, found the text "x"'),
        ({"limits": [3.0, "3,5"]}, 'limits[1]: must be a number, found the text "3,5"; decimals have a point'),
        ({"prior": 1}, "prior: must be true or false, found 1"),
        ({"call": None}, "call: must be a function, found None"),
    ],
)
def test_a_wrong_argument(given: dict[str, Any], message: str):
    with pytest.raises(InputError) as error:
        f(**given)
    assert str(error.value) == f"f: {message}"


def test_what_is_right_is_passed_on():
    scenario = load_scenario("wilkins")
    assert f(scenario)[0] is scenario
    assert f(names="abc")[2] == ("abc",)
    assert f(names=(x for x in "ab"))[2] == ("a", "b")
    assert f(limits=[1, 2])[6] == (1.0, 2.0)  # type: ignore[arg-type]
    assert (f(number=np.int64(3))[3], f(prior=np.bool_(True))[7]) == (3, True)  # type: ignore[arg-type]


def test_names_as_an_array():
    assert f(names=np.array(["a", "b"]))[2] == ("a", "b")
    assert f(names=np.array("abc"))[2] == ("abc",)
    with pytest.raises(InputError, match="f: names: must be a name or a sequence of names, found None in it"):
        f(names=np.ma.array(["a", "b"], mask=[False, True]))


@pytest.mark.parametrize("value", [np.ma.masked, NotAvailable(), Quantity(0.25)])
def test_what_is_no_number_is_neither_zero_nor_left_out(value: Any):
    for name in ("number", "confidence"):
        with pytest.raises(InputError, match=f"f: {name}: must be a .*, found"):
            f(**{name: value})


def test_a_wrong_call_has_one_traceback():
    with pytest.raises(TypeError, match=r"f\(\) got an unexpected keyword argument 'nam'") as error:
        f(nam="a")  # type: ignore[call-arg]
    assert error.value.__context__ is None


@pytest.mark.parametrize("module", [np, scipy.special])
def test_answers_do_not_depend_on_how_the_caller_treats_floating_point_errors(module: Any):
    shots = read_shots("tests/shots")
    error = ModelError(0.0, 1.0, 5.0)

    def answers() -> Any:
        result = v50(shots)
        chances = error.quantile([0.0, 1e-300, 0.5]), error.probability_of_stopping(700.0, np.array([1.0, 1e5]))
        axes = plot(result).axes
        return result.band(), *map(list, chances), known(result.recommended).probability(10.0), len(axes)

    usual = answers()
    with module.errstate(all="raise"):
        assert answers() == usual


def test_help_shows_types_without_bounds():
    shown = inspect.signature(f).parameters
    assert str(shown["names"]) == "names: str | collections.abc.Iterable[str] = ()"
    assert str(shown["confidence"]) == "confidence: float = 0.95"
