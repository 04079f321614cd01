from dataclasses import replace
from functools import cache
from math import nan
from typing import Any, TypeVar

import numpy as np
import pytest

from armour.analysis.impact import simulate
from armour.design.optimise import DesignResult, Pair, optimise
from armour.reporting.charts import (
    Band,
    Box,
    Chart,
    Contours,
    Line,
    Map,
    Panel,
    Points,
    Region,
    Rule,
    Spans,
    Words,
    quantity_axis,
)
from armour.reporting.views import calibration as calibration_view
from armour.reporting.views import design as design_view
from armour.reporting.views import firing as v50_view
from armour.reporting.views import impact as impact_view
from armour.reporting.views import sensitivity as sensitivity_view
from armour.reporting.views import suite as suite_view
from armour.reporting.views import sweep as sweep_view
from armour.reporting.views import uncertainty as uncertainty_view
from armour.scenario.inputs import BACKING, CERAMIC
from armour.statistics.calibration import CalibrationResult, Residual
from armour.statistics.sensitivity import Elasticity, SensitivityResult
from armour.statistics.v50 import Shots, v50
from armour.validation.figures import Figure, FigureLevel, FigureMark, FigureSection
from tests.helpers.cases import scenario, shipped_scenario
from tests.helpers.results import OTHER, THREAT, best_design, best_of, design_result, impact, uncertainty_result
from tests.helpers.suites import TABLE, WILKINS_LIMIT, case, result

Kind = TypeVar("Kind", Band, Box, Line, Points, Rule, Spans, Map, Contours, Region, Words)


def some(panel: Panel, kind: type[Kind]) -> list[Kind]:
    return [item for item in panel.series if isinstance(item, kind)]


def labels(*panels: Panel) -> list[str]:
    return [item.label for panel in panels for item in panel.series if item.label]


def headings(chart: Chart) -> list[tuple[str, str]]:
    return [(panel.x.heading, panel.y.heading) for panel in chart.panels]


def assert_matched(chart: Chart) -> None:
    """Every point has a coordinate of each kind and, where it has words, words of its own."""
    for panel in chart.panels:
        for item in panel.series:
            if isinstance(item, Line | Points):
                assert len(item.x) == len(item.y)
                assert len(item.text) in (0, len(item.x))


@pytest.mark.parametrize(
    ("name", "heading"),
    [
        ("ballistic_limit_m_s", "ballistic limit, m/s"),
        ("ceramic.flow_stress_GPa", "ceramic flow stress, GPa"),
        ("backing.dynamic_yield_strength_MPa", "back plate yield strength, MPa"),
        ("armour.backing_thickness_mm", "back plate thickness, mm"),
        ("projectile.penetrator_mass_g", "penetrator mass, g"),
        ("ceramic.youngs_modulus_GPa", "ceramic Young's modulus, GPa"),
        ("cost_per_m2", "cost per m²"),
        ("library.ceramic.Mine.flow_stress_GPa", "Mine flow stress, GPa"),
    ],
)
def test_an_axis_is_in_words_with_its_unit(name: str, heading: str):
    assert quantity_axis(name).heading == heading


def test_an_impact():
    found = impact()
    chart = impact_view.chart(found)
    assert chart.title == f"Perforated: residual velocity {found.residual_velocity_m_s:.0f} m/s"
    time = "time since impact, µs"
    assert headings(chart)[1:] == [
        (time, "velocity, m/s"),
        (time, "penetrator length L, mm"),
        (time, "depth, bulge, mm"),
    ]
    expected = ["projectile V", "penetration U", "target W", "depth Z", "bulge h"]
    assert labels(*chart.panels) == expected
    scene, velocities, *_ = chart.panels
    [spans] = some(velocities, Spans)
    assert [name.partition(":")[0] for name in spans.names] == [stage.stage for stage in found.stages]
    assert "stage i: intact ceramic; penetrator erodes" in spans.text[0]
    events = [words.splitlines()[2:] for item in some(scene, Words) for words in item.words if "µs" in words]
    assert [" ".join(words) for words in events] == [
        "impact",
        "ceramic fragments",
        "ceramic penetrated",
        "plug moves along",
        "perforated",
    ]
    assert some(velocities, Line)[0].y[0] == 800.0
    # At every end of a stage the rod is where the history has it.
    assert found.history is not None
    rods = [item.right - item.left for item in some(scene, Box) if item.colour == "rod"]
    assert rods[1:] == pytest.approx(
        [np.interp(stage.end_us, found.history.time_us, found.history.length_mm) for stage in found.stages]
    )
    assert_matched(chart)


