import warnings
from collections.abc import Callable
from itertools import combinations
from xml.etree import ElementTree

import matplotlib as mpl
import pytest
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.transforms import Bbox

from armour.errors import InputError
from armour.reporting.by_result import drawing_of
from armour.reporting.pictures.drawing import (
    BLUE,
    METADATA,
    PANEL,
    STYLE,
    Picture,
    Sheet,
    colours_of,
    contours,
    drawn,
    legible,
    ranges,
    rows,
    rows_height,
    saved,
)
from armour.reporting.show import plot
from armour.sweeps.sweep import sweep
from tests.analysis.results import impact
from tests.helpers.cases import scenario
from tests.statistics.results import uncertainty_result

pytestmark = pytest.mark.slow

MAGIC = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
NAMES = ["first", "second with a name that takes two lines"]


def named_rows(sheet: Sheet) -> Picture:
    """A picture of two rows."""
    picture = sheet.panels("T", rows_height(NAMES), note="N")
    rows(picture.axes[0], NAMES, {"one": [1.0, -1.0], "two": [2.0, None]}, 0.0)
    return picture


def a_map(sheet: Sheet) -> Picture:
    """A picture of a quantity over a grid."""
    picture = sheet.panels("T", PANEL)
    x, y, z = [4.0, 6.0, 8.0], [5.0, 7.0], [[0.0, 30.0, 60.0], [20.0, float("nan"), 80.0]]
    colours_of(picture.axes[0], x, y, z, "speed, m/s")
    contours(picture.axes[0], x, y, z, 6, numbered=True, label="l")
    return picture


DRAWINGS: dict[str, Callable[[], Callable[[Sheet], Picture]]] = {
    "impact": lambda: drawing_of(impact().of(scenario=scenario())),
    "uncertainty": lambda: drawing_of(uncertainty_result().of(scenario=scenario(velocity=700.0))),
    "map": lambda: a_map,
    "rows": lambda: named_rows,
}


@pytest.mark.parametrize("suffix", METADATA)
def test_the_same_picture_is_the_same_file(suffix: str):
    content = saved(drawn(named_rows, Sheet(), "it").figure, suffix)
    assert content.startswith(MAGIC[suffix])
    assert content == saved(drawn(named_rows, Sheet(), "it").figure, suffix)


def test_settings_of_a_user_are_for_axes_of_the_user():
    content = saved(drawn(named_rows, Sheet(), "it").figure, ".svg")
    with mpl.rc_context({"xtick.labelsize": 30, "text.usetex": True, "savefig.format": "eps", "savefig.bbox": "tight"}):
        assert saved(drawn(named_rows, Sheet(), "it").figure, ".svg") == content
        axes = Figure().subplots()
        drawn(named_rows, Sheet(ax=axes))
    assert axes.get_xticklabels()[0].get_fontsize() == 30


class InexactLayout(ConstrainedLayoutEngine):
    """A layout whose last digits are others, as those of another process are."""

    def execute(self, fig: Figure) -> None:
        super().execute(fig)
        for axes in fig.axes:
            x, y, width, height = axes.get_position(original=True).bounds
            axes.set_position((x + 1e-15, y, width, height + 1e-15))


def test_a_file_does_not_depend_on_the_last_digits_of_a_layout():
    exact, inexact = (drawn(a_map, Sheet(), "it").figure for _ in range(2))
    inexact.set_layout_engine(InexactLayout())
    assert saved(inexact, ".svg") == saved(exact, ".svg")
    assert isinstance(inexact.get_layout_engine(), InexactLayout)


@pytest.mark.parametrize("name", DRAWINGS)
def test_no_text_is_cut_and_no_panel_overlaps_another(name: str):
    figure = drawn(DRAWINGS[name](), Sheet(4.2), "what it is about").figure
    figure.draw_without_rendering()
    whole, (across, up) = figure.get_tightbbox(), figure.get_size_inches()
    assert min(whole.x0, whole.y0) > -0.02
    assert whole.x1 < across + 0.02
    assert whole.y1 < up + 0.02
    # The box of a panel has its legend.
    for first, second in combinations([axes.get_tightbbox() for axes in figure.axes], 2):
        shared = Bbox.intersection(first, second)
        assert shared is None or min(shared.width, shared.height) < 2.0


