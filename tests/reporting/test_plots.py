import numpy as np
import pytest
from armour.design.optimisation import optimise
from matplotlib.figure import Figure

from armour.analysis.ballistic_limit import ballistic_limit, residual_velocity_curve
from armour.analysis.impact import simulate
from armour.reporting.plots import FORMATS, impact_figure, limit_figure, optimum_figure, rendered
from tests.cases import scenario
from tests.design.test_optimisation import case

MAGIC = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


def figure_of_an_impact(velocity: float = 800.0) -> Figure:
    return impact_figure(simulate(scenario(velocity=velocity), history=True), "A title")


def test_an_impact_shows_velocities_length_depth_and_stages():
    figure = figure_of_an_impact()
    velocities, lengths, depths = figure.axes
    assert [line.get_label() for line in velocities.lines] == ["projectile V", "penetration U", "target W"]
    assert [text.get_text() for text in velocities.texts] == ["i", "ii.1", "iii.3", "iii.4"]
    assert [axes.get_ylabel() for axes in (velocities, lengths, depths)] == [
        "velocity, m/s",
        "rod length L, mm",
        "depth, bulge, mm",
    ]
    assert depths.get_xlabel() == "time since impact, us"
    assert len(depths.lines) == 2


def test_a_long_tail_is_not_shown():
    slow = simulate(scenario(ceramic_mm=12.0, velocity=300.0), history=True)
    figure = impact_figure(slow, "")
    assert figure.axes[-1].get_xlim()[1] < 0.3 * slow.duration_us


def test_a_title_is_shown_as_it_is():
    figure = impact_figure(simulate(scenario(), history=True), "5 $ for $x_{_^ <&>")
    assert "5 $ for $x_{_^ &lt;&amp;&gt;" in rendered(figure, ".svg").decode()


def test_an_impact_needs_its_history():
    with pytest.raises(ValueError, match="history"):
        impact_figure(simulate(scenario()), "")


def test_a_limit_shows_the_curve_and_the_limit():
    limit = ballistic_limit(scenario())
    figure = limit_figure(limit, residual_velocity_curve(scenario(), [600.0, 800.0, 1000.0]), "")
    [axes] = figure.axes
    labels = [line.get_label() for line in axes.lines]
    assert labels == ["no armour", "projectile", "plug", "ballistic limit 723.8 m/s"]
    assert np.asarray(axes.lines[1].get_ydata())[0] == 0.0


def test_an_optimum_marks_the_lightest():
    result = optimise(case(), refine=True)
    figure = optimum_figure(result, "")
    thickness, density = figure.axes
    assert np.asarray(density.lines[1].get_xdata()).tolist() == [result.best.backing_thickness_mm]
    assert len(thickness.lines) == 3


@pytest.mark.parametrize("suffix", FORMATS)
def test_the_same_figure_is_the_same_file(suffix: str):
    content = rendered(figure_of_an_impact(), suffix)
    assert content.startswith(MAGIC[suffix])
    assert content == rendered(figure_of_an_impact(), suffix)