def test_a_long_tail_is_left_out():
    slow = simulate(scenario(ceramic_mm=12.0, velocity=300.0), history=True)
    chart = impact_view.chart(slow)
    assert chart.title == f"Stopped at a depth of {slow.penetration_depth_mm:.3g} mm"
    _, *panels = chart.panels
    assert panels[0].x.text(12.3456) == "12.35 µs"
    assert panels[2].y.text(0.0018156) == "0.00 mm"
    for panel in panels:
        assert panel.x.limits is not None
        assert panel.x.limits[1] < 0.3 * slow.duration_us
        assert all(max(line.x) <= panel.x.limits[1] for line in some(panel, Line))  # type: ignore[type-var, operator]
        assert chart.note.startswith(f"Drawn up to {panel.x.limits[1]:.3g} µs of {slow.duration_us:.3g} µs.")


OFFERED = {"ceramic_thickness_mm": {"min": 4.0, "max": 14.0, "step": 2.0}}
OFFERED["backing_thickness_mm"] = OFFERED["ceramic_thickness_mm"]


@cache
def designs(confidence: float | None = None, ceramic: str | None = "AD85") -> DesignResult:
    """Designs against one impact; a bare plate where there is no ceramic."""
    grid = OFFERED if ceramic else {**OFFERED, "ceramic_thickness_mm": {"min": 0.0, "max": 0.0, "step": 1.0}}
    name = "6061-T6" if ceramic else "AA6082-T651"
    changes = {} if confidence is None else {"design": {"confidence": confidence}}
    velocity = 800.0 if ceramic else 300.0
    return optimise(
        scenario(ceramic=ceramic, ceramic_mm=0.0, backing=name, velocity=velocity, optimise=grid, **changes)
    )


def test_a_map_has_the_frontiers_and_the_lightest_designs():
    found = designs(0.9)
    [panel] = design_view.map_chart(found).panels
    assert (panel.x.heading, panel.y.heading) == ("back plate thickness, mm", "ceramic thickness, mm")
    frontiers = [item for item in some(panel, Contours) if item.at == (0.0,)]
    assert [(item.words, item.style) for item in frontiers] == [("50 %", "dashed"), ("90 %", "solid")]
    assert [item.label for item in some(panel, Region)] == [
        "perforated more often than not",
        "stopped in 90 % of cases or more",
        "probability unknown: too unlike tests",
    ]
    even, best = (item for item in some(panel, Points) if item.names)
    assert not even.filled
    assert best.filled
    assert (best.x[0], best.y[0]) == (best_of(found).backing_thickness_mm, best_of(found).ceramic_thickness_mm)
    through = [item for item in some(panel, Contours) if item.at and item.at != (0.0,)]
    assert through[1].at == (best_of(found).areal_density_kg_m2,)
    assert through[0].at < through[1].at
    assert "thicknesses tested" in labels(panel)
    assert "thicknesses on offer" in labels(panel)


def test_a_frontier_is_where_the_probability_is_that_of_its_line():
    """The lightest design lies on the side of the line on which it is stopped, its thinner neighbours on the other."""
    found = designs(0.9)
    [panel] = design_view.map_chart(found).panels
    [line] = [item for item in some(panel, Contours) if item.words == "90 %"]
    for design, stops in ((best_of(found), True), (replace(best_of(found), ceramic_thickness_mm=2.0), False)):
        x, y = design.backing_thickness_mm, design.ceramic_thickness_mm
        by_row = [np.interp(x, line.x, row) for row in np.asarray(line.z, dtype=float)]
        assert (np.interp(y, line.y, by_row) > -1.0) == stops


