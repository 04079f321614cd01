"""Tables of shots and tests as spreadsheets and ranges export them."""

import json
import re
from hashlib import sha256
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

import armour
from armour.errors import InputError
from tests.helpers.cases import scenario
from tests.helpers.foreign import NotAvailable, Quantity
from tests.helpers.known import known
from tests.helpers.spreadsheets import export

FEET = 0.3048
# Tables of a partial penetration, a complete and a partial one: by their velocities, m/s.
OF_METRES = {
    "semicolons": b"\xef\xbb\xbfshot;velocity_m_s;result;n\r\n1;735,3;partial;\r\n2;761,4;CP;spall\r\n3;750;PP;\r\n",
    "sep": b"sep=;\r\nSchuss;V (m/s);Ergebnis\r\n1;735,3;gehalten\r\n2;761,4;durchschlagen\r\n3;750,0;gehalten\r\n",
    "Windows-1252": b"N\xb0;V (m/s);R\xe9sultat\n1;735,3;non perfor\xe9\n2;761,4;perfor\xe9\n3;750;non perfor\xe9\n",
    "UTF-16": "Shot\tV, m/s\tResult\n1\t735.3\tnot perforated\n2\t761.4\tperforated\n3\t750\tNot Perforated\n".encode(
        "utf-16"
    ),
    "titles": b"Report 7;;;\nDate;2026-03-02;;\n;;;\nshot;velocity_m_s;result;\n1;735.3;PP;\n2;761.4;CP;\n3;750;PP;\n",
    "trailing": b"shot,velocity_m_s,result,,\r\n1,735.3,PP,,\r\n2,761.4,CP,,\r\n3,750,PP,,\r\n,,,,\r\n",
    "two units": b"Shot;Velocity (ft/s);V (m/s);Result\n1;2412,4;735,3;PP\n2;2498,0;761,4;CP\n3;2460,6;750,0;PP\n",
    "two results": b"Shot;v (m/s);Partial;Complete;Valid\n1;735,3;x;;x\n2;761,4;;x;x\n4;700;;;\n3;750,0;x;;x\n",
    "thousandths": b"velocity (m/s);result\n735,300;P\n761,400;C\n750,000;P\n",
    "said by the header": b"V_m_s,Result (1 = perforated)\n735.3,0\n761.4,1\n750,0\n",
    "units below": b"Schuss;Geschwindigkeit;Durchschlag\n;[m/s];\n1;735,3;nein\n2;761,4;ja\n3;750;nein\n",
    "an index": b",velocity_m_s,result\n0,735.3,stopped\n1,761.4,perforated\n2,750.0,stopped\n",
    "stopped": b"Strike Velocity (m/s),Stopped\n735.3,TRUE\n761.4,FALSE\n750,TRUE\n",
}
OF_FEET = {
    "feet": b"Shot;Velocity (ft/s);Result (PP/CP);Yaw\r\n1;2415,3;PP;1,2\r\n\r\n2;2498,7;CP;0,8\r\n3;2451,0;PP;2\r\n",
    "quoted": b'"V (ft/s)","Result"\n"2,415.3","partial penetration"\n"2,498.7",complete penetration\n"2,451.0",PP\n',
}
EXPORTS = {
    **{name: (content, [735.3, 761.4, 750.0]) for name, content in OF_METRES.items()},
    **{name: (content, [2415.3 * FEET, 2498.7 * FEET, 2451 * FEET]) for name, content in OF_FEET.items()},
    "groups alone": (
        b"Velocity fps\tResult\n2,415\tPP\n2,498\tCP\n2,451\tPP\n",
        [2415 * FEET, 2498 * FEET, 2451 * FEET],
    ),
}


@pytest.mark.parametrize("name", EXPORTS)
def test_what_an_export_holds(tmp_path: Path, name: str):
    content, velocities = EXPORTS[name]
    (tmp_path / "t.csv").write_bytes(content)
    shots = armour.read_shots(tmp_path / "t.csv")
    assert list(shots.velocities_m_s) == pytest.approx(velocities, abs=1e-9)
    assert list(shots.complete) == [False, True, False]
    assert known(shots.read).sha256 == sha256(content).hexdigest()
    case = scenario()
    tests = armour.read_tests(tmp_path / "t.csv", case)
    assert [m.value for m in tests.measurements] == pytest.approx(velocities, abs=1e-9)
    assert [m.side for m in tests.measurements] == [1, -1, 1]


