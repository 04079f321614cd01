import itertools
import re
from math import dist
from xml.etree import ElementTree

import pytest

from armour.reporting.charts import PALETTE, Axis, Bars, Chart, Line, Panel, Points, Spans
from armour.reporting.draw import draw
from armour.reporting.html import MAX_POINTS, inline_svg
from armour.reporting.views import design as design_view
from armour.reporting.views import impact as impact_view
from tests.helpers.results import design_result, impact

SVG = "{http://www.w3.org/2000/svg}"


def one(*series, **panel) -> Chart:
    """A chart of one panel."""
    y = panel.pop("y", Axis("mass", "g", limits=(0.0, 10.0)))
    return Chart("T", (Panel(Axis("length", "mm", limits=(0.0, 10.0)), y, series, **panel),))


def words(chart: Chart) -> list[str]:
    """Texts shown on hover."""
    root = ElementTree.fromstring(inline_svg(chart, "c"))
    return ["\n".join(text.itertext()) for text in root.findall(f"{SVG}g[@class='point']/{SVG}text")]


def circles(chart: Chart) -> list[tuple[float, float]]:
    root = ElementTree.fromstring(inline_svg(chart, "c"))
    found = root.findall(f"{SVG}g[@class='point']/{SVG}circle")
    return [(float(circle.attrib["cx"]), float(circle.attrib["cy"])) for circle in found]


def test_points_tell_their_values_with_units():
    chart = one(Points([2.0, 4.0], [3.25, 123.456], label="p"), Points([5.0], [5.0], text=("first\nsecond",)))
    assert words(chart) == ["p: 3.25 g\nlength 2 mm", "first\nsecond"]  # the other is outside the axes


def test_points_are_where_they_are_drawn():
    """Markers of matplotlib and circles have the same place."""
    chart = one(Points([2.0, 4.0], [3.0, 7.0], label="p", colour="vermilion"))
    root = ElementTree.fromstring(inline_svg(chart, "c"))
    markers = [use for use in root.iter(f"{SVG}use") if PALETTE["vermilion"] in use.attrib["style"]]
    drawn = [(float(use.attrib["x"]), float(use.attrib["y"])) for use in markers]
    for circle, marker in zip(circles(chart), drawn[:2], strict=True):
        assert dist(circle, marker) < 0.2


def test_points_of_a_curve_keep_a_distance_and_are_bounded():
    x = [i / 1000.0 for i in range(10_001)]
    curve, zigzag = one(Line(x, x)), one(Line(x, [10.0 * (i % 2) for i in range(10_001)]))
    found = circles(curve)
    assert 40 < len(found) < MAX_POINTS
    assert min(dist(a, b) for a, b in itertools.pairwise(found)) > 3.8
    assert len(circles(zigzag)) == MAX_POINTS


def test_bars_and_spans_have_their_words():
    bars = Bars([0.0, 0.0, 0.0], [4.0, None, 0.0], text=("one", "two", "three"))
    assert words(one(bars, y=Axis(categories=("a", "b", "c")))) == ["one"]
    values = Bars([0.0, 1.0], [4.0, 2.5], label="made")
    assert words(one(values, y=Axis(categories=("a", "b")))) == ["a\nmade: length 4 mm", "b\nmade: length 2.5 mm"]
    spans = Spans([0.0, 5.0], [5.0, 10.0], ("i", "ii"), text=("stage i", "stage ii"))
    assert words(one(spans)) == ["stage i", "stage ii"]


def test_gaps_have_no_point():
    assert len(words(one(Line([1.0, 2.0, 3.0], [1.0, None, 9.0])))) == 2


def test_colours_follow_the_theme():
    content = inline_svg(impact_view.chart(impact()), "c")
    assert not [colour for colour in ("ink", "soft", "blue") if PALETTE[colour] in content]
    assert {"var(--ink)", "var(--soft)", "var(--blue)"} <= set(re.findall(r"var\(--[a-z]+\)", content))


def test_identifiers_of_two_charts_differ_and_refer_to_each_other():
    chart = impact_view.chart(impact())
    first, second = (inline_svg(chart, name) for name in ("a", "b"))
    ids = [set(re.findall(r' id="([^"]*)"', content)) for content in (first, second)]
    assert ids[0]
    assert not ids[0] & ids[1]
    for content, own in zip((first, second), ids, strict=True):
        assert set(re.findall(r"url\(#([^)]*)\)", content)) <= own
        assert set(re.findall(r'href="#([^"]*)"', content)) <= own


def test_the_same_chart_is_the_same_svg():
    chart = design_view.chart(design_result(pareto=True))
    assert inline_svg(chart, "c") == inline_svg(chart, "c")


@pytest.mark.parametrize("name", ["<!--<script>", "</svg><script>alert(1)</script>", "a\x08\x00\u2028b", "url(#x)"])
def test_names_are_text(name: str):
    chart = design_view.frontier_chart(design_result(ceramic=name))
    content = inline_svg(chart, "c")
    assert "<script" not in content
    assert "<!--" not in content
    shown = "".join(ElementTree.fromstring(content).itertext())
    assert (name if name.isprintable() else "a\\x08\\x00\\u2028b") in shown


def test_words_stay_within_the_picture():
    long = "a name of very many words " * 6
    points = Points([0.0, 5.0, 10.0], [5.0, 5.0, 10.0], text=(long,) * 3)
    root = ElementTree.fromstring(inline_svg(one(points), "c"))
    _, _, width, height = map(float, root.attrib["viewBox"].split())
    for text in root.findall(f"{SVG}g[@class='point']/{SVG}text"):
        lines = list(text.itertext())
        assert float(text.attrib["x"]) >= 0.0
        assert float(text.attrib["x"]) + 4.5 * max(map(len, lines)) <= width
        assert 0.0 < float(text.attrib["y"]) < height


def test_the_size_is_that_of_a_column():
    root = ElementTree.fromstring(inline_svg(one(Points([1.0], [1.0])), "c"))
    assert "width" not in root.attrib
    assert draw(one(Points([1.0], [1.0])), 4.2).get_figwidth() * 72.0 == pytest.approx(
        float(root.attrib["viewBox"].split()[2])
    )