def test_without_a_confidence_the_map_shows_the_usual_one():
    [panel] = design_view.map_chart(designs()).panels
    assert [item.words for item in some(panel, Contours) if item.at == (0.0,)][:2] == ["50 %", "95 %"]
    [best] = [item for item in some(panel, Points) if item.names]
    assert best.colour == "ink"
    assert best.names[0].endswith(" stopped")


def test_designs_of_bare_plates_are_drawn_over_their_thickness():
    [panel] = design_view.map_chart(designs(0.9, None)).panels
    assert (panel.x.heading, panel.y.heading) == ("back plate thickness, mm", "ballistic limit, m/s")
    assert some(panel, Band)
    assert [item.filled for item in some(panel, Points)] == [True, False]


def test_designs_of_which_no_probability_is_known_have_the_line_of_the_limit():
    found = optimise(scenario(ceramic="SiC", optimise=OFFERED))
    chart = design_view.map_chart(found)
    assert chart.note == "No probability is known for these designs."
    assert "ballistic limit by the model = velocity" in labels(*chart.panels)
    assert not some(chart.panels[0], Region)


def test_the_best_of_every_pair_is_marked_up_to_a_limit():
    found = design_result()
    count = design_view.MAX_PAIRS + 5
    others = [Pair(f"C{i}", "6061-T6", best_design(), 1.0 + i, f"{1 + i} % heavier") for i in range(count - 1)]
    chart = design_view.pair_chart(replace(found, pairs=(*found.pairs, *others)))
    points, untested = some(chart.panels[0], Points)
    assert not untested.x
    assert len(points.x) == len(chart.panels[0].y.categories) == design_view.MAX_PAIRS
    assert chart.note == f"The best {design_view.MAX_PAIRS} of {count} pairs of materials are shown."
    assert_matched(chart)


def test_designs_of_a_front_are_not_joined():
    [panel] = design_view.pareto_chart(design_result(threats=(THREAT, OTHER), pareto=True)).panels
    assert (panel.x.heading, panel.y.heading) == ("areal density, kg/m²", "cost per m²")
    assert labels(panel) == ["AD85 on 6061-T6", "AD99.5 on 6061-T6", "best"]
    assert not some(panel, Line)


def figure() -> Figure:
    curves = {"A": (1.0, None, 9.0), "B": (2.0, 3.0, 4.0)}
    printed = FigureMark(label="printed", of="B", points=[[5.0, 3.0]], x_ends=[[4.5, 5.5]])
    marks = [printed, FigureMark(label="another", points=[[6.0, 2.0]])]
    levels = [FigureLevel(label="L", value=5.0)]
    words: dict[str, Any] = {"title": "T", "x_label": "each, mm", "y_label": "residual velocity, m/s"}
    section = FigureSection.model_construct(mark=marks, level=levels, **words)
    return Figure(section, (4.0, 6.0, 8.0), curves)


def test_a_figure_of_the_paper():
    chart = suite_view.figure_chart([figure()])
    [panel] = chart.panels
    assert labels(panel) == ["A", "B", "L", "printed", "another"]
    assert (panel.x.heading, panel.y.heading) == ("each, mm", "residual velocity, m/s")
    assert panel.x.limits == (4.0, 8.0)
    assert panel.y.from_zero
    curves, marks = some(panel, Line), some(panel, Points)
    assert marks[0].colour == curves[1].colour
    assert (marks[0].x_ends, marks[1].x_ends) == (((4.5, 5.5),), ())
    assert marks[1].colour not in [curve.colour for curve in curves]
    assert chart.width < 4.0