def test_random_exports_hold_what_was_written(tmp_path: Path):
    endings = [export(Random(seed)).ends(tmp_path / "t.csv") for seed in range(40)]
    assert {*endings} == {"read", "quoted", "refused", "asked"}


def shots_of(folder: Path, text: str, **settings: object) -> armour.Shots:
    (folder / "t.csv").write_text(text)
    return armour.read_shots(folder / "t.csv", **settings)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "v (m/s);result\n10,000;P\n",
            r'line 2: v \(m/s\): must be a number with one meaning, found "10,000": 10 or 10000',
        ),
        ("v (m/s);result\n735,3;P\n741.2;C\n", 'line 3: .* must be a number, found "741.2"'),
        ("velocity_m_s,result\n9.500,P\n9.600,C\n", "line 2: velocity_m_s: must be at least 10 .*, found 9.500"),
        ("velocity_m_s,result\n700,0\n720,1\n", 'line 2: result: must be "stopped" or "perforated"'),
        ("velocity_m_s,result,valid\n700,P,yes\n720,C,perhaps\n", 'line 3: valid: must be yes or no, found "perhaps"'),
        ("velocity_m_s,result,valid\n700,P,no\n720,C,no\n", "must have rows that count"),
        ("velocity_m_s,result,valid\n700,P,-1\n720,C,1\n", 'line 2: valid: must be yes or no, found "-1"'),
        ("velocity_m_s,result,valid\n700,P,\n720,C,yes\n", 'line 2: valid: must be yes or no, found ""'),
        (
            "velocity_m_s,Result (protected yes/no)\n700,no\n720,yes\n",
            'line 2: Result .*: must be "stopped" or "perforated", found "no", which may mean both',
        ),
        ("velocity_m_s,stopped,perforated\n700,yes,yes\n720,no,yes\n", "found several: stopped and perforated"),
        *(
            (f'velocity_m_s,"Result ({said})"\n700,no\n720,yes\n', 'found "no", which may mean both')
            for said in ("P", "Schutz, ja/nein", "PP/CP, visual", "protected: yes", "pass/fail", "stopped, visual")
        ),
        (
            "velocity_m_s,Result (P = perforated)\n700,P\n720,P\n",
            'must agree with the words for results or yes and no, found "P = perforated"',
        ),
        ("velocity_m_s,Perforated (stopped?)\n700,no\n720,yes\n", 'must agree with .*, found "stopped"'),
        ("velocity_m_s,result,panel\n700,P,A\n720,C,\n710,P,\n800,P,B\n", "panel: must be filled .* in line 3, line 4"),
    ],
)
def test_what_may_mean_two_things_is_refused(tmp_path: Path, text: str, message: str):
    with pytest.raises(InputError, match=message):
        shots_of(tmp_path, text)


def test_equal_rows_without_a_name_are_two_shots(tmp_path: Path):
    shots = shots_of(tmp_path, "velocity_m_s,result\n700,P\n700,P\n720,C\n")
    assert (shots.velocities_m_s, shots.complete) == ((700.0, 700.0, 720.0), (False, False, True))
    assert "line 3 equal to an earlier row, counted" in str(shots.read)
    other = shots_of(tmp_path, "shot,velocity_m_s,result\n1,800,P\n1,801,P\n2,810,C\n")
    assert "line 3 with the number of an earlier shot, counted" in str(other.read)
    with pytest.raises(InputError, match="line 4: has the name and velocity of an earlier shot but another result"):
        shots_of(tmp_path, "shot,velocity_m_s,result,remark\n1,801,P,\n1,800,P,\n1,800,C,first\n2,810,C,\n")
    with pytest.raises(InputError, match="line 3: repeats line 2"):
        shots_of(tmp_path, "shot,velocity_m_s,result\n1,700,P\n1,700,P\n2,720,C\n")


