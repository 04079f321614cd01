"""Results as HTML for a notebook."""

import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from armour.analysis.confidence import confidence
from armour.analysis.results import TableResult
from armour.reporting.show import in_html
from armour.reporting.views.registry import VIEWS
from tests.helpers.cases import scenario
from tests.helpers.results import impact
from tests.reporting.test_figures import results


def test_every_result_has_its_tables_and_its_line(folder: Path):
    found = [result for result, _ in results(folder).values()] + [confidence(scenario())]
    assert {type(result).__name__ for result in found} == VIEWS.keys()
    for result in found:
        html = in_html(result)
        assert html is not None
        assert html.count("<table") >= 1
        assert "\n" not in repr(result)
        assert len(repr(result)) < 200


def test_rows_are_columns_of_equal_lengths(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=dict))
    framed = {name: found for name, (found, _) in results(folder).items() if isinstance(found, TableResult)}
    assert framed.keys() == {
        "CalibrationResult",
        "PlannedTests",
        "Comparison",
        "FiringResult",
        "ImpactResult",
        "SensitivityResult",
        "SuiteResult",
        "SweepResult",
        "UncertaintyResult",
    }
    for found in framed.values():
        lengths = {len(values) for values in found.to_dataframe().values()}
        assert len(lengths) == 1
        assert lengths != {0}


def test_the_tables_are_those_of_the_command():
    html = in_html(impact())
    assert html is not None
    assert '<th scope="row">residual velocity</th><td>277.38\N{NO-BREAK SPACE}m/s</td>' in html
    assert "fragmented ceramic, penetrated; rod erodes" in html


def test_a_history_has_no_tables():
    history = impact().history
    assert history is not None
    assert in_html(history) is None
