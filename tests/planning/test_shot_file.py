"""Shots that are added to the file that `v50` reads."""

from pathlib import Path

import pytest

from armour.errors import InputError
from armour.planning import shot_file
from armour.planning.shot_file import locked, with_shot
from armour.statistics.v50 import read_shots


@pytest.mark.parametrize(
    ("text", "row"),
    [
        ("velocity_m_s,result\n700,partial\n", "750,complete\n"),
        ("result,velocity_m_s\nP,700\n", "C,750\n"),
        ("velocity_m_s,result\r\n700,partial\r\n", "750,complete\r\n"),
        ("velocity_m_s,result\n700,PARTIAL", "\n750,COMPLETE\n"),
        ("velocity_m_s,result\n700,Partial\n", "750,Complete\n"),
        ("velocity_m_s,result\n700,PP\n", "750,CP\n"),
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


def test_a_shot_that_repeats_another_gets_a_name(tmp_path: Path):
    path = tmp_path / "s.csv"
    path.write_text("velocity_m_s,result\n700,partial\n")
    path.write_bytes(with_shot(path, 700.0, "partial"))
    assert path.read_text() == "shot,velocity_m_s,result\n1,700,partial\n2,700,partial\n"
    assert read_shots(path, one_kind=True).names == ("1", "2")
    path.write_text('velocity_m_s,result,remark\n700,partial,\n710,complete,"a, b"\n')
    assert with_shot(path, 700.0, "partial").splitlines()[2:] == [b'2,710,complete,"a, b"', b"3,700,partial,"]
    path.write_bytes(b"\xef\xbb\xbfvelocity_m_s , result\r\n\r\n700, P")
    assert with_shot(path, 700.0, "partial") == b"\xef\xbb\xbfshot,velocity_m_s , result\r\n\r\n1,700, P\r\n2,700,P\r\n"
    path.write_text("velocity_m_s,result,shot\n700,partial,1\n")
    assert with_shot(path, 700.0, "partial").endswith(b"\n700,partial,2\n")


def test_other_columns_stay_and_misspelt_ones_are_refused(tmp_path: Path):
    path = tmp_path / "s.csv"
    path.write_text("shot,velocity_m_s,result,yaw_deg\nA1,700,partial,1\nA2,750.25,complete,\n")
    assert read_shots(path).names == ("A1", "A2")
    for wrong in ("shots", "velocity", "results"):
        path.write_text(f"velocity_m_s,result,{wrong}\n700,partial,1\n")
        with pytest.raises(InputError, match=f"{wrong}: unknown column"):
            read_shots(path, one_kind=True)
    path.write_text("test,ballistic_limit_m_s\na,700\n")
    with pytest.raises(
        InputError, match=r"s.csv: must be a table of shots .*, found tests; armour calibrate fits inputs"
    ):
        read_shots(path)


def test_a_locked_table_is_refused_after_a_while(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(shot_file, "WAIT_S", 0.1)
    (tmp_path / "link.csv").symlink_to(tmp_path / "s.csv")
    with (
        locked(tmp_path / "s.csv"),
        pytest.raises(InputError, match=r"link.csv: cannot be written: other commands"),
        locked(tmp_path / "link.csv"),
    ):
        pass
    with locked(tmp_path / "link.csv"):
        pass