@pytest.mark.parametrize(
    ("name", "yes", "no"),
    [
        *(
            (name, "yes", "no")
            for name in ("fair hit", "FairHit", "Valid", "counts", "Accepted", "Used for V50", "Status")
        ),
        *(("G\u00fcltiger Schuss", "ja", "nein"), ("Coup retenu", "oui", "non"), ("Fair hit (Y/N)", "Y", "N")),
        *(("Rejected", "no", "yes"), ("Excluded", "", "x"), ("ung\u00fcltig", "", "X"), ("valid", "x", "")),
        *(("counts", "", "no"), ("Fair hit", "", "N"), ("rejected", "", "yes"), ("Status", "", "rejected")),
        *(("Status", "accepted", "rejected"), ("G\u00fcltigkeit", "i.O.", "n. i. O."), ("Valid (0 = yes)", "0", "1")),
    ],
)
def test_rows_that_do_not_count_are_left_out(tmp_path: Path, name: str, yes: str, no: str):
    shots = shots_of(tmp_path, f"velocity_m_s,result,{name}\n700,P,{yes}\n9,?,{no}\n720,C,{yes}\n")
    assert shots.velocities_m_s == (700.0, 720.0)
    assert shots.read is not None
    assert shots.read.left_out == ("line 3",)
    assert shots.read.words == "commas, 2 shots, without line 3, which does not count"


def test_no_row_is_left_out_without_a_cross(tmp_path: Path):
    assert shots_of(tmp_path, "velocity_m_s,result,Rejected\n700,P,\n720,C,\n").velocities_m_s == (700.0, 720.0)
    with pytest.raises(InputError, match='Accepted: must be yes or no, found ""'):
        shots_of(tmp_path, "velocity_m_s,result,Accepted\n700,P,\n720,C,\n")
    with pytest.raises(InputError, match="line 2: perforated: must be"):
        shots_of(tmp_path, "velocity_m_s,perforated\n700,\n720,\n", one_kind=True)


@pytest.mark.parametrize(
    ("stopped", "perforated"),
    [
        *(("Teildurchschlag", "Volldurchschlag"), ("keine Durchdringung", "Durchdringung"), ("PP", "PC")),
        *(("non travers\u00e9", "travers\u00e9"), ("not penetrated", "penetrated")),
    ],
)
def test_words_for_results(tmp_path: Path, stopped: str, perforated: str):
    shots = shots_of(tmp_path, f"V strike (m/s),Result\n700,{stopped}\n720,{perforated}\n")
    assert shots.complete == (False, True)


@pytest.mark.parametrize("word", ["PP?", "(CP)", "CP*", "perforated!", "~C", "PP [?]"])
def test_a_result_that_is_marked_is_not_certain(tmp_path: Path, word: str):
    with pytest.raises(InputError, match='line 4: result: must be "stopped" or "perforated"'):
        shots_of(tmp_path, f"velocity_m_s,result\n700,P\n720,C\n710,{word}\n")
    with pytest.raises(InputError, match="line 4: counts: must be yes or no"):
        shots_of(tmp_path, "velocity_m_s,result,counts\n700,P,valid\n720,C,valid\n710,P,valid?\n")


def with_column(folder: Path, name: str, cells: str, **settings: object) -> armour.Shots:
    """Read seven shots with a column of these cells, from 700 m/s on in steps of 5 m/s."""
    rows = [f"{700 + 5 * i},{'PPCPCPC'[i]},{cell}" for i, cell in enumerate(cells.split("|"))]
    return shots_of(folder, "\n".join([f"velocity_m_s,result,{name}", *rows, ""]), **settings)


