import warnings
from dataclasses import replace
from itertools import combinations
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.contour import ContourSet
from matplotlib.transforms import Bbox

from armour.design.optimise import optimise
from armour.reporting.charts import PALETTE, Axis, Chart, Contours, Line, Map, Panel, Points, printable_chart
from armour.reporting.draw import METADATA, draw, rendered
from armour.reporting.views import design as design_view
from armour.reporting.views import impact as impact_view
from armour.reporting.views import uncertainty as uncertainty_view
from tests.helpers.cases import scenario, shipped_scenario
from tests.helpers.results import impact, uncertainty_result

pytestmark = pytest.mark.slow

MAGIC = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
GRID = [4.0, 6.0, 8.0], [5.0, 7.0]
VALUES: list[list[float | None]] = [[0.0, 30.0, 60.0], [20.0, None, 80.0]]


def one(*series, **panel) -> Chart:
    """A chart of one panel."""
    return Chart("T", (Panel(Axis("length", "mm"), panel.pop("y", Axis("mass", "g")), series, **panel),))


CHARTS = {
    "impact": lambda: impact_view.chart(impact()),
    "design": lambda: design_view.chart(optimise(shipped_scenario("catalogue"))),
    "uncertainty": lambda: uncertainty_view.chart(uncertainty_result().of(scenario=scenario(velocity=700.0))),
    "map": lambda: one(Map(*GRID, VALUES, "speed, m/s"), Contours(*GRID, VALUES)),
    "rows": lambda: one(
        Points([1.0, -1.0], [0.0, 1.0], x_ends=((0.0, 1.0), (-1.0, 0.0)), label="one"),
        Points([2.0], [0.0], label="two"),
        y=Axis(categories=("first", "second with a name that takes two lines")),
    ),
}


@pytest.fixture(params=CHARTS)
def chart(request: pytest.FixtureRequest) -> Chart:
    made: Chart = CHARTS[request.param]()
    return made


def test_an_interval_need_not_contain_its_point():
    """Only the bar of a point that is drawn is drawn."""
    points = Points([1.0, 9.0, 5.0], [1.0, 2.0, 3.0], x_ends=((2.0, 4.0), (8.0, 10.0), (4.0, 5.5)))
    axes = draw(Chart("T", (Panel(Axis("a", limits=(0.0, 6.0)), Axis("b"), (points,)),))).axes[0]
    [bars] = [item for item in axes.collections if isinstance(item, LineCollection)]
    assert [[x for x, _ in ends] for ends in bars.get_segments()] == [[2.0, 4.0], [4.0, 5.5]]


@pytest.mark.parametrize("suffix", METADATA)
def test_the_same_chart_is_the_same_file(suffix: str):
    chart = CHARTS["rows"]()
    content = rendered(chart, suffix)
    assert content.startswith(MAGIC[suffix])
    assert content == rendered(chart, suffix)


def test_no_text_is_cut_and_no_panel_overlaps_another_or_the_legend(chart: Chart):
    figure = draw(chart)
    figure.draw_without_rendering()
    whole = figure.get_tightbbox()
    width, height = figure.get_size_inches()
    assert whole.x0 > -0.02
    assert whole.y0 > -0.02
    assert whole.x1 < width + 0.02
    assert whole.y1 < height + 0.02
    boxes = [axes.get_tightbbox() for axes in figure.axes] + [legend.get_window_extent() for legend in figure.legends]
    for first, second in combinations(boxes, 2):
        assert first is not None
        assert second is not None
        shared = Bbox.intersection(first, second)
        assert shared is None or min(shared.width, shared.height) < 2.0


def test_the_name_of_a_line_has_its_colour_unless_that_is_pale():
    lines = [Line([0.0, 1.0], [y, y], label=colour, colour=colour) for y, colour in enumerate(("blue", "orange"))]
    figure = draw(one(*lines))
    found = {text.get_text(): text.get_color() for text in figure.axes[0].texts}
    assert found["blue"] == PALETTE["blue"]
    assert found["orange"] == PALETTE["ink"]


def test_points_that_are_missing_take_no_room():
    places = []
    for missing in ([], [None]):
        panel = one(Points([1.0, 2.0], [3.0, 4.0]), Points(missing, missing, label="none")).panels[0]
        figure = draw(Chart("T", (panel, panel)))
        figure.draw_without_rendering()
        places.append([axes.get_position().bounds for axes in figure.axes])
    alone = draw(Chart("T", (replace(panel, series=panel.series[:1]),) * 2))
    alone.draw_without_rendering()
    assert places == [[axes.get_position().bounds for axes in alone.axes]] * 2


def test_the_name_of_a_point_at_the_lower_edge_is_above_it():
    axis = Axis("length", "mm", limits=(0.0, 1.0))
    figure = draw(one(Points([0.5, 0.5], [0.0, 0.9], filled=False, names=("low", "high")), y=axis))
    [low, high] = figure.axes[0].texts
    assert (low.get_verticalalignment(), high.get_verticalalignment()) == ("bottom", "top")


def test_categories_are_rows_with_the_first_on_top():
    [axes] = draw(CHARTS["rows"]()).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == [
        "first",
        "second with a name\nthat takes two lines",
    ]
    assert axes.get_ylim()[0] > axes.get_ylim()[1]
    assert [line.get_ydata().tolist() for line in axes.lines if line.get_label() == "one"] == [[0.0, 1.0]]  # type: ignore[union-attr]


