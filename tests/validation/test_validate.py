"""Statuses of cases, summaries of tables and errors of predictions."""

from pathlib import Path
from typing import Any

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.closed_forms import florence_ballistic_limit
from armour.validation.questions import Asked
from armour.validation.validate import Check, TableSummary, result_of, validate
from tests.helpers.cases import scenario
from tests.helpers.suites import TABLE, case, load, result


@pytest.fixture(scope="module")
def limit() -> float:
    """Ballistic limit of the Wilkins case, m/s."""
    return ballistic_limit(scenario()).ballistic_limit_m_s


def the_check(folder: Path, text: str) -> Check:
    [check] = result(folder, text).checks
    return check


def the_summary(folder: Path, text: str) -> TableSummary:
    [summary] = result(folder, text).summaries
    return summary


def test_within_and_outside(folder: Path, limit: float):
    found = result(folder, case("in", 724.0, "band = 1.0") + case("out", 725.0, "band = 1.0"))
    inside, outside = found.checks
    assert (inside.status, outside.status) == ("within", "outside")
    assert inside.computed == limit
    assert outside.deviation == pytest.approx(limit - 725.0)
    assert outside.deviation_percent == pytest.approx(100.0 * (limit / 725.0 - 1.0))
    assert not found.passed
    assert (found.count("within"), found.count("outside")) == (1, 1)


@pytest.mark.parametrize(("percent", "status"), [(0.2, "within"), (0.1, "outside")])
def test_a_band_in_per_cent(folder: Path, percent: float, status: str):
    assert the_check(folder, case("a", 725.0, f"band_percent = {percent}")).status == status


def test_a_difference_from_a_measured_value(folder: Path, limit: float):
    """The expected value is a part of the measured one, in per cent, whichever is the greater."""
    for measured in (700.0, 750.0):
        found = the_check(folder, case("a", 3.4, f"band = 0.2\nmeasured = {measured}"))
        assert found.computed == pytest.approx(100.0 * abs(limit / measured - 1.0))
        assert (found.status, found.case.unit, found.deviation_percent) == ("within", "%", None)
        assert found.to_dict()["measured"] == measured
    assert the_check(folder, case("a", 3.4, "band = 0.1\nmeasured = 750.0")).status == "within"
    assert the_check(folder, case("a", 3.4, "band = 0.1\nmeasured = 740.0")).status == "outside"


def test_a_table_of_differences(folder: Path, limit: float):
    rows = TABLE.replace("720.0", "4.0").replace("730.0, 730.0", "1.0, 730.0").replace('"they"]', '"measured"]', 1)
    found = result(folder, rows.replace('rivals = ["they"]', ""))
    assert [check.case.measured for check in found.checks] == [756.0, 730.0]
    assert [check.computed for check in found.checks] == pytest.approx([100 * (1 - limit / v) for v in (756.0, 730.0)])
    assert (found.summaries[0].unit, found.errors) == ("%", ())


def test_what_is_not_scored_fails_nothing(folder: Path, limit: float):
    found = result(folder, case("a", 1.0, 'not_scored = "a slip of the print"'))
    assert found.checks[0].status == "not scored"
    assert found.checks[0].computed == limit
    assert found.passed


def test_a_question_without_an_answer_fails(folder: Path):
    high = "set.ballistic_limit.velocity_min_m_s = 1000.0"
    found = result(folder, case("a", 724.0, f"band = 1.0\n{high}"))
    assert found.checks[0].status == "no answer"
    assert "lower ballistic_limit.velocity_min_m_s" in found.checks[0].message
    assert found.checks[0].deviation is None
    assert not found.passed


def test_an_outcome(folder: Path):
    text = case("a", '"perforated"', "").replace("ballistic_limit_m_s", "outcome")
    assert the_check(folder, text).status == "within"
    assert the_check(folder, text.replace("perforated", "defeated")).status == "outside"


def test_a_table_as_a_whole(folder: Path, limit: float):
    summary = the_summary(folder, TABLE)
    first, second = limit - 720.0, limit - 730.0
    assert (summary.count, summary.unit) == (2, "m/s")
    assert summary.mean == pytest.approx((first + second) / 2)
    assert summary.rms == pytest.approx(((first**2 + second**2) / 2) ** 0.5)
    assert summary.largest == pytest.approx(-second)
    assert summary.status == "outside"
    assert the_summary(folder, TABLE.replace("rms_band = 5.0", "rms_band = 6.0")).status == "within"
    assert the_summary(folder, TABLE.replace("rms_band = 5.0", "")).status == "not scored"
    percent = the_summary(folder, TABLE.replace("rms_band = 5.0", "rms_band_percent = 0.8"))
    assert (percent.unit, percent.status) == ("%", "within")
    assert percent.largest == pytest.approx(-second / 7.3)


def test_a_table_left_by_its_root_mean_square_alone_fails(folder: Path):
    found = result(folder, TABLE)
    assert {check.status for check in found.checks} == {"within"}
    assert not found.passed


def test_errors_of_every_prediction(folder: Path, limit: float):
    errors = {error.predictor: error for error in result(folder, TABLE).errors}
    assert list(errors) == [
        "they",
        "this model",
        "Florence, penetrator (5.46 g, 6.5 mm)",
        "Florence, whole projectile (8.32 g, 7.62 mm)",
    ]
    assert errors["they"].mean_percent == pytest.approx(2.5)
    assert errors["they"].largest_percent == pytest.approx(5.0)
    assert errors["this model"].largest_percent == pytest.approx(100.0 * (1.0 - limit / 730.0))
    florence = florence_ballistic_limit(scenario())
    off = [100.0 * (1.0 - florence / expected) for expected in (720.0, 730.0)]
    assert errors["Florence, penetrator (5.46 g, 6.5 mm)"].mean_percent == pytest.approx(sum(off) / 2)


def test_a_table_without_rivals_compares_nothing(folder: Path):
    assert (
        result(folder, TABLE.replace('rivals = ["they"]', "").replace('"they"', '"solver.arrest_velocity_m_s"')).errors
        == ()
    )


def test_one_scenario_is_asked_once(folder: Path, monkeypatch: pytest.MonkeyPatch):
    made: list[Asked] = []

    class Counted(Asked):
        def __init__(self, *args: Any) -> None:
            super().__init__(*args)
            made.append(self)

    monkeypatch.setattr("armour.validation.validate.Asked", Counted)
    result(folder, TABLE + case("a", 724.0, "band = 1.0"))
    computed = [asked for asked in made if "answers" in vars(asked)]
    assert len(computed) == 1


def test_as_many_as_have_been_checked(folder: Path):
    suite = load(folder, TABLE + case("a", 724.0, "band = 1.0"))
    done: list[Check] = []
    validate(suite, on_check=lambda check, total: done.append(check) if total == 3 else None)
    part = result_of(suite, done[:1])
    assert [summary.count for summary in part.summaries] == [1]
    assert result_of(suite, []).summaries == ()