@pytest.mark.parametrize(
    ("name", "cells", "message"),
    [
        ("Unfair hit", "||||x||", "blank (6 shots), x (1 shot); --where 'Unfair hit=' chooses one, --ignore 'Unfair"),
        ("void", "no|no|yes|no|no|no|no", "no (6 shots), yes (1 shot); --where void=no chooses one, --ignore void"),
        ("G\u00fcltiger Treffer", "ja|ja|ja|ja|ja|ja|nein", "ja (6 shots), nein (1 shot); --where 'G\u00fcltiger Tr"),
        ("Ausrei\u00dfer", "||||||ja", "blank (6 shots), ja (1 shot)"),
        ("Remarks", "|NFH|spall on witness||||", "blank (5 shots), NFH (1 shot), spall on witness (1 shot)"),
        ("flag", "||1||||", "blank (6 shots), 1 (1 shot)"),
        (
            "operator",
            "A|A|B|B|B|B|B",
            "B (5 shots), A (2 shots); --where operator=B chooses one, --each operator gives an",
        ),
        ("tile", "8|8|8|8|10|10|10", "8 (4 shots), 10 (3 shots)"),
        ("yaw", "0.4|1.2|0.8|2.1|1.1|6.4|0.9", 'up to 2.1, from 6.4; a column "counts" with "no" leaves shots out'),
        ("yaw", "0.4|1.2|7.3|2.1|1.1|6.4|8.1", "up to 2.1, from 6.4"),
        ("Temp", "-40.1|-39.5|-40.3|60.2|59.9|60.1|-39.9", "up to -39.5, from 59.9"),
        ("", "A|A|B|A|A|A|A", "A (6 shots), B (1 shot); --where 'column 3=A' chooses one, --ignore 'column 3' takes"),
    ],
)
def test_a_column_that_is_not_read_and_divides_the_shots_is_refused(
    tmp_path: Path, name: str, cells: str, message: str
):
    title = name or "column 3"
    with pytest.raises(InputError, match=re.escape(f"{title}: is not read and divides the shots: {message}")):
        with_column(tmp_path, name, cells)
    assert len(with_column(tmp_path, name, cells, ignore=title).velocities_m_s) == 7
    first = cells.split("|")[0]
    chosen = with_column(tmp_path, name, cells, where={title: first}, one_kind=True)
    assert len(chosen.velocities_m_s) == cells.split("|").count(first)


@pytest.mark.parametrize(
    "cells",
    [
        "A|A|A|A|A|A|A",
        "||||||",
        "a|b|c|d|e|f|g",
        "0.4|1.2|0.8|2.1|1.1|3.4|0.8",
        "1.2||0.8|2.1|1.6|2.4|0.9",
        "1|2|3|4|5|6|7",
    ],
)
def test_a_column_that_divides_nothing_is_named(tmp_path: Path, cells: str):
    read = known(with_column(tmp_path, "seen", cells).read)
    assert (read.ignored, read.warnings) == (("seen",), ())
    assert "7 shots, without seen" in read.words


def test_numbers_in_three_rows_are_not_measured_if_they_repeat(tmp_path: Path):
    with pytest.raises(InputError, match=r"mm: is not read and divides the shots: 8 \(2 shots\), 10 \(1 shot\)"):
        shots_of(tmp_path, "velocity_m_s,result,mm\n700,P,8\n720,C,8\n710,P,10\n")


def test_remarks_are_quoted_with_their_rows(tmp_path: Path):
    shots = with_column(tmp_path, "Remarks", "||yaw 6 deg|spall||spall|")
    warning = 'Remarks, which is not read, says "yaw 6 deg" in line 4; "spall" in line 5, line 7'
    assert known(shots.read).warnings == (warning,)
    assert armour.v50(shots, confidence=0.5).warnings[0] == warning
    every = with_column(tmp_path, "Remarks", "|".join(f"edge hit {'abcdefg'[i]}" for i in range(7)))
    assert all(f'"edge hit {letter}"' in known(every.read).warnings[0] for letter in "abcdefg")


def test_no_requirement_is_decided_over_remarks_that_are_not_read(tmp_path: Path):
    shots = with_column(tmp_path, "Remarks", "||yaw 6 deg||||")
    for decide in (armour.v50, lambda fired, **options: armour.plan_shots(shots=fired, **options)):
        with pytest.raises(InputError, match='says "yaw 6 deg" in line 4; for a requirement, a column "counts" with'):
            decide(shots, requirement_m_s=600.0)


