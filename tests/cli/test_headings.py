"""The first line of every answer, chart and report is what was computed."""

from html import unescape
from pathlib import Path
from re import findall

import pytest

from armour import load_scenario, simulate, sweep

SIC = ("--set", "armour.ceramic=SiC")
OTHER = "scenario: 6.35 mm AD85 on 6.35 mm 6061-T6, 7.62 mm AP"
ARMOUR = "6.35 mm SiC on 6.35 mm 6061-T6 against 7.62 mm AP"
GRID = ("--set", "optimise.backing_thickness_mm={min = 5, max = 6, step = 1}")
THICKNESSES = ("armour.ceramic_thickness_mm=6,8",)
QUESTIONS = {
    ("simulate", "wilkins"): f"{ARMOUR} at 800 m/s",
    ("simulate", "wilkins", "--velocity", "700"): f"{ARMOUR} at 700 m/s",
    ("ballistic-limit", "wilkins"): ARMOUR,
    ("compare", "wilkins"): ARMOUR,
    ("optimise", "wilkins", *GRID): "Lightest SiC on 6061-T6 against 7.62 mm AP at 800 m/s",
    ("sensitivity", "wilkins"): f"{ARMOUR} at 800 m/s",
    ("uncertainty", "uncertain", "--samples", "128"): f"{ARMOUR} at 700 m/s",
    ("calibrate", "wilkins.csv", "wilkins"): "Tests of SiC on 6061-T6 against 7.62 mm AP",
    ("v50", "shots.csv", "wilkins"): f"V50 of the shots in shots.csv: {ARMOUR}",
    ("plan", "shots", "wilkins", "--procedure", "up-and-down"): ARMOUR,
    ("plan", "tests", "wilkins", "--scatter-percent", "3", "--candidates", *THICKNESSES): (
        "Tests of SiC on 6.35 mm 6061-T6 against 7.62 mm AP"
    ),
}


def texts(chart: Path) -> str:
    """The texts of a chart, in their order."""
    return unescape(" ".join(findall(r"<(?:text|tspan)[^>]*>([^<]+)", chart.read_text())))


@pytest.mark.parametrize("question", QUESTIONS, ids=" ".join)
def test_answers_and_charts_name_what_was_computed(cli, folder: Path, question: tuple[str, ...]):
    done = cli(*question, *SIC, "--plot", "chart.svg")
    assert done.exit_code == 0, done.stderr
    first, second, *_ = done.stdout.splitlines()
    assert first == QUESTIONS[question]
    assert second.startswith(OTHER)
    assert f"{first} {OTHER}" in texts(folder / "chart.svg")


def test_the_chart_of_a_sweep_names_what_was_computed(cli, folder: Path):
    done = cli("sweep", "wilkins", "--over", THICKNESSES[0], *SIC, "-o", "s.csv", "--plot", "s.svg")
    assert (done.exit_code, done.stdout) == (0, "")
    assert f"SiC on 6.35 mm 6061-T6 against 7.62 mm AP {OTHER}" in texts(folder / "s.svg")
    (folder / "cases.csv").write_text("armour.ceramic\nSiC\nB4C\n")
    asked = "--cases", "cases.csv", "--quantities", "residual_velocity_m_s", "-o", "c.csv", "--json"
    assert cli("sweep", "wilkins", *asked).exit_code == 0


def test_a_report_names_what_was_computed(cli, folder: Path):
    for option, words in (([], "5.8 mm SiC on 5 mm 6061-T6"), (["--as-is"], "6.35 mm SiC on 6.35 mm 6061-T6")):
        assert cli("report", "wilkins", *SIC, *option, "-o", "r.md", "--force").exit_code == 0
        first, _, byline, *_ = (folder / "r.md").read_text().splitlines()
        assert first == f"# {words} against 7.62 mm AP at 800 m/s"
        assert byline.startswith(OTHER)


def test_results_in_python_name_what_was_computed():
    scenario = load_scenario("wilkins", {"armour.ceramic": "SiC"})
    result = simulate(scenario)
    assert repr(result) == f"<ImpactResult: {ARMOUR} at 800 m/s: defeated at 800 m/s>"
    html = result._repr_html_()
    assert html is not None
    assert html.lstrip().startswith(f"<p>{ARMOUR}".replace(" mm", "\N{NO-BREAK SPACE}mm"))
    over = sweep(scenario, {"armour.ceramic_thickness_mm": [6.0, 8.0]}, "residual_velocity_m_s")
    assert repr(over).startswith("<SweepResult: SiC on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s: residual")
