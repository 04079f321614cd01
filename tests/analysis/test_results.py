"""Results as data frames."""

import json
import pickle
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import armour
from armour.analysis import results
from armour.analysis.impact import impact_at, simulate
from armour.analysis.results import data_frame, installed
from armour.statistics.v50 import Shots, v50
from armour.sweeps.sweep import sweep
from tests.analysis.results import impact
from tests.design.results import design_result
from tests.helpers.cases import scenario
from tests.helpers.known import known
from tests.statistics.results import uncertainty_result

# Lists, which a type checker accepts too.
SHOTS = Shots([700.0, 708.0, 715.0, 731.0, 740.0, 748.0], [False] * 3 + [True] * 3)


class Frame(dict[str, object]):
    """A stand-in for a data frame."""

    def __init__(self, columns: dict[str, object], schema_overrides: dict[str, type] | None = None) -> None:
        super().__init__(columns)
        self.types = schema_overrides


@pytest.fixture(params=["pandas", "polars"])
def library(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """One library of data frames installed, the other not."""
    for name in ("pandas", "polars"):
        stub = SimpleNamespace(DataFrame=Frame) if name == request.param else None
        monkeypatch.setitem(sys.modules, name, stub)
    return str(request.param)


def test_a_library_of_data_frames_that_lacks_a_part_says_which(monkeypatch: pytest.MonkeyPatch):
    def broken(_name: str) -> None:
        raise ModuleNotFoundError("No module named 'pytz'", name="pytz")

    monkeypatch.setattr("armour.analysis.results.import_module", broken)
    with pytest.raises(ModuleNotFoundError, match="pytz"):
        data_frame({"a": [1.0]})


@pytest.mark.usefixtures("library")
def test_rows_of_results():
    history, curve = impact().history, uncertainty_result().to_dataframe()
    assert list(known(history).to_dataframe())[:3] == ["time_us", "depth_mm", "length_mm"]
    assert isinstance(curve, Frame)
    assert list(curve) == ["velocity_m_s", "probability", "low", "high"]
    design = design_result(pareto=True)
    assert design.to_dataframe()["ceramic_thickness_mm"] == [10.0, 8.0, 7.0]
    assert design.to_dataframe("pareto")["ceramic"] == ["AD85", "AD99.5"]
    empty = design_result().to_dataframe("pareto")
    assert empty.keys() == design.to_dataframe("pareto").keys()
    assert not any(empty.values())
    assert list(impact().to_dataframe())[:2] == ["stage", "start_us"]
    assert v50(SHOTS).to_dataframe()["method"][0] == "penalised likelihood"


def test_iteration_gives_the_rows():
    """A list of dictionaries is what pandas and polars take as rows."""
    design = design_result(pareto=True)
    assert [row["ceramic_thickness_mm"] for row in design] == [10.0, 8.0, 7.0]
    found = sweep(scenario(), {"armour.ceramic_thickness_mm": [4.0, 6.0], "armour.ceramic": ["AD85", "SiC"]})
    rows = list(found)
    assert len(rows) == 4
    for name, values in found.columns.items():
        assert [row[name] for row in rows] == values.tolist()
    for result in (impact(), uncertainty_result(), v50(SHOTS), design):
        columns = {name: list(values) for name, values in result._columns().items()}
        assert {name: [row[name] for row in result] for name in columns} == columns


def test_a_column_without_any_value_is_one_of_numbers(library: str):
    found = data_frame({"a": [None, None], "b": [1.0, None]})
    assert np.isnan(found["a"]).all() if library == "pandas" else found.types == {"a": float}


def test_a_history_is_plain_data_and_compares():
    first, second = (simulate(scenario(), history=True) for _ in range(2))
    assert first == second
    assert first != simulate(scenario(velocity=700.0), history=True)
    assert json.loads(json.dumps(known(first.history).to_dict()))["stage"][0] == "i"


def test_the_question_of_a_result_is_no_part_of_it():
    found = simulate(scenario())
    assert found == impact_at(scenario(), 800.0)
    assert "scenario" not in found.to_dict()
    assert pickle.loads(pickle.dumps(found)) == found


def test_numbers_and_texts_in_a_column(library: str):
    found = data_frame({"a": [1.5, "stopped", None], "b": [1.5, 2.5, None]})
    mixed = [1.5, "stopped", None] if library == "pandas" else ["1.5", "stopped", None]
    assert found == {"a": mixed, "b": [1.5, 2.5, None]}


def test_without_a_library(monkeypatch: pytest.MonkeyPatch):
    for name in ("pandas", "polars"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ModuleNotFoundError, match="needs pandas or polars"):
        data_frame({"a": [1.0]})


def test_portions():
    assert [list(range(10))[part] for part in results.portions(10, 4)] == [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9]]
    assert not list(results.portions(0, 4))


def test_versions_of_what_is_installed():
    """A package may be missing."""
    [(name, version)] = installed(["numpy", "no-such-package"])
    assert (name, version) == ("numpy", np.__version__)


def test_plain_data_is_json():
    untested = armour.load_scenario("wilkins", {"armour.ceramic": "SiC"})
    [threat] = json.loads(json.dumps(armour.check(untested).to_dict(), allow_nan=False))["threats"]
    assert threat["far_from_tests"] == ["SiC (no test)"]
    limit = armour.ballistic_limit(untested)
    assert limit.to_dict()["reason"] == limit.reason == armour.confidence(untested).reason != ""
    assert armour.ballistic_limit(armour.load_scenario("wilkins")).reason == ""