def test_tests_and_frames_are_closed_too():
    columns: dict[str, list[Any]] = {
        "armour.ceramic_thickness_mm": [6.0, 8.0, 9.0],
        "ballistic_limit_m_s": [700, 760, 790],
    }
    columns["angle of fire"] = ["0", "0", "30"]
    with pytest.raises(
        InputError, match=r"angle of fire: is not read and divides the tests: 0 \(2 tests\), 30 \(1 test\)"
    ):
        armour.read_tests(columns, scenario())
    assert len(armour.read_tests(columns, scenario(), ignore=["angle of fire"]).names) == 3
    with pytest.raises(InputError) as refused:
        armour.read_shots({"velocity_m_s": [700, 720, 710], "result": ["P", "C", "C"], "ok": [True, True, False]})
    assert refused.value.options == ("--where", "ok=True")


def test_a_copy_of_a_column_and_a_misspelling_that_is_none_may_be_named(tmp_path: Path):
    text = "velocity_m_s,result,Shot OK?\n700,P,ok\n720,C,ok\n705,C,NOK\n"
    with pytest.raises(InputError, match=r"Shot OK\?: unknown column; did you mean"):
        shots_of(tmp_path, text)
    assert shots_of(tmp_path, text, where={"Shot OK?": "ok"}).velocities_m_s == (700.0, 720.0)
    assert len(shots_of(tmp_path, text, ignore="Shot OK?").velocities_m_s) == 3
    both = "velocity_m_s,result,Note,Note\n700,P,A,1\n720,C,A,1\n705,C,B,2\n"
    assert len(shots_of(tmp_path, both, ignore="Note").velocities_m_s) == 3


@pytest.mark.parametrize("name", ["Strike face (mm)", "Plate in inches", "Winkel (\u00b0)", "Unsicherheit (m/s)"])
def test_a_column_that_may_be_an_input_is_not_left_out_silently(tmp_path: Path, name: str):
    text = f"test;V50 (m/s);Charge (gr);V50 (ft/s);{name}\n1;700;40;2296,6;6\n2;762;45;2500;8\n"
    (tmp_path / "t.csv").write_text(text)
    if "mm" in name or "inches" in name:
        with pytest.raises(InputError, match=f"{re.escape(name)}: is not read and differs between tests"):
            armour.read_tests(tmp_path / "t.csv", scenario())
    tests = armour.read_tests(tmp_path / "t.csv", scenario(), ignore=name)
    [warning] = armour.calibrate(tests, scenario()).warnings[:1]
    assert warning.startswith(f"not read: {name}; an input is named by its key")


def test_rows_that_sum_up_others_are_left_out(tmp_path: Path):
    rows = "1;812,4;PP;yes\n2;846,9;CP;yes\nMittelwert;830,95;;\nStabw.;10,3;;\nV50 (1+1);829,7;CP;\nStd. dev.;9;;\n"
    shots = shots_of(tmp_path, f"Shot;Velocity (m/s);Result;Valid\n{rows}")
    assert (shots.names, shots.velocities_m_s) == (("1", "2"), (812.4, 846.9))
    assert "without line 4, line 5, line 6, line 7, which do not count" in str(shots.read)


@pytest.mark.parametrize(
    ("name", "stopped", "perforated"),
    [
        *(("Result (stopped?)", "yes", "no"), ("R\u00e9sultat (non perfor\u00e9 oui/non)", "oui", "non")),
        *(("Durchschlag (0 = ja, 1 = nein)", "1", "0"), ("Perforated (1 = no)", "1", "0")),
        ("Stopped (0 = yes)", "0", "1"),
        *(("Result (0 = perforated, 1 = stopped)", "1", "0"), ("Result (P = partial, C = complete)", "P", "C")),
        *(("Result (witness plate)", "P.P.", "C.P."), ("Perforated (visual)", "no", "yes"), ("Durchschlag", "", "x")),
    ],
)
def test_what_a_header_says_of_the_words_below_it(tmp_path: Path, name: str, stopped: str, perforated: str):
    shots = shots_of(tmp_path, f'velocity_m_s,"{name}"\n700,{stopped}\n720,{perforated}\n710,{stopped}\n')
    assert shots.complete == (False, True, False)


