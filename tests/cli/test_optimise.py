import json
import subprocess
import sys
from pathlib import Path

import pytest

from armour import load_scenario
from tests.helpers.cases import SCENARIOS

GRID = """
ceramic_thickness_mm = { min = 8.0, max = 14.0, step = 0.5 }
backing_thickness_mm = { min = 5.0, max = 8.0, step = 1.0 }
"""
CATALOGUE = SCENARIOS / "catalogue.toml"


@pytest.fixture
def small(folder: Path) -> Path:
    text = (SCENARIOS / "paper" / "optimum_7.62mm_AP.toml").read_text()
    path = folder / "small.toml"
    path.write_text(text[: text.index("[optimise]")] + "[optimise]" + GRID)
    return path


def test_a_single_pair(cli, small: Path):
    result = cli("optimise", small, "--refine")
    assert result.exit_code == 0
    assert result.stderr == ""
    lines = [line.split() for line in result.stdout.splitlines()]
    assert [line[:3] for line in lines if line[-1:] == ["lightest"]] == [["11.0", "6.0", "54.23"]]
    assert ["lightest", "design", "between", "the", "values", "of", "the", "grid"] in lines
    assert ["areal", "density", "54.23", "kg/m²"] in lines


def test_json_is_the_same_as_from_python(cli, small: Path):
    from armour.design.optimise import optimise

    data = json.loads(cli("optimise", small, "--json").stdout)
    assert data == json.loads(json.dumps(optimise(load_scenario(small)).to_dict()))
    thicknesses = {"ceramic_thickness_mm", "backing_thickness_mm", "areal_density_kg_m2"}
    assert thicknesses | {"ballistic_limit_m_s"} <= set(data["best"])
    assert all(thicknesses <= set(row) for row in data["frontier"])
    assert "refined" not in data
    assert "refined" in json.loads(cli("optimise", small, "--json", "--refine").stdout)


def test_csv_and_plot(cli, small: Path, folder: Path):
    result = cli("optimise", small, "--csv", "f.csv", "--plot", "f.pdf")
    assert result.stderr.splitlines() == ["wrote f.csv", "wrote f.pdf"]
    lines = (folder / "f.csv").read_text().splitlines()
    assert lines[0].startswith("ceramic_thickness_mm,backing_thickness_mm,areal_density_kg_m2")
    assert len(lines) == 5


def test_files_are_written_although_the_reader_stops_reading(small: Path, folder: Path):
    command = [sys.executable, "-m", "armour", "optimise", str(small), "--csv", "f.csv", "--plot", "p.svg"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=folder) as done:
        assert done.stdout is not None
        done.stdout.close()
        assert done.wait() == 0
    assert (folder / "f.csv").read_text().startswith("ceramic_thickness_mm,")
    assert "</svg>" in (folder / "p.svg").read_text()


def test_no_design_is_exit_code_1(cli, small: Path):
    small.write_text(small.read_text().replace("min = 8.0, max = 14.0", "min = 2.0, max = 4.0"))
    [line] = cli.fails(1, "optimise", small)
    assert line.startswith("no design")


def test_a_scenario_without_a_grid(cli, folder: Path):
    path = folder / "a.toml"
    text = (SCENARIOS / "wilkins.toml").read_text()
    path.write_text(text[: text.index("[optimise]")])
    [line] = cli.fails(2, "optimise", path)
    assert line.startswith(f"{path}: optimise: is missing")


def test_a_design_outside_the_data_is_warned_of(cli, folder: Path):
    text = (SCENARIOS / "paper" / "optimum_7.62mm_AP.toml").read_text()
    path = folder / "slow.toml"
    path.write_text(
        text.replace("850.0", "400.0").replace("step = 0.1", "step = 2.0").replace("step = 0.5", "step = 2.0")
    )
    result = cli("optimise", path, "--json")
    assert result.stderr.startswith(f"warning: {path}: impact.velocity_m_s: the model was compared with results at")
    assert [f"warning: {path}: {w}" for w in json.loads(result.stdout)["warnings"]] == result.stderr.splitlines()


def test_a_confidence_is_designed_for(cli, small: Path):
    plain = cli("optimise", small)
    assert "probability of defeating the threat  5" in plain.stdout
    assert "a design without a margin is perforated with a probability of 50 %; --confidence 0.95 d" in plain.stdout
    left_out = cli("optimise", small, "--set", "uncertainty.model.included=false").stdout.splitlines()
    assert left_out[-1] == "the error of the model is not included, as uncertainty.model says"
    args = ("optimise", small, "--set", "optimise.ceramic_thickness_mm.max=20")
    best = json.loads(cli(*args, "--confidence", 0.95, "--json").stdout)["best"]
    [probability] = best["probabilities_of_defeat"].values()
    assert 0.95 <= probability < 0.96
    assert best["areal_density_kg_m2"] > json.loads(cli(*args, "--json").stdout)["best"]["areal_density_kg_m2"]
    assert "--confidence 0.95" not in cli(*args, "--confidence", 0.95).stdout
    told = cli.fails(2, "optimise", small, "--confidence", 1.5)
    assert told == ["command line: --confidence: must be less than 1, found 1.5"]
    unknown = cli.fails(1, *args, "--set", "armour.ceramic=SiC", "--confidence", 0.95)
    assert unknown[0].startswith("the error of the model is not known for SiC on 5083-H3; [uncertainty.model] can")


def test_a_design_at_the_end_of_its_range_is_warned_of(cli, small: Path):
    small.write_text(small.read_text().replace("min = 5.0", "min = 7.0"))
    assert "the best design lies at the least back plate thickness of the range, 7 mm" in cli("optimise", small).stderr


def test_a_catalogue_and_threats(cli, folder: Path):
    result = cli("optimise", CATALOGUE, "--csv", "front.csv", "--plot", "study.svg")
    assert result.exit_code == 0
    words = [line.split() for line in result.stdout.splitlines()]
    assert ["ceramic", "Al-N"] in words
    assert ["ceramic", "thickness", "5.0", "mm"] in words
    assert any(line[-1:] == ["governs"] for line in words)
    assert any(line[-2:] == ["%", "heavier"] for line in words)
    assert (folder / "front.csv").read_text().startswith("ceramic,backing,ceramic_thickness_mm")
    assert "Pareto front" in (folder / "study.svg").read_text()


@pytest.mark.parametrize(("command", "what"), [("optimise", "design"), ("report", "report")])
def test_an_impact_that_threats_replace_is_not_changed(cli, command: str, what: str):
    [line] = cli.fails(2, command, CATALOGUE, "--set", "impact.velocity_m_s=2000")
    assert line == f"command line: --set impact.velocity_m_s: must have an effect: the {what} does not depend on it"


def test_a_catalogue_as_json(cli):
    data = json.loads(cli("optimise", CATALOGUE, "--json").stdout)
    for design in (data["best"], *data["frontier"]):
        assert {"ceramic_thickness_mm", "backing_thickness_mm", "areal_density_kg_m2"} <= design.keys()
    assert data["best"]["ballistic_limit_m_s"] >= 850.0
    assert data["examined"] <= data["designs"] == 282


def test_back_plates_on_which_nothing_passes_are_told(cli, small: Path):
    found = cli("optimise", small, "--confidence", "0.95").stdout
    assert "without a row" in found
