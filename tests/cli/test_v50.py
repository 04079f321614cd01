import json
from pathlib import Path

import pytest

from tests.helpers.cases import SCENARIOS, csv_file

WILKINS = SCENARIOS / "wilkins.toml"
SHOTS = SCENARIOS / "tests" / "shots.csv"


def test_with_the_model_beside_it(cli, folder: Path):
    result = cli("v50", SHOTS, WILKINS, "--plot", "v50.svg")
    assert result.exit_code == 0
    assert "ballistic limit by the model" in result.stdout
    assert "deterministic" in result.stdout
    assert result.stderr == "wrote v50.svg\n"
    assert "probability of complete penetration" in (folder / "v50.svg").read_text()


def test_json(cli):
    data = json.loads(cli("v50", SHOTS, "--pairs", "2", "--span-m-s", "25", "--json").stdout)
    assert data["mean"]["pairs"] == 2
    assert data["mean"]["span_allowed_m_s"] == 25.0
    assert data["model_ballistic_limit_m_s"] is None


def test_shots_that_separate(cli, folder: Path):
    (folder / "s.csv").write_text("velocity_m_s,result\n700,partial\n710,partial\n720,complete\n730,complete\n")
    result = cli("v50", "s.csv")
    assert "any V50 between them is as likely" in result.stdout
    words = [line.split() for line in result.stdout.splitlines()]
    assert ["V50,", "mean", "none:", "too"] in [line[:4] for line in words]
    assert ["probit", "maximum", "715.0"] in [line[:3] for line in words]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("velocity_m_s,result\n700,partial\n", "must have at least one partial and one complete penetration"),
        ("velocity,result\n700,partial\n", "velocity: unknown column; its unit is missing: velocity_m_s"),
        ("velocity_m_s,result\n700,partial\n700,partial\n", "line 3: repeats line 2"),
        ("", "must have a header"),
    ],
)
def test_wrong_input(cli, folder: Path, text: str, message: str):
    (folder / "s.csv").write_text(text)
    assert message in cli.fails(2, "v50", "s.csv")[0]


def test_a_change_needs_a_scenario(cli):
    assert cli.fails(2, "v50", SHOTS, "--set", "a=1") == ["command line: --set: changes a scenario, which is not given"]


def test_no_answer(cli, folder: Path):
    (folder / "s.csv").write_text("velocity_m_s,result\n700,complete\n730,partial\n")
    assert cli.fails(1, "v50", "s.csv")[0].startswith("no V50")


@pytest.mark.parametrize("option", [("--pairs", "0"), ("--span-m-s", "-1"), ("--confidence", "2")])
def test_an_option_out_of_range(cli, option: tuple[str, str]):
    [line] = cli.fails(2, "v50", SHOTS, *option)
    assert line.startswith(f"command line: {option[0]}: must be at ")


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (("--confidence", "95%"), "--confidence: must be at most 0.9999, found 95; did you mean 0.95?"),
        (("--confidence", "95"), "--confidence: must be at most 0.9999, found 95; did you mean 0.95?"),
        (("--pairs", "2.5"), "--pairs: must be a whole number, found 2.5"),
        (("--pairs", "4"), "--span-m-s: must be given for 4 pairs; a span is usual with 2, 3 and 5 only"),
    ],
)
def test_an_option_that_is_no_number_of_its_kind(cli, option: tuple[str, str], message: str):
    assert cli.fails(2, "v50", SHOTS, *option) == [f"command line: {message}"]


def test_shots_far_from_the_models_limit(cli, folder: Path):
    csv_file(folder / "s.csv", "velocity_m_s,result", "2600,partial", "2650,complete", "2590,partial", "2605,complete")
    warning = cli("v50", "s.csv", "wilkins").stderr
    assert "wilkins.toml: all shots, at 2590 to 2650 m/s, lie outside the model's 95 % interval" in warning


def test_the_models_limit_has_its_interval_and_warnings(cli):
    shots, case = SCENARIOS / "tests" / "shots.csv", SCENARIOS / "wilkins.toml"
    plain = cli("v50", shots, case)
    assert "95 % interval, with the error of the model  613 to 834 m/s" in plain.stdout
    assert plain.stderr == ""
    thin = cli("v50", shots, case, "--set", "armour.backing_thickness_mm=2")
    assert "armour.backing_thickness_mm: the model was compared with results for back plates 0.66 to 3" in thin.stderr


def test_a_prior(cli, folder: Path):
    (folder / "s.csv").write_text("velocity_m_s,result\n700,partial\n")
    shown = cli("v50", "s.csv", "wilkins", "--prior").stdout
    assert "of the precision of V50, the inverse of its variance, is that of the prior" in shown
    assert "the shots alone have no curve" in shown
    assert json.loads(cli("v50", SHOTS, "wilkins", "--prior", "--json").stdout)["prior_share"] < 0.1
    assert cli.fails(2, "v50", SHOTS, "--prior") == ["command line: --prior: must not be asked for without a scenario"]
    assert "found only partial ones" in cli.fails(2, "v50", "s.csv", "wilkins")[0]
    assert "these shots have none" in cli("v50", "s.csv", "wilkins", "--prior", "--plot", "p.svg").stderr