@pytest.mark.parametrize("name", ["Panel #", "PlattenNr", "N\u00b0 de plaque", "Ziel Nr.", "Batch"])
def test_names_of_panels_may_have_a_word_for_number(tmp_path: Path, name: str):
    with pytest.raises(InputError, match=f"{name}: divides the shots: 1 "):
        shots_of(tmp_path, f"velocity_m_s,result,{name}\n700,P,1\n720,C,1\n800,P,2\n820,C,2\n")


def test_tests_of_several_lots_are_not_one_lot(tmp_path: Path):
    text = "Los Nr.;ballistic_limit_m_s;armour.ceramic_thickness_mm;Wetter\na;700;8;nass\nA;760;8;nass\n"
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(
        InputError, match=r"Los Nr\.: divides the tests: a \(1 test\), A \(1 test\); --where 'Los Nr\.=a'"
    ):
        armour.read_tests(tmp_path / "t.csv", scenario())
    tests = armour.read_tests(tmp_path / "t.csv", scenario(), where={"lot": "A"})
    assert [m.value for m in tests.measurements] == [760.0]
    others = "without 1 row of other Los Nr., even a, which differs in case or blanks alone"
    assert known(tests.read).words == f"semicolons, 1 test, lot A, {others}, without Wetter"


def test_several_panels_are_not_pooled(tmp_path: Path):
    text = "velocity_m_s,result,panel\n700,P,A\n720,C,A\n800,P,B\n820,C,B\n810,P,C\n"
    with pytest.raises(InputError, match=r"panel: divides the shots: A \(2 shots\), B \(2 shots\), C"):
        shots_of(tmp_path, text)
    assert shots_of(tmp_path, text, where={"panel": "B"}).velocities_m_s == (800.0, 820.0)
    with pytest.raises(InputError, match='where panel: must be one of A, B, C, found "D"'):
        shots_of(tmp_path, text + "720,C,\n", where={"panel": "D"})
    with pytest.raises(InputError, match="panel: must be filled in every row that counts, found blank cells in line 7"):
        shots_of(tmp_path, text + "720,C,\n", where={"panel": "A"})
    with pytest.raises(InputError, match='where: must name a column, found "yaw"'):
        shots_of(tmp_path, text, where={"yaw": "1"})
    with pytest.raises(InputError, match="panel: divides the tests"):
        armour.read_tests(tmp_path / "t.csv", scenario())
    assert len(armour.read_tests(tmp_path / "t.csv", scenario(), where={"panel": "A"}).names) == 2
    serial = "velocity_m_s,result,Plate No\n700,P,1\n720,C,2\n710,P,3\n730,C,4\n"
    assert len(shots_of(tmp_path, serial).velocities_m_s) == 4
    with pytest.raises(InputError, match=r"Plate No: divides the shots: 1 \(3 shots\), 2 \(1 shot\)"):
        shots_of(tmp_path, "velocity_m_s,result,Plate No\n700,P,1\n720,C,1\n710,P,1\n730,C,2\n")


def test_own_tests_as_a_laboratory_exports_them(tmp_path: Path):
    text = (
        "\ufeffVersuch;Keramik;Dicke Keramik [mm];R\u00fccken;Dicke Stahl [mm];"
        "Geschoss;V50 [ft/s];s [m/s];Datum;Labor\n"
        "F1;AD85;8,0;6061-T6;6,5;7.62 mm AP;2444;12,0;2026-03-02;X\r\n"
        "F2;AD85;6,125;6061-T6;6,375;7.62 mm AP;2343;15,5;2026-03-03;X\r\n"
    )
    (tmp_path / "t.csv").write_text(text, newline="")
    tests = armour.read_tests(tmp_path / "t.csv", scenario())
    assert [m.value for m in tests.measurements] == pytest.approx([2444 * FEET, 2343 * FEET])
    assert [m.uncertainty for m in tests.measurements] == [12.0, 15.5]
    assert [cells["armour.ceramic_thickness_mm"] for cells in tests.cells] == [8.0, 6.125]
    assert known(tests.read).ignored == ()