def test_parity_of_the_tables_of_a_suite(folder):
    chart = suite_view.chart(result(folder, TABLE + case("own", 700.0, "band = 100.0")))
    [panel] = chart.panels
    [points] = some(panel, Points)
    assert headings(chart) == [("expected ballistic limit, m/s", "computed ballistic limit, m/s")]
    assert list(points.x) == [720.0, 730.0]
    assert list(points.y) == pytest.approx([WILKINS_LIMIT] * 2)
    assert panel.x.limits == panel.y.limits
    assert panel.square
    assert points.text[0] == "ceramic thickness 6.35 mm\nexpected 720 m/s, computed 723.78 m/s"
    assert labels(panel) == ["t", "agreement", "± 10 %"]
    assert chart.note.startswith("1 of 3 cases are not shown")


def calibrated(count: int = 3) -> CalibrationResult:
    residuals = [
        Residual(f"test {i}", "ballistic_limit_m_s", 700.0 + 10.0 * i, 705.0 + 9.0 * i, 707.0 + 9.0 * i, "")
        for i in range(count)
    ]
    residuals.append(Residual("bound", "ballistic_limit_m_s", 690.0, 700.0, None, "at least"))
    return CalibrationResult("t.csv", "", "relative", (), (), tuple(residuals), 1.0, 2.0, 1, 0.1, 8, 8, 0.95)


def test_a_calibration():
    chart = calibration_view.chart(calibrated())
    parity, deviations = chart.panels
    assert chart.title == "Calibration to 4 tests: mean error 1.0 %, 2.0 % leave-one-out"
    assert (parity.x.heading, parity.y.heading) == ("measured ballistic limit, m/s", "computed ballistic limit, m/s")
    assert labels(parity) == ["tests", "stopped at", "agreement"]
    assert some(parity, Points)[0].text[0] == "test 0\nmeasured 700 m/s, computed 705 m/s"
    assert deviations.y.categories == ("test 0", "test 1", "test 2")
    fitted, left_out = some(deviations, Points)
    assert fitted.x[0] == pytest.approx(100.0 * (705.0 / 700.0 - 1.0))
    assert left_out.label == "leave-one-out"
    assert fitted.marker != left_out.marker
    assert_matched(chart)


def test_a_calibration_to_tests_with_uncertainties_has_error_bars():
    found = calibrated()
    assert calibration_view.chart(found).note == ""
    first, *others = found.residuals
    known = replace(found, residuals=(replace(first, uncertainty=30.0), *others))
    chart = calibration_view.chart(known)
    parity = chart.panels[0]
    tests, bound = some(parity, Points)
    assert tests.x_ends == ((670.0, 730.0), (710.0, 710.0), (720.0, 720.0))
    assert bound.x_ends == ()
    assert tests.text[0] == "test 0\nmeasured 700 m/s ± 30 m/s, computed 705 m/s"
    assert parity.x.limits is not None
    assert parity.x.limits[0] < 670.0
    assert "one standard deviation" in chart.note


def test_a_calibration_to_many_tests_shows_the_largest_deviations():
    _, deviations = calibration_view.chart(calibrated(60)).panels
    assert len(deviations.y.categories) == calibration_view.MAX_ROWS
    assert deviations.title == "Deviation of the computed ballistic limit, the 40 largest of 60"
    assert deviations.y.categories[0] == "test 59"


def test_a_sensitivity_is_ordered_by_the_ballistic_limit():
    def item(name: str, limit: float | None, residual: float | None) -> Elasticity:
        return Elasticity(name, 1.0, {"ballistic_limit_m_s": limit, "residual_velocity_m_s": residual})

    found = SensitivityResult(
        {"ballistic_limit_m_s": 700.0, "residual_velocity_m_s": 50.0},
        (
            item("ceramic.flow_stress_GPa", 0.5, -0.4),
            item("impact.velocity_m_s", 0.0, 1.7),
            item(CERAMIC, -0.6, None),
            item(BACKING, None, None),
        ),
    )
    chart = sensitivity_view.chart(found)
    limit, residual = chart.panels
    assert (
        limit.y.categories == residual.y.categories == ("ceramic thickness", "ceramic flow stress", "impact velocity")
    )
    assert (limit.title, residual.title) == ("ballistic limit", "residual velocity")
    assert [some(panel, Points)[0].x for panel in chart.panels] == [[-0.6, 0.5, 0.0], [-0.4, 1.7]]
    assert chart.title == "The ballistic limit depends most on the ceramic thickness: -0.60 % for 1 % more"
    assert_matched(chart)


