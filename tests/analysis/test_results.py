"""Results as data frames."""

import sys
from types import SimpleNamespace

import pytest

from armour.analysis.results import data_frame
from tests.helpers.results import design_result, impact, uncertainty_result


class Frame(dict[str, object]):
    """A stand-in for a data frame."""


@pytest.fixture(params=["pandas", "polars"])
def library(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """One library of data frames installed, the other not."""
    for name in ("pandas", "polars"):
        stub = SimpleNamespace(DataFrame=Frame) if name == request.param else None
        monkeypatch.setitem(sys.modules, name, stub)
    return str(request.param)


@pytest.mark.usefixtures("library")
def test_rows_of_results():
    history, curve = impact().history, uncertainty_result().to_dataframe()
    assert history is not None
    assert list(history.to_dataframe())[:3] == ["time_us", "depth_mm", "length_mm"]
    assert isinstance(curve, Frame)
    assert list(curve) == ["velocity_m_s", "probability", "low", "high"]
    design = design_result(pareto=True)
    assert design.to_dataframe()["ceramic_thickness_mm"] == [10.0, 8.0, 7.0]
    assert design.to_dataframe("pareto")["ceramic"] == ["AD85", "AD99.5"]
    assert design_result().to_dataframe("pareto") == {}


def test_numbers_and_texts_in_a_column(library: str):
    found = data_frame({"a": [1.5, "defeated", None], "b": [1.5, 2.5, None]})
    mixed = [1.5, "defeated", None] if library == "pandas" else ["1.5", "defeated", None]
    assert found == {"a": mixed, "b": [1.5, 2.5, None]}


def test_without_a_library(monkeypatch: pytest.MonkeyPatch):
    for name in ("pandas", "polars"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ModuleNotFoundError, match="needs pandas or polars"):
        data_frame({"a": [1.0]})