@pytest.mark.parametrize("nothing", [None, float("nan"), NotAvailable(), np.ma.masked, pa.scalar(None)])
def test_a_row_without_values_is_no_row_that_may_be_left_out(nothing: object):
    for row, values in ((2, [5.0, nothing, 7.0]), (3, [5.0, 7.0, nothing])):
        with pytest.raises(InputError, match=rf"row {row}: armour\.ceramic_thickness_mm: must be a number"):
            armour.sweep(scenario(), cases={"armour.ceramic_thickness_mm": values})


@pytest.mark.parametrize(
    ("velocities", "found"),
    [
        ([np.array([700.0, 710.0]), 720.0], "[700. 710.]"),
        (np.ones((2, 2)), "[1.0, 1.0]"),
        ([Quantity(0.25), 720.0], "0.25 inch"),
        (Quantity([0.25, 720.0]), "0.25 inch"),
    ],
)
def test_a_cell_that_is_no_number(velocities: Any, found: str):
    message = re.escape(f'rows: row 1: velocity_m_s: must be a number, found "{found}"')
    with pytest.raises(InputError, match=message):
        armour.read_shots({"velocity_m_s": velocities, "result": ["P", "C"]})
    rows = [{"velocity_m_s": value, "result": "P"} for value in velocities]
    with pytest.raises(InputError, match=r'rows: row 1: velocity_m_s: must be a number, found "'):
        armour.read_shots(rows, one_kind=True)


def test_a_text_is_no_column():
    with pytest.raises(InputError, match="rows: must be a path, rows as mappings, columns of equal length"):
        armour.read_shots({"velocity_m_s": "700", "result": "PPP"})


@pytest.mark.parametrize("key", ["id", "title", "model.shear_perimeter"])
def test_texts_below_what_is_no_key_of_numbers(key: str):
    cases: dict[str, Any] = {"armour.ceramic_thickness_mm": [5.0, 6.0], key: ["conoid", "projectile"]}
    with pytest.raises(InputError, match=f'rows: header: {key}: must be a key of numbers, found "conoid"'):
        armour.sweep(scenario(), cases=cases)


@pytest.mark.parametrize("said", [True, 0])
def test_a_result_that_may_mean_both_names_its_column(said: object):
    shots: dict[str, Any] = {"velocity_m_s": [700.0, 720.0], "result": [said, said]}
    with pytest.raises(InputError, match='such a column needs the name "perforated" or "stopped"'):
        armour.read_shots(shots)


def test_columns_of_different_lengths_are_refused():
    columns: dict[str, list[object]] = {"velocity_m_s": [700.0, 720.0], "result": ["P"]}
    with pytest.raises(InputError, match="columns of equal length"):
        armour.read_shots(columns)


def test_cases_of_a_spreadsheet(tmp_path: Path):
    (tmp_path / "t.csv").write_bytes(
        b"\xef\xbb\xbfDicke Keramik [mm];backing thickness (in);\r\n6,35;0,25;\r\n8;0,5;\r\n"
    )
    found = armour.sweep(scenario(), cases=tmp_path / "t.csv", quantities="areal_density_kg_m2")
    assert found["armour.ceramic_thickness_mm"].tolist() == [6.35, 8.0]
    assert found["armour.backing_thickness_mm"].tolist() == [6.35, 12.7]
    (tmp_path / "t.csv").write_text("ceramic.flow_stress_GPa;armour.ceramic_thickness_mm\n3,500;6\n")
    with pytest.raises(InputError, match='must be a number with one meaning, found "3,500"'):
        armour.sweep(scenario(), cases=tmp_path / "t.csv")