VELOCITIES = (700.0, 710.0, 715.0, 720.0, 725.0, 730.0)
SHOTS = Shots(VELOCITIES, (False, False, True, False, True, True), "folder/shots.csv")


def test_a_v50():
    found = v50(SHOTS, scenario())
    chart = v50_view.chart(found.of(shots=SHOTS))
    [panel] = chart.panels
    assert f"limit by this model {WILKINS_LIMIT:.1f} m/s" in labels(panel)
    assert [item.text[0] for item in some(panel, Points)][:2] == [
        "partial penetration at 700 m/s",
        "complete penetration at 715 m/s",
    ]
    for line in some(panel, Line):
        assert all(b >= a for a, b in zip(line.y, line.y[1:], strict=False))  # type: ignore[operator]
    [band] = some(panel, Band)
    [curve] = some(panel, Line)
    assert all(low <= y <= high for low, y, high in zip(band.low, curve.y, band.high, strict=True))  # type: ignore[operator]
    assert chart.title == f"V50 {found.recommended.v50_m_s:.1f} m/s, 80 % interval 702.1 to 730.8 m/s"  # type: ignore[union-attr]
    [ends] = [item.x_ends for item in some(panel, Points) if item.x_ends]
    assert ends == (found.bounded_interval_m_s,)


def test_the_posterior_of_a_v50_is_drawn():
    found = v50(SHOTS, shipped_scenario("wilkins"), prior=True)
    chart = v50_view.chart(found.of(shots=SHOTS))
    [panel] = chart.panels
    assert found.posterior is not None
    [bar] = [item for item in some(panel, Points) if "posterior" in item.label]
    assert (bar.x, bar.x_ends) == ([found.posterior.v50_m_s], (found.posterior.v50_interval_m_s,))
    assert panel.x.limits is not None
    assert panel.x.limits[0] < bar.x_ends[0][0] < bar.x_ends[0][1] < panel.x.limits[1]
    assert "Posterior, with the model as prior: 95 % interval" in chart.note


def test_a_limit_outside_the_axis_of_a_v50_is_in_the_note_and_not_in_the_legend():
    thick = scenario(ceramic_mm=9.0)
    found = v50(SHOTS, thick)
    chart = v50_view.chart(found.of(shots=SHOTS))
    [panel] = chart.panels
    assert panel.x.limits is not None
    assert found.model_ballistic_limit_m_s is not None
    assert found.model_ballistic_limit_m_s > panel.x.limits[1]
    assert not any("this model" in label for label in labels(panel))
    assert f"{found.model_ballistic_limit_m_s:.1f} m/s, lies outside the axis" in chart.note


def test_an_uncertainty():
    found = uncertainty_result()
    chart = uncertainty_view.chart(found.of(scenario=scenario(velocity=700.0)))
    curve, swings = chart.panels
    assert "0.210 at 700 m/s" in labels(curve)
    assert chart.title == "Perforated with a probability of 21 % at 700 m/s"
    assert swings.y.categories == ("ceramic flow stress", "penetrator mass")
    low, high = some(swings, Points)
    assert (list(low.x), list(high.x)) == ([677.0, 729.0], [769.0, 718.0])
    assert curve.x.limits is not None
    assert 640.0 < curve.x.limits[0] < 677.0
    assert 770.0 < curve.x.limits[1] < 810.0
    assert_matched(chart)


def table(*keys: str) -> dict[str, Any]:
    first, second = (values.ravel() for values in np.meshgrid([4.0, 6.0, 8.0], [5.0, 7.0], indexing="ij"))
    answer = 100.0 * first + second
    return {keys[0]: first, keys[1]: second, "ballistic_limit_m_s": answer}


