"""Shots that are added to the file that `v50` reads."""

from pathlib import Path

import pytest

from armour.errors import InputError
from armour.planning.shot_file import with_shot, without_last
from armour.statistics.v50 import read_shots


@pytest.mark.parametrize(
    ("text", "row"),
    [
        ("velocity_m_s,result\n700,partial\n", "750,complete\n"),
        ("result,velocity_m_s\nP,700\n", "C,750\n"),
        ("velocity_m_s,result\r\n700,partial\r\n", "750,complete\r\n"),
        ("velocity_m_s,result\n700,PARTIAL", "\n750,COMPLETE\n"),
        ("velocity_m_s,result\n700,pp\n", "750,cp\n"),
        ('\ufeff"velocity_m_s", result\r\n"700",P\r\n,\r\n', "750,C\r\n"),
        ("result,velocity_m_s\r\nP,7e2", "\r\nC,750\r\n"),
        ("velocity_m_s , result, shot\n700, p ,7\n\n", "750,c,8\n"),
        ("shot,velocity_m_s,result\na,700,partial\n", "2,750,complete\n"),
        (f"shot,velocity_m_s,result\n{'9' * 4301},700,partial\n", "2,750,complete\n"),
        ("shot,velocity_m_s,result,remark\nA1,700,partial,clean\n", "2,750,complete,\n"),
    ],
)
def test_columns_ends_of_lines_and_letters_stay(tmp_path: Path, text: str, row: str):
    path = tmp_path / "s.csv"
    path.write_bytes(text.encode())
    made = with_shot(path, 750.0, "complete")
    assert made == (text + row).encode()
    path.write_bytes(made)
    assert read_shots(path).complete == (False, True)


def test_a_shot_that_repeats_another_is_another_shot(tmp_path: Path):
    path = tmp_path / "s.csv"
    path.write_text("velocity_m_s,result\n700,partial\n")
    path.write_bytes(with_shot(path, 700.0, "partial"))
    assert path.read_text() == "velocity_m_s,result\n700,partial\n700,partial\n"
    assert read_shots(path, one_kind=True).velocities_m_s == (700.0, 700.0)