def test_a_workbook(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["Range report"])
    book.active.append(["Shot No", "Velocity (ft/s)", "Result", "Valid"])
    for row in ([1, 2415.3, "PP", True], [2, 2498.7, "CP", True], [3, 9999.0, "CP", False]):
        book.active.append(row)
    book.create_sheet("second").append(["velocity_m_s", "result"])
    book["second"].append([700, "P"])
    book["second"].append([720, "C"])
    path = tmp_path / "t.xlsx"
    book.save(path)
    with pytest.raises(InputError, match=r"must have one visible sheet with a table, found Sheet, second; --sheet ch"):
        armour.read_shots(path)
    assert armour.read_shots(path, sheet="second").velocities_m_s == (700.0, 720.0)
    with pytest.raises(InputError, match=r"t.xlsx: must have the sheet third, found Sheet, second"):
        armour.read_shots(path, sheet="third")
    book["second"].sheet_state = "hidden"
    book.create_sheet("cover", 0).append(["Report"])
    book.save(path)
    assert armour.read_shots(path).velocities_m_s == pytest.approx((2415.3 * FEET, 2498.7 * FEET))
    assert "sheet Sheet" in known(armour.read_shots(path).read).words
    book["second"]["A3"] = "=1*2"
    book.save(path)
    with pytest.raises(InputError, match="row 3: velocity_m_s: is missing and must be given; if it is a formula"):
        armour.read_shots(path, sheet="second")
    book["second"]["A2"] = "=1*2"
    book.save(path)
    with pytest.raises(InputError, match="velocity_m_s: must have values, found none; save the workbook after"):
        armour.read_shots(path, sheet="second")
    monkeypatch.setattr("armour.workbooks.MAX_UNPACKED", 1000)
    with pytest.raises(InputError, match=r"must be at most 1,000 bytes long$"):
        armour.read_shots(path)


@pytest.mark.parametrize("mark", ["hidden", "struck through"])
def test_rows_of_a_sheet_that_are_not_to_be_read(tmp_path: Path, mark: str):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in (["velocity_m_s", "result", "counts"], [700, "P", "yes"], [720, "C", "yes"], [800, "P", "no"]):
        book.active.append(row)
    book.active.row_dimensions[4].hidden = mark == "hidden"
    book.active["A4"].font = openpyxl.styles.Font(strike=mark != "hidden")
    book.save(tmp_path / "t.xlsx")
    assert armour.read_shots(tmp_path / "t.xlsx").velocities_m_s == (700.0, 720.0)
    book.active["C4"] = "yes"
    book.save(tmp_path / "t.xlsx")
    with pytest.raises(InputError, match=f"row 4: must not be {mark} if it counts"):
        armour.read_shots(tmp_path / "t.xlsx")


def test_comments_of_cells_are_named(tmp_path: Path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in (["velocity_m_s", "result"], [700, "P"], [720, "C"]):
        book.active.append(row)
    book.active["B3"].comment = openpyxl.comments.Comment("yaw 6 deg", "Jones")
    book.active["B3"].hyperlink = "https://example.org"
    book.save(tmp_path / "t.xlsx")
    read = known(armour.read_shots(tmp_path / "t.xlsx").read)
    assert read.words == "sheet Sheet, without the comments of B3, 2 shots"


def test_velocities_in_feet_are_named_as_such():
    case = scenario(uncertainty={"model": {"included": False}})
    shots = armour.Shots((2350.0, 2400.0, 2370.0, 2420.0), (False, True, False, True))
    assert "they are probably ft/s" in armour.v50(shots, case, confidence=0.5).warnings[0]
    slow = armour.Shots((700.0, 720.0), (False, True))
    assert not any("ft/s" in text for text in armour.v50(slow, case, confidence=0.5).warnings)
    rows = [{"armour.ceramic_thickness_mm": 5, "ballistic_limit_m_s": 2170}]
    fitted = armour.calibrate(armour.read_tests(rows, scenario()), scenario())
    assert (
        "row 1: a measured limit is impossible for any lot of such armour; check it, its unit and the armour"
        in fitted.warnings
    )


def test_json_holds_the_shots_and_the_hash_of_their_table(tmp_path: Path):
    content = EXPORTS["feet"][0]
    (tmp_path / "t.csv").write_bytes(content)
    shots = armour.read_shots(tmp_path / "t.csv")
    fired = json.loads(json.dumps(armour.v50(shots, confidence=0.5).to_dict()))["fired"]
    assert fired["velocities_m_s"] == pytest.approx(EXPORTS["feet"][1])
    assert fired["read"]["sha256"] == sha256(content).hexdigest()
    assert fired["read"]["words"] == "semicolons, decimal commas, velocity in ft/s, 3 shots, without Yaw"