def test_a_sweep_over_one_key():
    columns = {CERAMIC: np.array([4.0, 6.0]), "ballistic_limit_m_s": np.array([500.0, np.nan])}
    chart = sweep_view.sweep_chart(columns, [CERAMIC], "ballistic_limit_m_s", scenario())
    [panel] = chart.panels
    assert chart.title == "Ballistic limit over ceramic thickness"
    assert (panel.x.heading, panel.y.heading) == ("ceramic thickness, mm", "ballistic limit, m/s")
    assert some(panel, Line)[0].y == pytest.approx([500.0, nan], nan_ok=True)
    assert chart.note == "1 of 2 rows have no ballistic limit."
    assert panel.x.limits is not None
    assert panel.x.limits[1] > 6.0


def test_a_sweep_over_names_has_rows_and_one_over_names_and_numbers_curves():
    names, limits = ["AD85", "AD85", "Al-N", "Al-N"], np.array([5.0, 7.0, 6.0, np.nan])
    columns = {"armour.ceramic": np.array(names), CERAMIC: np.array([4.0, 6.0] * 2), "ballistic_limit_m_s": limits}
    [panel] = sweep_view.sweep_chart(columns, ["armour.ceramic", CERAMIC], "ballistic_limit_m_s", scenario()).panels
    lines = {line.label: line.y for line in some(panel, Line)}
    assert lines == {"AD85": [5.0, 7.0], "Al-N": pytest.approx([6.0, nan], nan_ok=True)}
    columns["armour.backing"] = np.array(["a", "b"] * 2)
    for keys, ends in (
        (["armour.ceramic", "armour.backing"], {"a": [5.0, 6.0], "b": [7.0]}),
        (["armour.backing", "armour.ceramic"], {"AD85": [5.0, 7.0], "Al-N": [6.0]}),
    ):
        [panel] = sweep_view.sweep_chart(columns, keys, "ballistic_limit_m_s", scenario()).panels
        assert {item.label: item.x for item in some(panel, Points)} == ends
    first = {key: values[::2] for key, values in columns.items()}
    [panel] = sweep_view.sweep_chart(first, ["armour.ceramic"], "ballistic_limit_m_s", scenario()).panels
    assert (panel.y.categories, list(some(panel, Points)[0].x)) == (("AD85", "Al-N"), [5.0, 6.0])


@pytest.mark.parametrize("keys", [(CERAMIC, BACKING), (BACKING, CERAMIC)])
def test_a_sweep_over_both_thicknesses(keys: tuple[str, str]):
    chart = sweep_view.sweep_chart(table(*keys), keys, "ballistic_limit_m_s", scenario())
    [panel] = chart.panels
    [colours] = some(panel, Map)
    assert np.asarray(colours.z).tolist() == [[405.0, 605.0, 805.0], [407.0, 607.0, 807.0]]
    limits, areal = some(panel, Contours)
    thickness = dict(zip(keys, (4.0, 5.0), strict=True))
    assert areal.z[0][0] == pytest.approx(scenario().replaced(thickness).areal_density_kg_m2())
    assert limits.label == ""
    assert areal.label == "lines of equal areal density, kg/m²"
    first, second = (quantity_axis(key).label.removesuffix(" thickness") for key in keys)
    assert chart.title == f"Ballistic limit over {first} and {second} thickness: 405 to 807 m/s"


def test_a_front_over_three_criteria_says_what_is_not_drawn():
    criteria = ("areal_density_kg_m2", "cost_per_m2", "margin_m_s")
    front = tuple(replace(design, margin_m_s=5.0) for design in design_result(pareto=True).pareto)
    found = replace(design_result(pareto=True), criteria=criteria, pareto=front)
    note = "Designs that others beat in both criteria drawn are better in margin by the model."
    assert note in design_view.pareto_chart(found).note
    assert note not in design_view.pareto_chart(replace(found, criteria=criteria[:2])).note
