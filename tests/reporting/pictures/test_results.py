"""What the picture of each result shows."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from math import nan
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.contour import ContourSet
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.impact import simulate
from armour.design.check import check
from armour.design.optimise import DesignResult, optimise
from armour.planning.firing import plan_shots
from armour.reporting.by_result import draw, drawing_of
from armour.reporting.pictures import analysis, design, sweeps, validation
from armour.reporting.pictures.drawing import BLUE, Picture, Sheet, drawn
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.scenario import load_scenario
from armour.statistics.calibration import CalibrationResult, Residual
from armour.statistics.likelihood import Coefficient
from armour.statistics.sensitivity import Elasticity, SensitivityResult
from armour.statistics.v50 import FiringResult, Shots, v50
from armour.sweeps.sweep import SweepResult
from armour.validation.figures import Figure, FigureLine, FigureMark, FigureSection
from tests.analysis.results import impact as impact_result
from tests.design.results import best_of
from tests.helpers.cases import scenario, shipped_scenario
from tests.helpers.known import known
from tests.helpers.suites import TABLE, WILKINS_LIMIT, case, result
from tests.statistics.results import uncertainty_result

pytestmark = pytest.mark.usefixtures("not_laid_out")


def picture_of(result: Any, drawing: Callable[[Any, Sheet], Picture] = draw) -> Picture:
    """The picture of a result, with its legends."""
    return drawn(drawing_of(result) if drawing is draw else partial(drawing, result), Sheet())


def marks(axes: Axes) -> dict[str, Line2D]:
    """Points by their labels; those without one by their order."""
    return {str(line.get_label()): line for line in axes.lines if not line.get_clip_on()}


def curves(axes: Axes) -> dict[str, Line2D]:
    """Curves, and lines across the panel, by their labels."""
    return {
        str(line.get_label()): line
        for line in axes.lines
        if line.get_linestyle() != "None"
        and np.size(line.get_xdata())
        and not str(line.get_label()).startswith("_nolegend_")
    }


def x_of(line: Line2D) -> list[float]:
    return np.asarray(line.get_xdata(), float).tolist()


def y_of(line: Line2D) -> list[float]:
    return np.asarray(line.get_ydata(), float).tolist()


def labels(*panels: Axes) -> list[str]:
    """What curves, points, lines and regions are named, at their ends or in a legend."""
    return [label for axes in panels for label in axes.get_legend_handles_labels()[1]]


def headings(picture: Picture) -> list[tuple[str, str]]:
    return [(axes.get_xlabel(), axes.get_ylabel()) for axes in picture.axes]


def rows_of(axes: Axes) -> list[str]:
    return [label.get_text().replace("\n", " ") for label in axes.get_yticklabels()]


def words_in(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def test_an_impact():
    found = impact_result().of(scenario=scenario())
    picture = picture_of(found)
    assert picture.title == f"Perforated by the model: {found.residual_velocity_m_s:.0f} m/s left of 800 m/s"
    scene, velocities, lengths, depths = picture.axes
    assert [axes.get_ylabel() for axes in picture.axes[1:]] == [
        "velocity, m/s",
        "penetrator length L, mm",
        "depth, bulge, mm",
    ]
    assert depths.get_xlabel() == "time since impact, µs"
    curves_named = ["projectile V", "penetration U", "target W", "depth Z", "bulge h"]
    assert labels(*picture.axes) == ["tile", "plate", *curves_named]
    assert words_in(velocities) == [stage.stage for stage in found.stages]
    events = [words.splitlines()[2:] for words in words_in(scene) if "µs" in words]
    assert [" ".join(words) for words in events] == [
        "impact",
        "tile fragments",
        "tile penetrated",
        "plug moves along",
        "perforated",
    ]
    assert y_of(curves(velocities)["projectile V"])[0] == 800.0
    # At every end of a stage the rod is where the history has it.
    assert found.history is not None
    boxes = [patch for patch in scene.patches if isinstance(patch, Rectangle)]
    rods = [box.get_width() for box in boxes if to_hex(box.get_facecolor()) == analysis.ROD_COLOUR]
    assert rods[1:] == pytest.approx(
        [np.interp(stage.end_us, found.history.time_us, found.history.length_mm) for stage in found.stages]
    )
    assert lengths.get_ylim()[0] == 0.0


def test_the_end_of_dwell_is_named_as_that():
    words = words_in(picture_of(simulate(load_scenario("dwell"), history=True)).axes[0])
    assert [text for text in words if text.endswith("dwell ends")]
    [fragments] = [text for text in words if "fragments" in text]
    assert fragments.startswith("6.41 µs")


def test_a_long_tail_is_left_out():
    slow = simulate(scenario(ceramic_mm=12.0, velocity=300.0), history=True)
    picture = picture_of(slow)
    assert picture.title == "Stopped by the model: 5.3 mm deep"
    shown = picture.axes[-1].get_xlim()[1]
    assert shown < 0.3 * slow.duration_us
    assert picture.note.startswith(f"Drawn up to {shown:.3g} µs of {slow.duration_us:.3g} µs.")
    for axes in picture.axes[1:]:
        assert all(max(x_of(line)) <= shown for line in curves(axes).values())


OFFERED = {"ceramic_thickness_mm": {"min": 4.0, "max": 14.0, "step": 2.0}}
OFFERED["backing_thickness_mm"] = OFFERED["ceramic_thickness_mm"]


@cache
def designs(confidence: float | None = None, ceramic: str | None = "AD85") -> DesignResult:
    """Designs against one impact; a bare plate where there is no ceramic."""
    grid = OFFERED if ceramic else {**OFFERED, "ceramic_thickness_mm": {"min": 0.0, "max": 0.0, "step": 1.0}}
    name = "6061-T6" if ceramic else "AA6082-T651"
    changes = {} if confidence is None else {"design": {"probability_of_stopping": confidence}}
    velocity = 800.0 if ceramic else 300.0
    return optimise(
        scenario(ceramic=ceramic, ceramic_mm=0.0, backing=name, velocity=velocity, optimise=grid, **changes)
    )


def test_a_map_has_the_line_of_what_is_required_and_the_best_design():
    found = designs(0.9)
    axes = picture_of(found).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("plate thickness, mm", "tile thickness, mm")
    lines = [lines for lines in axes.collections if isinstance(lines, ContourSet) and not lines.filled]
    [line] = [each for each in lines if list(each.levels) == [0.0]]
    assert to_hex(np.asarray(line.get_edgecolor())[0]) == BLUE
    thicknesses = best_of(found).backing_thickness_mm, best_of(found).ceramic_thickness_mm
    assert labels(axes)[0] == "stops a shot with 90 % or more"
    assert labels(axes)[-2] == "equal areal density, kg/m²"
    assert labels(axes)[-1] == f"lightest: {thicknesses[1]:g} on {thicknesses[0]:g} mm"
    [best] = marks(axes).values()
    assert (x_of(best)[0], y_of(best)[0]) == thicknesses


def test_the_line_is_where_the_probability_is_the_required_one():
    """The lightest design lies on the side of the line on which it is stopped, its thinner neighbours on the other."""
    found = designs(0.9)
    pair_map = design._map_of(found)
    values, _, _ = pair_map.required()
    for each, stops in ((best_of(found), True), (replace(best_of(found), ceramic_thickness_mm=2.0), False)):
        by_row = [np.interp(each.backing_thickness_mm, pair_map.grid.backing_mm, row) for row in values]
        assert (np.interp(each.ceramic_thickness_mm, pair_map.grid.ceramic_mm, by_row) > -1.0) == stops


def test_without_a_required_probability_the_line_is_that_of_the_limit():
    found = designs()
    pair_map = design._map_of(found)
    values, is_stated, words = pair_map.required()
    assert words == "stops a shot with 50 % or more"
    np.testing.assert_array_equal(is_stated, ~np.isnan(pair_map.grid.untruncated_m_s[..., 0, 0]))
    np.testing.assert_array_equal(values, pair_map.shown_m_s[..., 0] - 800.0)
    by_model = found.question["scenario"].replaced({"uncertainty.model": {"included": False}})
    pair_map = design._map_of(optimise(by_model))
    values, is_stated, words = pair_map.required()
    assert (words, is_stated.all()) == ("stopped by the model", True)
    np.testing.assert_array_equal(values, pair_map.grid.limits_m_s[..., 0] - 800.0)


def test_the_line_of_several_requirements_is_where_all_are_met():
    """Where no probability as great is stated, it is not known whether a design holds."""
    required = {"design.probability_of_stopping": 0.9}
    pair_map = design._map_of(optimise(shipped_scenario("catalogue").replaced(required)))
    values, is_stated, words = pair_map.required()
    assert words == "does what is required"
    grid, catalogue = pair_map.grid, pair_map.catalogue
    by_limit = np.where(catalogue.margins_m_s > 0.0, pair_map.shown_m_s - catalogue.margins_m_s, np.inf)
    surely = grid.untruncated_m_s[..., grid.probabilities.index(0.9)]
    np.testing.assert_array_equal(values, (np.minimum(surely, by_limit) - catalogue.velocities_m_s).min(axis=-1))
    np.testing.assert_array_equal(is_stated, (grid.greatest_probability >= 0.9).all(axis=-1))


def test_designs_of_bare_plates_are_drawn_over_their_thickness():
    [axes] = picture_of(designs(0.9, None)).axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("plate thickness, mm", "expected limit, m/s")
    assert [item for item in axes.collections if isinstance(item, PolyCollection)]
    [best] = marks(axes).values()
    assert x_of(best)[0] == best_of(designs(0.9, None)).backing_thickness_mm
    assert y_of(best)[0] == pytest.approx(
        known(best_of(designs(0.9, None)).check.threats[0].expected_limit_m_s), abs=0.5
    )


def test_designs_of_which_no_probability_is_known_have_no_line_of_one():
    case = scenario(ceramic="SiC", optimise=OFFERED, design={"probability_of_stopping": 0.9})
    picture = picture_of(optimise(case))
    assert picture.note.startswith("No probability is known for these designs.")
    assert labels(*picture.axes)[:2] == ["not known", "equal areal density, kg/m²"]


def test_below_the_map_is_the_front_whose_designs_are_not_joined():
    found = optimise(shipped_scenario("catalogue"))
    front = tuple(replace(each, margin_m_s=5.0) for each in found.pareto)
    criteria = ("areal_density_kg_m2", "cost_per_m2", "margin_m_s")
    picture = picture_of(replace(found, criteria=criteria, pareto=front).of(scenario=shipped_scenario("catalogue")))
    _, axes = picture.axes
    assert (axes.get_title(), axes.get_xlabel()) == ("Pareto front", "areal density, kg/m²")
    shown = [x for label, line in marks(axes).items() if label != "lightest" for x in x_of(line)]
    assert sorted(shown) == sorted(each.areal_density_kg_m2 for each in front)
    assert not curves(axes)
    assert "Designs that others beat in both criteria drawn are better in least margin." in picture.note


def figure() -> Figure:
    curves = {"A": (1.0, None, 9.0), "B": (2.0, 3.0, 4.0)}
    printed = FigureMark(label="printed", of="B", points=[[5.0, 3.0]], x_ends=[[4.5, 5.5]])
    marks = [printed, FigureMark(label="another", points=[[6.0, 2.0]])]
    levels = [FigureLine(label="L", value=5.0)]
    words: dict[str, Any] = {"title": "T", "x_label": "each, mm", "y_label": "residual velocity, m/s"}
    section = FigureSection.model_construct(mark=marks, level=levels, **words)
    return Figure(section, (4.0, 6.0, 8.0), curves)


def test_a_figure_of_the_paper():
    picture = drawn(partial(validation.draw_figure, [figure()]), Sheet())
    [axes] = picture.axes
    assert labels(axes) == ["A", "B", "L", "printed", "another"]
    assert headings(picture) == [("each, mm", "residual velocity, m/s")]
    assert axes.get_xlim() == (4.0, 8.0)
    assert axes.get_ylim()[0] == 0.0
    printed, another = marks(axes).values()
    assert printed.get_color() == curves(axes)["B"].get_color()
    assert another.get_color() not in [line.get_color() for line in curves(axes).values()]
    assert len(axes.containers) == 1  # the range of one of them


def test_parity_of_the_tables_of_a_suite(folder):
    picture = picture_of(result(folder, TABLE + case("own", 700.0, "band = 100.0")))
    [axes] = picture.axes
    points = marks(axes)["t"]
    assert headings(picture) == [("expected ballistic limit, m/s", "computed ballistic limit, m/s")]
    assert x_of(points) == [720.0, 730.0]
    assert y_of(points) == pytest.approx([WILKINS_LIMIT] * 2)
    assert axes.get_xlim() == axes.get_ylim()
    assert axes.get_aspect() == 1.0
    assert labels(axes) == ["t", "agreement", "± 10 %"]
    assert picture.note.startswith("1 of 3 cases are not shown")


def calibrated() -> CalibrationResult:
    residuals = [
        Residual(f"test {i}", "ballistic_limit_m_s", 700.0 + 10.0 * i, 705.0 + 9.0 * i, 707.0 + 9.0 * i, "")
        for i in range(3)
    ]
    residuals.append(Residual("bound", "ballistic_limit_m_s", 690.0, 700.0, None, "at least"))
    fit = (Coefficient("ceramic.flow_stress_GPa", 5.2, (4.9, 5.5)),)
    return CalibrationResult("t.csv", "", "relative", fit, (), tuple(residuals), 1.0, 2.0, 1, 0.1, 8, 8, 0.95)


def test_a_calibration():
    picture = picture_of(calibrated())
    [axes] = picture.axes
    assert picture.title == "Ceramic flow stress 5.2 GPa (95 % between 4.9 and 5.5)"
    assert headings(picture) == [("measured ballistic limit, m/s", "computed ballistic limit, m/s")]
    assert labels(axes) == ["tests", "stopped at", "agreement", "± 10 %"]
    assert (x_of(marks(axes)["tests"])[0], y_of(marks(axes)["tests"])[0]) == (700.0, 705.0)


def test_a_calibration_to_tests_with_uncertainties_has_error_bars():
    found = calibrated()
    assert picture_of(found).note == ""
    first, *others = found.residuals
    picture = picture_of(replace(found, residuals=(replace(first, uncertainty=30.0), *others)))
    parity = picture.axes[0]
    [bars] = parity.containers
    assert bars.lines[2][0].get_segments()[0][:, 0].tolist() == [670.0, 730.0]  # type: ignore[attr-defined]
    assert parity.get_xlim()[0] < 670.0
    assert "one standard deviation" in picture.note


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
    picture = picture_of(found)
    limit, residual = picture.axes
    assert rows_of(limit) == ["tile thickness", "ceramic flow stress", "impact velocity"]
    assert (limit.get_title(), residual.get_title()) == ("ballistic limit", "residual velocity")
    assert [x_of(line) for axes in picture.axes for line in marks(axes).values()] == [[-0.6, 0.5, 0.0], [-0.4, 1.7]]
    assert picture.title == "The limit by the model, 700 m/s, depends most on the tile thickness"


VELOCITIES = (700.0, 710.0, 715.0, 720.0, 725.0, 730.0)
SHOTS = Shots(VELOCITIES, (False, False, True, False, True, True), "folder/shots.csv")


@cache
def fired(**changes: Any) -> FiringResult:
    """The V50 of these shots with the limit by the model, with changes."""
    return replace(fired(), **changes).of(shots=SHOTS) if changes else v50(SHOTS, scenario())


def test_a_v50():
    found = fired()
    picture = picture_of(found)
    axes = picture.axes[0]
    assert f"limit by the model {WILKINS_LIMIT:.1f} m/s" in labels(axes)
    assert x_of(marks(axes)["stopped"])[0] == 700.0
    assert x_of(marks(axes)["perforated"])[0] == 715.0
    [curve] = [y_of(line) for label, line in curves(axes).items() if "probit" in label]
    assert (np.diff(curve) >= 0.0).all()
    assert [item for item in axes.collections if isinstance(item, PolyCollection)]
    assert found.recommended is not None
    assert axes.containers == []
    lower = fired(confidence=0.8, recommended=v50(SHOTS, confidence=0.8).recommended)
    [bars] = picture_of(lower).axes[0].containers
    ends = bars.lines[2][0].get_segments()[0][:, 0].tolist()  # type: ignore[attr-defined]
    assert ends == pytest.approx(known(lower.recommended).v50_interval_m_s)


def test_the_axis_of_a_v50_has_the_requirement_and_the_limit_by_the_model():
    [axes] = picture_of(fired(requirement_m_s=600.0, requirement_fraction=0.05, decision="not decided")).axes
    assert "not decided: V05 required 600.0 m/s" in labels(axes)
    assert f"limit by the model {WILKINS_LIMIT:.1f} m/s" in labels(axes)
    [axes] = picture_of(fired(model_ballistic_limit_m_s=950.0)).axes
    assert "limit by the model 950.0 m/s" in labels(axes)


def test_the_posterior_of_a_v50_is_drawn():
    found = v50(SHOTS, scenario(), prior=True)
    picture = picture_of(found)
    axes = picture.axes[0]
    assert found.posterior is not None
    [bar] = [line for label, line in marks(axes).items() if "posterior" in label]
    assert x_of(bar) == [found.posterior.v50_m_s]
    low, high = axes.get_xlim()
    assert low < found.posterior.v50_interval_m_s[0] < found.posterior.v50_interval_m_s[1] < high


def test_an_uncertainty_without_a_known_probability_draws_what_is_given_and_calls_it_so():
    picture = picture_of(uncertainty_result(known=False).of(scenario=scenario(velocity=700.0)))
    assert picture.title.startswith("Not known: ")
    assert picture.title.endswith("; with the model taken as exact 79.0 %")
    assert picture.axes[0].get_ylabel() == "stopped, with the model taken as exact"


def test_an_uncertainty():
    picture = picture_of(uncertainty_result().of(scenario=scenario(velocity=700.0)))
    curve, swings = picture.axes
    assert "79.0 % at 700 m/s" in labels(curve)
    assert picture.title == "Stops a shot of 7.62 mm AP at 700 m/s with 79.0 % (± 1 by sampling)"
    assert rows_of(swings) == ["ceramic flow stress", "penetrator mass"]
    assert [x_of(line) for line in marks(swings).values()] == [[677.0, 729.0], [769.0, 718.0]]
    low, high = curve.get_xlim()
    assert 640.0 < low < 677.0
    assert 770.0 < high < 810.0


def table(*keys: str) -> dict[str, Any]:
    first, second = (values.ravel() for values in np.meshgrid([4.0, 6.0, 8.0], [5.0, 7.0], indexing="ij"))
    answer = 100.0 * first + second
    return {keys[0]: first, keys[1]: second, "ballistic_limit_m_s": answer}


def sweep_picture(columns: dict[str, Any], *keys: str) -> Picture:
    result = SweepResult(scenario(), keys, ("ballistic_limit_m_s",), len(columns[keys[0]]), None, (), columns)
    return drawn(lambda sheet: sweeps.draw_sweep(result.of(changed="crack_velocity changed"), sheet), Sheet())


def test_a_sweep_over_one_key():
    columns = {CERAMIC: np.array([4.0, 6.0]), "ballistic_limit_m_s": np.array([500.0, np.nan])}
    picture = sweep_picture(columns, CERAMIC)
    [axes] = picture.axes
    assert picture.title == "Ballistic limit over tile thickness"
    assert headings(picture) == [("tile thickness, mm", "ballistic limit, m/s")]
    [curve] = curves(axes).values()
    assert y_of(curve) == pytest.approx([500.0, nan], nan_ok=True)
    outside = "1 of 2, hollow and dashed, are far from the tests."
    assert picture.note == f"1 of 2 rows have no ballistic limit. Computed with crack_velocity changed. {outside}"
    assert axes.get_xlim()[1] > 6.0


@pytest.mark.parametrize("keys", [(CERAMIC, BACKING), (BACKING, CERAMIC)])
def test_a_sweep_over_both_thicknesses(keys: tuple[str, str]):
    picture = sweep_picture(table(*keys), *keys)
    [axes] = picture.axes
    [colours] = [item for item in axes.collections if isinstance(item, QuadMesh)]
    assert np.asarray(colours.get_array()).ravel().tolist() == [405.0, 605.0, 805.0, 407.0, 607.0, 807.0]
    [limits] = [lines for lines in axes.collections if isinstance(lines, ContourSet)]
    assert 405.0 < min(limits.levels) < max(limits.levels) < 807.0
    words = {CERAMIC: "tile", BACKING: "plate"}
    over = f"{words[keys[0]]} thickness and {words[keys[1]]} thickness"
    assert picture.title == f"Ballistic limit over {over}"


FIVE = Shots((700.0, 720.0, 760.0, 710.0, 740.0), (False, True, True, False, False), "f.csv")


def test_prior_posterior_shots_and_the_next_velocity():
    plan = plan_shots(scenario(), FIVE)
    picture = picture_of(plan)
    assert picture.title == f"Fire at {plan.next_velocity_m_s:.1f} m/s"
    density, response = picture.axes
    prior, posterior, following = curves(density).values()
    assert max(y_of(posterior)) > max(y_of(prior))
    assert {label: x_of(line) for label, line in marks(response).items()} == {
        "stopped": [700.0, 710.0, 740.0],
        "perforated": [720.0, 760.0],
    }
    assert set(x_of(following)) == {plan.next_velocity_m_s}


def test_without_a_model_error_the_prior_is_no_models():
    unknown = scenario(uncertainty={"model": {"included": False}})
    plan = plan_shots(unknown, FIVE, procedure="up-and-down", half_width_m_s=100.0, requirement_m_s=730.0)
    shown = labels(*picture_of(plan).axes)
    assert {"prior", "requirement 730.0 m/s"} <= set(shown)


def test_titles_and_notes_of_pictures_say_what_the_model_cannot_do():
    thin = scenario("12.7 mm APM2", "SiC", "6061-T6", 3.0, 40.0, velocity=500.0)
    tiles = {"ceramic": [{"material": "SiC", "thickness_mm": [3.0]}]}
    metals = [{"material": name, "thickness_mm": [40.0, 45.0]} for name in ("6061-T6", "7075-T6")]
    of_metals = picture_of(optimise(thin.replaced({"design": {**tiles, "backing": metals}})))
    found = simulate(thin, history=True), ballistic_limit(thin), check(thin)
    for picture in (*map(picture_of, found), of_metals):
        assert (
            "Far from the tests: SiC (no test), 3 mm tile (tested 9.7 to 13.2 mm, scaled to this round)" in picture.note
        )
    assert "limit by the model" in marks(picture_of(check(thin)).axes[0])
    library = {"metal": {"X": {"density_kg_m3": 980.0, "static_yield_strength_MPa": 900.0}}}
    laminate = simulate(scenario("7.62 mm AP", "AD85", "X", 8.0, 15.0, library=library), history=True)
    assert picture_of(laminate).title.startswith("Not known: a back plate of 980 kg/m³")
