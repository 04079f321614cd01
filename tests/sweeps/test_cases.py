import re
from pathlib import Path

import numpy as np
import pytest

from armour.errors import InputError
from armour.sweeps import cases
from armour.sweeps.cases import Axis, SweepCases, axis_of
from tests.helpers.cases import csv_file, sweep_grid


def test_axes():
    assert axis_of("armour.ceramic_thickness_mm=4:5:0.5") == Axis("armour.ceramic_thickness_mm", (4.0, 4.5, 5.0))
    words = "the last value is 4.4, since 5 is not a whole number of steps away"
    assert axis_of("a=3:5:0.7") == Axis("a", (3.0, 3.7, 4.4), words)
    assert axis_of("a=0:1:0.3333333").omission == ""
    assert axis_of("ceramic.flow_stress_backing_slope=-0.5:0.1:0.2").values == (-0.5, -0.3, -0.1, 0.1)
    assert axis_of('library.metal."a=b".x = 1, 2.5') == Axis('library.metal."a=b".x', (1.0, 2.5))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a", 'over: must be KEY=MIN:MAX:STEP or KEY=VALUE,VALUE,..., found "a"'),
        ("a b=1", "over: must be KEY=MIN:MAX:STEP"),
        ("a=", 'over a: must be MIN:MAX:STEP or VALUE,VALUE,... of finite numbers, found ""'),
        ("a=1:2", 'over a: must be MIN:MAX:STEP or VALUE,VALUE,... of finite numbers, found "1:2"'),
        ("a=1,x", "over a: must be MIN:MAX:STEP"),
        ("a=1:nan:1", "over a: must be MIN:MAX:STEP"),
        ("a=\u0661", "over a: must be MIN:MAX:STEP"),
        ("a=2:1:1", "over a: max: must be at least min, which is 2, found 1"),
        ("a=1:2:0", "over a: step: must be greater than 0, found 0"),
        ("a=0:1:1e-9", "over a: must contain at most 100,000 values, found 1e+09; widen the step"),
        ("armour.ceramic=SiC", "over armour.ceramic: must be a key of numbers"),
    ],
)
def test_texts_that_are_not_axes(text: str, message: str):
    with pytest.raises(InputError, match=re.escape(message)):
        axis_of(text)


def test_a_grid_gives_every_combination_once():
    source = sweep_grid("a=1,2,3", "b=4:5:0.5")
    columns = source.rows(np.arange(9))
    rows = list(zip(columns["a"].tolist(), columns["b"].tolist(), strict=True))
    assert rows == [(a, b) for a in (1.0, 2.0, 3.0) for b in (4.0, 4.5, 5.0)]
    assert (source.keys, source.count) == (("a", "b"), 9)


def test_a_grid_of_many_axes_is_not_held_in_memory():
    wide = "=" + ",".join(map(str, range(1000)))
    source = sweep_grid(*(key + wide for key in "abcd"))
    assert source.count == 10**12
    ends = source.rows(np.array([0, 10**12 - 1]))
    assert {key: column.tolist() for key, column in ends.items()} == {key: [0.0, 999.0] for key in "abcd"}
    assert source.rows(np.arange(3))["d"].tolist() == [0.0, 1.0, 2.0]


def test_a_grid_of_more_rows_than_can_be_numbered():
    wide = "=" + ",".join(map(str, range(1000)))
    assert sweep_grid(*(key + wide for key in "abcdef")).count == 10**18
    with pytest.raises(InputError, match="over: must have at most 10"):
        sweep_grid(*(key + wide for key in "abcdef"), "g=1,2")


def test_rows_of_cases(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    rows = np.random.default_rng(3).uniform(0.0, 1.0, (57, 2))
    source = SweepCases(csv_file(tmp_path / "cases.csv", "a,b", *(f"{a!r},{b!r}" for a, b in rows.tolist())))
    assert (source.keys, source.count) == (("a", "b"), 57)
    found = source.rows(np.arange(50, 57))
    for column, key in enumerate(source.keys):
        np.testing.assert_array_equal(found[key], rows[50:, column])
    spaced = SweepCases(csv_file(tmp_path / "spaced.csv", '"a"', "1.0", "", " 2"))
    assert spaced.digest == SweepCases(csv_file(tmp_path / "same.csv", "a", "1", "2")).digest != source.digest
    monkeypatch.setattr(cases, "MAX_CASES", 56)
    with pytest.raises(InputError, match="must have at most 56 rows, found more"):
        SweepCases(tmp_path / "cases.csv")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must have a header of keys and at least one row"),
        ("a,b\n", "at least one row"),
        ("a,b\n1,2\n\n3,x\n", 'line 4: b: must be a number, found "x"'),
        ("a,b\n1,\n", 'line 2: b: must be a number, found ""'),
        ("a,b\nx,1\ny,2\n3,3\n", "line 2: a: must be a number.*\n.*line 3: a: must be a number"),
        ("a,,b\n1,2,3\n", "line 1: must name a key in each column, found none in 2"),
    ],
)
def test_wrong_tables(tmp_path: Path, text: str, message: str):
    (tmp_path / "cases.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        SweepCases(tmp_path / "cases.csv")


def test_names_stand_beside_numbers(tmp_path: Path):
    lines = ('AD85, 1,"6061-T6"', '"AD99.5",2.5, 5083-H3', "B4C,3,6061-T6")
    source = SweepCases(csv_file(tmp_path / "cases.csv", "armour.ceramic,a,armour.backing", *lines))
    assert {key: column.tolist() for key, column in source.rows(np.arange(3)).items()} == {
        "armour.ceramic": ["AD85", "AD99.5", "B4C"],
        "a": [1.0, 2.5, 3.0],
        "armour.backing": ["6061-T6", "5083-H3", "6061-T6"],
    }
    only = SweepCases(csv_file(tmp_path / "names.csv", "armour.ceramic", "AD85", "B4C"))
    assert (only.keys, only.count) == (("armour.ceramic",), 2)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (",1", 'line 3: armour.ceramic: must be a name, found ""'),
        ("x" * 300 + ",1", "line 3: armour.ceramic: must be a name, found"),
        ("AD85,AD85", 'line 3: a: must be a number, found "AD85"'),
    ],
)
def test_wrong_lines_with_names(tmp_path: Path, line: str, message: str):
    with pytest.raises(InputError, match=message):
        SweepCases(csv_file(tmp_path / "cases.csv", "armour.ceramic,a", "AD85,1", line))
