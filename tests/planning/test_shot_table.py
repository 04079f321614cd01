"""Shots are added to the file that `v50` reads."""

from pathlib import Path

import pytest

from armour.errors import InputError
from armour.planning.shot_table import with_shot
from armour.statistics.v50 import read_shots


def test_a_new_file(tmp_path: Path):
    path = tmp_path / "s.csv"
    path.write_text(with_shot(path, 722.8, "partial"))
    path.write_text(with_shot(path, 772.25, "complete"))
    assert path.read_text() == "shot,velocity_m_s,result\n1,722.8,partial\n2,772.25,complete\n"
    read = read_shots(path)
    assert (read.velocities_m_s, read.complete) == ((722.8, 772.25), (False, True))


@pytest.mark.parametrize(
    ("text", "row"),
    [
        ("velocity_m_s,result\n700,partial\n", "750,complete\n"),
        ("result,velocity_m_s\nP,700\n", "C,750\n"),
        ("velocity_m_s,result\r\n700,partial\r\n", "750,complete\r\n"),
        ("velocity_m_s,result\n700,PARTIAL", "\n750,COMPLETE\n"),
        ("velocity_m_s,result\n700,Partial\n", "750,Complete\n"),
        ("velocity_m_s , result, shot\n700, p ,7\n\n", "750,c,8\n"),
        ("shot,velocity_m_s,result\na,700,partial\n", "2,750,complete\n"),
        ("shot,velocity_m_s,result,remark\nA1,700,partial,clean\n", "2,750,complete,\n"),
    ],
)
def test_columns_ends_of_lines_and_letters_stay(tmp_path: Path, text: str, row: str):
    path = tmp_path / "s.csv"
    path.write_bytes(text.encode())
    made = with_shot(path, 750.0, "complete")
    assert made == text + row
    path.write_bytes(made.encode())
    assert read_shots(path).complete == (False, True)


def test_a_shot_that_repeats_another_gets_a_name(tmp_path: Path):
    path = tmp_path / "s.csv"
    path.write_text("velocity_m_s,result\n700,partial\n")
    path.write_text(with_shot(path, 700.0, "partial"))
    assert path.read_text() == "shot,velocity_m_s,result\n1,700,partial\n2,700,partial\n"
    assert read_shots(path, one_kind=True).names == ("1", "2")
    path.write_text('velocity_m_s,result,remark\n700,partial,\n710,complete,"a, b"\n')
    assert with_shot(path, 700.0, "partial").splitlines()[2:] == ['2,710,complete,"a, b"', "3,700,partial,"]
    path.write_text("velocity_m_s,result,shot\n700,partial,1\n")
    assert with_shot(path, 700.0, "partial").endswith("\n700,partial,2\n")


def test_other_columns_stay_and_misspelt_ones_are_refused(tmp_path: Path):
    path = tmp_path / "s.csv"
    path.write_text("shot,velocity_m_s,result,yaw_deg\nA1,700,partial,1\nA2,750.25,complete,\n")
    assert read_shots(path).names == ("A1", "A2")
    for wrong in ("shots", "velocity", "results"):
        path.write_text(f"velocity_m_s,result,{wrong}\n700,partial,1\n")
        with pytest.raises(InputError, match=f"{wrong}: unknown column"):
            read_shots(path, one_kind=True)
