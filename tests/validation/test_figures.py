from pathlib import Path

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.impact import simulate
from armour.errors import InputError
from armour.reporting.plots import chart_figure, parity_figure
from armour.reporting.tables import chart_csv, parity_csv
from armour.scenario.loading import load_scenario
from armour.validation.figures import Chart, chart, charts, paper_figures, parity_of_table_3, read_figures
from armour.validation.validate import SuiteResult, validate
from tests.cases import SCENARIOS, scenario
from tests.validation.test_validate import TABLE, load

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


def drawn(folder: Path, text: str) -> Chart:
    (folder / "figures.toml").write_text(text)
    (folder / "wilkins.toml").write_text((SCENARIOS / "wilkins.toml").read_text())
    [section] = read_figures(folder / "figures.toml")
    return chart(section, folder, {})


def test_curves_are_the_quantity_over_the_keys(tmp_path: Path):
    found = drawn(tmp_path, FIGURES)
    assert found.x == (4.0, 6.0, 8.0)
    first, second = found.curves
    assert (first.label, second.label) == ("A", "B")
    for thickness, value in zip(found.x, first.values, strict=True):
        there = scenario(ceramic_mm=thickness, backing_mm=thickness)
        assert value == simulate(there).residual_velocity_m_s
    assert (
        second.values[0] == simulate(scenario(ceramic="AD99.5", ceramic_mm=4.0, backing_mm=4.0)).residual_velocity_m_s
    )


def test_several_quantities_go_by_their_names(tmp_path: Path):
    two = FIGURES.replace('"residual_velocity_m_s"', '"velocity_lost_percent", "mass_lost_percent"')
    labels = [curve.label for curve in drawn(tmp_path, two).curves]
    assert labels == ["A, velocity lost", "A, mass lost", "B, velocity lost", "B, mass lost"]
    alone = two.replace('curve = [{ label = "A" }, { label = "B", set = { armour = { ceramic = "AD99.5" } } }]', "")
    assert [curve.label for curve in drawn(tmp_path, alone).curves] == ["velocity lost", "mass lost"]


def test_where_there_is_no_answer_the_curve_has_a_gap(tmp_path: Path):
    text = FIGURES.replace("residual_velocity_m_s", "ballistic_limit_m_s")
    text = text.replace('{ label = "A" }', '{ label = "A", set = { ballistic_limit = { velocity_max_m_s = 700.0 } } }')
    found = drawn(tmp_path, text)
    limit = ballistic_limit(scenario(ceramic_mm=4.0, backing_mm=4.0)).ballistic_limit_m_s
    first, *others = found.curves[0].values
    assert first == pytest.approx(limit, abs=0.01)
    assert others == [None, None]
    assert chart_csv(found).splitlines()[-1].startswith("8.0,,")
    chart_figure(found)


def test_a_chart_shows_curves_marks_and_levels(tmp_path: Path):
    figure = chart_figure(drawn(tmp_path, FIGURES))
    [axes] = figure.axes
    assert [line.get_label() for line in axes.lines] == ["A", "B", "here", "printed"]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("each, mm", "residual velocity, m/s")
    assert axes.get_ylim()[0] == 0.0
    [legend] = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["A", "B", "here", "printed"]


def test_a_chart_as_csv(tmp_path: Path):
    lines = chart_csv(drawn(tmp_path, FIGURES)).splitlines()
    assert lines[0] == '"each, mm","A: residual velocity, m/s","B: residual velocity, m/s"'
    assert len(lines) == 4


def test_a_mistake_in_a_file_of_figures(tmp_path: Path):
    with pytest.raises(InputError, match="must name quantities, found speed"):
        drawn(tmp_path, FIGURES.replace("residual_velocity_m_s", "speed"))


def test_the_papers_figures_are_all_there_and_their_scenarios_hold():
    path = paper_figures()
    sections = read_figures(path)
    assert [section.name for section in sections] == [f"fig{number:02d}" for number in range(3, 15)]
    for section in sections:
        base = load_scenario(path.parent / section.scenario)
        assert "paper" in section.scenario
        for curve in section.curve:
            base.replaced(curve.set).replaced(dict.fromkeys(section.over, section.range.max))
        for mark in section.mark:
            assert mark.of in ("", "velocity lost", "mass lost")
            assert all(section.range.min <= x <= section.range.max for x, _ in mark.points)


def test_what_two_figures_share_is_computed_once(monkeypatch: pytest.MonkeyPatch):
    import armour.analysis.quantities
    from armour.analysis.least_thickness import least_ceramic

    asked = []

    def counted(*args):
        asked.append(args)
        return least_ceramic(*args)

    monkeypatch.setattr(armour.quantities, "least_ceramic", counted)
    path = paper_figures()
    chosen = [s for s in read_figures(path) if s.name in ("fig05", "fig07")]
    coarse = [s.model_copy(update={"range": s.range.model_copy(update={"step": 4.0})}) for s in chosen]
    thickness, density = charts(coarse, path.parent)
    assert len(asked) == 4
    ceramic, areal = thickness.curves[0].values, density.curves[0].values
    for backing, h, d in zip(thickness.x, ceramic, areal, strict=True):
        assert h is not None
        assert d == pytest.approx(3.43 * h + 2.75 * backing)


@pytest.fixture
def tables(folder: Path) -> SuiteResult:
    return validate(load(folder, TABLE))


def test_parity_of_tables(tables: SuiteResult):
    [axes] = parity_figure(tables).axes
    limit = ballistic_limit(scenario()).ballistic_limit_m_s
    points = axes.lines[0]
    assert list(points.get_xdata()) == [720.0, 730.0]  # type: ignore[arg-type]
    assert list(points.get_ydata()) == [limit, limit]  # type: ignore[arg-type]
    assert axes.get_xlim() == axes.get_ylim()
    assert parity_csv(tables).splitlines()[1].startswith("t,ceramic thickness 6.35 mm,ballistic_limit_m_s,720.0,723.77")


def test_parity_is_of_the_three_columns_of_table_3(monkeypatch: pytest.MonkeyPatch):
    import armour.validation.figures

    monkeypatch.setattr(armour.figures, "validate", lambda suite: suite)
    suite = parity_of_table_3()
    assert len(suite.cases) == 39  # type: ignore[attr-defined]
