"""Figures, reports and tables in a notebook."""

import re
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import armour
from armour.analysis.ballistic_limit import Crossing, LimitResult, confidence
from armour.analysis.impact import History, simulate
from armour.analysis.results import Result, TableResult
from armour.design.check import check
from armour.design.optimise import optimise
from armour.errors import InputError
from armour.planning.firing import plan_shots
from armour.reporting.by_result import by_result, draw
from armour.reporting.show import in_html, plot, report
from armour.scenario.scenario import save_scenario
from armour.statistics.calibration import CalibrationResult, Residual
from armour.statistics.sensitivity import Elasticity, SensitivityResult
from armour.statistics.v50 import Shots, v50
from armour.sweeps.sweep import sweep
from armour.validation.comparison import Comparison, Prediction
from tests.analysis.results import impact
from tests.helpers.cases import scenario
from tests.helpers.suites import case
from tests.helpers.suites import result as suite_result
from tests.statistics.results import uncertainty_result

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("not_laid_out")]

SHOTS = Shots((700.0, 710.0, 720.0, 730.0), (False, True, False, True))
LIMIT = "ballistic_limit_m_s"
THREE = ["armour.ceramic_thickness_mm", "armour.backing_thickness_mm", "ceramic.flow_stress_GPa"]


OFFERED = {f"{layer}_thickness_mm": {"min": 5.0, "max": 9.0, "step": 1.0} for layer in ("ceramic", "backing")}


def test_the_docstring_of_plot_names_every_result_that_is_drawn():
    public = [getattr(armour, name) for name in dir(armour)]
    classes = [thing for thing in public if isinstance(thing, type) and issubclass(thing, Result)]
    drawn = [cls.__name__ for cls in classes if by_result(draw, object.__new__(cls)) is not None]
    assert "ImpactResult" in drawn
    assert [name for name in drawn if not re.search(rf"\b{name}\b", str(plot.__doc__))] == []


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> list[Any]:
    """A result of each kind."""
    folder = tmp_path_factory.mktemp("results")
    save_scenario(scenario(), folder / "wilkins.toml")
    residual = Residual("1", LIMIT, 700.0, 710.0, 712.0, "")
    calibrated = CalibrationResult("t.csv", "", "relative", (), (), (residual,), 1.0, 2.0, 1.0, 1.0, 1, 1, 0.95)
    limit = LimitResult(
        723.8, (723.7, 723.8), 50, 43.6, True, (Crossing((723.7, 723.8), "perforated"),), 33, (1, 2), ()
    )
    item = Elasticity("ceramic.flow_stress_GPa", 5.0, {LIMIT: 0.6})
    return [
        calibrated,
        Comparison(limit, (Prediction("the model", 723.8),), "").of(scenario=scenario()),
        optimise(scenario(optimise=OFFERED)),
        v50(SHOTS),
        plan_shots(scenario(), SHOTS),
        check(scenario()),
        impact().of(scenario=scenario()),
        limit.of(scenario=scenario()),
        SensitivityResult({LIMIT: 723.0}, (item,)),
        suite_result(folder, case("a", 720.0, "band = 5.0")),
        sweep(scenario(), {"armour.ceramic_thickness_mm": [6.0, 7.0]}, "areal_density_kg_m2"),
        uncertainty_result().of(scenario=scenario()),
    ]


def test_every_result_is_drawn_with_its_title(results):
    for result in results:
        if isinstance(result, Comparison):
            continue
        figure = plot(result, title="mine")
        assert figure.axes
        assert figure.get_suptitle() == "mine"
    # A notebook shows it.
    assert figure._repr_png_().startswith(b"\x89PNG")  # type: ignore[attr-defined]


def texts(figure: Any) -> list[str]:
    return [text.get_text() for text in figure.texts]


def test_a_picture_names_armour_and_round_below_the_answer():
    armour = "6.35 mm AD85 on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s"
    drawn = plot(simulate(scenario(), history=True))
    assert drawn.get_suptitle().strip() == "Perforated by the model: 277 m/s left of 800 m/s"
    assert armour in texts(drawn)


def test_what_cannot_be_drawn():
    with pytest.raises(InputError, match="history=True"):
        plot(simulate(scenario()))
    history = impact().history
    assert isinstance(history, History)
    with pytest.raises(InputError, match=r"must be one that help\(armour\.plot\) lists, found History"):
        plot(history)
    with pytest.raises(InputError, match="a quantity that is a number, found only outcome"):
        plot(sweep(scenario(), {"impact.velocity_m_s": [700.0, 800.0]}, "outcome"))
    with pytest.raises(InputError, match="one or two keys of numbers, found"):
        plot(sweep(scenario(), {key: [7.0] for key in THREE}, "areal_density_kg_m2"))


def test_every_result_has_its_tables_and_its_line(results):
    for result in [*results, confidence(scenario())]:
        html = in_html(result)
        assert html is not None
        assert html.count("<table") >= 1
        assert "\n" not in repr(result)
        assert len(repr(result)) < 250


def test_rows_are_columns_of_equal_lengths(results, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=dict))
    framed = [found for found in [*results, impact().history] if isinstance(found, TableResult)]
    public = [getattr(armour, name) for name in dir(armour)]
    with_rows = {thing for thing in public if isinstance(thing, type) and issubclass(thing, TableResult)}
    assert {type(found) for found in framed} == with_rows
    for found in framed:
        lengths = {len(values) for values in found.to_dataframe().values()}
        assert len(lengths) == 1
        assert lengths != {0}


def test_the_armour_as_it_is(folder: Path):
    asks = scenario(threat=[{"projectile": "7.62 mm AP", "velocity_m_s": 700.0}])
    report(asks, folder / "x.md", as_is=True)
    text = (folder / "x.md").read_text()
    assert "as_is=True)" in text
    assert "Best design" not in text


def test_another_ending(folder: Path):
    with pytest.raises(InputError, match=r"\.html or \.md"):
        report(suite_result(folder, case("a", 720.0, "band = 5.0")), folder / "x.pdf")


def test_a_report_is_on_a_scenario_or_a_suite(tmp_path: Path):
    with pytest.raises(InputError, match="subject: must be a Scenario or the result of validate or v50, found a str"):
        report("wilkins", tmp_path / "x.md")  # type: ignore[arg-type]