def stage_names(axes: Axes) -> list[list[str]]:
    codes = [stage.stage for stage in impact().stages]
    lines = [text.get_text().splitlines() for text in axes.texts]
    return [words for words in lines if words and words[0] in codes]


def test_stages_are_named_where_there_is_room():
    chart = impact_view.chart(impact())
    wide = stage_names(draw(chart).axes[1])
    assert [code for code, *_ in wide] == [stage.stage for stage in impact().stages]
    assert ["ii.1", "fragmented ceramic"] in wide
    narrow = stage_names(draw(chart, 1.5).axes[1])
    assert 0 < len(narrow) < len(impact().stages)


@pytest.mark.parametrize("width", [3.5, 5.2])
def test_names_stand_beside_their_lines_and_on_no_other(width: float):
    x = [0.0, 1.0, 2.0, 3.0]
    steep, flat = Line(x, [0.0, 3.0, 6.0, 9.0], label="steep"), Line(x, [4.0, 4.0, 4.0, 4.0], "--", label="flat")
    few, near = Points([1.0], [8.0], label="few"), Line(x, [4.05, 4.05, 4.05, 4.05], label="near")
    figure = draw(one(steep, flat, few), width)
    [axes] = figure.axes
    assert not figure.legends
    assert {text.get_text() for text in axes.texts} == {"steep", "flat", "few"}
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in axes.texts]
    assert not [pair for pair in combinations(boxes, 2) if Bbox.intersection(*pair) is not None]
    for box in boxes:
        assert axes.bbox.contains(box.x0, box.y0)
        assert axes.bbox.contains(box.x1, box.y1)
        for line in (steep, flat):
            across = np.linspace(0.0, 3.0, 99)
            curve = np.column_stack([across, np.interp(across, x, np.array(line.y, float))])
            assert not box.count_contains(axes.transData.transform(curve))
    # Lines that cannot be told apart by a place have a legend.
    [legend] = draw(one(steep, flat, near), width).legends
    assert "near" in [text.get_text() for text in legend.get_texts()]


def test_the_title_is_the_answer_above_what_it_is_about():
    chart = replace(CHARTS["rows"](), title="answer").about(["armour and round", "scenario"])
    figure = draw(chart)
    assert figure.get_suptitle().strip() == "answer"
    assert "armour and round" in [text.get_text() for text in figure.texts]
    assert draw(replace(chart, title="", subject="").about(["armour"])).get_suptitle() == "armour"


def test_no_text_is_markup():
    text = "_ $\\frac{1}{0}$ <&>"
    points = Points([1.0], [0.0], label=text)
    panel = Panel(Axis(text, text), Axis(text, categories=(text,)), (points,), title=text)
    root = ElementTree.fromstring(rendered(Chart(text, (panel,), text), ".svg"))
    shown = ["".join(element.itertext()).strip() for element in root.iter("{http://www.w3.org/2000/svg}text")]
    # Title, note, legend, category, y axis and panel; the x axis has its unit as well.
    assert shown.count(text) == 6
    assert f"{text}, {text}" in shown


def test_no_line_ends_between_a_number_and_its_unit():
    for length in range(40, 80, 4):
        lines = draw(replace(CHARTS["rows"](), title=f"{length * 'a'} 6.35 mm")).get_suptitle().splitlines()
        assert lines[-1].endswith("6.35 mm")


def test_control_characters_are_escaped():
    chart = one(Line([0.0, 1.0], [0.0, 1.0], label="a\x08b", text=("one\ntwo\x00", "")))
    [item] = printable_chart(chart).panels[0].series
    assert isinstance(item, Line)
    assert (item.label, item.text) == ("a\\x08b", ("one\ntwo\\x00", ""))
    assert item.x == [0.0, 1.0]
    assert b"a\\x08b" in rendered(chart, ".svg")


def test_every_contour_has_a_label_apart_from_the_others():
    x = y = [float(i) for i in range(2, 13)]
    limits: list[list[float | None]] = [[200.0 * (a * b) ** 0.4 for a in x] for b in y]
    masses: list[list[float | None]] = [[3.4 * a + 2.7 * b for a in x] for b in y]
    contours = Contours(x, y, limits, levels=8, label="l"), Contours(x, y, masses, "dashed", 5, label="m")
    figure = draw(one(Map(x, y, limits, "speed, m/s"), *contours))
    figure.draw_without_rendering()
    axes = figure.axes[0]
    drawn = [lines for lines in axes.collections if isinstance(lines, ContourSet)]
    shown = {f"{level:g}" for lines in drawn for level in lines.levels}
    assert len(shown) > 8
    assert {text.get_text() for text in axes.texts} == shown
    boxes = [text.get_window_extent() for text in axes.texts]
    assert not [pair for pair in combinations(boxes, 2) if Bbox.intersection(*pair) is not None]
    [legend] = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["l", "m"]


def test_a_flat_map_has_no_contours():
    flat = [[1.0, 1.0, 1.0], [1.0, 1.0, 1.0]]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rendered(one(Map(*GRID, flat, "speed, m/s")), ".png")
