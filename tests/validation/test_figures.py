from pathlib import Path

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.impact import simulate
from armour.scenario.scenario import load_scenario
from armour.validation.figures import Figure, compute_figure, paper_figures, read_figures
from tests.helpers.cases import scenario

FIGURES = """
[[figure]]
name = "f"
title = "T"
scenario = "wilkins.toml"
over = ["armour.ceramic_thickness_mm", "armour.backing_thickness_mm"]
range = { min = 4.0, max = 8.0, step = 2.0 }
quantities = ["residual_velocity_m_s"]
x_label = "each, mm"
y_label = "residual velocity, m/s"
curve = [{ label = "A" }, { label = "B", set = { armour = { ceramic = "AD99.5" } } }]
mark = [{ label = "printed", points = [[5.0, 100.0], [6.0, 50.0]] }]
level = [{ label = "here", value = 10.0 }]
"""


def computed(folder: Path, text: str) -> Figure:
    (folder / "figures.toml").write_text(text)
    [section] = read_figures(folder / "figures.toml")
    return compute_figure(section, folder)


def test_curves_are_the_quantity_over_the_keys(folder: Path):
    found = computed(folder, FIGURES)
    assert found.x == (4.0, 6.0, 8.0)
    assert list(found.curves) == ["A", "B"]
    for values, ceramic in zip(found.curves.values(), ("AD85", "AD99.5"), strict=True):
        cases = [scenario(ceramic=ceramic, ceramic_mm=thickness, backing_mm=thickness) for thickness in found.x]
        assert values == tuple(simulate(case).residual_velocity_m_s for case in cases)


def test_quantities_may_be_divided_and_the_abscissa_moved(folder: Path):
    plain = computed(folder, FIGURES)
    moved = computed(folder, FIGURES.replace("x_label", "add_to_x = 8.0\ndivide_by = 800.0\nx_label"))
    assert moved.x == (12.0, 14.0, 16.0)
    assert [[value * 800.0 for value in values if value is not None] for values in moved.curves.values()] == [
        pytest.approx(values) for values in plain.curves.values()
    ]


def test_a_curve_has_a_gap_where_there_is_no_answer(folder: Path):
    text = FIGURES.replace("residual_velocity_m_s", "ballistic_limit_m_s")
    text = text.replace('{ label = "A" }', '{ label = "A", set = { ballistic_limit = { velocity_max_m_s = 700.0 } } }')
    limit = ballistic_limit(scenario(ceramic_mm=4.0, backing_mm=4.0)).ballistic_limit_m_s
    first, *others = computed(folder, text).curves["A"]
    assert first == pytest.approx(limit, abs=0.01)
    assert others == [None, None]


def test_the_papers_figures_are_complete_and_their_scenarios_valid():
    path = paper_figures()
    sections = read_figures(path)
    panels = [3, 4, 5, 6, 7, 8, 9, 9, 10, 10, 11, 12, 13, 14]
    assert [section.name for section in sections] == [f"fig{number:02d}" for number in panels]
    for section in sections:
        base = load_scenario(path.parent / section.scenario)
        assert "paper" in section.scenario
        for curve in section.curve:
            base.replaced(curve.set).replaced(dict.fromkeys(section.over, section.range.max))
        for mark in section.mark:
            assert mark.of in ("", *(curve.label for curve in section.curve))
            assert all(section.range.min <= x - section.add_to_x <= section.range.max for x, _ in mark.points)


@pytest.mark.parametrize(
    ("name", "tolerance", "marks"),
    [
        ("fig05", 0.4, 1),
        ("fig07", 0.5, 1),
        ("fig06", 4.0, 1),
        ("fig08", 16.0, 1),
        ("fig09", 0.02, 4),
        ("fig10", 0.05, 4),
    ],
)
def test_curves_pass_near_the_numbers_of_the_papers_text(name: str, tolerance: float, marks: int):
    path, found = paper_figures(), 0
    for section in [section for section in read_figures(path) if section.name == name]:
        for mark in section.mark:
            for x, y in mark.points:
                ends = dict.fromkeys(("min", "max"), x - section.add_to_x)
                at = section.model_copy(update={"range": section.range.model_copy(update=ends)})
                figure = compute_figure(at, path.parent)
                assert figure.x == (x,)
                assert figure.curves[mark.of][0] == pytest.approx(y, abs=tolerance)
                found += 1
    assert found == marks