def test_the_ends_of_a_range_may_be_in_either_order():
    picture = Sheet().panels("T", PANEL)
    ranges(picture.axes[0], [1.0, 3.0], [(2.0, 4.0), (5.5, 4.0)], BLUE)
    [bars] = [item for item in picture.axes[0].collections if isinstance(item, LineCollection)]
    assert [[x for x, _ in ends] for ends in bars.get_segments()] == [[2.0, 4.0], [4.0, 5.5]]


def test_names_are_rows_with_the_first_on_top():
    [axes] = drawn(named_rows, Sheet()).axes
    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert labels == ["first", "second with a name\nthat takes two lines"]
    assert axes.get_ylim()[0] > axes.get_ylim()[1]
    marks = {line.get_label(): line.get_ydata() for line in axes.lines if line.get_linestyle() == "None"}
    assert {label: list(y) for label, y in marks.items()} == {"one": [0.0, 1.0], "two": [0.0]}  # type: ignore[arg-type]


def test_the_title_is_the_answer_above_what_it_is_about():
    figure = drawn(named_rows, Sheet(), "armour and round").figure
    assert figure.get_suptitle().strip() == "T"
    assert "armour and round" in [text.get_text() for text in figure.texts]
    assert drawn(named_rows, Sheet(), "armour", title="mine").figure.get_suptitle() == "mine"
    bare = drawn(named_rows, Sheet(4.2), title="").figure
    assert not bare.texts
    assert bare.get_figwidth() == 4.2


@pytest.mark.parametrize("text", ["_ $\\frac{1}{0}$ <&>", "a\x08b"])
def test_no_text_is_markup_and_none_has_control_characters(text: str):
    def draw(sheet: Sheet) -> Picture:
        picture = sheet.panels(text, PANEL, note=text)
        rows(picture.axes[0], [text], {text: [1.0]})
        picture.axes[0].set(title=text, xlabel=text)
        return picture

    root = ElementTree.fromstring(saved(drawn(draw, Sheet(), text).figure, ".svg"))
    shown = ["".join(element.itertext()).strip() for element in root.iter("{http://www.w3.org/2000/svg}text")]
    # Title, subject, note, legend, row, x axis and panel.
    assert shown.count(text.replace("\x08", "\\x08")) == 7
    assert legible("_a") == " _a"


@pytest.mark.usefixtures("not_laid_out")
def test_no_line_ends_between_a_number_and_its_unit():
    for length in range(40, 80, 4):
        figure = drawn(named_rows, Sheet(), title=f"{length * 'a'} 6.35 mm").figure
        assert figure.get_suptitle().splitlines()[-1].endswith("6.35 mm")


def test_a_flat_map_has_no_contours():
    axes = Sheet().panels("T", PANEL).axes[0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        contours(axes, [4.0, 6.0], [5.0, 7.0], [[1.0, 1.0], [1.0, 1.0]], 6, numbered=True)
    assert not axes.collections


def test_a_picture_of_one_panel_is_drawn_into_axes_of_a_user():
    figure = Figure()
    left, right = figure.subplots(1, 2)
    limit = sweep(scenario(), {"armour.ceramic_thickness_mm": [6.0, 7.0]}, "areal_density_kg_m2")
    assert plot(limit, ax=right) is figure
    assert right.get_title().startswith("Areal density over")
    assert right.get_xlabel() == "tile thickness, mm"
    assert not left.lines
    assert figure.axes == [left, right]
    with pytest.raises(InputError, match="plot: ax: must not be given for a picture of 4 panels"):
        plot(impact().of(scenario=scenario()), ax=left)


def test_the_settings_of_a_user_stay_as_they_are():
    before = mpl.rcParams.copy()
    drawn(named_rows, Sheet())
    assert {key: mpl.rcParams[key] for key in STYLE} == {key: before[key] for key in STYLE}