@pytest.mark.parametrize(
    ("text", "encoding", "row"),
    [
        ("\ufeffShot No;Velocity (ft/s);Result (PP/CP);Remarks\r\n1;2415,3;PP;\r\n", "utf-8", "2;2460,62992;CP;\r\n"),
        ("Schuss\tv [m/s]\tErgebnis\r\n1\t735,3\tkein Durchschlag\r\n", "utf-16", "2\t750\tDurchschlag\r\n"),
        ("n\u00b0;V (m/s);r\u00e9sultat\n1;735,5;non perfor\u00e9\n", "cp1252", "2;750;perfor\u00e9\n"),
        ("sep=;\nv (m/s);perforated;valid\n735.5;0;ja\n", "utf-8", "750;1;ja\n"),
        ("velocity_m_s,stopped\n735.5,yes\n", "utf-8", "750,no\n"),
        ('Shot;Velocity (ft/s);Result\n1;"2,757.7";PP\n', "utf-8", "2;2460.62992;CP\n"),
        ('Shot,Velocity (ft/s),Result\n1,"2,757",PP\n', "utf-8", "2,2460.62992,CP\n"),
        ("v (ft/s);Ergebnis\n2.757;Kein Durchschlag\n", "utf-8", "2460,62992;Durchschlag\n"),
        ("v (m/s);Durchschlag;valid;Panel\n735,5;;x;A\n755,5;x;x;A\n", "utf-8", "750;x;x;A\n"),
        ("velocity_m_s,result,counts\n735.5,P,\n800,C,no\n", "utf-8", "750,C,\n"),
        ("v (m/s),v (ft/s),PP,CP\n700,2296.6,x,\n800,2624.7,,x\n", "utf-8", "750,2460.62992,,x\n"),
        ("v (m/s);Ergebnis;ung\u00fcltig\n735,5;kein Durchschlag;nein\n", "utf-8", "750;Durchschlag;nein\n"),
        ("v (m/s);Ergebnis;gewertet\n735,5;PP;\n740;PP;nein\n755,5;CP;\n", "utf-8", "750;CP;\n"),
        ("V1 (m/s),V2 (m/s),result\n700,702,P\n730,728,C\n", "utf-8", "750,750,C\n"),
        ("velocity_m_s,result,armour and round\n735.5,P,a b\n755.5,C,a b\n", "utf-8", "750,C,a b\n"),
    ],
)
def test_a_shot_is_written_as_the_others_are(tmp_path: Path, text: str, encoding: str, row: str):
    path = tmp_path / "s.csv"
    path.write_bytes(text.encode(encoding))
    made = with_shot(path, 750.0, "complete")
    assert made.decode(encoding) == (text + row).removeprefix("\ufeff" if encoding == "utf-16" else "")
    path.write_bytes(made)
    shots = read_shots(path)
    assert (shots.complete[0], shots.complete[-1]) == (False, True)
    assert shots.velocities_m_s[-1] == pytest.approx(750.0, rel=1e-8)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "cp1252"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_the_last_shot_that_counts_is_taken_back(tmp_path: Path, encoding: str, end: str):
    rows = ("n\u00b0;v (m/s);r\u00e9sultat;valable;plaque", "1;700;PP;oui;A", "2;720,5;CP;oui;A", "3;710;PP;oui;B", "")
    path, text = tmp_path / "s.csv", end.join((*rows[:-1], "4;750;CP;non;B", "moyenne;715;;;", ""))
    path.write_bytes(text.encode(encoding))
    for where, taken in ((None, rows[3]), ({"plaque": "A"}, rows[2])):
        content, said = without_last(path, where)
        assert content.decode(encoding) == text.replace(taken + end, "")
        assert said == f"line {rows.index(taken) + 1}: {taken}"
    for none in ("", "velocity_m_s,result\n", "velocity_m_s,result,counts\n700,P,no\n"):
        path.write_text(none)
        with pytest.raises(InputError, match="must have a shot to take back, found none"):
            without_last(path)


def test_a_new_file_says_what_the_shots_are_at(tmp_path: Path):
    path = tmp_path / "s.csv"
    path.write_bytes(with_shot(path, 700.0, "partial", target="8 mm AD85, glued"))
    path.write_bytes(with_shot(path, 720.0, "complete", target="8 mm AD85, glued"))
    shots = read_shots(path)
    assert (shots.target, shots.names) == ("8 mm AD85, glued", ("1", "2"))
    assert shots.read is not None
    assert shots.read.plain
    path.write_text(f"{path.read_text()}3,730,complete,something else\n")
    with pytest.raises(InputError, match=r"armour and round: divides the shots: 8 mm AD85, glued \(2 shots\), "):
        read_shots(path)


def test_a_shot_at_one_of_several_panels(tmp_path: Path):
    path = tmp_path / "s.csv"
    path.write_text("velocity_m_s,result,panel\n700,P,A\n720,C,A\n800,P,B\n820,C,B\n")
    assert with_shot(path, 710.0, "stopped", {"panel": "B"}).endswith(b"\n710,P,B\n")


def test_other_columns_stay_and_misspelt_ones_are_refused(tmp_path: Path):
    path = tmp_path / "s.csv"
    path.write_text("shot,velocity_m_s,result,yaw_deg\nA1,700,partial,1\nA2,750.25,complete,\n")
    assert read_shots(path).names == ("A1", "A2")
    for header, wrong in (("velocity_m_s,result", "shots"), ("velocity_m_s,shot", "results")):
        path.write_text(f"{header},{wrong}\n700,partial,1\n")
        with pytest.raises(InputError, match=f"{wrong}: unknown column"):
            read_shots(path, one_kind=True)
    path.write_text("test,ballistic_limit_m_s\na,700\n")
    with pytest.raises(InputError, match="ballistic_limit_m_s: unknown column; choose from velocity_m_s, shot, result"):
        read_shots(path)
