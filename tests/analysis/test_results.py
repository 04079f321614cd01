"""Results as data frames."""

import json
import pickle
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import armour
from armour.analysis.impact import impact_at, simulate
from armour.analysis.results import data_frame
from armour.statistics.v50 import Shots, v50
from armour.sweeps.sweep import sweep
from tests.analysis.results import impact
from tests.design.results import design_result
from tests.helpers.cases import scenario
from tests.helpers.known import known
from tests.statistics.results import uncertainty_result

# Lists, which a type checker accepts too.
SHOTS = Shots([700.0, 708.0, 715.0, 731.0, 740.0, 748.0], [False] * 3 + [True] * 3)


@pytest.fixture
def pandas(monkeypatch: pytest.MonkeyPatch) -> None:
    """A stand-in for pandas."""
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=dict))


@pytest.mark.usefixtures("pandas")
def test_rows_of_results():
    history, curve = impact().history, uncertainty_result().to_dataframe()
    assert list(known(history).to_dataframe())[:3] == ["time_us", "depth_mm", "length_mm"]
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


@pytest.mark.usefixtures("pandas")
def test_a_column_without_any_value_is_one_of_numbers():
    assert np.isnan(data_frame({"a": [None, None], "b": [1.0, None]})["a"]).all()


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


def test_without_pandas(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ModuleNotFoundError, match="pandas"):
        data_frame({"a": [1.0]})


def test_plain_data_is_json():
    untested = armour.load_scenario("wilkins", {"armour.ceramic": "SiC"})
    [threat] = json.loads(json.dumps(armour.check(untested).to_dict(), allow_nan=False))["threats"]
    assert threat["far_from_tests"] == ["SiC (no test)"]
    oblique = untested.replaced({"impact.obliquity_deg": 45.0})
    for function in (armour.simulate, armour.ballistic_limit, armour.confidence):
        assert function(untested).to_dict()["far_from_tests"] == ["SiC (no test)"]
        assert function(oblique).warnings == oblique.notes != ()
    limit = armour.ballistic_limit(untested)
    assert limit.to_dict()["reason"] == limit.reason == armour.confidence(untested).reason != ""
    assert armour.ballistic_limit(armour.load_scenario("wilkins")).reason == ""
